"""Builds the rclcpp nodes of examples/ros2 and holds what they print against its README.

    ros2_nodes.py EXAMPLES BUILD PREFIX

EXAMPLES is the folder examples/ros2, BUILD is for the build, ROS 2 is in PREFIX (folders, separated
by colons). Left out is what depends on how fast the machine is: the numbers of `late-server`
without `wait`, whether the second call of `nested reentrant` is answered when the first gives up,
and `camera` with images that take long.
"""

import os
import pathlib
import signal
import subprocess
import sys

LIMIT = 60  # seconds, of one program


def blocks(readme):
    """The commands of the section "The nodes", each with the lines that it prints."""
    section = readme.split("\n## The nodes\n")[1].split("\nOver Fast DDS ")[0]
    commands = []
    for line in section.splitlines():
        if line.startswith("    $ "):
            commands.append((line[6:].split("#")[0].split(), []))
        elif line.startswith("    ") and commands:
            commands[-1][1].append(line.strip())
    return commands


def is_steady(command):
    unsteady = (["late-server"], ["nested", "reentrant"])
    return command not in unsteady and command[:2] != ["camera", "own"]


def run(build, command, lines):
    """The first so many lines that the program prints; what goes on behind them is interrupted."""
    program = subprocess.Popen(
        [str(build / command[0])] + command[1:],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, bufsize=1,
    )
    signal.alarm(LIMIT)
    try:
        return [program.stdout.readline().strip() for _ in range(lines)]
    finally:
        signal.alarm(0)
        program.send_signal(signal.SIGINT)
        try:
            program.wait(LIMIT)
        except subprocess.TimeoutExpired:
            program.kill()
            program.wait()


def main(examples, build, prefix):
    folders = {"AMENT_PREFIX_PATH": "", "CMAKE_PREFIX_PATH": "", "LD_LIBRARY_PATH": "/lib"}
    for name, folder in folders.items():
        os.environ[name] = ":".join(one + folder for one in prefix.split(":"))
    os.environ["ROS_LOCALHOST_ONLY"] = "1"
    os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 100)
    os.environ["RCUTILS_LOGGING_USE_STDOUT"] = "0"
    for step in (["-S", str(examples), "-B", str(build)], ["--build", str(build)]):
        built = subprocess.run(["cmake"] + step, capture_output=True, text=True)
        if built.returncode != 0:
            print(built.stdout + built.stderr)
            return 1
    page = examples / "README.md"
    commands = [block for block in blocks(page.read_text()) if is_steady(block[0])]
    if len(commands) < 12:
        print(f"only {len(commands)} commands were found in {page}")
        return 1
    failed = 0
    for command, expected in commands:
        seen = run(build, command, len(expected))
        is_right = seen == expected
        found = "as the page says" if is_right else f"{seen}, not {expected}"
        print(" ".join(command) + ":", found)
        failed += not is_right
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]))
