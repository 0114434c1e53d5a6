// Files are written whole or not at all, and every failure names its reason and the file.
#include "maide/base/file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "maide/base/error.hpp"

namespace maide {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(File, WritesAndReadsBytes) {
  const TempDir folder;
  const fs::path path = folder.path() / "with space.txt";
  const std::string content("a\0b\n\xff", 5);
  write_file_atomically(path, content);
  EXPECT_EQ(read_file(path), content);
  write_file_atomically(path, "");
  EXPECT_EQ(read_file(path), "");
}

TEST(File, LeavesNothingElseBehind) {
  const TempDir folder;
  write_file_atomically(folder.path() / "a", "1");
  write_file_atomically(folder.path() / "a", "2");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(File, KeepsTheModeOfWhatItReplaces) {
  const TempDir folder;
  const fs::path path = folder.path() / "a";
  write_file_atomically(path, "1");
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  write_file_atomically(path, "2");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(File, NewFilesFollowTheUmask) {
  const TempDir folder;
  const mode_t earlier = ::umask(027);
  write_file_atomically(folder.path() / "a", "1");
  ::umask(earlier);
  EXPECT_EQ(static_cast<unsigned>(fs::status(folder.path() / "a").permissions()), 0640U);
}

TEST(File, FollowsSymbolicLinks) {
  const TempDir folder;
  write_file_atomically(folder.path() / "target", "1");
  fs::create_symlink("target", folder.path() / "link");
  write_file_atomically(folder.path() / "link", "2");
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
  EXPECT_EQ(read_file(folder.path() / "target"), "2");
}

TEST(File, SaysWhyItCannotRead) {
  const TempDir folder;
  const fs::path missing = folder.path() / "missing";
  EXPECT_EQ(message_of([&] { read_file(missing); }),
            "cannot read the file: No such file or directory (" + missing.string() + ")");
  EXPECT_THAT(message_of([&] { read_file(folder.path()); }), HasSubstr("Is a directory"));
}

TEST(File, SaysWhyItCannotWrite) {
  const TempDir folder;
  EXPECT_THAT(message_of([&] { write_file_atomically(folder.path() / "no" / "a", "1"); }),
              HasSubstr("cannot write the file: No such file or directory"));
  EXPECT_THAT(message_of([&] { write_file_atomically(folder.path(), "1"); }),
              HasSubstr("Is a directory"));
  EXPECT_THAT(message_of([&] { write_file_atomically("", "1"); }), HasSubstr("cannot write"));
  EXPECT_THAT(message_of([&] { write_file_atomically("/dev/full", "1"); }),
              HasSubstr("No space left on device (/dev/full)"));
}

TEST(File, TellsAFullDiskFromWhatTheCallerDidWrong) {
  const auto status_of = [](const fs::path& path) {
    try {
      write_file_atomically(path, "1");
    } catch (const Error& error) {
      return error.status();
    }
    return ExitStatus::ok;
  };
  EXPECT_EQ(status_of("/dev/full"), ExitStatus::inconclusive);
  EXPECT_EQ(status_of("/no/such/folder/a"), ExitStatus::usage);
}

TEST(File, ForeseesWhatCannotBeWritten) {
  const TempDir folder;
  for (const fs::path& path : {folder.path() / "no" / "a", folder.path(), fs::path("")}) {
    EXPECT_EQ(message_of([&] { check_can_write(path); }),
              message_of([&] { write_file_atomically(path, "1"); }));
  }
  EXPECT_NO_THROW(check_can_write(folder.path() / "new"));
  EXPECT_FALSE(fs::exists(folder.path() / "new"));
  EXPECT_NO_THROW(check_can_write("in-the-current-folder"));
  EXPECT_NO_THROW(check_can_write("/dev/full"));
}

// The limit of time of `maide check` is for the check: a system that was not read has no verdicts.
TEST(File, IsReadWhenTimeIsUpButAPipeIsNotWaitedFor) {
  const TempDir folder;
  RunControl control;
  control.deadline = deadline_in(-1);
  write_file_atomically(folder.path() / "file", "1");
  EXPECT_EQ(read_file(folder.path() / "file", control), "1");
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(read_file(pipe, control), Interrupted);
}

TEST(File, ReadsNoDevicesAndNoPipeAsARegularFile) {
  EXPECT_EQ(message_of([] { read_file("/dev/zero"); }),
            "cannot read the file: it is a device (/dev/zero)");
  const TempDir folder;
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(message_of([&] { read_regular_file(pipe); }),
            "cannot read the file: it is no regular file (" + pipe.string() + ")");
  EXPECT_THAT(message_of([&] { read_regular_file(folder.path()); }), HasSubstr("Is a directory"));
}

TEST(File, WritesIntoDevices) { EXPECT_NO_THROW(write_file_atomically("/dev/null", "1")); }

TEST(TempDir, IsGoneWithItsContent) {
  fs::path path;
  {
    const TempDir folder("maide test ");
    path = folder.path();
    fs::create_directories(path / "deep" / "er");
    write_file_atomically(path / "deep" / "er" / "file", "1");
  }
  EXPECT_FALSE(fs::exists(path));
}

}  // namespace
}  // namespace maide
