#include "maide/check/language/built_in_models.hpp"

#include <algorithm>
#include <map>
#include <utility>

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

}  // namespace maide
