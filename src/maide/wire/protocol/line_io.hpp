// Lines over file descriptors: cutting what arrives into lines, and writing all of a text, however
// much the kernel takes at a time. No SIGPIPE ever leaves here.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace maide {

// Bytes in, lines out.
class LineSplitter {
 public:
  // Throws protocol::ProtocolError once a line is longer than protocol::max_line.
  void append(std::string_view bytes);
  // The next whole line without its end ("\n" or "\r\n"), if there is one.
  std::optional<std::string> take_line();
  // Something is there that is not a whole line.
  bool has_rest() const { return from_ < buffer_.size(); }

 private:
  std::string buffer_;
  std::size_t from_ = 0;     // where the next line begins
  std::size_t scanned_ = 0;  // up to here there is no end of a line behind from_
};

// Reads what is there, at most 64 KiB, blocking or not as the descriptor is. EINTR is not seen.
enum class ReadResult { some, nothing_yet, ended };
ReadResult read_some(int descriptor, std::string& bytes);

// Writes as much as the descriptor takes: the number of bytes, 0 if it would block, -1 if nobody
// reads any more.
std::ptrdiff_t write_some(int descriptor, std::string_view bytes);

// Writes everything to a blocking descriptor; false if nobody reads any more.
bool write_all(int descriptor, std::string_view bytes);

}  // namespace maide
