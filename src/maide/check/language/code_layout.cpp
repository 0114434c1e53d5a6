// A text becomes statements, which have words, signs and blocks; statements become lines.
#include "maide/check/language/code_layout.hpp"

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide {
namespace {

// How the token is written.
std::string written(const Token& token) {
  return token.kind == Token::Kind::quoted ? '"' + token.text + '"' : token.text;
}

bool is_among(const std::string& text, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, text) != words.end();
}

// Words behind which an expression or a bracket begins, and no argument of theirs. `before` stands
// before the word: behind a dot or an arrow it is the name of an input or output.
bool is_keyword(const Token& piece, const Token* before = nullptr) {
  if (before != nullptr && (before->is(".") || before->is("->"))) return false;
  return piece.kind == Token::Kind::identifier &&
         is_among(piece.text, {"if", "while", "repeat", "when", "in", "any", "fair", "timeout",
                               "switch", "on", "wait", "idle", "else", "return", "select"});
}

bool is_operand(const Token& token) { return token.is_name() || token.kind == Token::Kind::number; }

// Whether what follows the token begins an operand.
bool begins_operand(const Token* before) {
  if (before == nullptr || is_keyword(*before)) return true;
  return before->kind == Token::Kind::symbol && !is_among(before->text, {")", "]", "}"});
}

// Whether there is a blank between the token and the next one, in a program.
bool is_apart(const Token* before_last, const Token& last, const Token& next) {
  if (next.kind == Token::Kind::symbol &&
      is_among(next.text, {";", ",", ")", "]", ".", "..", "[", ":"})) {
    return false;
  }
  if (last.kind == Token::Kind::symbol && is_among(last.text, {"(", "[", ".", "..", "@"})) {
    return false;
  }
  const bool ends_operand = is_operand(last) || last.is(")") || last.is("]");
  if (last.is("!") || last.is("-")) {
    return last.is("-") && !begins_operand(before_last);  // else a sign of one operand, or M!output
  }
  if (next.is("!")) return !ends_operand || is_keyword(last);
  if (next.is("(")) return !is_operand(last) || is_keyword(last, before_last);
  return true;
}

// ---- Statements ---------------------------------------------------------------------------------

struct Statement;
struct Braces {
  std::string comment;  // behind the `{`
  std::vector<Statement> statements;
  bool is_broken = false;  // over several lines
};
struct Element {
  Token piece;
  std::unique_ptr<Braces> block;  // in place of a piece
};
struct Statement {
  std::vector<Element> elements;      // none: comments alone
  std::vector<std::string> comments;  // on lines of their own before it
  std::string comment;                // at its end
  int breaks = 0;                     // line breaks before it
};

class StatementReader {
 public:
  explicit StatementReader(const ScalarText& text) : tokens_(read_tokens(text)) {}

  std::vector<Statement> parse() {
    std::vector<Statement> statements = parse_statements(nullptr);
    MAIDE_CHECK(peek().kind == Token::Kind::end);  // the parser has read the text
    return statements;
  }

 private:
  const Token& peek() const { return tokens_[at_]; }
  Token next() { return at_ + 1 < tokens_.size() ? tokens_[at_++] : tokens_[at_]; }

  std::vector<Statement> parse_statements(Braces* braces) {
    std::vector<Statement> statements;
    while (peek().kind != Token::Kind::end && !peek().is("}")) {
      if (peek().kind != Token::Kind::comment) {
        statements.push_back(parse_statement());
        continue;
      }
      const Token comment = next();
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
      if (peek().kind == Token::Kind::comment) {  // in the middle
        statement.comments.push_back(next().text);
        continue;
      }
      if (peek().kind == Token::Kind::end || peek().is("}")) return statement;
      const bool is_type = !statement.elements.empty() && statement.elements.back().piece.is(":");
      Token piece = next();
      if (piece.is("{") && !is_type) {
        Element element;
        element.block = parse_braces();
        statement.elements.push_back(std::move(element));
        if (goes_on()) continue;
        if (peek().is("at") && at_ + 1 < tokens_.size() &&
            tokens_[at_ + 1].kind == Token::Kind::quoted) {
          for (int i = 0; i < 2; ++i) statement.elements.push_back({next(), nullptr});
        }
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

  // Behind a block: an `else`, if only after comments; `at "FILE:LINE"`, with which it ends.
  bool goes_on() const {
    std::size_t at = at_;
    while (tokens_[at].kind == Token::Kind::comment) ++at;
    return tokens_[at].is("else");
  }

  // The words of a type, as one piece.
  void append_type(Statement& statement, Token open) {
    while (peek().kind != Token::Kind::end && !peek().is("}")) {
      const Token part = next();
      if (part.kind == Token::Kind::comment) {
        statement.comments.push_back(part.text);
        continue;
      }
      open.text += written(part) + (part.is(",") ? " " : "");
    }
    open.text += next().text;
    open.kind = Token::Kind::identifier;
    statement.elements.push_back({std::move(open), nullptr});
  }

  std::unique_ptr<Braces> parse_braces() {
    auto braces = std::make_unique<Braces>();
    const std::size_t first = at_;
    braces->statements = parse_statements(braces.get());
    for (std::size_t at = first; at <= at_; ++at) {
      const bool is_comment = tokens_[at].kind == Token::Kind::comment;
      braces->is_broken = braces->is_broken || is_comment || tokens_[at].breaks > 0;
    }
    next();
    return braces;
  }

  std::vector<Token> tokens_;
  std::size_t at_ = 0;
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
    const auto piece_at = [&](std::size_t index) -> const Token* {
      return index < statement.elements.size() && !statement.elements[index].block
                 ? &statement.elements[index].piece
                 : nullptr;
    };
    for (; at < statement.elements.size() && !statement.elements[at].block; ++at) {
      const Token& piece = statement.elements[at].piece;
      const Token* last = at > 0 ? piece_at(at - 1) : nullptr;
      const bool apart =
          last == nullptr ? at > 0 : is_apart(at > 1 ? piece_at(at - 2) : nullptr, *last, piece);
      if (apart) line += " ";
      line += written(piece);
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
    return std::ranges::any_of(statement.elements, [](const Element& element) {
      return element.block && element.block->is_broken;
    });
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
    return std::ranges::any_of(statement.elements, [](const Element& element) {
      return element.block && !element.block->statements.empty();
    });
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
  return LineWriter(width).write(StatementReader(program).parse());
}

std::string lay_out_formula(const ScalarText& formula) {
  const auto is_operator = [](const Token& token) {
    return token.kind == Token::Kind::symbol &&
           is_among(token.text,
                    {"&&", "||", "->", "<->", "==", "!=", "<=", ">=", "<", ">", "=", "<>"});
  };
  std::string line;
  const Token* last = nullptr;
  const std::vector<Token> tokens = read_tokens(formula);
  for (const Token& token : tokens) {
    if (token.kind == Token::Kind::comment || token.kind == Token::Kind::end) continue;
    const bool is_behind =
        last != nullptr && !last->is("<>") && (is_operator(*last) || last->is(","));
    const bool is_close = token.is(")") || token.is("]") || token.is(",") || token.is(";") ||
                          (last != nullptr && (last->is("(") || last->is("[")));
    if (last != nullptr && !is_close && (token.has_blank || is_operator(token) || is_behind)) {
      line += " ";
    }
    line += written(token);
    last = &token;
  }
  return line;
}

bool has_same_words(const ScalarText& one, const ScalarText& other) {
  const std::vector<Token> a = read_tokens(one), b = read_tokens(other);
  const auto of_kind = [](const std::vector<Token>& tokens, bool is_comment) {
    std::vector<std::string> words;
    for (const Token& token : tokens) {
      if ((token.kind == Token::Kind::comment) == is_comment) words.push_back(written(token));
    }
    return words;
  };
  return of_kind(a, false) == of_kind(b, false) && of_kind(a, true) == of_kind(b, true);
}

bool has_comments(const ScalarText& text) {
  const std::vector<Token> tokens = read_tokens(text);
  return std::ranges::any_of(tokens,
                             [](const Token& token) { return token.kind == Token::Kind::comment; });
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
