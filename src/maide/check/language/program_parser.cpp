// Recursive descent over the program language; the grammar stands in program.hpp.
#include <charconv>

#include "maide/check/language/program_syntax.hpp"
#include "maide/check/language/tokens.hpp"

namespace maide::program_syntax {
namespace {

constexpr std::string_view symbols[] = {"->", "{", "}", ";", ".", "@", "*"};
constexpr std::string_view keywords[] = {"loop", "repeat", "if",   "else", "skip",
                                         "stop", "switch", "wait", "quiet"};
constexpr int max_nesting = 200;  // of blocks: the parser recurses

class Parser {
 public:
  Parser(const ScalarText& text, std::span<const ProgramInterface> models)
      : tokens_(text, symbols), models_(models) {}

  Tree parse() {
    while (tokens_.peek().kind != Token::Kind::end) {
      if (tokens_.peek().is("}")) tokens_.fail("this '}' closes nothing", tokens_.peek());
      tree_.statements.push_back(parse_statement());
    }
    if (tree_.statements.empty()) {
      tokens_.fail("a program has no statement; one that does nothing is written `skip;`",
                   tokens_.peek());
    }
    return std::move(tree_);
  }

 private:
  std::unique_ptr<Block> parse_block(std::string_view where) {
    const Token open = tokens_.peek();
    tokens_.expect("{", where);
    if (++nesting_ > max_nesting) tokens_.fail("blocks are nested too deeply", open);
    auto block = std::make_unique<Block>();
    while (!tokens_.accept("}")) {
      if (tokens_.peek().kind == Token::Kind::end) tokens_.fail("this '{' is not closed", open);
      block->push_back(parse_statement());
    }
    --nesting_;
    return block;
  }

  Statement parse_statement() {
    Statement statement;
    while (tokens_.peek().is("@")) statement.labels.push_back(parse_label());
    const Token first = tokens_.peek();
    const SourcePosition place = tokens_.position(first);
    statement.line = place.line;
    statement.column = place.column;
    if (!statement.labels.empty() && (first.kind == Token::Kind::end || first.is("}"))) {
      tokens_.fail("a label stands before a statement; to mark this point write `@" +
                       tree_.labels[statement.labels.back()] + " skip;`",
                   first);
    }
    if (!first.is_name()) tokens_.fail("expected a statement, not " + to_string(first), first);
    parse_body(first, statement);
    return statement;
  }

  void parse_body(const Token& first, Statement& statement) {
    if (tokens_.accept("loop")) {
      statement.kind = Statement::Kind::loop;
      statement.body = parse_block("after 'loop'");
    } else if (tokens_.accept("repeat")) {
      statement.kind = Statement::Kind::repeat;
      statement.count = parse_count();
      statement.body = parse_block("after 'repeat N'");
    } else if (tokens_.accept("if")) {
      statement.kind = Statement::Kind::choice;
      tokens_.expect("*", "after 'if' (the only choice there is is the internal one, `if *`)");
      statement.body = parse_block("after 'if *'");
      statement.otherwise =
          tokens_.accept("else") ? parse_block("after 'else'") : std::make_unique<Block>();
    } else if (tokens_.accept("skip")) {
      tokens_.expect(";", "after 'skip'");
    } else if (tokens_.accept("stop")) {
      statement.kind = Statement::Kind::stop;
      tokens_.expect(";", "after 'stop'");
    } else if (tokens_.accept("wait")) {
      statement.kind = Statement::Kind::wait;
      statement.model = parse_model();
      tokens_.expect("->", "after 'wait " + models_[statement.model].name + "'");
      statement.arms.push_back(parse_awaited(statement.model));
      tokens_.expect(";", "at the end of the statement");
    } else if (tokens_.accept("switch")) {
      parse_input(statement);
      parse_arms(first, statement);
    } else if (first.kind == Token::Kind::identifier && (first.is("else") || first.is("quiet"))) {
      tokens_.fail(first.is("else") ? "this 'else' follows no 'if *' block"
                                    : "'quiet' is an arm of 'switch'",
                   first);
    } else {
      parse_input(statement);
      if (tokens_.accept("->")) statement.arms.push_back(parse_awaited(statement.model));
      tokens_.expect(";", "at the end of the statement");
    }
  }

  std::uint32_t parse_label() {
    tokens_.expect("@", "before a label");
    const Token name = tokens_.next();
    if (!name.is_name()) {
      tokens_.fail("expected a label's name after '@', not " + to_string(name), name);
    }
    if (name.text == "end") {
      tokens_.fail("the label 'end' is taken: it holds when the program has ended", name);
    }
    for (const std::string& known : tree_.labels) {
      if (known == name.text) {
        tokens_.fail("the label '" + name.text + "' stands before two statements", name);
      }
    }
    tree_.labels.push_back(name.text);
    return static_cast<std::uint32_t>(tree_.labels.size() - 1);
  }

  std::uint32_t parse_count() {
    const Token token = tokens_.next();
    std::uint32_t count = 0;
    const char* end = token.text.data() + token.text.size();
    const auto [stop, error] = std::from_chars(token.text.data(), end, count);
    if (error == std::errc::result_out_of_range || count > max_control_states) {
      tokens_.fail("'repeat' goes up to " + std::to_string(max_control_states), token);
    }
    if (token.kind != Token::Kind::number || error != std::errc() || stop != end) {
      tokens_.fail("expected a number after 'repeat', not " + to_string(token), token);
    }
    return count;
  }

  std::uint32_t parse_model() {
    const Token name = tokens_.next();
    if (!name.is_name()) {
      tokens_.fail("expected a model instance, not " + to_string(name), name);
    }
    std::string known;
    for (std::uint32_t index = 0; index < models_.size(); ++index) {
      if (models_[index].name == name.text) return index;
      known += (known.empty() ? "" : ", ") + models_[index].name;
    }
    for (const std::string_view keyword : keywords) {
      if (name.is(keyword)) tokens_.fail("'" + name.text + "' is a keyword here", name);
    }
    tokens_.fail("unknown model '" + name.text + "'; there is: " + (known.empty() ? "none" : known),
                 name);
  }

  Symbol find_symbol(const Alphabet& alphabet, const Token& name, std::uint32_t model,
                     const std::string& what) {
    if (!name.is_name()) {
      tokens_.fail(
          "expected an " + what + " of " + models_[model].name + ", not " + to_string(name), name);
    }
    if (const auto symbol = alphabet.find(name.text)) return *symbol;
    std::string known;
    for (const std::string& other : alphabet.names()) known += (known.empty() ? "" : ", ") + other;
    tokens_.fail("model " + models_[model].name + " has no " + what + " '" + name.text +
                     "'; it has: " + (known.empty() ? "none" : known),
                 name);
  }

  void parse_input(Statement& statement) {
    statement.kind = Statement::Kind::give;
    statement.model = parse_model();
    const std::string& model = models_[statement.model].name;
    tokens_.expect(".", "after model '" + model + "'");
    statement.input =
        find_symbol(*models_[statement.model].inputs, tokens_.next(), statement.model, "input");
  }

  Arm parse_arm_head(std::uint32_t model) {
    const Token name = tokens_.next();
    const SourcePosition place = tokens_.position(name);
    Arm arm;
    arm.line = place.line;
    arm.column = place.column;
    arm.is_quiet = name.is("quiet");
    if (!arm.is_quiet) arm.output = find_symbol(*models_[model].outputs, name, model, "output");
    return arm;
  }

  Arm parse_awaited(std::uint32_t model) {
    const Token name = tokens_.peek();
    Arm arm = parse_arm_head(model);
    if (arm.is_quiet) {
      tokens_.fail("'quiet' is no output: it is an arm of `switch M.input { quiet { } }`", name);
    }
    arm.body = std::make_unique<Block>();
    return arm;
  }

  void parse_arms(const Token& first, Statement& statement) {
    tokens_.expect("{", "after the input of 'switch'");
    while (!tokens_.accept("}")) {
      const Token name = tokens_.peek();
      if (name.kind == Token::Kind::end) tokens_.fail("this 'switch' is not closed", first);
      Arm arm = parse_arm_head(statement.model);
      for (const Arm& other : statement.arms) {
        if (other.is_quiet == arm.is_quiet && other.output == arm.output) {
          tokens_.fail("this 'switch' has two arms for " + to_string(name), name);
        }
      }
      arm.body = parse_block("after " + to_string(name));
      statement.arms.push_back(std::move(arm));
    }
    if (statement.arms.empty()) tokens_.fail("this 'switch' has no arm", first);
  }

  TokenStream tokens_;
  std::span<const ProgramInterface> models_;
  Tree tree_;
  int nesting_ = 0;
};

}  // namespace

Tree parse(const ScalarText& text, std::span<const ProgramInterface> models) {
  return Parser(text, models).parse();
}

}  // namespace maide::program_syntax
