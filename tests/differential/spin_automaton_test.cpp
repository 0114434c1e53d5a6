// Maide's automata against those of `spin -f`, on random formulas without X: no run is accepted by
// Maide's automaton of f and by SPIN's of not-f, nor the other way round. SPIN's never claims are
// rewritten into the Hanoi Omega-Automata format and read from there.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <sstream>

#include "maide/base/subprocess.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "random_formula.hpp"

namespace maide {
namespace {

using Operator = FormulaNode::Operator;

// In SPIN's words, over p0, p1, p2; of a formula in negation normal form.
std::string spin_text(const Formula& formula) {
  const auto binary = [&](const char* op) {
    return "(" + spin_text(formula->left) + op + spin_text(formula->right) + ")";
  };
  switch (formula->op) {
    case Operator::truth: return "true";
    case Operator::falsity: return "false";
    case Operator::atom: return "p" + std::to_string(formula->atom.symbol);
    case Operator::negation: return "(!" + spin_text(formula->left) + ")";
    case Operator::conjunction: return binary(" && ");
    case Operator::disjunction: return binary(" || ");
    case Operator::until: return binary(" U ");
    default: return binary(" V ");
  }
}

// The label of a transition in HOA's words.
std::string hoa_label(const std::string& expression) {
  std::string text = std::regex_replace(expression, std::regex("p([0-9])"), "@p$1");
  text = std::regex_replace(text, std::regex("\\btrue\\b|\\b1\\b"), "t");
  text = std::regex_replace(text, std::regex("\\bfalse\\b|\\b0\\b"), "f");
  text = std::regex_replace(text, std::regex("&&"), "&");
  return std::regex_replace(text, std::regex("\\|\\|"), "|");
}

// A claim has a state for each label, or for several labels in a row; those called accept... must
// come again and again. `atomic { (p) -> assert(!(p)) }` and accept_all take every run from there.
LtlAutomaton read_claim(const std::string& claim, const FormulaScope& scope) {
  std::map<std::string, std::size_t> numbers;
  std::vector<std::string> marks;  // by state
  std::string line;
  const std::regex label("(\\w+):"), option("\\s*:: (.*) -> goto (\\w+)"),
      violated("\\s*:: atomic \\{ (.*) -> assert.*"), stays("\\s*skip|\\s*:: skip");
  struct Edge {
    std::size_t from;
    std::string label, target;
  };
  std::vector<Edge> edges;
  std::size_t count = 0;
  bool is_label = false;
  for (std::istringstream lines(claim); std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, label)) {
      if (!is_label) marks.emplace_back();
      count = marks.size();
      numbers[match[1]] = count - 1;
      if (match[1].str().starts_with("accept")) marks.back() = " {0}";
      is_label = true;
      continue;
    }
    is_label = false;
    if (std::regex_match(line, match, option)) {
      edges.push_back({count - 1, hoa_label(match[1]), match[2]});
    } else if (std::regex_match(line, match, violated)) {
      edges.push_back({count - 1, hoa_label(match[1]), "accept_all"});
    } else if (std::regex_match(line, match, stays)) {
      edges.push_back({count - 1, "t", "accept_all"});
    }
  }
  std::ostringstream hoa;
  hoa << "HOA: v1\nStart: 0\nAP: 3 \"p@a0\" \"p@a1\" \"p@a2\"\n"
         "Alias: @p0 0\nAlias: @p1 1\nAlias: @p2 2\nAcceptance: 1 Inf(0)\n--BODY--\n";
  for (std::size_t state = 0; state < marks.size(); ++state) {
    hoa << "State: " << state << marks[state] << "\n";
    for (const Edge& edge : edges) {
      if (edge.from == state) hoa << "[" << edge.label << "] " << numbers.at(edge.target) << "\n";
    }
  }
  hoa << "--END--\n";
  return read_hoa(hoa.str(), claim, scope);
}

// The letter in terms of p@a0, p@a1, p@a2.
Letter renamed(const Letter& letter, const std::vector<Atom>& atoms) {
  Letter result;
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    result.positive |= (letter.positive >> i & 1) << atoms[i].symbol;
    result.negative |= (letter.negative >> i & 1) << atoms[i].symbol;
  }
  return result;
}

// The product's transitions that some letter allows, without their letters: whether any run is
// accepted by both is then whether one run without atoms is.
bool is_intersection_empty(const LtlAutomaton& left, const LtlAutomaton& right) {
  LtlAutomaton product;
  product.mark_count = left.mark_count + right.mark_count;
  product.states.resize(left.states.size() * right.states.size());
  const auto pair = [&](std::size_t one, std::size_t other) {
    return static_cast<std::uint32_t>(one * right.states.size() + other);
  };
  for (std::size_t one = 0; one < left.states.size(); ++one) {
    for (std::size_t other = 0; other < right.states.size(); ++other) {
      for (const auto& move : left.states[one]) {
        for (const auto& answer : right.states[other]) {
          const Letter a = renamed(move.letter, left.atoms),
                       b = renamed(answer.letter, right.atoms);
          if (Letter{a.positive | b.positive, a.negative | b.negative}.is_contradiction()) continue;
          product.states[pair(one, other)].push_back(
              {Letter(), pair(move.target, answer.target),
               move.marks | answer.marks << left.mark_count});
        }
      }
    }
  }
  for (const std::uint32_t one : left.initial) {
    for (const std::uint32_t other : right.initial) product.initial.push_back(pair(one, other));
  }
  return !accepts(product, {0}, 0);
}

TEST(SpinAutomata, AreDisjointFromOursOfTheNegation) {
  const test::FormulaAtoms atoms;
  Random random(61);
  int compared = 0, satisfiable = 0;
  while (compared < 150) {
    const Formula formula = test::random_formula(random, 1 + static_cast<int>(random.below(3)));
    const Formula normal = negation_normal_form(formula);
    if (contains(normal, Operator::next)) continue;
    ++compared;
    const SubprocessResult spin = run_program({"spin", "-f", spin_text(normal)});
    ASSERT_TRUE(spin.succeeded()) << spin.out << spin.err;
    const LtlAutomaton theirs = read_claim(spin.out, atoms.scope());
    const LtlAutomaton ours = translate(formula);
    const LtlAutomaton negation = translate(test::make(Operator::negation, formula));
    ASSERT_TRUE(is_intersection_empty(negation, theirs)) << spin_text(normal) << "\n" << spin.out;
    // Where some run satisfies the formula, both accept it.
    const bool is_empty = is_intersection_empty(ours, translate(test::make(Operator::truth)));
    ASSERT_EQ(is_intersection_empty(ours, theirs), is_empty) << spin_text(normal) << "\n"
                                                             << spin.out;
    satisfiable += is_empty ? 0 : 1;
    const Formula dual = negation_normal_form(test::make(Operator::negation, formula));
    const SubprocessResult other = run_program({"spin", "-f", spin_text(dual)});
    ASSERT_TRUE(is_intersection_empty(ours, read_claim(other.out, atoms.scope())))
        << spin_text(dual) << "\n"
        << other.out;
  }
  EXPECT_GT(satisfiable, 50);
}

}  // namespace
}  // namespace maide
