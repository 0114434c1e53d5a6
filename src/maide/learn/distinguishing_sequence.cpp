#include "maide/learn/distinguishing_sequence.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "maide/learn/adaptive_experiment.hpp"

namespace maide {
namespace {

using States = std::vector<StateId>;
using Parts = std::map<Symbol, States>;  // where they go, by output

// States that may still be meant, at worst.
std::size_t largest(const Parts& parts) {
  std::size_t result = 0;
  for (const auto& [output, states] : parts) result = std::max(result, states.size());
  return result;
}

class Search {
 public:
  Search(const Mealy& machine, std::size_t effort) : machine_(machine), effort_(effort) {}

  std::optional<DecisionTree> find(const States& states) {
    std::vector<Place> queue{{states, {}, {}}};
    std::set<States> seen{sorted(states)};
    for (std::size_t next = 0; next < queue.size(); ++next) {
      if (effort_ == 0) return std::nullopt;
      --effort_;
      std::vector<Split> splits;
      for (Symbol input = 0; input < machine_.inputs().size(); ++input) {
        auto parts = part(queue[next].states, input);
        if (!parts) continue;
        if (parts->size() > 1) {
          splits.push_back({largest(*parts), input, std::move(*parts)});
        } else if (seen.insert(sorted(parts->begin()->second)).second) {
          Place place{std::move(parts->begin()->second), queue[next].word, queue[next].outputs};
          place.word.push_back(input);
          place.outputs.push_back(parts->begin()->first);
          queue.push_back(std::move(place));
        }
      }
      std::ranges::stable_sort(splits, {}, &Split::largest_part);
      for (const Split& split : splits) {
        if (auto found = find_below(queue[next], split)) return found;
      }
    }
    return std::nullopt;
  }

 private:
  // What a word that parts nothing leads to.
  struct Place {
    States states;
    Word word, outputs;
  };
  struct Split {
    std::size_t largest_part;
    Symbol input;
    Parts parts;
  };

  static States sorted(States states) {
    std::ranges::sort(states);
    return states;
  }

  // Nothing if two of the states become one.
  std::optional<Parts> part(const States& states, Symbol input) const {
    Parts parts;
    for (const StateId state : states) {
      States& targets = parts[machine_.output(state, input)];
      const StateId target = machine_.target(state, input);
      if (std::ranges::find(targets, target) != targets.end()) return std::nullopt;
      targets.push_back(target);
    }
    return parts;
  }

  std::optional<DecisionTree> find_below(const Place& place, const Split& split) {
    Word word = place.word;
    word.push_back(split.input);
    DecisionTree result = chain(word, place.outputs);
    for (const auto& [output, states] : split.parts) {
      if (states.size() == 1) continue;
      const std::optional<DecisionTree> below = find(states);
      if (!below) return std::nullopt;
      graft(result, place.word.size(), output, *below);
    }
    return result;
  }

  const Mealy& machine_;
  std::size_t effort_;  // sets of states that may still be looked at
};

}  // namespace

std::optional<DecisionTree> find_distinguishing_sequence(const Mealy& machine,
                                                         const std::vector<StateId>& states,
                                                         std::size_t effort) {
  return Search(machine, effort).find(states);
}

}  // namespace maide
