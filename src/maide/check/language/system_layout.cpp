// The layout of a system file. yaml-cpp says what the file means and where each text stands, but
// forgets comments and how things were written. So the lines are read a second time, as a tree of
// entries with their comments; what that reader does not know is kept as it stands. In the end both
// texts must mean the same to yaml-cpp, or the layout is an error of Maide's own.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/language/layout.hpp"
#include "maide/check/text/yaml_reader.hpp"

namespace maide {
namespace {

struct Entry;
// A value as it is written.
struct Written {
  enum class Kind : std::uint8_t {
    none,   // nothing: null
    text,   // plain, or in quotes, on one line or several
    lines,  // behind | or >
    map,    // in braces
    list,   // in brackets
    block,  // entries on lines of their own
    as_is,  // what the reader does not know
  };
  Kind kind = Kind::none;
  std::string raw;  // of a text: as it is written; of lines: the sign with its marks
  std::vector<std::string> source;  // of lines and as_is: the lines as they stand
  std::vector<Entry> entries;       // of maps and blocks; of a list its values
  std::vector<std::string> tail;    // of a block: comments behind the last entry
};
struct Entry {
  std::vector<std::string> before;  // comments, and "" for a blank line
  std::string key;                  // as it is written
  Written value;
  std::string comment;  // at the end of its first line
};

struct Unknown {};  // to this reader: thrown within an entry

bool is_blank_line(std::string_view line) {
  return line.find_first_not_of(" \t") == std::string_view::npos;
}
std::size_t indent_of(std::string_view line) {
  return std::min(line.find_first_not_of(' '), line.size());
}
std::string stripped(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\n");
  if (begin == std::string_view::npos) return "";
  return std::string(text.substr(begin, text.find_last_not_of(" \t\n") - begin + 1));
}

// ---- Reading ------------------------------------------------------------------------------------

// A text from some place on, over several lines.
class Cursor {
 public:
  Cursor(const std::vector<std::string>& lines, std::size_t line, std::size_t column)
      : lines_(lines), line_(line), column_(column) {}

  std::size_t line() const { return line_; }
  bool at_line_end() const { return column_ >= lines_[line_].size(); }
  char peek() const { return at_line_end() ? '\n' : lines_[line_][column_]; }
  char before() const { return column_ == 0 ? '\n' : lines_[line_][column_ - 1]; }
  char next() {
    const char c = peek();
    if (c != '\n') {
      ++column_;
      return c;
    }
    if (line_ + 1 >= lines_.size()) throw Unknown();
    ++line_;
    column_ = 0;
    return c;
  }
  std::string_view rest() const { return std::string_view(lines_[line_]).substr(column_); }
  void skip_blanks() {
    while (peek() == ' ' || peek() == '\t' || peek() == '\n') next();
  }

 private:
  const std::vector<std::string>& lines_;
  std::size_t line_, column_;
};

class LayoutReader {
 public:
  explicit LayoutReader(std::vector<std::string> lines) : lines_(std::move(lines)) {}

  Written read() {
    Written root = read_block(0);
    if (at_ < lines_.size()) throw Unknown();
    return root;
  }

 private:
  // The entries at that indentation.
  Written read_block(std::size_t indent) {
    Written block;
    block.kind = Written::Kind::block;
    for (;;) {
      std::vector<std::string> before = take_comments(indent);
      if (at_ >= lines_.size() || indent_of(lines_[at_]) < indent) {
        block.tail = std::move(before);
        return block;
      }
      if (indent_of(lines_[at_]) > indent) throw Unknown();
      Entry entry = read_entry(indent);
      entry.before = std::move(before);
      block.entries.push_back(std::move(entry));
    }
  }

  // Comments and blank lines; those in front of what is farther out belong there.
  std::vector<std::string> take_comments(std::size_t indent) {
    std::vector<std::string> taken;
    for (; at_ < lines_.size(); ++at_) {
      const std::string& line = lines_[at_];
      if (is_blank_line(line)) {
        if (taken.empty() || !taken.back().empty()) taken.emplace_back();
      } else if (line[indent_of(line)] == '#' && indent_of_what_follows() >= indent) {
        taken.push_back(stripped(line));
      } else {
        break;
      }
    }
    return taken;
  }

  // Of the next line that is no comment, or of the comment if that is farther in.
  std::size_t indent_of_what_follows() const {
    for (std::size_t at = at_; at < lines_.size(); ++at) {
      const std::string& line = lines_[at];
      if (is_blank_line(line) || line[indent_of(line)] == '#') continue;
      return std::max(indent_of(line), indent_of(lines_[at_]));
    }
    return indent_of(lines_[at_]);
  }

  Entry read_entry(std::size_t indent) {
    const std::size_t first = at_;
    try {
      Entry entry;
      const std::string& line = lines_[at_];
      const std::size_t colon = end_of_key(line, indent);
      entry.key = stripped(std::string_view(line).substr(indent, colon - indent));
      Cursor cursor(lines_, at_, colon + 1);
      while (cursor.peek() == ' ' || cursor.peek() == '\t') cursor.next();
      entry.value = read_value(cursor, indent, entry.comment);
      return entry;
    } catch (const Unknown&) {
      at_ = first;
      return read_as_is(indent);
    }
  }

  // The ':' behind the key that begins at the column.
  static std::size_t end_of_key(const std::string& line, std::size_t begin) {
    std::size_t at = begin;
    const char quote = line[at];
    if (quote == '"' || quote == '\'') {
      at = line.find(quote, at + 1);
      if (at == std::string::npos || line.find('\\') < at) throw Unknown();
      at = line.find_first_not_of(' ', at + 1);
      if (at == std::string::npos || line[at] != ':') throw Unknown();
      return at;
    }
    if (std::string_view("-?&*!|>%@`{[#").find(quote) != std::string_view::npos) throw Unknown();
    for (; at < line.size(); ++at) {
      if (line[at] == '#' && line[at - 1] == ' ') throw Unknown();
      if (line[at] == ':' && (at + 1 == line.size() || line[at + 1] == ' ')) return at;
    }
    throw Unknown();
  }

  // Of an entry of that indentation; moves to the line behind it.
  Written read_value(Cursor& cursor, std::size_t indent, std::string& comment) {
    const char first = cursor.peek();
    if (first == '\n' || first == '#') {
      comment = stripped(cursor.rest());
      at_ = cursor.line() + 1;
      return read_below(indent);
    }
    if (first == '|' || first == '>') return read_lines(cursor, indent, comment);
    Written value = read_inline(cursor, indent);
    while (cursor.peek() == ' ' || cursor.peek() == '\t') cursor.next();
    if (cursor.peek() != '\n' && cursor.peek() != '#') throw Unknown();
    comment = stripped(cursor.rest());
    at_ = cursor.line() + 1;
    return value;
  }

  // What stands on the lines below a key: entries, a text, or nothing.
  Written read_below(std::size_t indent) {
    std::size_t next = at_;
    while (next < lines_.size() &&
           (is_blank_line(lines_[next]) || lines_[next][indent_of(lines_[next])] == '#')) {
      ++next;
    }
    if (next == lines_.size() || indent_of(lines_[next]) <= indent) {
      if (next < lines_.size() && indent_of(lines_[next]) == indent &&
          lines_[next][indent] == '-') {
        throw Unknown();  // a list may stand there
      }
      return {};
    }
    const std::size_t inner = indent_of(lines_[next]);
    try {
      end_of_key(lines_[next], inner);
    } catch (const Unknown&) {
      if (next != at_) throw;
      Cursor cursor(lines_, next, inner);
      std::string comment;
      Written value = read_value(cursor, indent, comment);
      if (!comment.empty()) throw Unknown();
      return value;
    }
    return read_block(inner);
  }

  Written read_lines(Cursor& cursor, std::size_t indent, std::string& comment) {
    Written value;
    value.kind = Written::Kind::lines;
    const std::string_view rest = cursor.rest();
    const std::size_t end = std::min(rest.find(' '), rest.size());
    value.raw = rest.substr(0, end);
    comment = stripped(rest.substr(end));
    at_ = cursor.line() + 1;
    while (at_ < lines_.size() && (is_blank_line(lines_[at_]) || indent_of(lines_[at_]) > indent)) {
      value.source.push_back(lines_[at_++]);
    }
    while (!value.source.empty() && is_blank_line(value.source.back())) {
      value.source.pop_back();
      --at_;
    }
    return value;
  }

  // A text, or a map or list in braces, over as many lines as it has.
  Written read_inline(Cursor& cursor, std::size_t indent) {
    const char first = cursor.peek();
    if (first == '{' || first == '[') return read_flow(cursor);
    if (first == '"' || first == '\'') return read_quoted(cursor);
    if (std::string_view("&*!|>%@`#]},").find(first) != std::string_view::npos) throw Unknown();
    Written value;
    value.kind = Written::Kind::text;
    for (;;) {
      const std::string_view rest = cursor.rest();
      const std::size_t comment = rest.find(" #");
      value.raw += (value.raw.empty() ? "" : " ") + stripped(rest.substr(0, comment));
      if (comment != std::string_view::npos) {
        for (std::size_t i = 0; i < comment; ++i) cursor.next();
        return value;
      }
      while (!cursor.at_line_end()) cursor.next();
      const std::size_t below = cursor.line() + 1;
      if (below >= lines_.size() || is_blank_line(lines_[below]) ||
          indent_of(lines_[below]) <= indent || lines_[below][indent_of(lines_[below])] == '#') {
        return value;
      }
      cursor.next();
    }
  }

  static Written read_quoted(Cursor& cursor) {
    Written value;
    value.kind = Written::Kind::text;
    const char quote = cursor.next();
    value.raw += quote;
    for (;;) {
      const char c = cursor.next();
      value.raw += c;
      if (c == '\\' && quote == '"') value.raw += cursor.next();
      if (c != quote) continue;
      if (quote == '\'' && cursor.peek() == '\'') {
        value.raw += cursor.next();
      } else {
        return value;
      }
    }
  }

  static Written read_flow(Cursor& cursor) {
    Written value;
    const bool is_map = cursor.next() == '{';
    value.kind = is_map ? Written::Kind::map : Written::Kind::list;
    const char close = is_map ? '}' : ']';
    for (;;) {
      cursor.skip_blanks();
      if (cursor.peek() == close) break;
      Entry entry;
      if (is_map) {
        entry.key = read_flow_text(cursor, true);
        cursor.skip_blanks();
        if (cursor.next() != ':') throw Unknown();
        cursor.skip_blanks();
      }
      const char first = cursor.peek();
      if (first == '{' || first == '[') {
        entry.value = read_flow(cursor);
      } else if (first == '"' || first == '\'') {
        entry.value = read_quoted(cursor);
      } else if (first != ',' && first != close) {
        entry.value.kind = Written::Kind::text;
        entry.value.raw = read_flow_text(cursor, false);
      }
      value.entries.push_back(std::move(entry));
      cursor.skip_blanks();
      if (cursor.peek() == ',') {
        cursor.next();
      } else if (cursor.peek() != close) {
        throw Unknown();
      }
    }
    cursor.next();
    return value;
  }

  static std::string read_flow_text(Cursor& cursor, bool is_key) {
    if (cursor.peek() == '"' || cursor.peek() == '\'') return read_quoted(cursor).raw;
    if (std::string_view("&*!|>%@`#?").find(cursor.peek()) != std::string_view::npos) {
      throw Unknown();
    }
    std::string text;
    for (;;) {
      const char c = cursor.peek();
      if (c == ',' || c == '}' || c == ']' || c == '{' || c == '[') break;
      if (c == '#' && (cursor.before() == ' ' || cursor.before() == '\n')) throw Unknown();
      if (c == ':') {
        Cursor ahead = cursor;
        ahead.next();
        const char behind = ahead.peek();
        const bool ends = behind == ' ' || behind == '\n' || behind == ',' || behind == '}';
        if (ends && is_key) break;
        if (ends) throw Unknown();
      }
      text += c == '\n' || c == '\t' ? ' ' : c;
      cursor.next();
    }
    std::string joined;  // line breaks and what is around them are one blank
    for (const char c : stripped(text)) {
      if (c != ' ' || joined.back() != ' ') joined += c;
    }
    return joined;
  }

  Entry read_as_is(std::size_t indent) {
    Entry entry;
    entry.value.kind = Written::Kind::as_is;
    std::size_t end = at_ + 1;
    for (std::size_t at = end; at < lines_.size(); ++at) {
      if (is_blank_line(lines_[at])) continue;
      const std::size_t here = indent_of(lines_[at]);
      const bool is_list = here == indent && lines_[at][here] == '-';
      if (here <= indent && !is_list && lines_[at][here] != '#') break;
      if (here > indent || is_list) end = at + 1;
    }
    for (; at_ < end; ++at_) entry.value.source.push_back(lines_[at_]);
    return entry;
  }

  std::vector<std::string> lines_;
  std::size_t at_ = 0;
};

// ---- Writing ------------------------------------------------------------------------------------

class LayoutWriter : private YamlReader {
 public:
  LayoutWriter(std::string_view text, const std::string& file) : YamlReader(text, file) {}

  std::string write(const Written& root, const YAML::Node& meaning) {
    write_block(root, meaning, 0);
    while (lines_.back().text.empty()) lines_.pop_back();
    std::string text;
    for (const std::string& line : align_comments(lines_, layout_width)) text += line + "\n";
    return text;
  }

 private:
  void write_block(const Written& block, const YAML::Node& meaning, std::size_t indent) {
    if (!meaning.IsMap() || meaning.size() != block.entries.size()) throw Unknown();
    auto node = meaning.begin();
    for (const Entry& entry : block.entries) {
      write_comments(entry.before, indent);
      path_.push_back(node->first.Scalar());
      write_entry(entry, node->second, indent);
      path_.pop_back();
      ++node;
    }
    write_comments(block.tail, indent);
  }

  void write_comments(const std::vector<std::string>& comments, std::size_t indent) {
    for (const std::string& comment : comments) {
      const bool is_blank = lines_.empty() || lines_.back().text.empty();
      if (comment.empty() && is_blank) continue;
      lines_.push_back({comment.empty() ? "" : std::string(indent, ' ') + comment, ""});
    }
  }

  void write_entry(const Entry& entry, const YAML::Node& meaning, std::size_t indent) {
    const std::string begin = std::string(indent, ' ') + entry.key + ":";
    switch (entry.value.kind) {
      case Written::Kind::none: lines_.push_back({begin, entry.comment}); break;
      case Written::Kind::block:
        lines_.push_back({begin, entry.comment});
        write_block(entry.value, meaning, indent + 2);
        break;
      case Written::Kind::as_is: write_as_is(entry.value, indent); break;
      case Written::Kind::map: write_map(entry, meaning, indent, begin); break;
      case Written::Kind::list:
        lines_.push_back({begin + " " + inline_text(entry.value, meaning).value(), entry.comment});
        break;
      case Written::Kind::text:
      case Written::Kind::lines: write_text(entry, meaning, indent, begin); break;
    }
  }

  void write_as_is(const Written& value, std::size_t indent) {
    const std::size_t before = indent_of(value.source.front());
    for (const std::string& line : value.source) {
      const std::size_t kept = std::max(indent_of(line), before) - before;
      const std::string text = line.substr(0, line.find_last_not_of(" \t") + 1);
      lines_.push_back(
          {text.empty() ? "" : std::string(indent + kept, ' ') + text.substr(indent_of(line)), ""});
    }
  }

  void write_map(const Entry& entry, const YAML::Node& meaning, std::size_t indent,
                 const std::string& begin) {
    const auto line = inline_text(entry.value, meaning);
    const std::size_t comment = entry.comment.empty() ? 0 : entry.comment.size() + 2;
    const bool fits = line && begin.size() + 1 + line->size() + comment <= layout_width;
    if (fits || (line && entry.value.entries.empty())) {
      lines_.push_back({begin + " " + *line, entry.comment});
      return;
    }
    lines_.push_back({begin, entry.comment});
    write_block(entry.value, meaning, indent + 2);
  }

  // On one line; nothing if a program in it takes several.
  std::optional<std::string> inline_text(const Written& value, const YAML::Node& meaning) {
    if (value.kind == Written::Kind::none) return "";
    if (value.kind == Written::Kind::text) return inline_scalar(value, meaning);
    const bool is_map = value.kind == Written::Kind::map;
    if (is_map ? !meaning.IsMap() : !meaning.IsSequence()) throw Unknown();
    if (meaning.size() != value.entries.size()) throw Unknown();
    std::string text = is_map ? "{" : "[";
    auto node = meaning.begin();
    for (const Entry& entry : value.entries) {
      path_.push_back(is_map ? node->first.Scalar() : "");
      const auto inner =
          inline_text(entry.value, is_map ? YAML::Node(node->second) : YAML::Node(*node));
      path_.pop_back();
      ++node;
      if (!inner) return std::nullopt;
      if (text.size() > 1) text += ", ";
      text += is_map ? entry.key + (inner->empty() ? ":" : ": ") + *inner : *inner;
    }
    return text + (is_map ? "}" : "]");
  }

  std::optional<std::string> inline_scalar(const Written& value, const YAML::Node& meaning) {
    const bool is_quoted = value.raw.front() == '"' || value.raw.front() == '\'';
    const TextMeaning what = meaning.IsScalar() ? meaning_of(path_) : TextMeaning::other;
    if (what == TextMeaning::other || meaning.Scalar().empty()) {
      if (is_quoted && value.raw.find('\n') != std::string::npos) throw Unknown();
      return value.raw;
    }
    const ScalarText text = text_of(meaning);
    if (what == TextMeaning::formula) {
      if (!words_of(meaning.Scalar()).comments.empty()) {
        if (value.raw.find('\n') != std::string::npos) throw Unknown();
        return value.raw;
      }
      return quoted(lay_out_formula(text));
    }
    const std::vector<LaidLine> lines = lay_out_program(text, ~std::size_t{0});
    if (lines.size() != 1 || !lines[0].comment.empty() || lines[0].text.starts_with("//") ||
        lines[0].text.starts_with("#")) {
      return std::nullopt;
    }
    return quoted(lines[0].text);
  }

  static std::string quoted(const std::string& text) {
    if (text.find_first_of("\"\\") == std::string::npos) return "\"" + text + "\"";
    if (text.find('\'') == std::string::npos) return "'" + text + "'";
    throw Unknown();
  }

  void write_text(const Entry& entry, const YAML::Node& meaning, std::size_t indent,
                  const std::string& begin) {
    const TextMeaning what = meaning.IsScalar() ? meaning_of(path_) : TextMeaning::other;
    const bool is_lines = entry.value.kind == Written::Kind::lines;
    if (what != TextMeaning::program || meaning.Scalar().empty()) {
      if (!is_lines) {
        lines_.push_back(
            {begin + " " + inline_scalar(entry.value, meaning).value(), entry.comment});
        return;
      }
      // Of a text that may be anything, every blank counts.
      if (entry.value.raw.find_first_of("0123456789") != std::string::npos) throw Unknown();
      lines_.push_back({begin + " " + entry.value.raw, entry.comment});
      const std::size_t before = first_indent(entry.value.source);
      for (const std::string& line : entry.value.source) {
        if (indent_of(line) < before && !is_blank_line(line)) throw Unknown();
        lines_.push_back(
            {is_blank_line(line) ? "" : std::string(indent + 2, ' ') + line.substr(before), ""});
      }
      return;
    }
    if (!is_lines) {
      const auto line = inline_scalar(entry.value, meaning);
      const std::size_t comment = entry.comment.empty() ? 0 : entry.comment.size() + 2;
      if (line && begin.size() + 1 + line->size() + comment <= layout_width) {
        lines_.push_back({begin + " " + *line, entry.comment});
        return;
      }
    }
    lines_.push_back({begin + " |", entry.comment});
    const auto program = lay_out_program(text_of(meaning), layout_width - indent - 2);
    for (const std::string& line : align_comments(program, layout_width - indent - 2)) {
      lines_.push_back({line.empty() ? "" : std::string(indent + 2, ' ') + line, ""});
    }
  }
  static std::size_t first_indent(const std::vector<std::string>& lines) {
    const auto first = std::find_if_not(lines.begin(), lines.end(), is_blank_line);
    return first == lines.end() ? 0 : indent_of(*first);
  }

  std::vector<LaidLine> lines_;
  std::vector<std::string> path_;
};

// ---- What was kept ------------------------------------------------------------------------------

// Throws std::logic_error unless both mean the same, but for the blanks of programs and formulas.
void require_same(const YAML::Node& before, const YAML::Node& after,
                  std::vector<std::string>& path) {
  const auto fail = [] { throw std::logic_error("the layout of a file changed what it means"); };
  if (before.Type() != after.Type()) fail();
  if (before.IsScalar()) {
    if (meaning_of(path) == TextMeaning::other
            ? before.Scalar() != after.Scalar()
            : words_of(before.Scalar()) != words_of(after.Scalar())) {
      fail();
    }
    return;
  }
  if (before.size() != after.size()) fail();
  auto other = after.begin();
  for (const auto& entry : before) {
    if (before.IsMap()) {
      if (!entry.first.IsScalar() || entry.first.Scalar() != other->first.Scalar()) fail();
      path.push_back(entry.first.Scalar());
      require_same(entry.second, other->second, path);
    } else {
      path.emplace_back();
      require_same(entry, *other, path);
    }
    path.pop_back();
    ++other;
  }
}

std::vector<std::string> plain_lines(std::string_view text) {
  std::vector<std::string> lines;
  for (std::string_view line : split_lines(text)) {
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.emplace_back(line);
  }
  return lines;
}

}  // namespace

std::string lay_out_system(std::string_view text, const std::string& file) {
  const YamlReader reader(text, file);
  const YAML::Node before = reader.load();
  if (!before.IsMap()) reader.fail("a system file must be a map (key: value)", before);
  std::string result;
  try {
    result = LayoutWriter(text, file).write(LayoutReader(plain_lines(text)).read(), before);
  } catch (const Unknown&) {
    return std::string(text);
  }
  const YAML::Node after = YamlReader(result, file).load();
  std::vector<std::string> path;
  require_same(before, after, path);
  return result;
}

}  // namespace maide
