#include "maide/extract/lexer.hpp"

#include <cctype>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace maide::extract {
namespace {

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// `500ms` as a call, `std::chrono::milliseconds(500)`: cppcheck 2.10 ends where it adds up such
// numbers. Empty: it is another number.
std::string time_of(std::string_view number) {
  static const std::vector<std::pair<std::string_view, std::string>> units{
      {"ms", "milliseconds"}, {"us", "microseconds"}, {"ns", "nanoseconds"},
      {"min", "minutes"},     {"h", "hours"},         {"s", "seconds"}};
  if (number.starts_with("0x") || number.starts_with("0X")) return {};
  for (const auto& [suffix, unit] : units) {
    if (!number.ends_with(suffix)) continue;
    number.remove_suffix(suffix.size());
    return "std::chrono::" + unit + "(" + std::string(number) + ")";
  }
  return {};
}

struct Piece {
  enum class Kind { word, number, sign, text, directive } kind = Kind::sign;
  std::size_t begin = 0, end = 0;
  int line = 0;
};

// Words, numbers, signs, strings and directives; comments and blanks are left out.
class Pieces {
 public:
  explicit Pieces(std::string_view text) : text_(text) {}

  std::vector<Piece> read() {
    std::vector<Piece> pieces;
    while (at_ < text_.size()) {
      if (text_[at_] == '\n') is_line_start_ = true;
      if (std::isspace(static_cast<unsigned char>(text_[at_])) != 0) {
        step();
        continue;
      }
      if (skip_comment()) continue;
      Piece piece;
      piece.begin = at_;
      piece.line = line_;
      piece.kind = take();
      piece.end = at_;
      is_line_start_ = false;
      pieces.push_back(piece);
    }
    return pieces;
  }

 private:
  char peek(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }
  void step() {
    if (text_[at_] == '\n') ++line_;
    ++at_;
  }

  bool skip_comment() {
    if (peek() != '/' || (peek(1) != '/' && peek(1) != '*')) return false;
    const bool is_line = peek(1) == '/';
    at_ += 2;
    while (at_ < text_.size()) {
      if (is_line && peek() == '\n' && text_[at_ - 1] != '\\') break;
      if (!is_line && peek() == '*' && peek(1) == '/') {
        at_ += 2;
        break;
      }
      step();
    }
    return true;
  }

  Piece::Kind take() {
    if (peek() == '#' && is_line_start_) {
      while (at_ < text_.size() && (peek() != '\n' || text_[at_ - 1] == '\\')) {
        if (!skip_comment()) step();
      }
      return Piece::Kind::directive;
    }
    if (is_letter(peek())) {
      const std::size_t begin = at_;
      while (is_letter(peek()) || is_digit(peek())) ++at_;
      const std::string_view word = text_.substr(begin, at_ - begin);
      if (peek() == '"' && word.ends_with("R")) return take_raw();
      return Piece::Kind::word;
    }
    if (is_digit(peek()) || (peek() == '.' && is_digit(peek(1)))) {
      while (is_letter(peek()) || is_digit(peek()) || peek() == '.' ||
             (peek() == '\'' && is_digit(peek(1)))) {
        ++at_;
      }
      return Piece::Kind::number;
    }
    if (peek() == '"' || peek() == '\'') return take_string(peek());
    step();
    return Piece::Kind::sign;
  }

  Piece::Kind take_string(char quote) {
    step();
    while (at_ < text_.size() && peek() != quote && peek() != '\n') {
      if (peek() == '\\') step();
      if (at_ < text_.size()) step();
    }
    if (peek() == quote) step();
    return Piece::Kind::text;
  }

  Piece::Kind take_raw() {
    const std::size_t open = text_.find('(', at_);
    if (open == std::string_view::npos) return take_string('"');
    const std::string end = ")" + std::string(text_.substr(at_ + 1, open - at_ - 1)) + "\"";
    const std::size_t close = text_.find(end, open);
    const std::size_t stop = close == std::string_view::npos ? text_.size() : close + end.size();
    while (at_ < stop) step();
    return Piece::Kind::text;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
  bool is_line_start_ = true;
};

// PRId64 and the like: they stand between strings.
bool is_format_word(std::string_view word) {
  return word.size() > 4 && word.starts_with("PRI") &&
         std::string_view("diouxX").find(word[3]) != std::string_view::npos;
}

}  // namespace

LexedFile lex_cpp(std::string_view text, const std::string& file) {
  static const std::set<std::string_view> words{
      "if",        "while",    "for",     "switch",   "catch",         "return",
      "sizeof",    "decltype", "alignof", "noexcept", "static_assert", "alignas",
      "constexpr", "operator", "throw",   "typeid",   "new",           "delete"};
  LexedFile lexed;
  const std::vector<Piece> pieces = Pieces(text).read();
  const auto word_of = [&](std::size_t i) {
    return text.substr(pieces[i].begin, pieces[i].end - pieces[i].begin);
  };
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (pieces[i].kind == Piece::Kind::directive) {
      const std::string directive(word_of(i));
      lexed.directives.emplace_back(pieces[i].line, directive);
      std::size_t at = directive.find("define");
      if (at < 6) {  // else it is no definition
        at += 6;
        while (at < directive.size() && directive[at] == ' ') ++at;
        std::size_t end = at;
        while (end < directive.size() && (is_letter(directive[end]) || is_digit(directive[end])))
          ++end;
        lexed.macros.push_back(directive.substr(at, end - at));
      }
    }
    if (pieces[i].kind != Piece::Kind::directive) {
      lexed.code_lines.insert(pieces[i].line);
    }
    if (i > 1 && word_of(i - 1) == "namespace" && word_of(i - 2) == "using") {
      std::string name;
      for (std::size_t k = i; k < pieces.size() && word_of(k) != ";"; ++k) name += word_of(k);
      lexed.namespaces.push_back(name);
    }
    if (pieces[i].kind != Piece::Kind::word || words.contains(word_of(i))) continue;
    if (i + 1 < pieces.size() && i > 0 && word_of(i - 1) == "using" && word_of(i + 1) == "=") {
      lexed.aliases.emplace_back(word_of(i));
    }
    std::size_t next = i + 1;
    int depth = 0;
    for (; next < pieces.size() && next < i + 64; ++next) {  // template arguments
      if (word_of(next) == "<") ++depth;
      if (depth == 0) break;
      if (word_of(next) == ">") --depth;
      if (word_of(next) == ";" || word_of(next) == "{") break;
    }
    if (next < pieces.size() && word_of(next) == "(") {
      lexed.calls.emplace_back(file, pieces[i].line, std::string(word_of(i)));
    }
  }
  return lexed;
}

std::string prepare_cpp(std::string_view text, std::vector<std::string>& components) {
  std::string prepared(text);
  std::vector<std::pair<Piece, std::string>> times;
  const std::vector<Piece> pieces = Pieces(text).read();
  const auto word_of = [&](std::size_t i) {
    return text.substr(pieces[i].begin, pieces[i].end - pieces[i].begin);
  };
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (pieces[i].kind == Piece::Kind::number) {
      if (std::string time = time_of(word_of(i)); !time.empty()) {
        times.emplace_back(pieces[i], std::move(time));
      }
    }
    if (pieces[i].kind == Piece::Kind::word && is_format_word(word_of(i))) {
      for (std::size_t k = pieces[i].begin; k < pieces[i].end; ++k) prepared[k] = ' ';
    }
    if (pieces[i].kind != Piece::Kind::word || word_of(i) != "RCLCPP_COMPONENTS_REGISTER_NODE") {
      continue;
    }
    std::string name;
    std::size_t k = i + 1;
    while (k < pieces.size() && word_of(k) != ")") {
      if (word_of(k) != "(") name += word_of(k);
      ++k;
    }
    if (name.starts_with("::")) name = name.substr(2);
    components.push_back(name);
    const std::size_t end = k < pieces.size() ? pieces[k].end : text.size();
    for (std::size_t at = pieces[i].begin; at < end; ++at) {
      if (prepared[at] != '\n') prepared[at] = ' ';
    }
  }
  for (; !times.empty(); times.pop_back()) {  // the last first: the others stay where they are
    const auto& [piece, time] = times.back();
    prepared.replace(piece.begin, piece.end - piece.begin, time);
  }
  return prepared;
}

}  // namespace maide::extract
