#include "maide/base/error.hpp"

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "maide/base/invariant.hpp"

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

namespace {

constexpr const char* nondeterminism_advice =
    "; give it longer waits, or, if it is like that, learn it with --algorithm nstar (for some 44 "
    "times as many words)";

// The first input behind a reset: nothing was before it but what the reset left.
constexpr const char* leak_advice =
    "; that is its first input: mostly the reset leaves something behind, or the step ends too "
    "early";

std::string advice_on(const std::string& word) {
  return (word.find(' ') == std::string::npos ? leak_advice : "") +
         std::string(nondeterminism_advice);
}

std::string describe_answers(const std::vector<std::pair<std::string, std::uint64_t>>& answers) {
  std::string text;
  for (const auto& [answer, count] : answers) {
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " times \"" + answer + "\"";
  }
  return text;
}

}  // namespace

NondeterminismError::NondeterminismError(
    std::string word, const std::vector<std::pair<std::string, std::uint64_t>>& answers)
    : Error(ExitStatus::inconclusive, "the system stays nondeterministic: it answered \"" + word +
                                          "\" " + describe_answers(answers) + advice_on(word)),
      word_(std::move(word)),
      first_(answers.at(0).first),
      second_(answers.at(1).first) {}

NondeterminismError::NondeterminismError(std::string word, std::string first_answer,
                                         std::string second_answer)
    : Error(ExitStatus::inconclusive, "the system answered \"" + word + "\" in two ways: \"" +
                                          first_answer + "\", then \"" + second_answer + "\"" +
                                          advice_on(word)),
      word_(std::move(word)),
      first_(std::move(first_answer)),
      second_(std::move(second_answer)) {}

std::string describe_internal_error(std::string_view what) {
  return "internal error" + (what.empty() ? "" : ": " + std::string(what)) + " (please report it)";
}

void fail_check(const char* condition, const char* file, int line) {
  std::string_view place = file;
  const std::size_t source = place.rfind("/maide/");
  if (source != std::string_view::npos) place.remove_prefix(source + 1);
  throw std::logic_error("check failed: " + std::string(condition) + " (" + std::string(place) +
                         ":" + std::to_string(line) + ")");
}

}  // namespace maide
