// Hopcroft & Karp, breadth first. Invariant: two states in one class of the union-find structure
// are equivalent unless some pair already in the queue, with a word that is no longer (and no
// greater among words as long), tells them apart; so skipping a pair within a class loses neither
// the shortest nor the least word.
#include "maide/automata/compare.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "maide/automata/behaviour.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/text.hpp"

namespace maide {

namespace {

// Of states that the same trace leads to.
constexpr std::size_t most_sets = 1'000'000;

}  // namespace

InterfaceAutomaton automaton_of_traces(const InterfaceAutomaton& automaton,
                                       std::span<const Symbol> silent, const RunControl& control) {
  using States = std::vector<StateId>;  // ascending
  const auto is_silent = [&](Action action) {
    return action.is_input() && std::ranges::find(silent, action.symbol) != silent.end();
  };
  const auto closed = [&](States states) {
    std::set<StateId> all(states.begin(), states.end());
    while (!states.empty()) {
      const StateId from = states.back();
      states.pop_back();
      for (const auto& transition : automaton.transitions(from)) {
        if (!is_silent(transition.action) || !all.insert(transition.target).second) continue;
        states.push_back(transition.target);
      }
    }
    return States(all.begin(), all.end());
  };
  Alphabet inputs;
  for (Symbol input = 0; input < automaton.inputs().size(); ++input) {
    if (!is_silent({Action::Kind::input, input})) inputs.intern(automaton.inputs().name(input));
  }
  const auto seen = [&](Action action) {
    if (action.is_input()) action.symbol = *inputs.find(automaton.inputs().name(action.symbol));
    return action;
  };
  InterfaceAutomaton result(inputs, automaton.outputs(), 0);
  result.origin = automaton.origin;
  std::map<States, StateId> numbers;
  std::vector<const States*> sets;  // by state of the result
  const auto number_of = [&](States states) {
    const auto [place, is_new] =
        numbers.try_emplace(std::move(states), static_cast<StateId>(sets.size()));
    if (is_new) {
      if (sets.size() == most_sets) {
        throw UsageError("the traces need more than " + std::to_string(most_sets) +
                         " sets of states");
      }
      sets.push_back(&place->first);
      result.add_state();
    }
    return place->second;
  };
  number_of(closed({automaton.initial()}));
  for (StateId from = 0; from < sets.size(); ++from) {
    control.check("the traces");
    std::map<Action, States> targets;
    for (const StateId state : *sets[from]) {
      for (const auto& transition : automaton.transitions(state)) {
        if (!is_silent(transition.action)) targets[transition.action].push_back(transition.target);
      }
    }
    for (auto& [action, states] : targets) {
      result.add_transition(from, seen(action), number_of(closed(std::move(states))));
    }
  }
  return result;
}
namespace {

class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t find(std::uint32_t element) {
    while (parent_[element] != element) {
      parent_[element] = parent_[parent_[element]];
      element = parent_[element];
    }
    return element;
  }
  // False if they were in one class already.
  bool unite(std::uint32_t left, std::uint32_t right) {
    left = find(left);
    right = find(right);
    if (left == right) return false;
    // Linking by a scrambled index is as good as by rank (Goel, Khanna, Larkin, Tarjan, SODA 2014).
    if (left * 2654435769U < right * 2654435769U) std::swap(left, right);
    parent_[right] = left;
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

constexpr Symbol unknown = StateSets::no_symbol;

// For each symbol of `from` the one of the same name in `to`, or `unknown`.
std::vector<Symbol> symbol_map(const Alphabet& from, const Alphabet& to) {
  std::vector<Symbol> map;
  map.reserve(from.size());
  for (const std::string& name : from.names()) map.push_back(to.find(name).value_or(unknown));
  return map;
}

class MealyComparison {
 public:
  MealyComparison(const Mealy& left, const Mealy& right)
      : left_(left),
        right_(right),
        inputs_(symbol_map(left.inputs(), right.inputs())),
        outputs_(symbol_map(right.outputs(), left.outputs())),
        classes_(left.size() + right.size()) {}

  // The shortest and least word over the inputs that both have.
  std::optional<Word> find_word() {
    visit(left_.initial(), right_.initial(), 0, 0);
    for (std::size_t next = 0; next < queue_.size(); ++next) {
      for (Symbol input = 0; input < inputs_.size(); ++input) {
        const auto [left, right, parent, last] = queue_[next];
        const Symbol other = inputs_[input];
        if (other == unknown) continue;
        if (left_.output(left, input) != outputs_[right_.output(right, other)]) {
          Word word = word_to(next, input);
          MAIDE_CHECK(leads_to(word, left, right));
          return word;
        }
        visit(left_.target(left, input), right_.target(right, other), next, input);
      }
    }
    return std::nullopt;
  }

  // The first input that only one machine has, in left's order and then right's.
  std::optional<std::string> input_of_one() const {
    for (Symbol input = 0; input < inputs_.size(); ++input) {
      if (inputs_[input] == unknown) return left_.inputs().name(input);
    }
    for (const std::string& name : right_.inputs().names()) {
      if (!left_.inputs().find(name)) return name;
    }
    return std::nullopt;
  }

 private:
  struct Pair {
    StateId left, right;
    std::size_t parent;  // place in the queue of the pair before it
    Symbol last;         // the input that led here from there
  };

  void visit(StateId left, StateId right, std::size_t parent, Symbol last) {
    if (classes_.unite(left, static_cast<std::uint32_t>(left_.size()) + right)) {
      // Breadth first: the words of later pairs are no shorter.
      MAIDE_CHECK(queue_.empty() || (queue_.back().parent <= parent && parent < queue_.size()));
      queue_.push_back({left, right, parent, last});
      MAIDE_CHECK(queue_.size() < left_.size() + right_.size());  // each pair joins two classes
    }
  }

  Word word_to(std::size_t pair, Symbol last) const {
    Word word{last};
    for (; pair != 0; pair = queue_[pair].parent) word.push_back(queue_[pair].last);
    return {word.rbegin(), word.rend()};
  }

  // Whether the word without its last input leads to these states.
  bool leads_to(const Word& word, StateId left, StateId right) const {
    StateId left_state = left_.initial(), right_state = right_.initial();
    for (std::size_t at = 0; at + 1 < word.size(); ++at) {
      left_state = left_.target(left_state, word[at]);
      right_state = right_.target(right_state, inputs_[word[at]]);
    }
    return left_state == left && right_state == right;
  }

  const Mealy& left_;
  const Mealy& right_;
  std::vector<Symbol> inputs_;   // left's -> right's
  std::vector<Symbol> outputs_;  // right's -> left's
  UnionFind classes_;
  std::vector<Pair> queue_;
};

}  // namespace

bool is_never_tried(std::string_view output) {
  return output == "unexplored" || output == "absorbed";
}

std::optional<MealyDifference> find_difference(const Mealy& left, const Mealy& right) {
  MealyComparison comparison(left, right);
  const auto word = comparison.find_word();
  const auto lonely = comparison.input_of_one();
  // A word of one input that both have goes before an input of one, if it is the lesser symbol.
  const bool word_first =
      word && word->size() == 1 &&
      (!lonely || word->front() < left.inputs().find(*lonely).value_or(unknown));
  if (lonely && !word_first) {
    MealyDifference difference{{*lonely}, std::nullopt, std::nullopt};
    if (const auto input = left.inputs().find(*lonely)) {
      difference.left = left.outputs().name(left.output(left.initial(), *input));
    }
    if (const auto input = right.inputs().find(*lonely)) {
      difference.right = right.outputs().name(right.output(right.initial(), *input));
    }
    return difference;
  }
  if (!word) return std::nullopt;
  MealyDifference difference;
  Word right_word;
  for (const Symbol input : *word) {
    difference.word.push_back(left.inputs().name(input));
    right_word.push_back(*right.inputs().find(difference.word.back()));
  }
  difference.left = left.outputs().name(left.output_word(*word).back());
  difference.right = right.outputs().name(right.output_word(right_word).back());
  return difference;
}

std::optional<Word> find_distinguishing_word(const Mealy& left, const Mealy& right) {
  MealyComparison comparison(left, right);
  if (const auto lonely = comparison.input_of_one()) {
    throw UsageError("only one of two machines has the input '" + *lonely + "'");
  }
  return comparison.find_word();
}

// The pairs of sets of states reached by the same words, breadth first. For deterministic automata
// all sets have one element. Comparing for each action not only whether it *may* happen but also
// whether it may be refused, and whether quiescence may be seen, keeps models apart that choose by
// themselves what they let the environment choose.

namespace {

// An action of either automaton, with its symbol in each.
struct JointAction {
  std::string name;  // "?a" or "!a"
  Action::Kind kind;
  Symbol left, right;  // `unknown` where there is none
};

void add_actions(std::vector<JointAction>& actions, Action::Kind kind, const Alphabet& left,
                 const Alphabet& right) {
  const std::string mark = kind == Action::Kind::input ? "?" : "!";
  for (Symbol symbol = 0; symbol < left.size(); ++symbol) {
    const std::string& name = left.name(symbol);
    actions.push_back({mark + name, kind, symbol, right.find(name).value_or(unknown)});
  }
  for (Symbol symbol = 0; symbol < right.size(); ++symbol) {
    if (left.find(right.name(symbol))) continue;
    actions.push_back({mark + right.name(symbol), kind, unknown, symbol});
  }
}

class PairExploration {
 public:
  PairExploration(const InterfaceAutomaton& left, const InterfaceAutomaton& right)
      : left_sets_(left), right_sets_(right) {
    add_actions(actions_, Action::Kind::input, left.inputs(), right.inputs());
    add_actions(actions_, Action::Kind::output, left.outputs(), right.outputs());
    const StateSets::Id first = left_sets_.intern({left.initial()});
    visit(first, right_sets_.intern({right.initial()}), 0, 0);
  }

  void run(IaComparison& result, const RunControl& control) {
    for (std::size_t pair = 0; pair < queue_.size(); ++pair) {
      if (pair % 1024 == 0) control.check("the comparison");
      expand(pair, result);
    }
  }

 private:
  struct Pair {
    StateSets::Id left, right;
    std::size_t parent;
    std::size_t last;  // place in actions_
  };

  void visit(StateSets::Id left, StateSets::Id right, std::size_t parent, std::size_t last) {
    const std::uint64_t key = (std::uint64_t{left} << 32) | right;
    MAIDE_CHECK(queue_.empty() || (queue_.back().parent <= parent && parent < queue_.size()));
    if (seen_.insert(key).second) queue_.push_back({left, right, parent, last});
  }

  void expand(std::size_t place, IaComparison& result) {
    const auto [left_set, right_set, parent, last] = queue_[place];
    std::vector<SoftDifference::Input> soft;
    for (std::size_t number = 0; number < actions_.size(); ++number) {
      const JointAction& action = actions_[number];
      const ActionStatus left = left_sets_.status(left_set, action.kind, action.left);
      const ActionStatus right = right_sets_.status(right_set, action.kind, action.right);
      const bool agree = left.enabled == right.enabled && left.refused == right.refused &&
                         left.untried == right.untried;
      if (!agree && (left.untried || right.untried)) {
        soft.push_back({action.name.substr(1), left, right});
      } else if (!agree && !result.hard) {
        result.hard = hard_difference(place, action.name, left, right);
      }
      if (left.enabled && right.enabled) {
        const StateSets::Id next = left_sets_.successor(left_set, {action.kind, action.left});
        visit(next, right_sets_.successor(right_set, {action.kind, action.right}), place, number);
      }
    }
    if (!result.hard && left_sets_.quiescence(left_set) != right_sets_.quiescence(right_set)) {
      ActionStatus left, right;
      std::tie(left.enabled, left.refused) = left_sets_.quiescence(left_set);
      std::tie(right.enabled, right.refused) = right_sets_.quiescence(right_set);
      result.hard = hard_difference(place, "(quiescence)", left, right);
    }
    if (soft.empty()) return;
    std::vector<std::string> word = word_to(place);
    MAIDE_CHECK(result.soft.empty() || result.soft.back().word.size() <= word.size());
    result.soft.push_back({std::move(word), std::move(soft)});
  }

  HardDifference hard_difference(std::size_t place, const std::string& last,
                                 const ActionStatus& left, const ActionStatus& right) const {
    HardDifference difference{word_to(place), left, right, {}, {}};
    difference.word.push_back(last);
    for (const JointAction& action : actions_) {
      if (left_sets_.status(queue_[place].left, action.kind, action.left).enabled) {
        difference.left_offers.push_back(action.name);
      }
      if (right_sets_.status(queue_[place].right, action.kind, action.right).enabled) {
        difference.right_offers.push_back(action.name);
      }
    }
    return difference;
  }

  std::vector<std::string> word_to(std::size_t place) const {
    std::vector<std::string> word;
    for (; place != 0; place = queue_[place].parent) {
      word.push_back(actions_[queue_[place].last].name);
    }
    std::ranges::reverse(word);
    return word;
  }

  std::vector<JointAction> actions_;
  StateSets left_sets_, right_sets_;
  std::unordered_set<std::uint64_t> seen_;
  std::vector<Pair> queue_;
};

std::string listed(std::span<const std::string> names) {
  return names.empty() ? "none" : join(names);
}

// Symbols that only one automaton has, whether they ever occur or not.
void note_alphabets(const std::string& what, const Alphabet& left, const Alphabet& right,
                    std::vector<std::string>& notes) {
  const auto missing = [](const Alphabet& from, const Alphabet& in) {
    std::vector<std::string> names;
    for (const std::string& name : from.names()) {
      if (!in.find(name)) names.push_back(name);
    }
    return names;
  };
  const auto only_left = missing(left, right);
  const auto only_right = missing(right, left);
  if (!only_left.empty()) {
    notes.push_back("only the first has the " + what + " " + join(only_left));
  }
  if (!only_right.empty()) {
    notes.push_back("only the second has the " + what + " " + join(only_right));
  }
}

}  // namespace

std::string to_string(const ActionStatus& status) {
  if (!status.is_known) return "not in the alphabet";
  std::string text;
  const auto add = [&](bool holds, const char* word) {
    if (holds) text += (text.empty() ? "" : " or ") + std::string(word);
  };
  add(status.enabled, "enabled");
  add(status.refused, "refused");
  add(status.untried, "never tried");
  return text;
}

IaComparison compare(const InterfaceAutomaton& left, const InterfaceAutomaton& right,
                     const RunControl& control) {
  IaComparison result;
  PairExploration(left, right).run(result, control);
  note_alphabets("inputs", left.inputs(), right.inputs(), result.notes);
  note_alphabets("outputs", left.outputs(), right.outputs(), result.notes);
  std::vector<std::string> left_returns = left.hidden_returns;
  std::vector<std::string> right_returns = right.hidden_returns;
  std::ranges::sort(left_returns);
  std::ranges::sort(right_returns);
  if (left_returns != right_returns) {
    result.notes.push_back("hidden returns differ: " + listed(left_returns) + " in the first, " +
                           listed(right_returns) + " in the second");
  }
  return result;
}

}  // namespace maide
