#include "maide/base/chunked_stream.hpp"

#include <utility>

namespace maide {

namespace {
constexpr std::size_t piece_size = 65536;
}

ChunkedStream::ChunkedStream(Sink sink) : buffer_(std::move(sink)), stream_(&buffer_) {
  stream_.exceptions(std::ios::badbit);  // else the standard library swallows what the sink throws
}

ChunkedStream::Buffer::Buffer(Sink sink) : sink_(std::move(sink)), bytes_(piece_size) {
  setp(bytes_.data(), bytes_.data() + bytes_.size());
}

void ChunkedStream::Buffer::hand_on() {
  const std::string_view piece(pbase(), static_cast<std::size_t>(pptr() - pbase()));
  setp(bytes_.data(), bytes_.data() + bytes_.size());
  if (!piece.empty()) sink_(piece);
}

std::streambuf::int_type ChunkedStream::Buffer::overflow(int_type letter) {
  hand_on();
  if (!traits_type::eq_int_type(letter, traits_type::eof())) {
    *pptr() = traits_type::to_char_type(letter);
    pbump(1);
  }
  return traits_type::not_eof(letter);
}

}  // namespace maide
