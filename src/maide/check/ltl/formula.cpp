#include "maide/check/ltl/formula.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "maide/check/text/tokens.hpp"

namespace maide {

Formula make_formula(FormulaNode::Operator op, Formula left, Formula right) {
  return std::make_shared<FormulaNode>(FormulaNode{op, {}, std::move(left), std::move(right)});
}

Formula make_formula(const Atom& atom) {
  return std::make_shared<FormulaNode>(
      FormulaNode{FormulaNode::Operator::atom, atom, nullptr, nullptr});
}

namespace {

using Operator = FormulaNode::Operator;
using Truth = std::vector<bool>;  // of a formula, for each position of a lasso

Formula make(Operator op, Formula left = nullptr, Formula right = nullptr) {
  return make_formula(op, std::move(left), std::move(right));
}

// The normal form of `formula`, or of its negation.
Formula normalise(const Formula& formula, bool negated) {
  const auto left = [&](bool flip) { return normalise(formula->left, negated != flip); };
  const auto right = [&](bool flip) { return normalise(formula->right, negated != flip); };
  const auto either = [&](Operator plain, Operator dual) { return negated ? dual : plain; };
  switch (formula->op) {
    case Operator::truth:
    case Operator::falsity: {
      const bool value = (formula->op == Operator::truth) != negated;
      return make(value ? Operator::truth : Operator::falsity);
    }
    case Operator::atom: return negated ? make(Operator::negation, formula) : formula;
    case Operator::negation: return left(true);
    case Operator::conjunction:
      return make(either(Operator::conjunction, Operator::disjunction), left(false), right(false));
    case Operator::disjunction:
      return make(either(Operator::disjunction, Operator::conjunction), left(false), right(false));
    case Operator::implication:
      return make(either(Operator::disjunction, Operator::conjunction), left(true), right(false));
    case Operator::equivalence:  // (l && r) || (!l && !r), and (l && !r) || (!l && r)
      return make(Operator::disjunction,
                  make(Operator::conjunction, normalise(formula->left, false),
                       normalise(formula->right, negated)),
                  make(Operator::conjunction, normalise(formula->left, true),
                       normalise(formula->right, !negated)));
    case Operator::next: return make(Operator::next, left(false));
    case Operator::finally:  // true U f; its dual is false R !f
      return negated ? make(Operator::release, make(Operator::falsity), left(false))
                     : make(Operator::until, make(Operator::truth), left(false));
    case Operator::globally:
      return negated ? make(Operator::until, make(Operator::truth), left(false))
                     : make(Operator::release, make(Operator::falsity), left(false));
    case Operator::until:
      return make(either(Operator::until, Operator::release), left(false), right(false));
    case Operator::release:
      return make(either(Operator::release, Operator::until), left(false), right(false));
    case Operator::weak_until: {  // l W r = r R (l || r)
      const Formula l = left(false), r = right(false);
      return negated ? make(Operator::until, r, make(Operator::conjunction, l, r))
                     : make(Operator::release, r, make(Operator::disjunction, l, r));
    }
  }
  return formula;
}

void collect_atoms(const Formula& formula, std::vector<Atom>& atoms) {
  if (!formula) return;
  if (formula->op == Operator::atom) atoms.push_back(formula->atom);
  collect_atoms(formula->left, atoms);
  collect_atoms(formula->right, atoms);
}

std::string quoted(const std::string& whole) {
  // Indices of an array's member, and values of a symbol, stand behind the name.
  const std::string name = whole.substr(0, std::min(whole.find('['), whole.find('(')));
  const bool is_operator =
      name.size() == 1 && std::string_view("XFGURW").find(name[0]) != std::string::npos;
  return is_identifier(name) && !is_operator ? whole : "\"" + whole + "\"";
}

// "camera:" before an event that names its program.
std::string giver(const Atom& atom, const FormulaScope& scope) {
  return atom.program == Atom::any_program ? "" : quoted(scope.programs[atom.program].name) + ":";
}

std::string to_string(const Atom& atom, const FormulaScope& scope) {
  switch (atom.kind) {
    case Atom::Kind::label: {
      const Program& program = scope.programs[atom.owner];
      const std::string& label = program.labels[atom.symbol];
      // A callback's label says whose it is.
      if (!program.nodes.empty()) return label;
      return quoted(program.name) + "@" + quoted(label);
    }
    case Atom::Kind::end: return quoted(scope.programs[atom.owner].name) + "@end";
    case Atom::Kind::input: {
      const ProgramInterface& model = scope.models[atom.owner];
      return giver(atom, scope) + quoted(model.name) + "." +
             quoted(model.inputs->name(atom.symbol));
    }
    case Atom::Kind::output: {
      const ProgramInterface& model = scope.models[atom.owner];
      return giver(atom, scope) + quoted(model.name) + "!" +
             quoted(model.outputs->name(atom.symbol));
    }
    case Atom::Kind::expression:
      return "(" + to_string(scope.expressions[atom.owner], *scope.words) + ")";
  }
  return "";
}

// Least (`until`) or greatest (`release`) solution of v = now || (later && next(v)), where the run
// closes into a loop. Two rounds backward reach it: the first finds what the loop's end needs.
Truth solve(std::size_t loop, bool start, const Truth& now, const Truth& later) {
  const std::size_t length = now.size();
  Truth value(length, start);
  for (int round = 0; round < 2; ++round) {
    for (std::size_t at = length; at-- > 0;) {
      const bool next = at + 1 < length ? value[at + 1] : value[loop];
      value[at] = now[at] || (later[at] && next);
    }
  }
  return value;
}

class LassoEvaluator {
 public:
  LassoEvaluator(std::size_t length, std::size_t loop,
                 const std::function<bool(const Atom&, std::size_t)>& value, std::size_t cut)
      : length_(length), loop_(loop), value_(value), cut_(cut) {}

  // `formula` in negation normal form.
  Truth evaluate(const Formula& formula) const {
    Truth result(length_, formula->op == Operator::truth);
    const auto combine = [&](auto&& rule) {
      const Truth left = evaluate(formula->left), right = evaluate(formula->right);
      for (std::size_t at = 0; at < length_; ++at) result[at] = rule(left[at], right[at]);
    };
    switch (formula->op) {
      case Operator::atom:
        for (std::size_t at = 0; at < length_; ++at)
          result[at] = at >= cut_ || value_(formula->atom, at);
        break;
      case Operator::negation:
        for (std::size_t at = 0; at < length_; ++at)
          result[at] = at >= cut_ || !value_(formula->left->atom, at);
        break;
      case Operator::conjunction: combine([](bool l, bool r) { return l && r; }); break;
      case Operator::disjunction: combine([](bool l, bool r) { return l || r; }); break;
      case Operator::next: {
        const Truth inner = evaluate(formula->left);
        for (std::size_t at = 0; at < length_; ++at) {
          result[at] = at + 1 < length_ ? inner[at + 1] : inner[loop_];
        }
        break;
      }
      case Operator::until:
        result = solve(loop_, false, evaluate(formula->right), evaluate(formula->left));
        break;
      case Operator::release: {  // v = (l && r) || (r && next(v))
        combine([](bool l, bool r) { return l && r; });
        result = solve(loop_, true, result, evaluate(formula->right));
        break;
      }
      default: break;  // constants, which a cut does not change: `F false` is a bad prefix
    }
    return result;
  }

 private:
  std::size_t length_, loop_;
  const std::function<bool(const Atom&, std::size_t)>& value_;
  std::size_t cut_;
};

}  // namespace

Formula negation_normal_form(const Formula& formula) { return normalise(formula, false); }

bool contains(const Formula& formula, Operator op) {
  return formula &&
         (formula->op == op || contains(formula->left, op) || contains(formula->right, op));
}

double expanded_size(const Formula& formula) {
  if (!formula) return 0;
  const double size = 1 + expanded_size(formula->left) + expanded_size(formula->right);
  const bool doubles = formula->op == Operator::equivalence || formula->op == Operator::weak_until;
  return doubles ? 2 * size : size;
}

bool is_boolean(const Formula& formula) {
  constexpr Operator temporal[] = {Operator::next,  Operator::finally, Operator::globally,
                                   Operator::until, Operator::release, Operator::weak_until};
  return std::none_of(std::begin(temporal), std::end(temporal),
                      [&](Operator op) { return contains(formula, op); });
}

bool is_syntactically_safe(const Formula& formula) {
  return !contains(negation_normal_form(formula), Operator::until);
}

std::vector<Atom> atoms_of(const Formula& formula) {
  std::vector<Atom> atoms;
  collect_atoms(formula, atoms);
  std::ranges::sort(atoms);
  atoms.erase(std::unique(atoms.begin(), atoms.end()), atoms.end());
  return atoms;
}

std::string to_string(const Formula& formula, const FormulaScope& scope) {
  const auto unary = [&](const char* op) { return op + to_string(formula->left, scope); };
  const auto binary = [&](const char* op) {
    return "(" + to_string(formula->left, scope) + op + to_string(formula->right, scope) + ")";
  };
  switch (formula->op) {
    case Operator::truth: return "true";
    case Operator::falsity: return "false";
    case Operator::atom: return to_string(formula->atom, scope);
    case Operator::negation: return unary("!");
    case Operator::conjunction: return binary(" && ");
    case Operator::disjunction: {
      // A node's label is one in each program that runs it, and all are written alike.
      const std::string left = to_string(formula->left, scope);
      return left == to_string(formula->right, scope) ? left : binary(" || ");
    }
    case Operator::implication: return binary(" -> ");
    case Operator::equivalence: return binary(" <-> ");
    case Operator::next: return unary("X ");
    case Operator::finally: return unary("F ");
    case Operator::globally: return unary("G ");
    case Operator::until: return binary(" U ");
    case Operator::release: return binary(" R ");
    case Operator::weak_until: return binary(" W ");
  }
  return "";
}

bool holds_on_lasso(const Formula& formula, std::size_t length, std::size_t loop,
                    const std::function<bool(const Atom&, std::size_t position)>& value,
                    std::size_t cut) {
  return evaluate_on_lasso(formula, length, loop, value, cut)[0];
}

std::vector<bool> evaluate_on_lasso(const Formula& formula, std::size_t length, std::size_t loop,
                                    const std::function<bool(const Atom&, std::size_t)>& value,
                                    std::size_t cut) {
  return LassoEvaluator(length, loop, value, cut).evaluate(negation_normal_form(formula));
}

}  // namespace maide
