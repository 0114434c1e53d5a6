#include "maide/check/tree/print.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/language/code_layout.hpp"
#include "maide/check/text/scalar_text.hpp"
#include "maide/check/tree/schema.hpp"
#include "maide/check/tree/system_tree.hpp"

namespace maide {
namespace {

// What a text is to this style.
enum class Meaning : std::uint8_t { other, program, formula };

// A place in the table of keys: of whom the children are, and what a text there means.
class Place {
 public:
  Place() : Place("", true) {}
  static Place unknown() { return Place("", false); }

  Place below(const YamlNode& key, const YamlNode& value) const {
    if (!is_known_) return Place("", false);
    const std::string head = path_.empty() ? "" : path_ + "/";
    for (const std::string& path : {head + key.value, head + "*"}) {
      const std::vector<const Key*> keys = keys_at(path);
      for (const Key* known : keys) {
        const bool is_for_maps = known->kind == FieldKind::map || known->kind == FieldKind::entries;
        if (is_for_maps != value.is_map()) continue;
        Place place(path, true);
        place.kind_ = known->kind;
        return place;
      }
    }
    return Place("", false);
  }
  Meaning meaning() const {
    switch (kind_) {
      case FieldKind::program:
      case FieldKind::procedure:
      case FieldKind::callback:
      case FieldKind::variables: return Meaning::program;
      case FieldKind::formula: return Meaning::formula;
      default: return Meaning::other;
    }
  }

 private:
  Place(std::string path, bool is_known) : path_(std::move(path)), is_known_(is_known) {}

  std::string path_;
  bool is_known_;
  FieldKind kind_ = FieldKind::map;
};

bool is_made(const YamlNode& node) { return node.begin == YamlNode::nowhere; }

// Its text stands in the file, and nothing else with it.
bool has_own_text(const YamlNode& node) {
  return !is_made(node) && node.tag.empty() && node.anchor.empty() && node.alias.empty();
}

bool is_blank_line(std::string_view line) {
  return line.find_first_not_of(" \t\r") == std::string_view::npos;
}
std::size_t spaces_before(std::string_view line) {
  return std::min(line.find_first_not_of(' '), line.size());
}

// Bytes of the character that stands there, if YAML takes it as an escape alone; else 0. Those that
// break a line in YAML are among them, but for \n.
std::size_t length_in_escape(std::string_view text) {
  const auto first = static_cast<unsigned char>(text.front());
  if (first < 0x20) return first == '\n' || first == '\t' ? 0 : 1;
  if (first == 0x7f) return 1;
  if (first == 0xc2 && text.size() > 1 && static_cast<unsigned char>(text[1]) < 0xa0) return 2;
  for (const std::string_view sign : {"\u2028", "\u2029", "\uFEFF", "\uFFFE", "\uFFFF"}) {
    if (text.starts_with(sign)) return sign.size();
  }
  return 0;
}

bool needs_escapes(std::string_view text) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (length_in_escape(text.substr(at)) > 0) return true;
  }
  return false;
}

// Of one character: "\x01", "\u2028".
std::string escape(std::string_view character) {
  std::uint32_t code = static_cast<unsigned char>(character.front());
  if (character.size() > 1) code &= character.size() == 2 ? 0x1fU : 0x0fU;
  for (const char c : character.substr(1))
    code = code << 6 | (static_cast<unsigned char>(c) & 0x3fU);
  return code < 0x80 ? fmt::format("\\x{:02x}", code) : fmt::format("\\u{:04x}", code);
}

// A text that YAML reads as this text without quotes, in braces, too.
bool is_plain(const std::string& text) {
  if (text.empty() || YamlNode(text).is_null() || text.front() == ' ' || text.back() == ' ' ||
      needs_escapes(text)) {
    return false;
  }
  if (std::string_view("-?:,[]{}#&*!|>'\"%@`").find(text.front()) != std::string_view::npos) {
    return text.front() == '-' && text.size() > 1 && text[1] >= '0' && text[1] <= '9' &&
           text.find_first_of(":, ") == std::string::npos;
  }
  if (text.back() == ':') return false;
  return text.find(": ") == std::string::npos && text.find(" #") == std::string::npos &&
         text.find_first_of(",[]{}\n\t\"\\") == std::string::npos;
}

std::string in_double_quotes(const std::string& text) {
  std::string written = "\"";
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (const auto length = length_in_escape(std::string_view(text).substr(at)); length > 0) {
      written += escape(std::string_view(text).substr(at, length));
      at += length - 1;
    } else if (c == '\n') {
      written += "\\n";
    } else if (c == '\t') {
      written += "\\t";
    } else {
      if (c == '"' || c == '\\') written += '\\';
      written += c;
    }
  }
  return written + "\"";
}

// Single quotes where the text has double ones.
std::string in_quotes(const std::string& text) {
  const bool has_double = text.find_first_of("\"\\") != std::string::npos;
  const bool has_others = text.find_first_of("'\n\t") != std::string::npos || needs_escapes(text);
  if (has_double && !has_others) return "'" + text + "'";
  return in_double_quotes(text);
}

class SystemPrinter {
 public:
  explicit SystemPrinter(const YamlDocument& document) : document_(document) {
    if (document.text.empty()) return;
    before_ = read_yaml(document.text, document.file, "a system file");
    is_changed_ = !is_same_value(before_.root, document.root);
    if (is_changed_) find_unchanged(document.root, before_.root);
  }

  std::string print() {
    if (is_changed_ ? !document_.root.is_map()
                    : document_.is_kept || !document_.root.is_map() ||
                          document_.root.style != YamlNode::Style::block) {
      return document_.text;
    }
    print_block(document_.root, Place(), 0);
    while (!lines_.empty() && lines_.back().text.empty()) lines_.pop_back();
    std::string text;
    for (const std::string& line : align_comments(lines_, layout_width)) text += line + "\n";
    return text;
  }

  // On one line; nothing if a program in it takes several.
  std::optional<std::string> inline_text(const YamlNode& node, const Place& place) const {
    if (node.is_scalar()) return inline_scalar(node, place.meaning());
    std::string text = node.is_map() ? "{" : "[";
    for (const YamlEntry& entry : node.entries) {
      const auto inner = inline_text(entry.value, place.below(entry.key, entry.value));
      if (!inner) return std::nullopt;
      if (text.size() > 1) text += ", ";
      if (node.is_map()) text += scalar(entry.key) + (inner->empty() ? ":" : ": ");
      text += *inner;
    }
    return text + (node.is_map() ? "}" : "]");
  }

 private:
  // The node's text, with the quotes that it has or needs.
  std::string scalar(const YamlNode& node) const {
    if (node.is_null() && node.value.empty()) return "";
    if (!has_own_text(node)) {
      return node.style == YamlNode::Style::plain && is_plain(node.value) ? node.value
                                                                          : in_quotes(node.value);
    }
    return node.is_quoted() ? std::string(document_.source(node)) : node.value;
  }

  ScalarText text_of(const YamlNode& node) const {
    if (!has_own_text(node)) return ScalarText(node.value, node.value, {document_.file, 1, 1});
    return ScalarText(node.value, document_.text, document_.position(node));
  }

  std::optional<std::string> inline_scalar(const YamlNode& node, Meaning meaning) const {
    if (node.value.empty() || meaning == Meaning::other) return scalar(node);
    const ScalarText text = text_of(node);
    if (meaning == Meaning::formula) {
      return has_comments(text) ? scalar(node) : in_quotes(lay_out_formula(text));
    }
    const std::vector<LaidLine> lines = lay_out_program(text, ~std::size_t{0});
    if (lines.size() != 1 || !lines[0].comment.empty() || lines[0].text.starts_with("//") ||
        lines[0].text.starts_with("#")) {
      return std::nullopt;
    }
    const std::string& line = lines[0].text;
    // A single word needs no quotes: `unknown`.
    const bool is_word = !node.is_quoted() && line.find_first_of(" ;.{}()") == std::string::npos;
    return is_word ? line : in_quotes(line);
  }

  // ---- What is written as it stands -------------------------------------------------------------

  // Notes the entries whose values are those of the text. Keys of a map differ.
  void find_unchanged(const YamlNode& map, const YamlNode& before) {
    for (const YamlEntry& entry : map.entries) {
      const YamlNode* const old = before.find(entry.key.value);
      if (old == nullptr) continue;
      if (is_same_value(entry.value, *old)) unchanged_.insert(&entry);
      find_unchanged(entry.value, *old);
    }
  }

  // Once something was changed, an anchor may not stand for its value any more, and where something
  // was changed nothing stands as it was.
  bool stands_as_it_is(const YamlEntry& entry) const {
    if (is_made(entry.key)) return false;
    if (is_changed_ && (!unchanged_.contains(&entry) || has_reference(entry.value))) return false;
    return entry.is_kept || has_no_form(entry.key) || has_no_form(entry.value) ||
           document_.text.compare(entry.key.begin, 1, "?") == 0 || is_behind_sign(entry.key);
  }
  // "? key"
  bool is_behind_sign(const YamlNode& key) const {
    std::size_t at = key.begin;
    while (at > 0 && document_.text[at - 1] == ' ') --at;
    return at > 0 && document_.text[at - 1] == '?';
  }
  bool has_no_form(const YamlNode& node) const {
    if (!node.tag.empty() || !node.anchor.empty() || !node.alias.empty()) return true;
    if (is_made(node)) return false;
    if (node.is_scalar()) {
      return node.is_quoted() && document_.source(node).find('\n') != std::string_view::npos;
    }
    if (node.style == YamlNode::Style::block) return node.is_list();
    return std::any_of(node.entries.begin(), node.entries.end(), [&](const YamlEntry& entry) {
      return has_no_form(entry.key) || has_no_form(entry.value);
    });
  }

  void print_as_it_stands(const YamlEntry& entry, std::size_t indent) {
    const std::string& text = document_.text;
    const std::size_t begin = text.rfind('\n', entry.key.begin) + 1;
    std::size_t end = std::max(entry.key.end, entry.value.end);
    if (end > begin && text[end - 1] == '\n') --end;
    end = std::min(text.find('\n', end), text.size());
    const std::vector<std::string_view> lines =
        split_lines(std::string_view(text).substr(begin, end - begin));
    const std::size_t before = spaces_before(lines.front());
    for (const std::string_view line : lines) {
      const std::size_t kept = std::max(spaces_before(line), before) - before;
      lines_.push_back(
          {is_blank_line(line)
               ? ""
               : std::string(indent + kept, ' ') +
                     std::string(line.substr(spaces_before(line), line.find_last_not_of(" \t\r") +
                                                                      1 - spaces_before(line))),
           ""});
    }
  }

  // ---- Blocks -----------------------------------------------------------------------------------

  void print_block(const YamlNode& map, const Place& place, std::size_t indent) {
    for (const YamlEntry& entry : map.entries) {
      print_comments(entry.before, indent);
      if (stands_as_it_is(entry)) {
        print_as_it_stands(entry, indent);
      } else {
        print_entry(entry, place.below(entry.key, entry.value), indent);
      }
    }
    print_comments(map.tail, indent);
  }

  void print_comments(const std::vector<std::string>& comments, std::size_t indent) {
    for (const std::string& comment : comments) {
      const bool is_blank = lines_.empty() || lines_.back().text.empty();
      if (comment.empty() && is_blank) continue;
      lines_.push_back({comment.empty() ? "" : std::string(indent, ' ') + comment, ""});
    }
  }

  void print_entry(const YamlEntry& entry, const Place& place, std::size_t indent) {
    const YamlNode& value = entry.value;
    const std::string begin = std::string(indent, ' ') + scalar(entry.key) + ":";
    if (value.is_scalar()) {
      print_text(entry, place, indent, begin);
    } else if (value.is_map() && value.style == YamlNode::Style::block) {
      lines_.push_back({begin, entry.comment});
      print_block(value, place, indent + 2);
    } else if (value.is_map()) {
      print_map(entry, place, indent, begin);
    } else {
      lines_.push_back({begin + " " + inline_text(value, place).value(), entry.comment});
    }
  }

  bool fits(const std::string& begin, const std::string& line, const std::string& comment) const {
    return begin.size() + 1 + line.size() + (comment.empty() ? 0 : comment.size() + 2) <=
           layout_width;
  }

  void print_map(const YamlEntry& entry, const Place& place, std::size_t indent,
                 const std::string& begin) {
    const auto line = inline_text(entry.value, place);
    if (line && (fits(begin, *line, entry.comment) || entry.value.entries.empty())) {
      lines_.push_back({begin + " " + *line, entry.comment});
      return;
    }
    lines_.push_back({begin, entry.comment});
    print_block(entry.value, place, indent + 2);
  }

  void print_text(const YamlEntry& entry, const Place& place, std::size_t indent,
                  const std::string& begin) {
    const YamlNode& value = entry.value;
    if (place.meaning() == Meaning::program && !value.value.empty()) {
      print_program(entry, place, indent, begin);
    } else if (value.is_lines()) {
      print_lines(entry, indent, begin);
    } else {
      const std::string line = inline_scalar(value, place.meaning()).value();
      lines_.push_back({line.empty() ? begin : begin + " " + line, entry.comment});
    }
  }

  void print_program(const YamlEntry& entry, const Place& place, std::size_t indent,
                     const std::string& begin) {
    if (!entry.value.is_lines()) {
      const auto line = inline_scalar(entry.value, place.meaning());
      if (line && fits(begin, *line, entry.comment)) {
        lines_.push_back({begin + " " + *line, entry.comment});
        return;
      }
    }
    if (needs_escapes(entry.value.value)) {  // a block has none
      lines_.push_back({begin + " " + scalar(entry.value), entry.comment});
      return;
    }
    lines_.push_back({begin + " |", entry.comment});
    const std::size_t width = layout_width - std::min(indent + 2, layout_width / 2);
    for (const std::string& line :
         align_comments(lay_out_program(text_of(entry.value), width), width)) {
      lines_.push_back({line.empty() ? "" : std::string(indent + 2, ' ') + line, ""});
    }
  }

  // In a text that may be anything, every blank counts.
  void print_lines(const YamlEntry& entry, std::size_t indent, const std::string& begin) {
    if (!has_own_text(entry.value)) {
      if (needs_escapes(entry.value.value)) {  // a block has none
        lines_.push_back({begin + " " + scalar(entry.value), entry.comment});
        return;
      }
      lines_.push_back({begin + " |", entry.comment});
      for (const std::string_view line : split_lines(entry.value.value)) {
        lines_.push_back(
            {is_blank_line(line) ? "" : std::string(indent + 2, ' ') + std::string(line), ""});
      }
      return;
    }
    const std::vector<std::string_view> lines = split_lines(document_.source(entry.value));
    const std::string_view mark = lines.front().substr(0, lines.front().find_first_of(" \t\r"));
    if (mark.find_first_of("0123456789") != std::string_view::npos) {
      print_as_it_stands(entry, indent);
      return;
    }
    lines_.push_back({begin + " " + std::string(mark), entry.comment});
    std::optional<std::size_t> before;
    for (std::size_t i = 1; i < lines.size(); ++i) {
      std::string_view line = lines[i];
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (is_blank_line(line)) {
        lines_.push_back({"", ""});
        continue;
      }
      if (!before) before = spaces_before(line);
      lines_.push_back({std::string(indent + 2, ' ') +
                            std::string(line.substr(std::min(*before, spaces_before(line)))),
                        ""});
    }
  }

  const YamlDocument& document_;
  YamlDocument before_;  // as its text has it
  bool is_changed_ = false;
  std::set<const YamlEntry*> unchanged_;  // if it is changed: entries that are not
  std::vector<LaidLine> lines_;
};

// Throws std::logic_error unless both mean the same, but for the blanks of programs and formulas.
void require_same(const YamlDocument& before, const YamlNode& one, const YamlDocument& after,
                  const YamlNode& other, const Place& place) {
  const auto fail = [] { throw std::logic_error("the layout of a file changed what it means"); };
  if (one.kind != other.kind || one.entries.size() != other.entries.size()) fail();
  if (one.is_scalar()) {
    if (place.meaning() == Meaning::other || one.value.empty()
            ? one.value != other.value
            : !has_same_words(ScalarText(one.value, before.text, before.position(one)),
                              ScalarText(other.value, after.text, after.position(other)))) {
      fail();
    }
    return;
  }
  for (std::size_t i = 0; i < one.entries.size(); ++i) {
    const YamlEntry &a = one.entries[i], &b = other.entries[i];
    if (a.key.value != b.key.value) fail();
    require_same(before, a.value, after, b.value, place.below(a.key, a.value));
  }
}

}  // namespace

std::string print_system(const YamlDocument& document) { return SystemPrinter(document).print(); }

std::string print_inline(const YamlDocument& document, const YamlNode& node) {
  return SystemPrinter(document).inline_text(node, Place::unknown()).value();
}

std::string format_system(const std::string& text, const std::string& file) {
  const SystemTree before = read_tree(text, file);
  std::string printed = print_system(*before.document);
  const SystemTree after = read_tree(printed, file);
  require_same(*before.document, before.document->root, *after.document, after.document->root,
               Place());
  return printed;
}

}  // namespace maide
