// The translation after Gastin & Oddoux: the moves of the alternating automaton, worked out part by
// part, then the generalised automaton of sets of parts, simplified as it grows and once more at
// the end.
#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"

namespace maide {
namespace {

using Operator = FormulaNode::Operator;
using Parts = std::uint64_t;  // a set of temporal parts, by bit

constexpr std::size_t most_states = 100'000;
constexpr std::size_t most_moves =
    1'000'000;  // of a state, and sets of parts that it may begin with

// A transition of the alternating automaton: read the letter, go on in all of `parts`.
struct Move {
  Letter letter;
  Parts parts = 0;
  auto operator<=>(const Move&) const = default;
};

// Whether `left` is possible wherever `right` is, and leaves no more to do.
bool covers(const Move& left, const Move& right) {
  return (left.letter.positive & ~right.letter.positive) == 0 &&
         (left.letter.negative & ~right.letter.negative) == 0 && (left.parts & ~right.parts) == 0;
}

// Literals, && and || stand for sets of parts; the parts are U, R, X and literals behind an X.
class Translation {
 public:
  // Keeps a reference to `control`.
  Translation(const Formula& formula, const RunControl& control) : control_(control) {
    automaton_.atoms = atoms_of(formula);
    if (automaton_.atoms.size() > max_automaton_atoms) {
      throw UsageError("a formula has more than 64 different atoms");
    }
    const Formula normal = negation_normal_form(formula);
    for (const Parts parts : sets_of(normal)) automaton_.initial.push_back(state_of(parts));
    while (!open_.empty()) {
      const Parts parts = open_.back();
      open_.pop_back();
      expand(parts);
    }
    finish();
  }

  LtlAutomaton take() { return std::move(automaton_); }

 private:
  struct Part {
    Formula formula;
    std::uint32_t key = 0;
    std::vector<Move> moves;
    bool has_moves = false;
    unsigned mark = 0;
    bool is_until = false;
  };

  // Told of each small piece of work. Throws Interrupted when the control says to stop.
  void look() {
    constexpr std::uint64_t interval = 1 << 14;
    if (++looked_at_ % interval == 0) control_.check("the translation of a formula");
  }
  static void require_room(std::size_t count) {
    if (count < most_moves) return;
    throw UsageError("a formula is too large: a state of its automaton has too many transitions");
  }

  std::vector<Move> without_covered(std::vector<Move> moves) {
    std::ranges::sort(moves);
    moves.erase(std::unique(moves.begin(), moves.end()), moves.end());
    std::vector<Move> kept;
    for (const Move& move : moves) {
      const bool is_covered = std::ranges::any_of(moves, [&](const Move& other) {
        look();
        return !(other == move) && covers(other, move);
      });
      if (!is_covered) kept.push_back(move);
    }
    return kept;
  }

  std::vector<Move> combine(const std::vector<Move>& left, const std::vector<Move>& right) {
    std::vector<Move> moves;
    for (const Move& one : left) {
      for (const Move& other : right) {
        look();
        const Move move{{one.letter.positive | other.letter.positive,
                         one.letter.negative | other.letter.negative},
                        one.parts | other.parts};
        if (move.letter.is_contradiction()) continue;
        require_room(moves.size());
        moves.push_back(move);
      }
    }
    std::ranges::sort(moves);
    moves.erase(std::unique(moves.begin(), moves.end()), moves.end());
    return moves;
  }

  std::vector<Move> both(const std::vector<Move>& left, const std::vector<Move>& right) {
    return without_covered(combine(left, right));
  }

  std::vector<Move> either(std::vector<Move> left, const std::vector<Move>& right) {
    left.insert(left.end(), right.begin(), right.end());
    return without_covered(std::move(left));
  }

  // The same formula is the same part wherever it stands.
  std::uint32_t part_of(const Formula& formula) {
    const std::uint32_t key = key_of(formula);
    const auto [place, is_new] = part_ids_.emplace(key, parts_.size());
    if (is_new) {
      if (parts_.size() == max_temporal_parts) {
        throw UsageError("a formula has more than 64 temporal parts");
      }
      Part part;
      part.formula = formula;
      part.key = key;
      part.is_until = formula->op == Operator::until;
      if (part.is_until) part.mark = automaton_.mark_count++;
      parts_.push_back(std::move(part));
    }
    return place->second;
  }

  // Hash-consing: a number for each formula, greater than those of its parts.
  std::uint32_t key_of(const Formula& formula) {
    const std::uint32_t left = formula->left ? key_of(formula->left) : 0;
    const std::uint32_t right = formula->right ? key_of(formula->right) : 0;
    const auto [place, is_new] = keys_.emplace(
        std::tuple(formula->op, formula->op == Operator::atom ? formula->atom : Atom(), left,
                   right),
        static_cast<std::uint32_t>(keys_.size() + 1));
    return place->second;
  }

  // The disjunctive normal form over parts.
  std::vector<Parts> sets_of(const Formula& formula) {
    switch (formula->op) {
      case Operator::truth: return {0};
      case Operator::falsity: return {};
      case Operator::disjunction: {
        std::vector<Parts> sets = sets_of(formula->left);
        const std::vector<Parts> others = sets_of(formula->right);
        sets.insert(sets.end(), others.begin(), others.end());
        return sets;
      }
      case Operator::conjunction: {
        std::vector<Parts> sets;
        const std::vector<Parts> left = sets_of(formula->left), right = sets_of(formula->right);
        for (const Parts one : left) {
          for (const Parts other : right) {
            look();
            require_room(sets.size());
            sets.push_back(one | other);
          }
        }
        return sets;
      }
      default: return {Parts{1} << part_of(formula)};
    }
  }

  Letter letter_of(const Formula& atom, bool is_positive) const {
    const auto place = std::ranges::find(automaton_.atoms, atom->atom);
    MAIDE_CHECK(place != automaton_.atoms.end());
    const std::uint64_t bit = std::uint64_t{1} << (place - automaton_.atoms.begin());
    return is_positive ? Letter{bit, 0} : Letter{0, bit};
  }

  // What is to be read, and done from the next position on, for the formula to hold.
  std::vector<Move> moves_of(const Formula& formula) {
    switch (formula->op) {
      case Operator::truth: return {Move()};
      case Operator::falsity: return {};
      case Operator::atom: return {{letter_of(formula, true), 0}};
      case Operator::negation: return {{letter_of(formula->left, false), 0}};
      case Operator::conjunction: return both(moves_of(formula->left), moves_of(formula->right));
      case Operator::disjunction: return either(moves_of(formula->left), moves_of(formula->right));
      case Operator::next: {
        std::vector<Move> moves;
        for (const Parts parts : sets_of(formula->left)) moves.push_back({{}, parts});
        return without_covered(std::move(moves));
      }
      case Operator::until:
      case Operator::release: {
        const std::vector<Move> again{{{}, Parts{1} << part_of(formula)}};
        const std::vector<Move> left = moves_of(formula->left), right = moves_of(formula->right);
        return formula->op == Operator::until ? either(right, both(left, again))
                                              : both(right, either(left, again));
      }
      default: throw std::logic_error("not in negation normal form");
    }
  }

  // Whether each of the parts is this part itself or could stand in its formula. That is what makes
  // the alternating automaton very weak.
  bool leads_down(Parts parts, std::size_t part) const {
    for (std::size_t next = 0; next < parts_.size(); ++next) {
      if ((parts >> next & 1) == 0 || next == part) continue;
      if (parts_[next].key >= parts_[part].key) return false;
    }
    return true;
  }

  const std::vector<Move>& moves_of_part(std::size_t part) {
    if (!parts_[part].has_moves) {
      std::vector<Move> moves = moves_of(parts_[part].formula);
      MAIDE_CHECK(std::ranges::all_of(moves, [&](const Move& move) {
        return !move.letter.is_contradiction() && leads_down(move.parts, part);
      }));
      parts_[part].moves = std::move(moves);
      parts_[part].has_moves = true;
    }
    return parts_[part].moves;
  }

  // Without what an `X R Y` says anyway: that Y holds now. So G F p and G F p && F p are one state.
  Parts without_implied(Parts parts) {
    Parts implied = 0;
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      const Formula formula = parts_[part].formula;
      if ((parts >> part & 1) == 0 || formula->op != Operator::release) continue;
      const std::vector<Parts> right = sets_of(formula->right);
      if (right.size() == 1) implied |= right.front();
    }
    return parts & ~implied;
  }

  std::uint32_t state_of(Parts any_parts) {
    const Parts parts = without_implied(any_parts);
    const auto [place, is_new] =
        state_ids_.emplace(parts, static_cast<std::uint32_t>(state_parts_.size()));
    if (is_new) {
      if (state_parts_.size() == most_states) {
        throw UsageError("a formula is too large: its automaton has more than 100,000 states");
      }
      state_parts_.push_back(parts);
      automaton_.states.emplace_back();
      open_.push_back(parts);
    }
    return place->second;
  }

  void expand(Parts parts) {
    std::vector<Move> moves{Move()};
    for (std::size_t part = 0; part < 64; ++part) {
      if ((parts >> part & 1) != 0) moves = combine(moves, moves_of_part(part));
    }
    std::vector<std::uint64_t> marks(moves.size());
    for (std::size_t i = 0; i < moves.size(); ++i) {
      look();
      for (std::size_t part = 0; part < parts_.size(); ++part) {
        if (parts_[part].is_until && is_served(part, moves[i])) {
          marks[i] |= std::uint64_t{1} << parts_[part].mark;
        }
      }
    }
    // A move that another covers is left out, unless it has a mark that the other lacks.
    std::vector<LtlAutomaton::Transition> transitions;
    for (std::size_t i = 0; i < moves.size(); ++i) {
      bool is_implied = false;
      for (std::size_t other = 0; other < moves.size() && !is_implied; ++other) {
        look();
        is_implied =
            other != i && covers(moves[other], moves[i]) && (marks[i] & ~marks[other]) == 0;
      }
      if (!is_implied) {
        transitions.push_back({moves[i].letter, state_of(moves[i].parts), marks[i]});
      }
    }
    automaton_.states[state_ids_.at(parts)] = std::move(transitions);
  }

  // The until is not waited for after this move, or could have come true in it.
  bool is_served(std::size_t part, const Move& move) {
    const Parts own = Parts{1} << part;
    if ((move.parts & own) == 0) return true;
    const std::vector<Move>& moves = moves_of_part(part);
    return std::ranges::any_of(moves, [&](const Move& own_move) {
      return (own_move.parts & own) == 0 && covers(own_move, move);
    });
  }

  // States with the same transitions are one; those of an until that came later get its mark, which
  // could not be known when they were made; transitions that others imply are left out.
  void finish() {
    for (std::size_t id = 0; id < state_parts_.size(); ++id) expand(state_parts_[id]);
    bool is_changed = true;
    while (is_changed) {
      is_changed = false;
      std::map<std::vector<LtlAutomaton::Transition>, std::uint32_t> known;
      std::vector<std::uint32_t> becomes(automaton_.states.size());
      merged_.resize(automaton_.states.size());
      for (std::uint32_t state = 0; state < automaton_.states.size(); ++state) {
        auto& transitions = automaton_.states[state];
        becomes[state] = state;
        if (merged_[state]) continue;
        leave_out_implied(transitions);
        becomes[state] = known.emplace(transitions, state).first->second;
        is_changed = is_changed || becomes[state] != state;
      }
      redirect(becomes);
    }
    drop_unreachable();
  }

  void leave_out_implied(std::vector<LtlAutomaton::Transition>& transitions) {
    std::ranges::sort(transitions);
    transitions.erase(std::unique(transitions.begin(), transitions.end()), transitions.end());
    std::vector<LtlAutomaton::Transition> kept;
    for (const auto& one : transitions) {
      const bool is_implied = std::ranges::any_of(transitions, [&](const auto& other) {
        look();
        return !(other == one) && other.target == one.target &&
               covers({other.letter, 0}, {one.letter, 0}) && (one.marks & ~other.marks) == 0;
      });
      if (!is_implied) kept.push_back(one);
    }
    transitions = std::move(kept);
  }

  void redirect(const std::vector<std::uint32_t>& becomes) {
    for (auto& transitions : automaton_.states) {
      for (auto& transition : transitions) transition.target = becomes[transition.target];
    }
    for (std::uint32_t& state : automaton_.initial) state = becomes[state];
    std::ranges::sort(automaton_.initial);
    automaton_.initial.erase(std::unique(automaton_.initial.begin(), automaton_.initial.end()),
                             automaton_.initial.end());
    for (std::uint32_t state = 0; state < becomes.size(); ++state) {
      merged_[state] = merged_[state] || becomes[state] != state;
      MAIDE_CHECK(becomes[becomes[state]] == becomes[state]);  // it takes one step to get there
    }
  }

  void drop_unreachable() {
    LtlAutomaton result;
    result.atoms = automaton_.atoms;
    result.mark_count = automaton_.mark_count;
    std::vector<std::uint32_t> number(automaton_.states.size(), LtlAutomaton::no_state);
    std::vector<std::uint32_t> order;
    const auto number_of = [&](std::uint32_t state) {
      if (number[state] == LtlAutomaton::no_state) {
        number[state] = static_cast<std::uint32_t>(order.size());
        order.push_back(state);
      }
      return number[state];
    };
    for (const std::uint32_t state : automaton_.initial) result.initial.push_back(number_of(state));
    for (std::size_t at = 0; at < order.size(); ++at) {
      auto& transitions = result.states.emplace_back(automaton_.states[order[at]]);
      for (auto& transition : transitions) transition.target = number_of(transition.target);
    }
    result.universal = find_universal(result);
    automaton_ = std::move(result);
  }

  const RunControl& control_;
  std::uint64_t looked_at_ = 0;
  LtlAutomaton automaton_;
  std::deque<Part> parts_;  // grows while its elements are read
  std::map<std::uint32_t, std::uint32_t> part_ids_;
  std::map<std::tuple<Operator, Atom, std::uint32_t, std::uint32_t>, std::uint32_t> keys_;
  std::map<Parts, std::uint32_t> state_ids_;
  std::vector<Parts> state_parts_;
  std::vector<Parts> open_;
  std::vector<bool> merged_;  // into another state
};

}  // namespace

LtlAutomaton translate(const Formula& formula, const RunControl& control) {
  return Translation(formula, control).take();
}

}  // namespace maide
