// nlohmann::json reports the offset of a syntax error; people want its line and column.
#include "maide/base/json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "maide/base/error.hpp"

namespace maide {

namespace {

SourcePosition position_of(std::string_view text, std::size_t offset, const std::string& file) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
  return {file, static_cast<int>(std::ranges::count(before, '\n')) + 1,
          static_cast<int>(before.size() - line_start) + 1};
}

// The library's text is "[json.exception.parse_error.101] parse error at line 1, column 2: reason"
// or "[json.exception.out_of_range.406] reason"; the reason alone is for people.
std::string reason_of(std::string text) {
  if (const std::size_t bracket = text.find("] "); bracket != std::string::npos) {
    text.erase(0, bracket + 2);
  }
  if (text.starts_with("parse error")) {
    if (const std::size_t colon = text.find(": "); colon != std::string::npos) {
      text.erase(0, colon + 2);
    }
  }
  if (const std::size_t expected = text.find("; expected "); expected != std::string::npos) {
    text.erase(expected);
  }
  return text;
}

// Values are walked by recursion.
constexpr std::size_t max_nesting = 1000;

// Where brackets are nested deeper than that; npos: nowhere.
std::size_t find_too_deep(std::string_view text) {
  std::size_t depth = 0;
  bool is_quoted = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '"') is_quoted = !is_quoted;
    if (is_quoted && c == '\\') ++at;
    if (is_quoted) continue;
    if ((c == '[' || c == '{') && ++depth > max_nesting) return at;
    if ((c == ']' || c == '}') && depth > 0) --depth;
  }
  return std::string_view::npos;
}

}  // namespace

Json parse_json(std::string_view text, const std::string& file) {
  if (const std::size_t at = find_too_deep(text); at != std::string_view::npos) {
    throw ParseError("not valid JSON: brackets are nested too deeply", position_of(text, at, file));
  }
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const std::size_t offset = error.byte > 0 ? error.byte - 1 : 0;
    throw ParseError("not valid JSON: " + reason_of(error.what()), position_of(text, offset, file));
  } catch (const Json::out_of_range& error) {  // a number; the library does not say where
    throw ParseError("not valid JSON: " + reason_of(error.what()), {file, 0, 0});
  }
}

std::string to_json_line(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace maide
