"""Checks on the sources: what a reader relies on and no compiler looks at.

    check_sources.py CHECK FOLDER

Each check prints one line a finding, "file:line: what is wrong", and exits 1 if there is any.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

# The layers of src/maide, lowest first. A file includes its own layer and those below it, with three
# exceptions: a wrapper's process carries no learner, so sul and wire do without formats; check knows
# nothing of learning, and learning nothing of it; the public face does without the command line.
LAYERS = ["base", "automata", "formats", "sul", "wire", "learn", "conformance", "experiment", "check", "extract",
          "ros2", "join", "report", "cli", "face"]
WRAPPER_LAYERS = ["base", "automata", "sul", "wire"]
LEARNING_LAYERS = ["sul", "wire", "learn", "conformance", "experiment"]
# The library that each layer belongs to (maide_layer() in its CMakeLists.txt). A library is linked
# with those below it alone, so these are the layers of each that may go without the others.
LIBRARIES = {"maide_base": ["base", "automata", "formats"], "maide_wrapper": ["sul", "wire"],
             "maide_learning": ["learn", "conformance", "experiment"], "maide_checking": ["check", "extract"],
             "maide": ["ros2", "join", "report"]}
FACE = ["maide.hpp", "learn.hpp", "check.hpp", "wrapper.hpp"]

# The rooms of src/maide/check, lowest first. A file includes its own room and those below it.
ROOMS = ["text", "language", "tree", "ltl", "system", "rules", "unroll", "build", "packed", "reduce", "search",
         "engines/export", "engines", "verdict"]

# Includes against the order that are still there, by the including file. This list only shrinks.
UPWARD = {
}


def allowed_layers(layer):
    if layer in WRAPPER_LAYERS:
        return set(WRAPPER_LAYERS[: WRAPPER_LAYERS.index(layer) + 1])
    allowed = set(LAYERS[: LAYERS.index(layer) + 1])
    if layer == "check":
        allowed -= set(LEARNING_LAYERS)
    if layer == "face":
        allowed.discard("cli")
    return allowed


CODE = {".cpp", ".hpp", ".py", ".sh"}
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')


class Sources:
    """The files under version control, or, in an unpacked archive, all files."""

    def __init__(self, root):
        self.root = root
        listing = subprocess.run(["git", "-C", root, "ls-files", "-z", "--cached", "--others",
                                  "--exclude-standard"], capture_output=True, text=True)
        if listing.returncode == 0:
            names = [name for name in listing.stdout.split("\0") if name]
        else:
            names = [str(path.relative_to(root)) for path in root.rglob("*") if path.is_file()
                     and path.relative_to(root).parts[0] not in ("build", ".git")]
        self.files = sorted(Path(name) for name in names if (root / name).is_file())

    def text(self, path):
        return (self.root / path).read_text(encoding="utf-8", errors="replace")

    def code(self):
        return [path for path in self.files if path.suffix in CODE or
                (path.parts[0] in ("scripts", ".ci") and path.suffix == "")]


def inside(path):
    """The path below src/maide of a file or of an include, such as "maide/base/error.hpp"; else None."""
    parts = path.parts[1:] if path.parts[0] == "src" else path.parts
    return Path(*parts[1:]) if len(parts) > 2 and parts[0] == "maide" else None


def layer_of(path):
    below = inside(path)
    return below.parts[0] if below else None


def room_of(path):
    """The room in check of a file or of an include; None outside of check."""
    below = inside(path)
    return "/".join(below.parts[1:-1]) if below and below.parts[0] == "check" else None


def check_layering(sources):
    upward = {file: set(includes) for file, includes in UPWARD.items()}
    for path in sources.code():
        if path.suffix not in (".cpp", ".hpp"):
            continue
        in_library = path.parts[:2] == ("src", "maide")
        in_wrapper = path.parts[0] == "wrappers"
        if in_library and layer_of(path) == "check" and room_of(path) not in ROOMS:
            yield path, 1, f"lies in no room of check; they are {', '.join(ROOMS)}"
            continue
        for number, line in enumerate(sources.text(path).splitlines(), 1):
            match = INCLUDE.match(line)
            if not match:
                continue
            included = match.group(1)
            if "../" in included:
                yield path, number, f"includes {included}: write the path from src/"
                continue
            if in_library and "/" not in included and line.rstrip().endswith('"'):
                yield path, number, f"includes {included}: write the path from src/"
            layer = layer_of(Path(included))
            if in_library and layer_of(path) not in (None, "face") and included.startswith("maide/"):
                if Path(included).name in FACE and layer is None:
                    yield path, number, f"includes {included}, the public face above it"
            if layer is None:
                continue
            if not (sources.root / "src" / included).is_file():
                yield path, number, f"includes {included}, which is not there"
                continue
            if in_wrapper and layer not in WRAPPER_LAYERS:
                yield path, number, f"a wrapper must not include {included}"
            own = layer_of(path) if in_library else None
            if own is None:
                continue
            if path.name == "learn.cpp" and own == "face" and layer in ("check", "ros2", "join", "report"):
                yield path, number, f"learning must not include {included}"
            known = upward.get(str(inside(path)), set())
            if str(inside(Path(included))) in known:
                known.discard(str(inside(Path(included))))
            elif layer not in allowed_layers(own):
                yield path, number, f"layer {own} must not include {included}"
            elif own == layer == "check" and (ROOMS.index(room_of(Path(included))) >
                                              ROOMS.index(room_of(path))):
                yield path, number, f"room {room_of(path)} must not include {included}"
    for library, layers in LIBRARIES.items():
        for layer in layers:
            listing = Path("src/maide") / layer / "CMakeLists.txt"
            if f"maide_layer({library}\n" not in sources.text(listing):
                yield listing, 1, f"layer {layer} belongs to the library {library}"
    for file, includes in upward.items():
        for included in sorted(includes):
            yield Path("src/maide") / file, 1, (
                f"does not include {included}: take it out of UPWARD in check_sources.py")


def check_rooms(sources):
    """No room of check has more than a quarter of its lines."""
    lines = {room: 0 for room in ROOMS}
    for path in sources.files:
        if path.parts[:2] == ("src", "maide") and path.suffix in (".cpp", ".hpp"):
            if room_of(path) in lines:
                lines[room_of(path)] += sources.text(path).count("\n")
    for room, count in lines.items():
        if count > sum(lines.values()) / 4:
            yield Path("src/maide/check") / room, 1, f"has {count} of {sum(lines.values())} lines"


def check_listed(sources):
    """Every source is in the list of its layer's CMakeLists.txt, so that it is built."""
    for path in sources.files:
        if path.parts[:2] != ("src", "maide") or path.suffix not in (".cpp", ".hpp"):
            continue
        if layer_of(path) == "cli" and path.suffix == ".hpp":
            continue  # not installed, so not listed
        layer = Path(*path.parts[: 3 if layer_of(path) else 2])
        listing = layer / "CMakeLists.txt"
        name = str(path.relative_to(layer))
        if not re.search(rf"(?<![\w./]){re.escape(name)}(?![\w.])", sources.text(listing)):
            yield path, 1, f"is not listed in {listing}"


def public_headers(sources):
    """The installed headers: the face, and those that a layer's CMakeLists.txt lists as HEADERS."""
    public = {Path("src/maide") / name for name in FACE}
    for path in sources.files:
        if path.name == "CMakeLists.txt" and path.parts[:2] == ("src", "maide"):
            listing = re.search(r"maide_layer\(\w+\s+HEADERS([^A-Z]*)", sources.text(path))
            names = listing.group(1).split() if listing else []
            public |= {path.parent / name for name in names}
    return sorted(public)


def includes_of(sources, path):
    for number, line in enumerate(sources.text(path).splitlines(), 1):
        match = INCLUDE.match(line)
        if match:
            yield number, match.group(1)


def check_public(sources):
    """A header that is installed includes the standard library and installed headers alone."""
    public = public_headers(sources)
    for path in public:
        for number, included in includes_of(sources, path):
            if included.startswith("maide/"):
                if Path("src") / included not in public:
                    yield path, number, f"is public and includes {included}, which is internal"
            elif "/" in included and not included.startswith(("sys/", "netinet/")):
                yield path, number, f"is public and includes another library's {included}"


# Most installed headers, and of checking most that maide/check.hpp brings along.
MOST_PUBLIC = 45
MOST_OF_CHECKING = 5


def check_face(sources):
    """The public face is small, made of whole headers, and described on one page."""
    public = public_headers(sources)
    page = Path("docs/library.md")
    if len(public) > MOST_PUBLIC:
        yield page, 1, f"{len(public)} headers are installed; {MOST_PUBLIC} is the limit"
    rows = re.findall(r"^\| `(maide/[^`]+)` \| \S", sources.text(page), re.MULTILINE)
    for path in public:
        text = sources.text(path)
        name = str(path.relative_to("src"))
        if rows.count(name) != 1:
            yield page, 1, f"has {rows.count(name)} rows for {name}, which is installed"
        if text.count("#pragma once") != 1 or len(re.findall(r"^namespace maide", text, re.MULTILINE)) > 1:
            yield path, 1, "looks like two headers in one file"
    for name in rows:
        if Path("src") / name not in public:
            yield page, 1, f"describes {name}, which is not installed"
    brought, open_headers = set(), [Path("src/maide/check.hpp")]
    while open_headers:
        for _, included in includes_of(sources, open_headers.pop()):
            header = Path("src") / included
            if included.startswith("maide/") and header not in brought:
                brought.add(header)
                open_headers.append(header)
    of_checking = sorted(str(header) for header in brought if layer_of(header) == "check")
    if len(of_checking) > MOST_OF_CHECKING:
        yield Path("src/maide/check.hpp"), 1, (
            f"brings {len(of_checking)} headers of checking, and {MOST_OF_CHECKING} is the limit: "
            + ", ".join(of_checking))


def check_openings(sources):
    """Every file says in its first lines what it is. A source whose header says it may begin with
    that header, a unit test with the header that it tests."""
    for path in sources.code():
        lines = sources.text(path).splitlines()
        if lines and lines[0].startswith("#!"):
            lines = lines[1:]
        first = lines[0] if lines else ""
        if first.startswith(("// ", "# ", '"""')):
            continue
        header = path.with_suffix(".hpp")
        own_includes = [f'#include "{Path(*header.parts[1:])}"', f'#include "{header.name}"']
        if path.suffix == ".cpp" and header in sources.files and first in own_includes:
            continue
        if path.parts[:2] == ("tests", "unit"):
            if first.startswith(f'#include "maide/{path.parts[2]}/'):
                continue
        yield path, 1, "does not open with a comment that says what it is"


# Classes that have members in several sources; the list only shrinks.
SEVERAL_SOURCES = {"WrapperProxy"}


def check_members(sources):
    """One class, one file: the members of a class are defined in one source."""
    definition = re.compile(r"^(?=\S)(?:[\w:<>,&*\[\] ]+ [*&]*)?(?:\w+::)*([A-Z]\w*)::~?\w+\(",
                            re.MULTILINE)
    seen = {}
    for path in sources.files:
        if path.parts[:2] != ("src", "maide") or path.suffix != ".cpp":
            continue
        text = sources.text(path)
        for match in definition.finditer(text):
            name = match.group(1)
            other = seen.setdefault(name, path)
            if other != path and name not in SEVERAL_SOURCES:
                number = text.count("\n", 0, match.start()) + 1
                yield path, number, f"defines a member of {name}, as {other} does"


def check_names(sources):
    """A file's name says its concept; the same name twice in the library says it twice."""
    seen = {}
    for path in sources.files:
        if path.parts[:2] == ("src", "maide") and path.suffix in (".cpp", ".hpp"):
            other = seen.setdefault(path.name, path)
            if other != path:
                yield path, 1, f"has the name of {other}"
            if not re.fullmatch(r"[a-z0-9_]+\.[ch]pp", path.name):
                yield path, 1, "the name is not in snake_case"


def check_test_names(sources):
    """Every file with tests of GoogleTest is called <concept>_test.cpp."""
    for path in sources.files:
        if path.parts[0] != "tests" or path.suffix != ".cpp":
            continue
        has_tests = re.search(r"^(TEST|TEST_F|TEST_P|TYPED_TEST)\(", sources.text(path), re.MULTILINE)
        if has_tests and not path.stem.endswith("_test"):
            yield path, 1, f"is called {path.stem}_test.cpp in this project"


def check_machine(sources):
    """Nothing that holds on one machine alone."""
    pattern = re.compile(r"(?<![\w.~$}>)-])/(?:home|root|work|Users)/\w|\b192\.168\.|\b10\.\d+\.\d+\.\d+\b")
    for path in sources.files:
        if path.suffix in (".png", ".svg", ".jpg") or path.name == "check_sources.py":
            continue
        for number, line in enumerate(sources.text(path).splitlines(), 1):
            if pattern.search(line):
                yield path, number, f"names a place on one machine: {line.strip()[:80]}"


def check_snippets(sources):
    """C++ in the documentation is cut from files that are compiled and tested. Before each block
    stands the file that it is from, `<!-- from examples/coffee/coffee.cpp -->`."""
    marker = re.compile(r"<!-- from (\S+) -->")
    for path in sources.files:
        if path.suffix != ".md":
            continue
        lines = sources.text(path).splitlines()
        for number, line in enumerate(lines, 1):
            if line.strip() not in ("```cpp", "```c++"):
                continue
            end = next((i for i in range(number, len(lines)) if lines[i].strip() == "```"), None)
            if end is None:
                yield path, number, "the block does not end"
                continue
            match = marker.search(lines[number - 2]) if number > 1 else None
            if match is None:
                yield path, number, "no line `<!-- from FILE -->` before the block"
                continue
            origin = Path(match.group(1))
            if origin not in sources.files:
                yield path, number, f"{origin} is not there"
                continue
            block = "\n".join(lines[number:end])
            if f"\n{block}\n" not in f"\n{sources.text(origin)}\n":
                yield path, number, f"is not what {origin} says"


# Where each of these names of std comes from; of several headers one is enough.
STD_HEADERS = {
    "algorithm": "all_of any_of none_of find_if find_if_not count_if copy_if fill sort stable_sort "
                 "partial_sort nth_element lower_bound upper_bound equal_range binary_search unique "
                 "reverse rotate remove_if transform min max clamp minmax min_element max_element "
                 "lexicographical_compare includes set_union set_intersection set_difference "
                 "is_sorted for_each mismatch partition stable_partition",
    "array": "array to_array",
    "atomic": "atomic atomic_flag",
    "bit": "bit_cast bit_width bit_ceil countr_zero countl_zero popcount has_single_bit",
    "charconv": "from_chars to_chars",
    "chrono": "chrono",
    "condition_variable": "condition_variable condition_variable_any cv_status",
    "cstdint": "uint8_t uint16_t uint32_t uint64_t int8_t int16_t int32_t int64_t",
    "deque": "deque",
    "exception": "exception_ptr current_exception rethrow_exception",
    "filesystem": "filesystem",
    "fstream": "ifstream ofstream fstream",
    "functional": "function reference_wrapper bind_front hash",
    "future": "future promise async packaged_task",
    "initializer_list": "initializer_list",
    "iomanip": "setw setprecision setfill",
    "limits": "numeric_limits",
    "map": "map multimap",
    "memory": "unique_ptr shared_ptr weak_ptr make_unique make_shared enable_shared_from_this",
    "mutex": "mutex recursive_mutex lock_guard unique_lock scoped_lock once_flag call_once",
    "numeric": "accumulate iota gcd lcm reduce",
    "optional": "optional nullopt make_optional",
    "queue": "queue priority_queue",
    "random": "mt19937 mt19937_64 uniform_int_distribution bernoulli_distribution",
    "regex": "regex smatch regex_match regex_search",
    "set": "set multiset",
    "shared_mutex": "shared_mutex shared_lock",
    "span": "span",
    "sstream": "stringstream istringstream ostringstream",
    "stdexcept": "runtime_error logic_error invalid_argument out_of_range length_error",
    "stop_token": "stop_token stop_source stop_callback",
    "string": "string to_string stoi stoul stoull getline",
    "string_view": "string_view",
    "system_error": "system_error error_code generic_category",
    "thread": "thread jthread this_thread",
    "tuple": "tuple tie make_tuple",
    "type_traits": "is_same_v decay_t remove_cvref_t conditional_t enable_if_t invoke_result_t",
    "unordered_map": "unordered_map unordered_multimap",
    "unordered_set": "unordered_set unordered_multiset",
    "utility": "move forward exchange swap pair make_pair as_const declval",
    "variant": "variant visit holds_alternative get_if monostate",
    "vector": "vector",
}
# These bring what the name's own header has: in the standard, or as their purpose.
STD_ALSO = {"pair": ["map", "unordered_map", "tuple"], "swap": ["array", "tuple", "optional"],
            "hash": ["string", "string_view", "optional", "variant"],
            "get_if": ["variant"], "this_thread": ["thread"], "stop_token": ["thread"],
            "stop_source": ["thread"], "stop_callback": ["thread"], "getline": ["istream"],
            "initializer_list": ["string", "vector", "map", "set", "array"],
            "error_code": ["filesystem"]}


def check_includes(sources):
    """A file includes itself what it uses of the standard library, or its own header does: what a
    neighbour brings along is not relied on."""
    header_of = {name: header for header, names in STD_HEADERS.items() for name in names.split()}
    used = re.compile(r"\bstd::(" + "|".join(sorted(header_of, key=len, reverse=True)) + r")\b")
    for path in sources.files:
        if path.parts[:2] != ("src", "maide") or path.suffix not in (".cpp", ".hpp"):
            continue
        included = included_by(sources, path)
        own_header = path.with_suffix(".hpp")
        if path.suffix == ".cpp" and own_header in sources.files:
            included |= included_by(sources, own_header)
        told = set()
        for number, line in enumerate(sources.text(path).splitlines(), 1):
            code = re.sub(r'"(\\.|[^"\\])*"', '""', line.split("//")[0])
            for name in used.findall(code):
                headers = {header_of[name], *STD_ALSO.get(name, [])}
                if not headers & included and header_of[name] not in told:
                    told.add(header_of[name])
                    yield path, number, f"uses std::{name} without <{header_of[name]}>"


def included_by(sources, path):
    return {match.group(1) for line in sources.text(path).splitlines()
            if (match := INCLUDE.match(line))}


# The least CMake that builds Maide, that of Ubuntu 22.04, and what came after it, by version.
LEAST_CMAKE = (3, 22)
NEWER_CMAKE = {
    "3.23": [r"\bFILE_SET\b", r"\bHEADER_SETS\b", r"\bIMPORTED_NO_SYSTEM\b"],
    "3.24": [r"\bPATH_EQUAL\b", r"\bVERIFY_INTERFACE_HEADER_SETS\b",
             r"\bCOMPILE_WARNING_AS_ERROR\b", r"--fresh\b",
             r"\$<LINK_(LIBRARY|GROUP):", r"\bFIND_PACKAGE_ARGS\b", r"\bREGISTRY_VIEW\b",
             r"\bSET_DEPENDENCY_PROVIDER\b"],
    "3.25": [r"^\s*(end)?block\s*\(", r"\breturn\s*\(\s*PROPAGATE\b", r"\bEXPORT_NO_SYSTEM\b",
             r"\bSOURCE_FROM_(CONTENT|VAR|FILE)\b", r"\bVALIDATOR\b", r"\bGET_MESSAGE_LOG_LEVEL\b",
             r"\badd_subdirectory\s*\([^)]*\bSYSTEM\b", r"--workflow\b"],
    "3.26": [r"cmake(_COMMAND\})? -E copy -t\b"],
    "3.27": [r"\$<(LIST|COMPILE_ONLY):"],
    "3.28": [r"\bCXX_MODULES\b", r"\bCXX_SCAN_FOR_MODULES\b"],
    "3.29": [r"\bTEST_LAUNCHER\b", r"\bLINKER_TYPE\b", r"\bIS_(EXECUTABLE|READABLE|WRITABLE)\b",
             r"\bcmake_language\s*\(\s*EXIT\b"],
    "3.31": [r"\bDISCOVERY_EXTRA_ARGS\b", r"\bCODEGEN\b", r"\bcmake_pkg_config\b"],
}
NEWEST_PRESETS = 3  # the version of CMakePresets.json that it reads


def check_cmake(sources):
    """Nothing that the least CMake does not know stands in the build's files."""
    for path in sources.files:
        if path.name == "CMakePresets.json":
            presets = json.loads(sources.text(path))
            if presets["version"] > NEWEST_PRESETS:
                yield path, 1, f"is of version {presets['version']}; {NEWEST_PRESETS} is the newest"
            least = presets["cmakeMinimumRequired"]
            if (least["major"], least["minor"]) > LEAST_CMAKE:
                yield path, 1, f"asks for CMake {least['major']}.{least['minor']}"
        if path.name != "CMakeLists.txt" and ".cmake" not in path.suffixes:
            continue
        for number, line in enumerate(sources.text(path).splitlines(), 1):
            match = re.search(r"cmake_(?:minimum_required|policy)\s*\(VERSION (\d+)\.(\d+)", line)
            if match and (int(match.group(1)), int(match.group(2))) > LEAST_CMAKE:
                yield path, number, f"asks for CMake {match.group(1)}.{match.group(2)}"
            for version, patterns in NEWER_CMAKE.items():
                for pattern in patterns:
                    if re.search(pattern, line.split("#")[0]):
                        yield path, number, f"needs CMake {version}: {line.strip()}"


def main():
    check, root = sys.argv[1], Path(sys.argv[2])
    sources = Sources(root)
    if not sources.files:
        sys.exit(f"no files under {root}")
    findings = list(globals()["check_" + check](sources))
    for path, number, what in findings:
        print(f"{path}:{number}: {what}")
    sys.exit(1 if findings else 0)


if __name__ == "__main__":
    main()
