// Files: reading and writing whole files, descriptors and pipes, temporary folders, and an output
// stream that hands its text on in pieces. A crash or a full disk never leaves half a file behind.
#pragma once

#include <cerrno>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <ostream>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/run_control.hpp"

namespace maide {

// The file's bytes. Throws UsageError "cannot read the file: reason (path)"; a directory is no
// file, and of devices only a terminal is one. A pipe is waited for, its other end too, until
// `control` says stop (throws Interrupted); a regular file is read all the same.
std::string read_file(const std::filesystem::path& path, const RunControl& control = {});

// Reads a file that may be read again, which a pipe cannot be: throws UsageError unless it is a
// regular file.
std::string read_regular_file(const std::filesystem::path& path);

// Puts `content` at `path`, all of it or none: a temporary file beside it, synced, then renamed. A
// symbolic link stays and its target is replaced; a device or pipe is written to directly. Throws
// UsageError "cannot write the file: reason (path)", or Error (inconclusive) where the disk is
// full; an earlier file is then untouched.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);
// As above, for content that need not fit the memory: `write` writes it to the stream. What it
// throws passes, and the file is as it was; a device or pipe may have got a part.
void write_file_atomically(const std::filesystem::path& path,
                           const std::function<void(std::ostream& out)>& write);

// For long work that ends with a file: throws now the error that write_file_atomically() would
// throw, as far as it can be foreseen (no such folder, no permission, a folder). Writes nothing.
void check_can_write(const std::filesystem::path& path);

// Whether both names are of one file, there or not.
bool is_same_file(const std::filesystem::path& left, const std::filesystem::path& right);

// ---- Descriptors ----
//
// A file descriptor that is closed with its owner.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() { reset(); }
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;

  int get() const { return value_; }
  bool is_open() const { return value_ >= 0; }
  void reset();
  // Closes, and returns 0 or the error number: some file systems report a full disk only then.
  int close();

 private:
  int value_ = -1;
};

// A pipe of two descriptors. Both ends are closed on exec. Throws std::system_error.
struct Pipe {
  Pipe();
  Descriptor read_end, write_end;
};

// ---- Errors of writing ----
//
// A full disk is a limit of the machine, met half way (exit status 3, inconclusive). No permission,
// no such folder or a closed pipe are arguments that cannot be used (exit status 2).

// Whether the errno says that there is no room: on the disk, in a quota, in a file.
inline bool is_out_of_space(int error) {
  return error == ENOSPC || error == EDQUOT || error == EFBIG;
}

[[noreturn]] inline void throw_write_failure(const std::string& message, int error) {
  if (is_out_of_space(error)) throw Error(ExitStatus::inconclusive, message);
  throw UsageError(message);
}

// ---- Temporary folders and long text ----
//
// A folder of its own under the system's folder for temporary files. It is removed with the object.
class TempDir {
 public:
  // Makes "<tmp>/<prefix>XXXXXX", readable by its owner alone. Throws UsageError if it cannot,
  // Error (inconclusive) where the disk is full.
  explicit TempDir(std::string_view prefix = "maide-");
  // Removes the folder with all that is in it.
  ~TempDir();
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;

  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

// An output stream for text of any length. It hands what is written on in pieces of 64 KiB to a
// function. Exceptions of that function come out of the `<<` (or finish()) that caused them,
// unchanged.
class ChunkedStream {
 public:
  using Sink = std::function<void(std::string_view piece)>;

  explicit ChunkedStream(Sink sink);

  std::ostream& stream() { return stream_; }
  // Hands on what is left. Without it, the last piece is lost.
  void finish() { buffer_.hand_on(); }

 private:
  class Buffer : public std::streambuf {
   public:
    explicit Buffer(Sink sink);
    void hand_on();

   protected:
    int_type overflow(int_type letter) override;

   private:
    Sink sink_;
    std::vector<char> bytes_;
  };

  Buffer buffer_;
  std::ostream stream_;
};

}  // namespace maide
