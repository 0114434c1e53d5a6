#include "maide/check/text/yaml_node.hpp"

#include <yaml.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "maide/base/text.hpp"

namespace maide {

YamlNode::YamlNode() = default;
YamlNode::YamlNode(std::string text, Style how) : style(how), value(std::move(text)) {}

YamlNode YamlNode::make_map(Style how) {
  YamlNode map;
  map.kind = Kind::map;
  map.style = how;
  return map;
}

bool YamlNode::is_null() const {
  return is_scalar() && style == Style::plain && tag.empty() &&
         (value.empty() || value == "~" || value == "null" || value == "Null" || value == "NULL");
}

const YamlNode* YamlNode::find(std::string_view key) const {
  if (!is_map()) return nullptr;
  for (const YamlEntry& entry : entries) {
    if (entry.key.is_scalar() && entry.key.value == key) return &entry.value;
  }
  return nullptr;
}

YamlNode* YamlNode::find(std::string_view key) {
  return const_cast<YamlNode*>(std::as_const(*this).find(key));
}

YamlNode YamlNode::make_names(const std::vector<std::string>& names) {
  if (names.size() == 1) return YamlNode(names.front());
  YamlNode list;
  list.kind = Kind::list;
  list.style = Style::flow;
  for (const std::string& name : names) list.entries.emplace_back().value = YamlNode(name);
  return list;
}

YamlNode& YamlNode::at(std::string_view key, Style how) {
  if (YamlNode* const known = find(key)) return *known;
  if (!is_map()) *this = make_map(how);
  YamlEntry& entry = entries.emplace_back();
  entry.key = YamlNode(std::string(key));
  return entry.value;
}

YamlNode& YamlNode::set(std::string_view key, YamlNode node) { return at(key) = std::move(node); }

void YamlNode::remove(std::string_view key) {
  std::erase_if(entries, [&](const YamlEntry& entry) { return entry.key.value == key; });
}

bool has_reference(const YamlNode& node) {
  return !node.anchor.empty() || !node.alias.empty() ||
         std::ranges::any_of(node.entries,
                             [](const YamlEntry& entry) { return has_reference(entry.value); });
}

bool is_same_value(const YamlNode& one, const YamlNode& other) {
  if (one.kind != other.kind || one.value != other.value) return false;
  return std::equal(one.entries.begin(), one.entries.end(), other.entries.begin(),
                    other.entries.end(), [](const YamlEntry& a, const YamlEntry& b) {
                      return is_same_value(a.key, b.key) && is_same_value(a.value, b.value);
                    });
}

namespace {

constexpr std::size_t max_depth = 100;        // readers of the tree recurse
constexpr std::size_t max_nodes = 1'000'000;  // of copies that aliases make

// Bytes and lines of places that libyaml counts in characters.
class PlaceTable {
 public:
  explicit PlaceTable(std::string_view text) : text_(text) {
    lines_.push_back(0);
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') lines_.push_back(i + 1);
    }
    if (std::ranges::none_of(text, is_continuation)) return;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (!is_continuation(text[i])) bytes_.push_back(i);
    }
    bytes_.push_back(text.size());
  }

  std::size_t byte_of(std::size_t character) const {
    if (bytes_.empty()) return std::min(character, text_.size());
    return bytes_[std::min(character, bytes_.size() - 1)];
  }
  // The number of the line, from 0.
  std::size_t line_of(std::size_t byte) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(lines_, byte) - lines_.begin()) - 1;
  }
  TextPlace place_of(std::size_t byte) const {
    const std::size_t line = line_of(byte);
    return {static_cast<int>(line) + 1, static_cast<int>(byte - lines_[line]) + 1};
  }
  std::size_t line_count() const { return lines_.size(); }
  std::size_t line_begin(std::size_t line) const { return lines_[line]; }
  // Without its end.
  std::string_view line(std::size_t number) const {
    const std::size_t begin = lines_[number];
    std::string_view line = text_.substr(
        begin, number + 1 < lines_.size() ? lines_[number + 1] - begin : std::string_view::npos);
    while (line.ends_with('\n') || line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

 private:
  std::string_view text_;
  std::vector<std::size_t> lines_, bytes_;  // bytes_: empty where each character is one
};

std::size_t indent_of(std::string_view line) {
  return std::min(line.find_first_not_of(" \t"), line.size());
}
std::string trimmed(std::string_view text) {
  return std::string(text.substr(0, text.find_last_not_of(" \t\r\n") + 1));
}

// ---- Messages -----------------------------------------------------------------------------------

// What libyaml says, as somebody says it who knows what files look like.
class YamlMessages {
 public:
  YamlMessages(std::string_view text, const PlaceTable& places) : text_(text), places_(places) {}

  std::string in_plain_words(const std::string& problem, const std::string& context,
                             std::size_t at) const {
    const std::string_view line = places_.line(places_.line_of(at));
    if (line.substr(0, line.find_first_not_of(" \t")).find('\t') != std::string_view::npos) {
      return "lines are indented with blanks, and here is a tab";
    }
    const char here = at < text_.size() ? text_[at] : '\0';
    if (here == '[' && at > 0 && is_in_name(text_[at - 1]) && is_in_brackets(problem)) {
      return "in braces and brackets a name with '[' is put in quotes, as in " + name_at(at);
    }
    if (problem == "found character that cannot start any token" && here != '\0') {
      return "a text that begins with '" + std::string(1, here) + "' is put in quotes";
    }
    if (problem == "found undefined tag handle" ||
        (here == '!' && context == "while parsing a tag") || context == "while scanning a tag") {
      return "to YAML, this '!' begins a tag: a text that begins with it is put in quotes";
    }
    if (problem == "found unexpected end of stream" &&
        context == "while scanning a quoted scalar") {
      return "a quote is not closed";
    }
    if (problem == "did not find expected key") {
      const bool begins_line = at == places_.line_begin(places_.line_of(at)) + indent_of(line);
      return begins_line ? "this line is indented like none above it"
                         : "nothing may follow a text in quotes, or a bracket, on its line";
    }
    constexpr std::pair<std::string_view, std::string_view> known[] = {
        {"did not find expected ',' or '}'",
         "a '{' is not closed, or a ',' is missing between its entries"},
        {"did not find expected ',' or ']'", "a '[' is not closed, or a ',' is missing in it"},
        {"mapping values are not allowed in this context",
         "a text with ': ' in it is in quotes, and a key begins a line or stands in braces"},
        {"could not find expected ':'", "a key has ': ' behind it"},
        {"did not find expected alphabetic or numeric character",
         "a text that begins with '*' or '&' is put in quotes"},
        {"found unknown escape character",
         "in double quotes a '\\' begins an escape: write it twice, or take single quotes"},
    };
    for (const auto& [theirs, ours] : known) {
      if (problem == theirs) return std::string(ours);
    }
    return context.empty() ? problem : problem + " " + context;
  }

 private:
  static bool is_in_name(char c) { return is_letter(c) || is_digit(c) || c == '_' || c == '-'; }
  static bool is_in_brackets(const std::string& problem) {
    return problem.starts_with("did not find expected ','");
  }
  // "p[k]", in quotes, of the '[' at that place.
  std::string name_at(std::size_t at) const {
    std::size_t begin = at;
    while (begin > 0 && is_in_name(text_[begin - 1])) --begin;
    const std::size_t end = text_.find_first_of("]\n", at);
    const bool is_closed = end != std::string_view::npos && text_[end] == ']';
    return "\"" + std::string(text_.substr(begin, is_closed ? end + 1 - begin : at + 1 - begin)) +
           (is_closed ? "\"" : "k]\"");
  }

  std::string_view text_;
  const PlaceTable& places_;
};

// ---- From events to nodes -----------------------------------------------------------------------

struct ParserDeleter {
  void operator()(yaml_parser_t* parser) const {
    yaml_parser_delete(parser);
    delete parser;
  }
};

std::string text_of(const yaml_char_t* text) {
  return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}

class YamlBuilder {
 public:
  // Keeps references. The text begins with no byte order mark.
  YamlBuilder(YamlDocument& document, std::string_view what)
      : document_(document), what_(what), places_(document.text) {
    auto* const parser = new yaml_parser_t;
    yaml_parser_initialize(parser);  // it fails for want of memory alone
    parser_.reset(parser);
    yaml_parser_set_encoding(parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(parser,
                                 reinterpret_cast<const unsigned char*>(document_.text.data()),
                                 document_.text.size());
  }

  void build() {
    bool has_document = false;
    for (;;) {
      Event event = next();
      switch (event->type) {
        case YAML_STREAM_END_EVENT: finish(has_document); return;
        case YAML_DOCUMENT_START_EVENT:
          if (has_document) {
            fail(std::string(what_) + " is one YAML document", byte_of(event->start_mark));
          }
          has_document = true;
          document_.is_kept = event->data.document_start.implicit == 0;
          document_.root = node(next());
          break;
        case YAML_DOCUMENT_END_EVENT:
          document_.is_kept = document_.is_kept || event->data.document_end.implicit == 0;
          break;
        default: break;
      }
    }
  }
  const PlaceTable& places() const { return places_; }
  // Where scalars have text of their own: begin and end, in order. No `#` in there is a comment.
  const std::vector<std::pair<std::size_t, std::size_t>>& texts() const { return texts_; }

 private:
  struct EventDeleter {
    void operator()(yaml_event_t* event) const {
      yaml_event_delete(event);
      delete event;
    }
  };
  using Event = std::unique_ptr<yaml_event_t, EventDeleter>;

  [[noreturn]] void fail(const std::string& message, std::size_t byte) const {
    const TextPlace place = places_.place_of(byte);
    throw ParseError(message, {document_.file, place.line, place.column});
  }
  std::size_t byte_of(const yaml_mark_t& mark) const { return places_.byte_of(mark.index); }

  void finish(bool has_document) const {
    if (!has_document || document_.root.is_null()) {
      throw ParseError("the " + without_article() + " is empty", {document_.file, 1, 1});
    }
  }
  std::string without_article() const { return std::string(what_.substr(what_.find(' ') + 1)); }

  Event next() {
    auto event = std::make_unique<yaml_event_t>();
    if (yaml_parser_parse(parser_.get(), event.get()) != 0) return Event(event.release());
    const yaml_parser_t& parser = *parser_;
    if (parser.error == YAML_READER_ERROR) {
      fail("not YAML: " + std::string(parser.problem),
           std::min(parser.problem_offset, document_.text.size()));
    }
    const std::string problem = parser.problem == nullptr ? "" : parser.problem;
    const std::string context = parser.context == nullptr ? "" : parser.context;
    std::size_t at = byte_of(parser.problem_mark);
    if (context == "while scanning a quoted scalar") at = byte_of(parser.context_mark);
    fail("not YAML: " + YamlMessages(document_.text, places_).in_plain_words(problem, context, at),
         at);
  }

  void begin(YamlNode& node, const Event& event, const yaml_char_t* anchor,
             const yaml_char_t* tag) const {
    node.begin = byte_of(event->start_mark);
    node.place = places_.place_of(node.begin);
    node.anchor = text_of(anchor);
    node.tag = text_of(tag);
  }

  YamlNode node(const Event& event) {
    if (depth_ == max_depth) fail("brackets nested too deeply", byte_of(event->start_mark));
    ++depth_;
    YamlNode made = node_of(event);
    --depth_;
    if (!made.anchor.empty()) anchors_[made.anchor] = made;
    return made;
  }

  YamlNode node_of(const Event& event) {
    switch (event->type) {
      case YAML_ALIAS_EVENT: return alias(event);
      case YAML_SEQUENCE_START_EVENT: return list(event);
      case YAML_MAPPING_START_EVENT: return map(event);
      default: return scalar(event);
    }
  }

  YamlNode alias(const Event& event) {
    const std::string name = text_of(event->data.alias.anchor);
    const auto known = anchors_.find(name);
    const std::size_t at = byte_of(event->start_mark);
    if (known == anchors_.end()) {
      fail("not YAML: a text that begins with '*' is put in quotes", at);
    }
    YamlNode copy = known->second;
    copies_ += count_of(copy);
    if (copies_ > max_nodes) fail("aliases stand for more than a million values", at);
    copy.anchor.clear();
    copy.alias = name;
    copy.begin = at;
    copy.end = byte_of(event->end_mark);
    copy.place = places_.place_of(at);
    return copy;
  }
  static std::size_t count_of(const YamlNode& node) {
    std::size_t count = 1;
    for (const YamlEntry& entry : node.entries) count += 1 + count_of(entry.value);
    return count;
  }

  YamlNode scalar(const Event& event) {
    const auto& data = event->data.scalar;
    YamlNode node(std::string(reinterpret_cast<const char*>(data.value), data.length));
    begin(node, event, data.anchor, data.tag);
    node.end = byte_of(event->end_mark);
    std::size_t text = node.begin;
    switch (data.style) {
      case YAML_SINGLE_QUOTED_SCALAR_STYLE: node.style = YamlNode::Style::single_quoted; break;
      case YAML_DOUBLE_QUOTED_SCALAR_STYLE: node.style = YamlNode::Style::double_quoted; break;
      case YAML_LITERAL_SCALAR_STYLE: node.style = YamlNode::Style::literal; break;
      case YAML_FOLDED_SCALAR_STYLE: node.style = YamlNode::Style::folded; break;
      default: break;
    }
    if (node.is_lines()) {  // its first line may end in a comment
      while (node.end > node.begin && is_space(document_.text[node.end - 1])) --node.end;
      text = std::min(document_.text.find('\n', node.begin), node.end);
    }
    texts_.emplace_back(text, node.end);
    return node;
  }

  YamlNode list(const Event& event) {
    const auto& data = event->data.sequence_start;
    YamlNode list;
    list.kind = YamlNode::Kind::list;
    list.style =
        data.style == YAML_FLOW_SEQUENCE_STYLE ? YamlNode::Style::flow : YamlNode::Style::block;
    begin(list, event, data.anchor, data.tag);
    for (;;) {
      const Event inner = next();
      if (inner->type == YAML_SEQUENCE_END_EVENT) {
        end(list, inner);
        return list;
      }
      list.entries.emplace_back().value = node(inner);
    }
  }

  YamlNode map(const Event& event) {
    const auto& data = event->data.mapping_start;
    YamlNode map = YamlNode::make_map(
        data.style == YAML_FLOW_MAPPING_STYLE ? YamlNode::Style::flow : YamlNode::Style::block);
    begin(map, event, data.anchor, data.tag);
    for (;;) {
      const Event inner = next();
      if (inner->type == YAML_MAPPING_END_EVENT) {
        end(map, inner);
        return map;
      }
      YamlEntry entry;
      entry.key = node(inner);
      entry.value = node(next());
      map.entries.push_back(std::move(entry));
    }
  }

  // Behind the bracket, or the last entry of a block.
  void end(YamlNode& node, const Event& event) const {
    node.end = byte_of(event->end_mark);
    if (node.style == YamlNode::Style::flow) return;
    node.end = node.begin;
    for (const YamlEntry& entry : node.entries) {
      if (entry.key.end != YamlNode::nowhere) node.end = std::max(node.end, entry.key.end);
      node.end = std::max(node.end, entry.value.end);
    }
  }

  YamlDocument& document_;
  std::string_view what_;
  PlaceTable places_;
  std::unique_ptr<yaml_parser_t, ParserDeleter> parser_;
  std::vector<std::pair<std::size_t, std::size_t>> texts_;
  std::map<std::string, YamlNode> anchors_;
  std::size_t depth_ = 0, copies_ = 0;
};

// ---- Comments -----------------------------------------------------------------------------------

// Gives comments and blank lines to the entries beside which they stand.
//
//   a:            # of a
//     b: 1
//     # behind b: it is indented as b is
//   # before c
//   c: 2
class CommentReader {
 public:
  CommentReader(YamlDocument& document, const PlaceTable& places,
                const std::vector<std::pair<std::size_t, std::size_t>>& texts)
      : document_(document), places_(places) {
    find_comments(texts);
  }

  void read() {
    if (document_.root.is_map() && document_.root.style == YamlNode::Style::block) {
      read_block(document_.root);
      std::vector<std::string>& tail = document_.root.tail;
      if (!tail.empty() && tail.back().empty()) tail.pop_back();  // the end of the file
    }
    for (const auto& [begin, is_taken] : comments_) {
      if (!is_taken && !keep_entry_at(document_.root, begin)) document_.is_kept = true;
    }
  }

 private:
  void find_comments(const std::vector<std::pair<std::size_t, std::size_t>>& texts) {
    const std::string& text = document_.text;
    std::size_t at = 0;
    const auto scan = [&](std::size_t end) {
      while (at < end) {
        const bool is_first =
            at == 0 || is_space(text[at - 1]) ||
            std::string_view("[]{},:").find(text[at - 1]) != std::string_view::npos;
        if (text[at] != '#' || !is_first) {
          ++at;
          continue;
        }
        comments_.emplace(at, false);
        at = std::min(text.find('\n', at), text.size());
      }
    };
    for (const auto& [begin, end] : texts) {
      scan(begin);
      at = std::max(at, end);
    }
    scan(text.size());
  }

  // The comment that begins at that place or behind blanks; it is taken.
  std::string take(std::size_t at) {
    const std::size_t begin = document_.text.find_first_not_of(" \t", at);
    const auto comment = comments_.find(begin);
    if (comment == comments_.end()) return "";
    comment->second = true;
    return trimmed(places_.line(places_.line_of(begin)).substr(begin - line_begin(begin)));
  }
  std::size_t line_begin(std::size_t byte) const {
    return places_.line_begin(places_.line_of(byte));
  }
  bool is_comment_line(std::size_t line) const {
    return comments_.contains(places_.line_begin(line) + indent_of(places_.line(line)));
  }
  bool is_blank(std::size_t line) const {
    return indent_of(places_.line(line)) == places_.line(line).size();
  }

  void read_block(YamlNode& map) {
    const std::size_t indent = map.entries.empty() ? 0 : column_of(map.entries.front().key);
    for (YamlEntry& entry : map.entries) {
      entry.before = take_lines(indent);
      YamlNode& value = entry.value;
      const bool is_below =
          value.style == YamlNode::Style::block && value.alias.empty() && !value.is_scalar();
      const bool is_nothing = value.is_scalar() && value.begin == value.end;
      const std::size_t last = is_below || is_nothing ? behind_colon(entry.key)
                               : value.is_lines()     ? behind_mark(value)
                                                      : value.end;
      entry.comment = take(last);
      at_ = places_.line_of(std::max(last, entry.key.end)) + 1;
      if (is_below && value.is_map()) {
        read_block(value);
      } else if (!is_nothing) {
        at_ = std::max(at_, places_.line_of(value.end == 0 ? 0 : value.end - 1) + 1);
      }
    }
    map.tail = take_lines(indent);
  }
  static std::size_t column_of(const YamlNode& node) {
    return static_cast<std::size_t>(node.place.column) - 1;
  }
  std::size_t behind_colon(const YamlNode& key) const {
    return std::min(document_.text.find(':', key.end), document_.text.size() - 1) + 1;
  }
  // Behind the `|` or `>` and what belongs to it.
  std::size_t behind_mark(const YamlNode& value) const {
    const std::size_t mark = document_.text.find_first_of("|>", value.begin);
    return std::min(document_.text.find_first_not_of("|>+-0123456789", mark),
                    document_.text.size());
  }

  // Comments and blank lines; those in front of what is farther out belong there.
  std::vector<std::string> take_lines(std::size_t indent) {
    std::vector<std::string> taken;
    for (; at_ < places_.line_count(); ++at_) {
      if (is_blank(at_)) {
        if (taken.empty() || !taken.back().empty()) taken.emplace_back();
      } else if (is_comment_line(at_) && indent_of_what_follows() >= indent) {
        taken.push_back(take(places_.line_begin(at_)));
      } else {
        break;
      }
    }
    return taken;
  }
  // Indentation of the next line that is no comment, or of the comment if that is farther in.
  std::size_t indent_of_what_follows() const {
    const std::size_t own = indent_of(places_.line(at_));
    for (std::size_t line = at_; line < places_.line_count(); ++line) {
      if (is_blank(line) || is_comment_line(line)) continue;
      return std::max(own, indent_of(places_.line(line)));
    }
    return own;
  }

  // The innermost entry of a block around that place is kept as it stands; false: there is none.
  static bool keep_entry_at(YamlNode& map, std::size_t at) {
    if (map.style != YamlNode::Style::block || !map.is_map() || !map.alias.empty()) return false;
    for (YamlEntry& entry : map.entries) {
      if (at < entry.key.begin || at >= std::max(entry.key.end, entry.value.end)) continue;
      if (!keep_entry_at(entry.value, at)) entry.is_kept = true;
      return true;
    }
    return false;
  }

  YamlDocument& document_;
  const PlaceTable& places_;
  std::map<std::size_t, bool> comments_;  // by where they begin: whether some entry has it
  std::size_t at_ = 0;                    // the next line
};

}  // namespace

YamlDocument read_yaml(std::string_view text, std::string file, std::string_view what) {
  YamlDocument document;
  document.file = std::move(file);
  if (text.size() > max_yaml_bytes) {
    throw ParseError(std::string(what) + " has at most 4 MiB", {document.file, 0, 0});
  }
  document.text = without_byte_order_mark(text);
  YamlBuilder builder(document, what);
  builder.build();
  CommentReader(document, builder.places(), builder.texts()).read();
  return document;
}

}  // namespace maide
