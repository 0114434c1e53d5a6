// A tokenizer and a recursive-descent parser after the grammar in Graphviz's documentation ("The
// DOT Language"). Subgraphs are the only recursion, and their depth is limited.
#include "maide/formats/dot_syntax.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <unordered_map>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/base/text_cursor.hpp"
#include "maide/formats/names.hpp"

namespace maide {
namespace {

// More than any model has; a few bytes of nested groups could otherwise ask for billions.
constexpr std::size_t max_edges = std::size_t{1} << 23;
constexpr int max_depth = 200;

struct Token {
  enum class Kind { end, identifier, punctuation, arrow, undirected };
  Kind kind = Kind::end;
  std::string text;     // identifier, or the punctuation mark
  bool quoted = false;  // a quoted identifier is never a keyword
  TextPlace place;
  bool is(char mark) const { return kind == Kind::punctuation && text[0] == mark; }
};

class Tokenizer {
 public:
  Tokenizer(std::string_view text, const std::string& file)
      : cursor_(without_byte_order_mark(text), file, TextCursor::Columns::bytes) {}

  [[noreturn]] void fail(const std::string& what, TextPlace place) const {
    cursor_.fail(what, place);
  }

  Token next() {
    Token token = read();
    last_line_ = cursor_.place().line;
    return token;
  }

 private:
  Token read() {
    skip_blanks();
    Token token;
    token.place = cursor_.place();
    if (cursor_.at_end()) return token;
    const char letter = cursor_.peek();
    if (letter == '"') {
      read_quoted(token);
    } else if (begins_name(letter)) {
      token.kind = Token::Kind::identifier;
      token.text = cursor_.take_while([](char c) { return begins_name(c) || is_digit(c); });
    } else if (cursor_.accept("->")) {
      token.kind = Token::Kind::arrow;
    } else if (cursor_.accept("--")) {
      token.kind = Token::Kind::undirected;
    } else if (letter == '-' || letter == '.' || is_digit(letter)) {
      read_number(token);
    } else if (letter == '<') {
      read_html(token);
    } else if (std::string_view("{}[]=;,:+").find(letter) != std::string_view::npos) {
      token.kind = Token::Kind::punctuation;
      token.text = cursor_.take();
    } else {
      fail("unexpected character " + shown(cursor_.rest().substr(0, 1)), token.place);
    }
    return token;
  }

  static bool begins_name(char letter) {
    return is_letter(letter) || letter == '_' || static_cast<unsigned char>(letter) >= 0x80;
  }

  void skip_blanks() {
    while (true) {
      cursor_.skip_blanks();
      const TextPlace begin = cursor_.place();
      // A preprocessor's line; others begin comments so, some behind blanks.
      const bool is_directive = cursor_.peek() == '#' && begin.line != last_line_;
      if (is_directive || cursor_.accept("//")) {
        cursor_.take_line();
      } else if (cursor_.accept("/*")) {
        while (!cursor_.accept("*/")) {
          if (cursor_.at_end()) fail("unfinished comment", begin);
          cursor_.take();
        }
      } else {
        return;
      }
    }
  }

  // Keeps every backslash sequence but \" and a backslash before the end of a line.
  void read_quoted(Token& token) {
    token.kind = Token::Kind::identifier;
    token.quoted = true;
    cursor_.take();
    while (!cursor_.accept("\"")) {
      if (cursor_.at_end()) fail("unfinished quoted name", token.place);
      if (cursor_.accept("\\\"")) {
        token.text += '"';
      } else if (cursor_.accept("\\\\")) {
        token.text += "\\\\";
      } else if (!cursor_.accept("\\\n") && !cursor_.accept("\\\r\n")) {
        token.text += cursor_.take();
      }
    }
  }

  // The text of an HTML label: words without tags. What stands in different cells or lines is
  // apart, as in the tables in which some tools put "input / output".
  void read_html(Token& token) {
    token.kind = Token::Kind::identifier;
    token.quoted = true;
    cursor_.take();
    std::string text, tag;
    for (int depth = 1; depth > 0;) {
      if (cursor_.at_end()) fail("unfinished HTML label", token.place);
      const char letter = cursor_.take();
      if (letter == '<') {
        ++depth;
        tag.clear();
      } else if (letter == '>') {
        if (--depth == 1 && !is_font(tag)) text += ' ';
      } else if (depth > 1) {
        tag += letter;
      } else if (letter == '&') {
        text += read_entity();
      } else {
        text += is_space(letter) ? ' ' : letter;
      }
    }
    for (const std::string_view word : split(text, ' ')) {
      if (word.empty()) continue;
      if (!token.text.empty()) token.text += ' ';
      for (const char letter : word) token.text += letter == '\\' ? "\\\\" : std::string(1, letter);
    }
  }

  // Whether the tag changes how letters look, and nothing else.
  static bool is_font(std::string_view tag) {
    if (tag.starts_with('/')) tag.remove_prefix(1);
    std::string name;
    for (const char letter : tag) {
      if (!is_letter(letter)) break;
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    }
    static constexpr std::array fonts = {"b", "i", "u", "o", "s", "sub", "sup", "font"};
    return std::ranges::find(fonts, name) != fonts.end();
  }

  // What "&amp;" stands for; the cursor is behind "&". What is no entity that is known stays.
  std::string read_entity() {
    const std::string_view rest = cursor_.rest();
    const std::size_t end = rest.substr(0, 10).find(';');
    if (end == std::string_view::npos) return "&";
    const std::string_view name = rest.substr(0, end);
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 6> known{
        {{"lt", "<"}, {"gt", ">"}, {"amp", "&"}, {"quot", "\""}, {"apos", "'"}, {"nbsp", " "}}};
    const auto entity = std::ranges::find(known, name, [](const auto& one) { return one.first; });
    std::string text;
    if (entity != known.end()) {
      text = entity->second;
    } else if (name.starts_with('#')) {
      const bool is_hex = name.size() > 1 && (name[1] == 'x' || name[1] == 'X');
      const std::string_view digits = name.substr(is_hex ? 2 : 1);
      unsigned value = 0;
      const auto [stop, error] =
          std::from_chars(digits.data(), digits.data() + digits.size(), value, is_hex ? 16 : 10);
      const bool is_whole = error == std::errc{} && stop == digits.data() + digits.size();
      if (is_whole && value >= 0x20) text = to_utf8(std::u32string(1, value));
    }
    if (text.empty()) return "&";
    cursor_.take(end + 1);
    return text;
  }

  void read_number(Token& token) {
    token.kind = Token::Kind::identifier;
    if (cursor_.accept("-")) token.text = "-";
    const std::string_view whole = cursor_.take_while(is_digit);
    token.text += whole;
    if (cursor_.accept(".")) token.text += '.';
    const std::string_view fraction = cursor_.take_while(is_digit);
    token.text += fraction;
    if (whole.empty() && fraction.empty()) {
      fail("unexpected character " + shown(token.text), token.place);
    }
  }

  TextCursor cursor_;
  int last_line_ = 0;  // of the last token's end
};

class Parser {
 public:
  Parser(std::string_view text, const std::string& file) : tokens_(text, file) { advance(); }

  DotGraph parse() {
    if (keyword("strict")) advance();
    if (keyword("graph")) fail("an undirected graph is not a model: 'digraph' expected");
    if (!keyword("digraph")) fail("'digraph' expected");
    advance();
    if (current_.kind == Token::Kind::identifier) graph_.name = identifier("name");
    expect('{');
    Scope scope;
    statements(scope);
    expect('}');
    if (current_.kind != Token::Kind::end) fail("text after the end of the graph");
    return std::move(graph_);
  }

 private:
  struct Scope {
    DotAttributes node_defaults = no_dot_attributes;
    DotAttributes edge_defaults = no_dot_attributes;
    std::vector<std::uint32_t> members;  // in order of mention
    int depth = 0;
  };

  void statements(Scope& scope) {
    while (!current_.is('}')) {
      if (current_.kind == Token::Kind::end) fail("'}' expected before the end of the file");
      statement(scope);
      if (current_.is(';') || current_.is(',')) advance();
    }
  }

  void statement(Scope& scope) {
    if (current_.is(';')) return;
    if (keyword("graph") || keyword("node") || keyword("edge")) {
      const char kind =
          static_cast<char>(std::tolower(static_cast<unsigned char>(current_.text.front())));
      advance();
      if (!current_.is('[')) fail("'[' expected");
      if (kind == 'n') scope.node_defaults = attributes(scope.node_defaults);
      if (kind == 'e') scope.edge_defaults = attributes(scope.edge_defaults);
      if (kind == 'g') {
        DotAttributes list = scope.depth == 0 ? graph_.attributes : no_dot_attributes;
        list = attributes(list);
        if (scope.depth == 0) graph_.attributes = list;
      }
      return;
    }
    if (current_.kind == Token::Kind::identifier && !keyword("subgraph")) {
      const TextPlace place = current_.place;
      std::string name = identifier("name");
      if (current_.is('=')) {
        advance();
        const TextPlace value_place = current_.place;
        std::string value = identifier("value");
        if (scope.depth == 0) {
          graph_.attributes =
              add_attribute(graph_.attributes, std::move(name), std::move(value), value_place);
        }
        return;
      }
      skip_port();
      node_or_edges(scope, {node(scope, std::move(name), place)}, true);
      return;
    }
    node_or_edges(scope, subgraph(scope), false);
  }

  // What follows the first operand of a statement: arrows and operands, then attributes.
  void node_or_edges(Scope& scope, std::vector<std::uint32_t> left, bool is_node) {
    if (current_.kind == Token::Kind::undirected) fail("'--' in a directed graph: '->' expected");
    if (current_.kind != Token::Kind::arrow) {
      if (is_node && current_.is('[')) {
        auto& list = graph_.nodes[left.front()].attributes;
        list = attributes(list);
      }
      return;
    }
    const std::size_t first_edge = graph_.edges.size();
    while (current_.kind == Token::Kind::arrow) {
      const TextPlace place = current_.place;
      advance();
      std::vector<std::uint32_t> right = operand(scope);
      if (left.size() * right.size() > max_edges - graph_.edges.size()) fail("too many edges");
      for (const std::uint32_t from : left) {
        for (const std::uint32_t to : right) {
          graph_.edges.push_back({from, to, scope.edge_defaults, place});
        }
      }
      left = std::move(right);
    }
    if (current_.kind == Token::Kind::undirected) fail("'--' in a directed graph: '->' expected");
    const DotAttributes list = attributes(scope.edge_defaults);
    for (std::size_t edge = first_edge; edge < graph_.edges.size(); ++edge) {
      graph_.edges[edge].attributes = list;
    }
  }

  std::vector<std::uint32_t> operand(Scope& scope) {
    if (current_.is('{') || keyword("subgraph")) return subgraph(scope);
    const TextPlace place = current_.place;
    const std::uint32_t found = node(scope, identifier("a node"), place);
    skip_port();
    return {found};
  }

  std::vector<std::uint32_t> subgraph(Scope& outer) {
    std::string name;
    if (keyword("subgraph")) {
      advance();
      if (current_.kind == Token::Kind::identifier) name = identifier("name");
      if (!current_.is('{')) {
        const auto known = subgraphs_.find(name);
        return known == subgraphs_.end() ? std::vector<std::uint32_t>{} : known->second;
      }
    }
    expect('{');
    Scope scope{outer.node_defaults, outer.edge_defaults, {}, outer.depth + 1};
    if (scope.depth > max_depth) fail("subgraphs are nested too deeply");
    statements(scope);
    expect('}');
    std::ranges::sort(scope.members);
    scope.members.erase(std::unique(scope.members.begin(), scope.members.end()),
                        scope.members.end());
    outer.members.insert(outer.members.end(), scope.members.begin(), scope.members.end());
    if (!name.empty()) subgraphs_[name] = scope.members;
    return scope.members;
  }

  std::uint32_t node(Scope& scope, std::string name, TextPlace place) {
    const auto [entry, is_new] =
        numbers_.try_emplace(name, static_cast<std::uint32_t>(graph_.nodes.size()));
    if (is_new) graph_.nodes.push_back({std::move(name), place, scope.node_defaults});
    if (scope.depth > 0) scope.members.push_back(entry->second);
    return entry->second;
  }

  // Any number of [key=value, ...], put before `list`.
  DotAttributes attributes(DotAttributes list) {
    while (current_.is('[')) {
      advance();
      while (!current_.is(']')) {
        std::string key = identifier("an attribute or ']'");
        TextPlace place = current_.place;
        std::string value = "true";
        if (current_.is('=')) {
          advance();
          place = current_.place;
          value = identifier("value");
        }
        list = add_attribute(list, std::move(key), std::move(value), place);
        if (current_.is(',') || current_.is(';')) advance();
      }
      advance();
    }
    return list;
  }

  DotAttributes add_attribute(DotAttributes older, std::string key, std::string value,
                              TextPlace place) {
    graph_.arena.push_back({std::move(key), std::move(value), older, place});
    return static_cast<DotAttributes>(graph_.arena.size() - 1);
  }

  void skip_port() {
    for (int part = 0; part < 2 && current_.is(':'); ++part) {
      advance();
      identifier("a port");
    }
  }

  bool keyword(std::string_view word) const {
    return current_.kind == Token::Kind::identifier && !current_.quoted &&
           std::equal(current_.text.begin(), current_.text.end(), word.begin(), word.end(),
                      [](char left, char right) {
                        return std::tolower(static_cast<unsigned char>(left)) == right;
                      });
  }

  std::string identifier(std::string_view what) {
    if (current_.kind != Token::Kind::identifier) fail(std::string(what) + " expected");
    std::string text = std::move(current_.text);
    bool quoted = current_.quoted;
    advance();
    while (quoted && current_.is('+')) {
      advance();
      if (!current_.quoted) fail("a quoted name expected after '+'");
      text += current_.text;
      advance();
    }
    return text;
  }

  void expect(char mark) {
    if (!current_.is(mark)) fail("'" + std::string(1, mark) + "' expected");
    advance();
  }
  void advance() { current_ = tokens_.next(); }
  [[noreturn]] void fail(const std::string& what) const { tokens_.fail(what, current_.place); }

  Tokenizer tokens_;
  Token current_;
  DotGraph graph_;
  std::unordered_map<std::string, std::uint32_t> numbers_;
  std::unordered_map<std::string, std::vector<std::uint32_t>> subgraphs_;
};

}  // namespace

const DotGraph::Attribute* DotGraph::find(DotAttributes list, std::string_view key) const {
  for (; list != no_dot_attributes; list = arena[list].older) {
    if (arena[list].key == key) return &arena[list];
  }
  return nullptr;
}

DotGraph parse_dot(std::string_view text, const std::string& file) {
  return Parser(text, file).parse();
}

std::string unescape_dot_label(std::string_view value) {
  std::string text;
  for (std::size_t place = 0; place < value.size(); ++place) {
    char letter = value[place];
    if (letter == '\\' && place + 1 < value.size()) {
      letter = value[++place];
      if (letter == 'n' || letter == 'l' || letter == 'r') letter = '\n';
    }
    text += letter;
  }
  return text;
}

std::string quote_dot_label(std::string_view text) {
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '\n') {
      quoted += "\\n";
      continue;
    }
    if (letter == '"' || letter == '\\') quoted += '\\';
    quoted += letter;
  }
  return quoted + '"';
}

namespace {

constexpr std::string_view separators = " \t\r\n\f\v:;";

std::string word(const std::string& name) {
  const bool plain = !name.empty() && name.front() != '"' && name.front() != '?' &&
                     name.front() != '!' && name.find_first_of(separators) == std::string::npos;
  return plain ? name : quote_name(name);
}

std::string take_word(std::string_view& text) {
  std::string name;
  if (!text.empty() && text.front() == '"') {
    if (!take_quoted_name(text, name)) throw UsageError("unfinished quote in the list of actors");
  } else {
    const std::string_view plain = text.substr(0, text.find_first_of(separators));
    name = plain;
    text.remove_prefix(plain.size());
    if (name.empty()) {
      throw UsageError("a name is missing in the list of actors before " + shown(text));
    }
  }
  text = trim(text);
  return name;
}

}  // namespace

std::string actors_to_text(std::span<const Actor> actors) {
  std::string text;
  for (const Actor& actor : actors) {
    if (&actor != &actors.front()) text += "; ";
    text += word(actor.name) + ":";
    for (const std::string& input : actor.inputs) text += " ?" + word(input);
    for (const std::string& output : actor.outputs) text += " !" + word(output);
  }
  return text;
}

std::vector<Actor> actors_from_text(std::string_view text) {
  std::vector<Actor> actors;
  text = trim(text);
  while (!text.empty()) {
    Actor actor;
    actor.name = take_word(text);
    if (!text.starts_with(':')) {
      throw UsageError("':' expected after actor " + shown(actor.name));
    }
    text = trim(text.substr(1));
    while (text.starts_with('?') || text.starts_with('!')) {
      auto& list = text.front() == '?' ? actor.inputs : actor.outputs;
      text.remove_prefix(1);
      list.push_back(take_word(text));
    }
    actors.push_back(std::move(actor));
    if (text.empty()) break;
    if (!text.starts_with(';')) {
      throw UsageError("?input, !output or ';' expected in the list of actors before " +
                       shown(text));
    }
    text = trim(text.substr(1));
  }
  return actors;
}

}  // namespace maide
