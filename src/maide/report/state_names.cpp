#include "maide/report/state_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <map>
#include <optional>

#include "maide/base/text.hpp"
#include "maide/check/verdict/message_account.hpp"

namespace maide {
namespace {

// A shortest word to each state, by breadth-first search. `visit(state, take)` calls
// take(name, target) for each step from the state.
template <typename Visit>
std::vector<std::vector<std::string>> find_access_words(std::size_t size, StateId initial,
                                                        Visit&& visit) {
  std::vector<std::vector<std::string>> words(size);
  std::vector<bool> seen(size);
  std::deque<StateId> open{initial};
  seen[initial] = true;
  while (!open.empty()) {
    const StateId from = open.front();
    open.pop_front();
    visit(from, [&](const std::string& name, StateId target) {
      if (seen[target]) return;
      seen[target] = true;
      words[target] = words[from];
      words[target].push_back(name);
      open.push_back(target);
    });
  }
  return words;
}

// How many of one actor's outputs can be had from each state by giving this actor's inputs; nothing
// where some state has no most.
std::optional<std::vector<std::size_t>> count_held(const InterfaceAutomaton& automaton,
                                                   const Actor& actor) {
  Awaited awaited;
  for (const std::string& name : actor.inputs) {
    if (const auto input = automaton.inputs().find(name)) awaited.asking.push_back(*input);
  }
  if (awaited.asking.empty()) return std::nullopt;
  std::ranges::sort(awaited.asking);
  // Outputs that come again and again without anything given ("null", "written") count nothing.
  for (const std::string& name : actor.outputs) {
    const auto output = automaton.outputs().find(name);
    if (!output) continue;
    Awaited alone = awaited;
    alone.outputs = {*output};
    const auto counts = count_obtainable(automaton, alone);
    if (std::ranges::all_of(counts, [](const auto& count) { return !!count; })) {
      awaited.outputs.push_back(*output);
    }
  }
  if (awaited.outputs.empty()) return std::nullopt;
  std::ranges::sort(awaited.outputs);
  std::vector<std::size_t> held;
  for (const auto& count : count_obtainable(automaton, awaited)) {
    if (!count) return std::nullopt;
    held.push_back(*count);
  }
  if (std::ranges::all_of(held, [](std::size_t count) { return count == 0; })) {
    return std::nullopt;
  }
  return held;
}

// Whether the actor is in a call: at rest the state takes none of its inputs, tried or not.
bool waits(const InterfaceAutomaton& automaton, const Actor& actor, StateId state) {
  if (!automaton.is_quiescent(state) || actor.inputs.empty()) return false;
  const auto is_of_actor = [&](Symbol input) {
    const std::string& name = automaton.inputs().name(input);
    return std::ranges::find(actor.inputs, name) != actor.inputs.end();
  };
  for (const auto& transition : automaton.transitions(state)) {
    if (transition.action.is_input() && is_of_actor(transition.action.symbol)) return false;
  }
  const auto& untried = automaton.unexplored(state);
  return std::ranges::none_of(untried, is_of_actor);
}

std::vector<std::string> describe_states(const InterfaceAutomaton& automaton) {
  std::vector<std::optional<std::vector<std::size_t>>> held;
  for (const Actor& actor : automaton.actors) held.push_back(count_held(automaton, actor));
  const std::size_t holders = static_cast<std::size_t>(
      std::ranges::count_if(held, [](const auto& counts) { return !!counts; }));
  std::vector<std::string> names;
  for (StateId state = 0; state < automaton.size(); ++state) {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < held.size(); ++i) {
      if (!held[i]) continue;
      const std::size_t count = (*held[i])[state];
      const std::string whose = holders > 1 ? " for " + automaton.actors[i].name : "";
      parts.push_back(count == 0 ? "empty" + whose : fmt::format("holds {}{}", count, whose));
    }
    for (const Actor& actor : automaton.actors) {
      if (waits(automaton, actor, state)) parts.push_back(actor.name + " waits");
    }
    for (const auto& transition : automaton.transitions(state)) {
      if (transition.action.is_input()) continue;
      parts.push_back(automaton.outputs().name(transition.action.symbol) + " due");
    }
    names.push_back(join(parts));
  }
  return names;
}

// Where names are empty or come twice, the word takes their place or stands behind them.
std::vector<std::string> tell_apart(std::vector<std::string> names,
                                    const std::vector<std::vector<std::string>>& words) {
  std::map<std::string, std::size_t> uses;
  for (const std::string& name : names) ++uses[name];
  for (std::size_t state = 0; state < names.size(); ++state) {
    if (names[state].empty()) {
      names[state] = describe_word(words[state]);
    } else if (uses[names[state]] > 1) {
      names[state] += " (" + describe_word(words[state]) + ")";
    }
  }
  return names;
}

}  // namespace

std::string describe_word(const std::vector<std::string>& word) {
  if (word.empty()) return "at the start";
  std::string text;
  for (std::size_t i = 0; i < word.size();) {
    std::size_t end = i + 1;
    while (end < word.size() && word[end] == word[i]) ++end;
    text += (text.empty() ? "after " : ", ") + word[i];
    if (end - i == 2) text += " twice";
    if (end - i > 2) text += fmt::format(" {} times", end - i);
    i = end;
  }
  return text;
}

std::vector<std::string> name_states(const InterfaceAutomaton& automaton) {
  const auto words =
      find_access_words(automaton.size(), automaton.initial(), [&](StateId from, auto&& take) {
        for (const auto& transition : automaton.transitions(from)) {
          const std::string name = automaton.name(transition.action);
          take(transition.action.is_input() ? name.substr(1) : name, transition.target);
        }
      });
  return tell_apart(describe_states(automaton), words);
}

std::vector<std::string> name_states(const NondeterministicMealy& machine) {
  const auto words =
      find_access_words(machine.size(), machine.initial(), [&](StateId from, auto&& take) {
        for (Symbol input = 0; input < machine.inputs().size(); ++input) {
          for (const auto& choice : machine.choices(from, input)) {
            take(machine.inputs().name(input), choice.target);
          }
        }
      });
  return tell_apart(std::vector<std::string>(machine.size()), words);
}

}  // namespace maide
