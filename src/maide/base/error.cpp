#include "maide/base/error.hpp"

#include <utility>

namespace maide {

std::string to_string(const SourcePosition& position) {
  std::string text = position.file;
  if (position.line > 0) {
    if (!text.empty()) text += ':';
    text += std::to_string(position.line);
    if (position.column > 0) text += ':' + std::to_string(position.column);
  }
  return text;
}

namespace {
std::string with_place(const std::string& message, const std::string& place) {
  return place.empty() ? message : message + " (" + place + ")";
}
}  // namespace

ParseError::ParseError(const std::string& message, SourcePosition position)
    : Error(ExitStatus::usage, with_place(message, to_string(position))),
      position_(std::move(position)) {}

WrapperError::WrapperError(const std::string& message, const std::string& endpoint)
    : Error(ExitStatus::system_failed, with_place(message, endpoint)), endpoint_(endpoint) {}

NondeterminismError::NondeterminismError(std::string word, std::string first_answer,
                                         std::string second_answer)
    : Error(ExitStatus::inconclusive, "the system answered \"" + word + "\" in two ways: \"" +
                                          first_answer + "\", then \"" + second_answer + "\""),
      word_(std::move(word)),
      first_(std::move(first_answer)),
      second_(std::move(second_answer)) {}

}  // namespace maide
