#include "maide/check/language/built_in_models.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "maide/base/error.hpp"

namespace maide {
namespace {

Action input(Symbol symbol) { return {Action::Kind::input, symbol}; }
Action output(Symbol symbol) { return {Action::Kind::output, symbol}; }

}  // namespace

InterfaceAutomaton make_mutex() {
  InterfaceAutomaton mutex({"lock", "unlock"}, {}, 2);
  mutex.add_transition(0, input(0), 1);
  mutex.add_transition(1, input(1), 0);
  return mutex;
}

InterfaceAutomaton make_semaphore(std::uint32_t count) {
  InterfaceAutomaton semaphore({"acquire", "release"}, {}, std::size_t{count} + 1);
  for (StateId taken = 0; taken < count; ++taken) {
    semaphore.add_transition(taken, input(0), taken + 1);
    semaphore.add_transition(taken + 1, input(1), taken);
  }
  return semaphore;
}

double queue_states(const QueueSize& queue) {
  const double letters = queue.values.empty() ? 1 : static_cast<double>(queue.values.size());
  double words = 0, longest = 1;
  for (std::uint32_t length = 0; length <= queue.size; ++length, longest *= letters)
    words += longest;
  // Contents when nobody waits, contents behind a message that is due, a reader that waits.
  return words + (words - longest / letters) * letters + 1;
}

InterfaceAutomaton make_queue(const QueueSize& queue) {
  std::vector<std::string> inputs, outputs;
  for (const std::string& value : queue.values) {
    inputs.push_back("write" + value);
    outputs.push_back("message" + value);
  }
  if (queue.values.empty()) {
    inputs = {"write"};
    outputs = {"message"};
  }
  const auto letters = static_cast<Symbol>(inputs.size());
  inputs.emplace_back("read");
  InterfaceAutomaton automaton(Alphabet(std::span<const std::string>(inputs)),
                               Alphabet(std::span<const std::string>(outputs)), 0);
  automaton.actors = {{"writer", {inputs.begin(), inputs.end() - 1}, {}},
                      {"reader", {"read"}, outputs}};

  // A state: what is kept, oldest first, and what the reader has: nothing, a read that waits, or
  // the message with that number.
  constexpr Symbol idle = ~Symbol{0}, waiting = idle - 1;
  using Kept = std::pair<Word, Symbol>;
  std::map<Kept, StateId> states;
  std::vector<Kept> met;
  const auto state_of = [&](Kept kept) {
    const auto [place, is_new] = states.try_emplace(kept, static_cast<StateId>(met.size()));
    if (is_new) {
      automaton.add_state();
      met.push_back(std::move(kept));
    }
    return place->second;
  };
  state_of({{}, idle});
  for (StateId state = 0; state < met.size(); ++state) {
    const Kept kept = met[state];
    if (kept.second < letters) {
      automaton.add_transition(state, output(kept.second), state_of({kept.first, idle}));
      continue;
    }
    for (Symbol letter = 0; letter < letters; ++letter) {
      Kept next = kept;
      if (kept.second == waiting) {
        next.second = letter;
      } else if (kept.first.size() < queue.size) {
        next.first.push_back(letter);
      } else if (queue.drops_oldest) {
        next.first.erase(next.first.begin());
        next.first.push_back(letter);
      } else {
        continue;
      }
      automaton.add_transition(state, input(letter), state_of(std::move(next)));
    }
    if (kept.second == waiting) continue;
    Kept next = kept;
    if (kept.first.empty()) {
      next.second = waiting;
    } else {
      next.second = kept.first.front();
      next.first.erase(next.first.begin());
    }
    automaton.add_transition(state, input(letters), state_of(std::move(next)));
  }
  return automaton;
}

bool is_of_writer(const InterfaceAutomaton& model, const std::string& name) {
  // "write(3)" is the writer's if "write" is, and the other way round.
  const auto names = [&](const std::vector<std::string>& symbols) {
    return std::any_of(symbols.begin(), symbols.end(), [&](const std::string& symbol) {
      return symbol.substr(0, symbol.find('(')) == name.substr(0, name.find('('));
    });
  };
  return std::any_of(model.actors.begin(), model.actors.end(), [&](const Actor& actor) {
    return actor.name == "writer" && (names(actor.inputs) || names(actor.outputs));
  });
}

namespace {

class Collector {
 public:
  explicit Collector(const InterfaceAutomaton& model) : model_(model) {
    for (const std::string& name : model.outputs().names()) {
      is_written_.push_back(is_of_writer(model, name));
    }
    for (const std::string& name : model.inputs().names()) {
      is_write_.push_back(is_of_writer(model, name));
    }
  }

  CollectedModel run() {
    result_.automaton = InterfaceAutomaton(model_.inputs(), model_.outputs(), 0);
    result_.automaton.actors = model_.actors;
    result_.automaton.origin = model_.origin;
    result_.automaton.hidden_returns = model_.hidden_returns;
    state_of({model_.initial(), std::nullopt});
    for (StateId state = 0; state < met_.size(); ++state) expand(state);
    for (StateId state = 0; state < met_.size(); ++state) {
      result_.collected.push_back(met_[state].second);
      result_.cleared.push_back(met_[state].second ? states_.at({met_[state].first, std::nullopt})
                                                   : state);
    }
    return std::move(result_);
  }

 private:
  using Collected = std::pair<StateId, std::optional<Symbol>>;

  StateId state_of(const Collected& collected) {
    const auto [place, is_new] = states_.try_emplace(collected, static_cast<StateId>(met_.size()));
    if (is_new) {
      result_.automaton.add_state();
      met_.push_back(collected);
      if (collected.second) state_of({collected.first, std::nullopt});  // behind the taking
    }
    return place->second;
  }

  // The states after what is due to the writer was collected.
  void settle(const Collected& at, std::vector<Collected>& settled) {
    bool is_settled = true;
    for (const auto& transition : model_.transitions(at.first)) {
      if (transition.action.is_input() || !is_written_[transition.action.symbol]) continue;
      is_settled = false;
      settle({transition.target, transition.action.symbol}, settled);
    }
    if (is_settled && std::find(settled.begin(), settled.end(), at) == settled.end()) {
      settled.push_back(at);
    }
  }

  void expand(StateId state) {
    const Collected at = met_[state];
    for (const auto& transition : model_.transitions(at.first)) {
      const bool is_write = transition.action.is_input() && is_write_[transition.action.symbol];
      if (is_write && at.second) continue;
      std::vector<Collected> settled;
      settle({transition.target, at.second}, settled);
      for (const Collected& next : settled) {
        result_.automaton.add_transition(state, transition.action, state_of(next),
                                         transition.absorbed);
      }
    }
    for (const Symbol input : model_.unexplored(at.first)) {
      if (!is_write_[input] || !at.second) result_.automaton.mark_unexplored(state, input);
    }
  }

  const InterfaceAutomaton& model_;
  std::vector<bool> is_written_, is_write_;  // by output, by input: the writer's
  CollectedModel result_;
  std::map<Collected, StateId> states_;
  std::vector<Collected> met_;
};

}  // namespace

CollectedModel collect_writes(const InterfaceAutomaton& model) {
  const bool has_writer = std::any_of(model.actors.begin(), model.actors.end(),
                                      [](const Actor& actor) { return actor.name == "writer"; });
  if (!has_writer) throw UsageError("a topic's model names its actors, and one is the \"writer\"");
  return Collector(model).run();
}

}  // namespace maide
