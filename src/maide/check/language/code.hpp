// Programs, formulas and names of a system file as trees, before anybody asks what a name means.
// A text becomes a tree once (code_parser.hpp, formula_text.hpp). Whoever gives names their meaning
// walks the tree as often as it needs. The trees know no model and no number of anything.
//
//   @sent sync.read -> message;    Statement{give}: labels {sent}, model `sync`, event `read`, one
//                                  arm with output `message`
//   x = a[i] + n;                  Statement{assign}: target `x`, expression `+` of a[i] and n.
//                                  Whether n is a constant or a variable is not asked.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide::syntax {

struct Name {
  std::string text;
  bool is_quoted = false;
  TextPlace place;
  // An identifier without quotes that is this word.
  bool is(std::string_view word) const { return !is_quoted && text == word; }
  // Where it stands for a value it may be a constant. In quotes a name that needs none is a word.
  bool may_be_constant() const { return !is_quoted || !is_identifier(text); }
};

// Signs of expressions and formulas.
enum class Sign : std::uint8_t {
  none,
  negate,    // -x
  negation,  // !x
  times,
  divide,
  remainder,
  plus,
  minus,
  less,
  at_most,
  greater,
  at_least,
  equal,
  unequal,
  conjunction,
  disjunction,
  implication,
  equivalence,
  next,
  finally,
  globally,
  until,
  release,
  weak_until,
};

struct NamePart;

// An expression, a formula, or a name with its indices.
struct Term {
  enum class Kind : std::uint8_t { number, boolean, name, operation };
  Kind kind = Kind::number;
  Sign sign = Sign::none;      // of an operation
  std::int64_t value = 0;      // of a number or a boolean
  Name name;                   // of Kind::name
  bool has_indices = false;    // brackets stand behind the name
  std::vector<Term> operands;  // of an operation; of a name what stands in its brackets
  std::vector<Term> reader;    // of a name: what stands in further brackets, as in image[0][logger]
  // What stands behind the name in a formula: `.input`, `@label`, `!output`, `:model.input`. In an
  // expression `.there`, at most.
  std::vector<NamePart> parts;
  TextPlace place;  // of an operation's sign, of a name, of a number
  TextPlace begin;  // of the first sign or word

  bool is_name() const { return kind == Kind::name; }
};

struct NamePart {
  char sign = '.';  // before it: one of `.@!:`
  Name name;
  bool has_indices = false;
  std::vector<Term> indices, reader;
  bool has_values = false;
  std::vector<Name> values;  // "(3,go)": words and signs in order
};

struct Range {
  Term low, high;
};

// `i in 0..4`
struct Index {
  Name name;
  Range range;
};

// `0..3`, `bool`, `{idle, busy}`
struct Type {
  bool is_boolean = false;
  std::vector<Name> words;
  std::optional<Range> range;
  TextPlace place;
};

// `message(var x)`: the variable is declared here. `write(e)`, `message(x)`: what it is shows when
// names have a meaning.
struct Argument {
  bool is_declared = false;
  Term term;  // of a declaration its name
};

// An input or an output: `write`, `write(e)`.
struct Event {
  Name name;
  bool has_arguments = false;
  std::vector<Argument> arguments;
};

struct Statement;
struct Block {
  std::vector<Statement> statements;
  Block();
  Block(Block&&) noexcept;
  Block& operator=(Block&&) noexcept;
  Block(const Block&);
  Block& operator=(const Block&);
  ~Block();
};

// What comes back from a model, and what is done then.
struct Arm {
  bool is_quiet = false;
  Event output;  // unless quiet
  Block body;
  TextPlace place;
};

struct SelectArm {
  enum class Kind : std::uint8_t { input, output, guard, otherwise, timeout };
  Kind kind = Kind::guard;
  std::optional<Term> guard;
  Term model;             // of an input or output
  Event event;            // of an input or output
  bool has_arms = false;  // of an input: outputs follow at once, and `body` is not used
  std::vector<Arm> arms;
  Term milliseconds;  // of a time-out
  Block body;
  TextPlace place;
};

struct Statement {
  enum class Kind : std::uint8_t {
    give,       // `model.event`, then the arm that is awaited, if any
    give_arms,  // switch
    wait,       // the arm of `model`
    loop,
    repeat,  // `body`, `expression` times
    choice,  // if *: `body` or `otherwise`
    when,    // if (expression)
    skip,
    stop,
    declare,  // var `name`[dimensions]: type = `expression`, where there is one
    assign,   // `target` = `expression`
    choose,   // `target` = any range
    repeat_while,
    repeat_for,  // `name` in range
    leave,       // break
    next_round,  // continue
    give_back,   // return
    call,        // `name`(arguments)
    atomic,      // where `expression` holds, if there is one
    select,
    offer,     // `model`, a service, is there from here on
    withdraw,  // and no more
    run,       // a copy of thread `name` begins
    join,      // until all of its copies are ended
    kill,      // the process that `name` is, or is in
    restart,   // so, and it begins anew
    end,       // the own process
    unknown,   // what comes is not known: the run is cut
    spin,      // runs callbacks of executor `name` (empty: none is named), as `spin` says
  };
  enum class Spin : std::uint8_t {
    ever,
    once,   // one callback
    some,   // what one look finds, `expression` at most
    all,    // until nothing is there, or so many were run
    until,  // the arm of `model`
  };
  Kind kind = Kind::skip;
  TextPlace place;
  std::optional<SourcePosition> origin;  // what it was made from, in another file
  std::vector<Name> labels;
  Spin spin = Spin::ever;
  bool is_idle = false;       // `idle` stands before it
  bool is_fair = false;       // of a choice, of `any`
  bool is_any = false;        // of a declaration: any value at first
  bool is_one_sided = false;  // of a fair choice: the other branch need never come
  Name name;
  Term model;
  Event event;
  std::vector<Arm> arms;
  std::vector<SelectArm> select_arms;
  Term target;
  std::vector<Index> dimensions;
  Type type;
  std::optional<Term> expression;
  Range range;
  std::vector<Term> arguments;
  Block body, otherwise;
};

// A program, a procedure's text, what a callback does, or declarations of variables.
struct Code {
  std::string file;
  Block block;
  TextPlace begin, end;  // of the text
  TextPlace last;        // of its last sign or word
};

// Calls visit(statement) for each statement of the block, those inside of others too, in the order
// of the text.
void for_each_statement(const Block& block, const std::function<void(const Statement&)>& visit);

// "image.read -> message(var k)": what starts a callback.
struct Taken {
  std::string file;
  Term model;
  bool is_output = false;  // `model!event`
  Event event;
  std::optional<Event> output;
  TextPlace name_place;  // of what stands behind the model's sign
};

// "33", "once 5000": when a timer comes.
struct Timer {
  bool comes_once = false;
  Term period;
};

// "name", "name[i in 0..4, j in 1..2]": what the key of a model, topic, program or node declares.
struct Declared {
  Name name;
  std::vector<Index> indices;
};

// "forall i in 0..4: G (philosopher[i]@hungry -> F philosopher[i]@eats)": a formula for each index.
struct Formula {
  std::string file;
  TextPlace begin;  // of the text
  std::vector<Index> indices;
  Term root;
};

// "name(a, b)" of a procedure.
struct Head {
  Name name;
  std::vector<Name> parameters;
};

// "detector", "grant[0, i + 1]", "detector[1].on_image": who or what an entry refers to.
struct Reference {
  std::string file;
  Term name;  // as it is written, up to a bracket: names of old files need not be identifiers
  std::string part;  // behind the bracket: "on_image"
  std::string text;  // all of it
};

}  // namespace maide::syntax
