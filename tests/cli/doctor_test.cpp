// `maide doctor` on this machine and on machines that lack something.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

Json finding(const Json& report, const std::string& name) {
  for (const Json& entry : report.at("findings")) {
    if (entry.at("name") == name) return entry;
  }
  ADD_FAILURE() << "nothing is said of " << name;
  return Json::object();
}

void make_program(const fs::path& path, const std::string& script) {
  write_file_atomically(path, "#!/bin/sh\n" + script + "\n");
  fs::permissions(path, fs::perms::owner_all);
}

TEST(Doctor, TextAndJsonAgree) {
  const SubprocessResult text = run_maide({"doctor"});
  const SubprocessResult json = run_maide({"doctor", "--json"});
  EXPECT_EQ(text.exit_status, json.exit_status);
  const Json report = json_of(json);
  EXPECT_EQ(report.at("ready"), json.exit_status == 0);
  for (const Json& entry : report.at("findings")) {
    EXPECT_THAT(text.out, HasSubstr("  " + entry.at("name").get<std::string>() + " "));
  }
}

TEST(Doctor, TriesWhatTheKernelShows) {
  const Json report = json_of(run_maide({"doctor", "--json"}));
  for (const char* name : {"schedstat", "syscall", "ptrace", "pidfd", "tcp_info", "meminfo"}) {
    EXPECT_EQ(finding(report, name).at("kind"), "kernel");
  }
  // The wrappers' self-tests need it.
  EXPECT_EQ(finding(report, "schedstat").at("state"), "usable");
}

TEST(Doctor, SaysWhatToInstall) {
  const TempDir empty;
  const SubprocessResult result =
      run_with_maide("PATH='" + empty.path().string() + "' \"$maide\" doctor --json");
  EXPECT_EQ(result.exit_status, 0);  // all of it is extras: the reference port is there
  const Json spin = finding(json_of(result), "spin");
  EXPECT_EQ(spin.at("state"), "missing");
  EXPECT_EQ(spin.at("advice"), "apt-get install spin");
  EXPECT_EQ(finding(json_of(result), "pins2lts-mc").at("advice"),
            "build LTSmin: github.com/utwente-fmt/ltsmin");
}

TEST(Doctor, FindsProgramsThatAreBroken) {
  const TempDir folder("maide doctor ");
  make_program(folder.path() / "spin", "echo 'cannot start' >&2; exit 1");
  make_program(folder.path() / "pins2lts-mc", "echo v3.1.0; exit 255");  // as LTSmin's does
  make_program(folder.path() / "maide-wrap-mine", "echo 'mine 1.0, tried'");
  make_program(folder.path() / "maide-wrap-broken", "echo 'no library' >&2; exit 4");
  const SubprocessResult result =
      run_with_maide("PATH='" + folder.path().string() + "':\"$PATH\" \"$maide\" doctor --json");
  EXPECT_EQ(result.exit_status, 0);
  const Json report = json_of(result);
  EXPECT_EQ(finding(report, "spin").at("state"), "broken");
  EXPECT_EQ(finding(report, "pins2lts-mc").at("state"), "usable");
  EXPECT_EQ(finding(report, "pins2lts-mc").at("version"), "v3.1.0");
  EXPECT_EQ(finding(report, "mine").at("state"), "usable");
  EXPECT_EQ(finding(report, "mine").at("version"), "mine 1.0, tried");
  EXPECT_EQ(finding(report, "broken").at("state"), "broken");
  EXPECT_EQ(finding(report, "broken").at("advice"), "no library");
}

}  // namespace
}  // namespace maide::test
