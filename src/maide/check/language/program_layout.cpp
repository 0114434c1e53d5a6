// The layout of programs and formulas. A text becomes a tree of statements, which have words, signs
// and blocks; a tree becomes lines.
#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/text_cursor.hpp"
#include "maide/check/language/layout.hpp"

namespace maide {
namespace {

// The signs of programs and formulas that are longer than one character, longest first.
constexpr std::string_view long_signs[] = {
    "<->", "->", "==", "!=", "<=", ">=", "&&", "||", "..", "<>", "[]"};
constexpr int max_nesting = 1000;  // of blocks: the layout recurses

struct Piece {
  enum class Kind : std::uint8_t { word, sign, comment, end };
  Kind kind = Kind::end;
  std::string text;
  std::size_t offset = 0;
  int breaks = 0;          // line breaks before it
  bool has_blank = false;  // something blank before it
  bool is(std::string_view what) const { return kind != Kind::comment && text == what; }
};

bool in_word(char c) { return is_letter(c) || is_digit(c) || c == '_'; }

std::vector<Piece> pieces_of(std::string_view text) {
  using Kind = Piece::Kind;
  std::vector<Piece> pieces;
  std::size_t at = 0;
  for (;;) {
    Piece piece;
    for (; at < text.size() && is_space(text[at]); ++at) {
      piece.has_blank = true;
      if (text[at] == '\n') ++piece.breaks;
    }
    piece.offset = at;
    const std::string_view rest = text.substr(at);
    std::size_t length = std::min<std::size_t>(rest.size(), 1);
    if (rest.empty()) {
      pieces.push_back(std::move(piece));
      return pieces;
    }
    if (rest[0] == '#' || rest.starts_with("//")) {
      piece.kind = Kind::comment;
      length = std::min(rest.find('\n'), rest.size());
    } else if (in_word(rest[0])) {
      piece.kind = Kind::word;
      while (length < rest.size() && in_word(rest[length])) ++length;
    } else if (rest[0] == '"') {
      piece.kind = Kind::word;
      const std::size_t end = rest.find_first_of("\"\n", 1);
      length = end == std::string_view::npos ? rest.size() : end + (rest[end] == '"' ? 1 : 0);
    } else {
      piece.kind = Kind::sign;
      for (const std::string_view sign : long_signs) {
        if (!rest.starts_with(sign)) continue;
        length = sign.size();
        break;
      }
    }
    piece.text = rest.substr(0, length);
    if (piece.kind == Kind::comment) {
      piece.text.erase(piece.text.find_last_not_of(" \t\r") + 1);
    }
    pieces.push_back(std::move(piece));
    at += length;
  }
}

bool is_among(const std::string& text, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), text) != words.end();
}

// Words behind which an expression or a bracket begins, and no argument of theirs.
bool is_keyword(const Piece& piece) {
  return piece.kind == Piece::Kind::word &&
         is_among(piece.text, {"if", "while", "repeat", "when", "in", "any", "fair", "timeout",
                               "switch", "on", "wait", "idle", "else", "return", "select"});
}

// Whether what follows the piece begins an operand.
bool begins_operand(const Piece* before) {
  if (before == nullptr || is_keyword(*before)) return true;
  return before->kind == Piece::Kind::sign && !is_among(before->text, {")", "]", "}"});
}

// Whether there is a blank between the piece and the next one, in a program.
bool is_apart(const Piece* before_last, const Piece& last, const Piece& next) {
  if (is_among(next.text, {";", ",", ")", "]", ".", "..", "[", ":"})) return false;
  if (is_among(last.text, {"(", "[", ".", "..", "@"}) && last.kind == Piece::Kind::sign) {
    return false;
  }
  const bool ends_operand = last.kind == Piece::Kind::word || is_among(last.text, {")", "]"});
  if (last.is("!") || last.is("-")) {
    return last.is("-") && !begins_operand(before_last);  // else a sign of one operand, or M!output
  }
  if (next.is("!")) return !ends_operand || is_keyword(last);
  if (next.is("(")) return last.kind != Piece::Kind::word || is_keyword(last);
  return true;
}

// ---- The tree -----------------------------------------------------------------------------------

struct Statement;
struct Braces {
  std::string comment;  // behind the `{`
  std::vector<Statement> statements;
  bool is_broken = false;  // over several lines
};
struct Element {
  Piece piece;
  std::unique_ptr<Braces> block;  // in place of a piece
};
struct Statement {
  std::vector<Element> elements;      // none: comments alone
  std::vector<std::string> comments;  // on lines of their own before it
  std::string comment;                // at its end
  int breaks = 0;                     // line breaks before it
};

class TreeParser {
 public:
  explicit TreeParser(const ScalarText& text) : text_(text), pieces_(pieces_of(text.value())) {}

  std::vector<Statement> parse() {
    std::vector<Statement> statements = parse_statements(nullptr);
    if (peek().is("}")) fail("this '}' closes nothing", peek());
    return statements;
  }

 private:
  const Piece& peek() const { return pieces_[at_]; }
  Piece next() { return at_ + 1 < pieces_.size() ? pieces_[at_++] : pieces_[at_]; }
  [[noreturn]] void fail(const std::string& message, const Piece& piece) const {
    throw ParseError(message, text_.position(piece.offset));
  }

  std::vector<Statement> parse_statements(Braces* braces) {
    std::vector<Statement> statements;
    while (peek().kind != Piece::Kind::end && !peek().is("}")) {
      if (peek().kind != Piece::Kind::comment) {
        statements.push_back(parse_statement());
        continue;
      }
      const Piece comment = next();
      if (comment.breaks == 0 && !statements.empty() && statements.back().comment.empty()) {
        statements.back().comment = comment.text;
      } else if (comment.breaks == 0 && statements.empty() && braces != nullptr &&
                 braces->comment.empty()) {
        braces->comment = comment.text;
      } else {
        Statement alone;
        alone.comments.push_back(comment.text);
        alone.breaks = std::max(comment.breaks, 1);
        statements.push_back(std::move(alone));
      }
    }
    return statements;
  }

  Statement parse_statement() {
    Statement statement;
    statement.breaks = peek().breaks;
    for (;;) {
      if (peek().kind == Piece::Kind::comment) {  // in the middle
        statement.comments.push_back(next().text);
        continue;
      }
      if (peek().kind == Piece::Kind::end || peek().is("}")) return statement;
      const bool is_type = !statement.elements.empty() && statement.elements.back().piece.is(":");
      Piece piece = next();
      if (piece.is("{") && !is_type) {
        Element element;
        element.block = parse_braces(piece);
        statement.elements.push_back(std::move(element));
        if (goes_on()) continue;
        return statement;
      }
      if (piece.is("{")) {
        append_type(statement, std::move(piece));
      } else {
        statement.elements.push_back({std::move(piece), nullptr});
      }
      if (statement.elements.back().piece.is(";")) return statement;
    }
  }

  // Behind a block: an `else`, if only after comments.
  bool goes_on() const {
    std::size_t at = at_;
    while (pieces_[at].kind == Piece::Kind::comment) ++at;
    return pieces_[at].is("else");
  }

  // The words of a type, as one piece.
  void append_type(Statement& statement, Piece open) {
    while (peek().kind != Piece::Kind::end && !peek().is("}")) {
      const Piece part = next();
      if (part.kind == Piece::Kind::comment) {
        statement.comments.push_back(part.text);
        continue;
      }
      open.text += part.text + (part.is(",") ? " " : "");
    }
    if (peek().kind == Piece::Kind::end) fail("this '{' is not closed", open);
    open.text += next().text;
    open.kind = Piece::Kind::word;
    statement.elements.push_back({std::move(open), nullptr});
  }

  std::unique_ptr<Braces> parse_braces(const Piece& open) {
    if (++nesting_ > max_nesting) fail("blocks are nested too deeply", open);
    auto braces = std::make_unique<Braces>();
    const std::size_t first = at_;
    braces->statements = parse_statements(braces.get());
    if (peek().kind == Piece::Kind::end) fail("this '{' is not closed", open);
    for (std::size_t at = first; at <= at_; ++at) {
      const bool is_comment = pieces_[at].kind == Piece::Kind::comment;
      braces->is_broken = braces->is_broken || is_comment || pieces_[at].breaks > 0;
    }
    next();
    --nesting_;
    return braces;
  }

  const ScalarText& text_;
  std::vector<Piece> pieces_;
  std::size_t at_ = 0;
  int nesting_ = 0;
};

// ---- Lines --------------------------------------------------------------------------------------

class LineWriter {
 public:
  explicit LineWriter(std::size_t width) : width_(width) {}

  std::vector<LaidLine> write(const std::vector<Statement>& statements) {
    write_all(statements, 0);
    return std::move(lines_);
  }

 private:
  // The pieces up to the next block or the end, behind `line`; `at` moves there.
  static void append_pieces(const Statement& statement, std::size_t& at, std::string& line) {
    const auto piece_at = [&](std::size_t index) -> const Piece* {
      return index < statement.elements.size() && !statement.elements[index].block
                 ? &statement.elements[index].piece
                 : nullptr;
    };
    for (; at < statement.elements.size() && !statement.elements[at].block; ++at) {
      const Piece& piece = statement.elements[at].piece;
      const Piece* last = at > 0 ? piece_at(at - 1) : nullptr;
      const bool apart =
          last == nullptr ? at > 0 : is_apart(at > 1 ? piece_at(at - 2) : nullptr, *last, piece);
      if (apart) line += " ";
      line += piece.text;
    }
  }

  static std::string one_line(const std::vector<Statement>& statements) {
    std::string line;
    for (const Statement& statement : statements) {
      if (!line.empty()) line += " ";
      line += one_line(statement);
    }
    return line;
  }
  static std::string one_line(const Statement& statement) {
    std::string line;
    for (std::size_t at = 0; at < statement.elements.size();) {
      append_pieces(statement, at, line);
      if (at == statement.elements.size()) break;
      const std::string inside = one_line(statement.elements[at].block->statements);
      line += line.empty() ? "{ " : " { ";
      line += inside.empty() ? "}" : inside + " }";
      ++at;
    }
    return line;
  }

  void write_all(const std::vector<Statement>& statements, std::size_t indent) {
    for (std::size_t first = 0; first < statements.size();) {
      if (first > 0 && statements[first].breaks > 1) lines_.push_back({});
      std::size_t last = first;  // of those that share a line
      while (!is_line_end(statements[last]) && last + 1 < statements.size() &&
             statements[last + 1].breaks == 0 && statements[last + 1].comments.empty() &&
             !has_broken_block(statements[last + 1])) {
        ++last;
      }
      write_group(statements, first, last, indent);
      first = last + 1;
    }
  }
  static bool has_broken_block(const Statement& statement) {
    return std::any_of(
        statement.elements.begin(), statement.elements.end(),
        [](const Element& element) { return element.block && element.block->is_broken; });
  }
  static bool is_line_end(const Statement& statement) {
    return statement.elements.empty() || !statement.comment.empty() || has_broken_block(statement);
  }

  void write_group(const std::vector<Statement>& statements, std::size_t first, std::size_t last,
                   std::size_t indent) {
    const std::string margin(indent, ' ');
    for (const std::string& comment : statements[first].comments) {
      lines_.push_back({margin + comment, ""});
    }
    if (statements[first].elements.empty()) {
      if (!statements[first].comment.empty()) {
        lines_.push_back({margin + statements[first].comment, ""});
      }
      return;
    }
    std::string line = margin;
    bool is_broken = false;
    for (std::size_t at = first; at <= last; ++at) {
      line += (at > first ? " " : "") + one_line(statements[at]);
      is_broken = is_broken || has_broken_block(statements[at]);
    }
    if (!is_broken && (line.size() <= width_ || (first == last && !has_block(statements[first])))) {
      lines_.push_back({line, statements[last].comment});
      return;
    }
    if (first == last) {
      write_broken(statements[first], indent);
      return;
    }
    for (std::size_t at = first; at <= last; ++at) {
      write_group(statements, at, at, indent);
    }
  }
  static bool has_block(const Statement& statement) {
    return std::any_of(
        statement.elements.begin(), statement.elements.end(),
        [](const Element& element) { return element.block && !element.block->statements.empty(); });
  }

  void write_broken(const Statement& statement, std::size_t indent) {
    const std::string margin(indent, ' ');
    std::string line = margin;
    for (std::size_t at = 0; at < statement.elements.size();) {
      append_pieces(statement, at, line);
      if (at == statement.elements.size()) break;
      const Braces& block = *statement.elements[at].block;
      line += line.size() == indent ? "{" : " {";
      ++at;
      if (block.statements.empty() && block.comment.empty()) {
        line += " }";
        continue;
      }
      lines_.push_back({line, block.comment});
      write_all(block.statements, indent + 2);
      line = margin + "}";
    }
    lines_.push_back({line, statement.comment});
  }

  std::size_t width_;
  std::vector<LaidLine> lines_;
};

}  // namespace

std::vector<LaidLine> lay_out_program(const ScalarText& program, std::size_t width) {
  return LineWriter(width).write(TreeParser(program).parse());
}

std::string lay_out_formula(const ScalarText& formula) {
  std::string line;
  bool is_first = true;
  const std::vector<Piece> pieces = pieces_of(formula.value());
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
    const Piece& piece = pieces[i];
    if (piece.kind == Piece::Kind::comment) continue;
    const bool is_operator = is_among(
        piece.text, {"&&", "||", "->", "<->", "==", "!=", "<=", ">=", "<", ">", "=", "<>"});
    const bool is_behind_operator =
        i > 0 && is_among(pieces[i - 1].text,
                          {"&&", "||", "->", "<->", "==", "!=", "<=", ">=", "<", ">", "=", ","});
    const bool is_close = is_among(piece.text, {")", "]", ",", ";"}) ||
                          (i > 0 && is_among(pieces[i - 1].text, {"(", "["}));
    if (!is_first && !is_close && (piece.has_blank || is_operator || is_behind_operator)) {
      line += " ";
    }
    line += piece.text;
    is_first = false;
  }
  return line;
}

ProgramWords words_of(std::string_view text) {
  ProgramWords words;
  for (const Piece& piece : pieces_of(text)) {
    if (piece.kind == Piece::Kind::end) break;
    (piece.kind == Piece::Kind::comment ? words.comments : words.words).push_back(piece.text);
  }
  return words;
}

TextMeaning meaning_of(const std::vector<std::string>& path) {
  if (path.empty()) return TextMeaning::other;
  if (path[0] == "variables" && path.size() == 1) return TextMeaning::program;
  if (path[0] == "procedures" && path.size() == 2) return TextMeaning::program;
  if (path[0] == "programs" && (path.size() == 2 || (path.size() == 3 && path[2] == "do"))) {
    return TextMeaning::program;
  }
  if (path[0] != "properties") return TextMeaning::other;
  const bool is_text = path.size() == 2 || path[2] == "ltl" || path[2] == "always";
  return path.size() < 2 || path.size() > 3 || !is_text ? TextMeaning::other : TextMeaning::formula;
}

std::vector<std::string> align_comments(const std::vector<LaidLine>& lines, std::size_t width) {
  std::vector<std::string> result;
  for (std::size_t first = 0; first < lines.size();) {
    std::size_t last = first, longest = 0, end = 0;
    const auto indent = [&](std::size_t at) { return lines[at].text.find_first_not_of(' '); };
    for (; last < lines.size() && !lines[last].comment.empty() && indent(last) == indent(first);
         ++last) {
      longest = std::max(longest, lines[last].text.size());
      end = std::max(end, lines[last].comment.size());
    }
    const bool fits = longest + 2 + end <= width;
    for (; first < last; ++first) {
      const LaidLine& line = lines[first];
      const std::size_t gap = fits ? longest + 2 - line.text.size() : 2;
      result.push_back(line.text + std::string(gap, ' ') + line.comment);
    }
    if (first < lines.size() && lines[first].comment.empty()) {
      result.push_back(lines[first++].text);
    }
  }
  return result;
}

}  // namespace maide
