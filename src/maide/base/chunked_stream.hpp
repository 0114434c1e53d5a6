// An output stream for text of any length: what is written is handed on in pieces of 64 KiB to a
// function, whose exceptions come out of the `<<` (or finish()) that caused them, unchanged.
#pragma once

#include <functional>
#include <ostream>
#include <streambuf>
#include <string_view>
#include <vector>

namespace maide {

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
