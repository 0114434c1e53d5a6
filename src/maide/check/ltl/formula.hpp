// Linear-time temporal logic over the steps of a system (Pnueli, FOCS 1977): syntax tree, parser,
// and a direct semantics on ultimately periodic runs. Every counterexample of an engine is held
// against that semantics before it is shown. Formulas are immutable and share their parts.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "maide/check/language/code.hpp"
#include "maide/check/language/program.hpp"
#include "maide/check/language/system_names.hpp"
#include "maide/check/text/scalar_text.hpp"

namespace maide {

struct Atom {
  enum class Kind : std::uint8_t {
    label,       // program@label: control is there, before the labelled statement's first step
    end,         // program@end: the program has ended
    input,       // model.input: the step that reached this state gave it
    output,      // model!output: the step that reached this state took it
    expression,  // over variables: number `owner` of the system's `expressions`
  };
  static constexpr std::uint32_t any_program = ~std::uint32_t{0};
  Kind kind = Kind::label;
  std::uint32_t owner = 0;              // the program, or the model instance
  std::uint32_t symbol = 0;             // the label, input or output; else 0
  std::uint32_t program = any_program;  // of an event: whose step it is
  bool is_event() const { return kind == Kind::input || kind == Kind::output; }
  auto operator<=>(const Atom&) const = default;
};

struct FormulaNode;
using Formula = std::shared_ptr<const FormulaNode>;

struct FormulaNode {
  enum class Operator : std::uint8_t {
    truth,
    falsity,
    atom,
    negation,
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
  Operator op = Operator::truth;
  Atom atom;            // of Operator::atom
  Formula left, right;  // one operand: left
};

Formula make_formula(FormulaNode::Operator op, Formula left = nullptr, Formula right = nullptr);
Formula make_formula(const Atom& atom);

// What the names in a formula may mean. Without the last four there are no variables.
struct FormulaScope {
  std::span<const Program> programs;
  std::span<const ProgramInterface> models;
  std::span<const Expression> expressions = {};  // of the system
  const WordTable* words = nullptr;              // of these
  const Names* names = nullptr;                  // variables and constants of the file
  // The models' inputs and outputs are known. Before, no use of them is checked.
  bool knows_models = true;
  // Atoms that never hold, for what they watch for arrives at once, are noted here: "map!arrives".
  std::vector<std::string>* at_once = nullptr;
};

// Parses: atoms `program@label`, `program@end`, `model.input`, `model!output`,
// `program:model.input` (that program gives it), `true`, `false`, comparisons of expressions over
// variables
// (`camera.left + 1 < n`) and `bool` variables; unary `! X F G` (also `<>` and `[]`); then, each
// binding weaker than the one before, `U R W` (to the right), `&&` (`&`), `||` (`|`), `->` (to the
// right), `<->`. Names that are no identifiers are in double quotes. Throws ParseError with the
// place: syntax, unknown names, too large. `expressions`: those of atoms are added there.
Formula parse_formula(const ScalarText& text, const FormulaScope& scope,
                      std::vector<Expression>* expressions = nullptr);

// "forall i in 0..4, j in 0..1: ..." is a formula for each value; any other text is one formula.
struct FormulaInstance {
  std::string suffix;  // "[2,0]", or empty
  Formula formula;
};
std::vector<FormulaInstance> resolve_formulas(const syntax::Formula& formula,
                                              const FormulaScope& scope,
                                              std::vector<Expression>* expressions);

// As the parser reads it.
std::string to_string(const Formula& formula, const FormulaScope& scope);

// An equivalent formula of literals, `&& || X U R` and constants: negation stands before atoms
// only. Linear, but for `<->`, which doubles.
Formula negation_normal_form(const Formula& formula);

bool contains(const Formula& formula, FormulaNode::Operator op);
// No temporal operator.
bool is_boolean(const Formula& formula);
// Nodes of the negation normal form, or an upper bound: it doubles what stands around <-> and W.
double expanded_size(const Formula& formula);
// In negation normal form it has no U and no F: every violation shows on a finite prefix.
bool is_syntactically_safe(const Formula& formula);
// Each atom once, in order.
std::vector<Atom> atoms_of(const Formula& formula);

// Whether the formula holds at the start of the run with positions 0, 1, ..., length-1, and from
// then on loop, ..., length-1 again and again (loop < length). `value` says which atoms are true
// where. A run that was cut holds weakly (Eisner et al., "Reasoning with temporal logic on
// truncated paths", CAV 2003): from position `cut` on every atom and every negated atom is taken to
// hold, so that only a bad prefix makes the formula false; `false` stays false. O(formula x
// length).
inline constexpr std::size_t never_cut = ~std::size_t{0};
bool holds_on_lasso(const Formula& formula, std::size_t length, std::size_t loop,
                    const std::function<bool(const Atom&, std::size_t position)>& value,
                    std::size_t cut = never_cut);
// Whether the formula holds at each position of such a run.
std::vector<bool> evaluate_on_lasso(
    const Formula& formula, std::size_t length, std::size_t loop,
    const std::function<bool(const Atom&, std::size_t position)>& value,
    std::size_t cut = never_cut);

}  // namespace maide
