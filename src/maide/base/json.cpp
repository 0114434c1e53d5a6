// nlohmann::json reports the offset of a syntax error; people want its line and column.
#include "maide/base/json.hpp"

#include <algorithm>
#include <cstddef>
#include <istream>
#include <nlohmann/json.hpp>
#include <streambuf>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/free_beside.hpp"

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

constexpr std::size_t heard_bytes = std::size_t{1} << 20;  // from one look at the control on
constexpr const char* phase = "reading JSON";

// Where brackets are nested deeper than that; npos: nowhere.
std::size_t find_too_deep(std::string_view text, const RunControl& control) {
  std::size_t depth = 0, heard = 0;
  bool is_quoted = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (at >= heard) {
      control.check(phase);
      heard = at + heard_bytes;
    }
    const char c = text[at];
    if (c == '"') is_quoted = !is_quoted;
    if (is_quoted && c == '\\') ++at;
    if (is_quoted) continue;
    if ((c == '[' || c == '{') && ++depth > max_nesting) return at;
    if ((c == ']' || c == '}') && depth > 0) --depth;
  }
  return std::string_view::npos;
}

// A text to read, in pieces between which the control is heard.
class HeardText : public std::streambuf {
 public:
  HeardText(std::string_view text, const RunControl& control) : rest_(text), control_(control) {}

 protected:
  int_type underflow() override {
    control_.check(phase);
    const std::string_view piece = rest_.substr(0, heard_bytes);
    rest_.remove_prefix(piece.size());
    char* const begin = const_cast<char*>(piece.data());  // it is only read
    setg(begin, begin, begin + piece.size());
    return piece.empty() ? traits_type::eof() : traits_type::to_int_type(piece.front());
  }

 private:
  std::string_view rest_;
  const RunControl& control_;
};

// The value, in which what was read of it stays when it is interrupted; and whether nothing follows
// it. Throws the library's errors.
template <typename Value>
bool read_value(std::string_view text, const RunControl& control, Value& value) {
  HeardText heard(text, control);
  std::istream in(&heard);
  in >> value;
  // Of a number the character behind it was read, too.
  const bool is_closed = value.is_structured() || value.is_string();
  return is_closed && (in >> std::ws).peek() == std::istream::traits_type::eof();
}

template <typename Value>
Value parse(std::string_view text, const std::string& file, const RunControl& control) {
  if (const std::size_t at = find_too_deep(text, control); at != std::string_view::npos) {
    throw ParseError("not valid JSON: brackets are nested too deeply", position_of(text, at, file));
  }
  Value value;
  try {
    if (!read_value(text, control, value)) value = Value::parse(text);  // or what is wrong with it
    return value;
  } catch (const Interrupted&) {
    free_beside(std::move(value));
    throw;
  } catch (const typename Value::parse_error& error) {
    const std::size_t offset = error.byte > 0 ? error.byte - 1 : 0;
    throw ParseError("not valid JSON: " + reason_of(error.what()), position_of(text, offset, file));
  } catch (const typename Value::out_of_range& error) {  // a number; the library does not say where
    throw ParseError("not valid JSON: " + reason_of(error.what()), {file, 0, 0});
  }
}

}  // namespace

Json parse_json(std::string_view text, const std::string& file, const RunControl& control) {
  return parse<Json>(text, file, control);
}

nlohmann::json parse_sorted_json(std::string_view text, const std::string& file,
                                 const RunControl& control) {
  return parse<nlohmann::json>(text, file, control);
}

std::string to_json_line(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace maide
