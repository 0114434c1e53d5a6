#include "maide/check/ltl/ltl_automaton.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <ostream>
#include <set>
#include <utility>

#include "maide/base/invariant.hpp"
#include "maide/base/strong_components.hpp"
#include "maide/base/version.hpp"
#include "maide/formats/names.hpp"

namespace maide {

std::uint64_t LtlAutomaton::all_marks() const {
  return mark_count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << mark_count) - 1;
}

namespace {

bool accepts_everything(const LtlAutomaton& automaton, std::uint32_t state) {
  const auto& transitions = automaton.states[state];
  return std::ranges::any_of(transitions, [&](const auto& transition) {
    return transition.target == state && transition.letter == Letter() &&
           transition.marks == automaton.all_marks();
  });
}

// Whether all letters, targets and marks are those of the automaton.
bool is_well_formed(const LtlAutomaton& automaton) {
  if (automaton.atoms.size() > max_automaton_atoms || automaton.mark_count > 64) return false;
  const std::size_t count = automaton.atoms.size();
  const std::uint64_t atoms = count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
  const auto is_state = [&](std::uint32_t state) { return state < automaton.states.size(); };
  const auto is_good = [&](const LtlAutomaton::Transition& transition) {
    const Letter& letter = transition.letter;
    return ((letter.positive | letter.negative) & ~atoms) == 0 && !letter.is_contradiction() &&
           is_state(transition.target) && (transition.marks & ~automaton.all_marks()) == 0;
  };
  return std::ranges::all_of(automaton.initial, is_state) &&
         std::ranges::all_of(automaton.states, [&](const auto& state) {
           return std::ranges::all_of(state, is_good);
         });
}

}  // namespace

std::uint32_t find_universal(const LtlAutomaton& automaton) {
  MAIDE_CHECK(is_well_formed(automaton));  // every automaton comes here when it is made
  for (std::uint32_t state = 0; state < automaton.states.size(); ++state) {
    if (accepts_everything(automaton, state)) return state;
  }
  return LtlAutomaton::no_state;
}

std::vector<bool> find_waiting(const LtlAutomaton& automaton) {
  constexpr std::size_t most_states = 1000;
  std::vector<bool> waiting(automaton.states.size(), false);
  if (automaton.states.size() > most_states) return waiting;
  std::uint64_t events = 0;
  for (std::size_t i = 0; i < automaton.atoms.size(); ++i) {
    if (automaton.atoms[i].is_event()) events |= std::uint64_t{1} << i;
  }
  const auto successors = [&](std::size_t state) {
    std::vector<std::size_t> targets;
    for (const auto& transition : automaton.states[state]) targets.push_back(transition.target);
    return targets;
  };
  std::vector<std::size_t> states(automaton.states.size());
  std::iota(states.begin(), states.end(), 0);
  for (const auto& component : strong_components(states.size(), states, successors)) {
    if (component.size() > 1) continue;  // a path leads back
    const std::size_t state = component.front();
    std::uint64_t marks = 0, letters = 0;
    bool may_stay = false;
    for (const auto& transition : automaton.states[state]) {
      letters |= transition.letter.positive | transition.letter.negative;
      if (transition.target != state) continue;
      marks |= transition.marks;
      may_stay = may_stay || transition.letter == Letter();
    }
    waiting[state] = may_stay && marks != automaton.all_marks() && (letters & events) == 0;
  }
  return waiting;
}

bool accepts_nothing(const LtlAutomaton& automaton) {
  const auto successors = [&](std::size_t state) {
    std::vector<std::size_t> targets;
    for (const auto& transition : automaton.states[state]) targets.push_back(transition.target);
    return targets;
  };
  const std::vector<std::size_t> starts(automaton.initial.begin(), automaton.initial.end());
  const auto components = strong_components(automaton.states.size(), starts, successors);
  return std::ranges::none_of(components, [&](const std::vector<std::size_t>& component) {
    bool has_edge = false;
    std::uint64_t marks = 0;
    for (const std::size_t state : component) {
      for (const auto& transition : automaton.states[state]) {
        if (!std::ranges::binary_search(component, transition.target)) continue;
        has_edge = true;
        marks |= transition.marks;
      }
    }
    return has_edge && marks == automaton.all_marks();
  });
}

// The automaton together with the run is a graph: a node is a state and the position that it reads.
// A component accepts if it has an edge inside and every mark.
bool accepts(const LtlAutomaton& automaton, const std::vector<std::uint64_t>& valuations,
             std::size_t loop) {
  MAIDE_CHECK(loop < valuations.size());
  const std::size_t length = valuations.size();
  const auto for_each_edge = [&](std::size_t node, const auto& visit) {
    const std::size_t at = node % length, next = at + 1 < length ? at + 1 : loop;
    for (const LtlAutomaton::Transition& transition : automaton.states[node / length]) {
      if (!transition.letter.allows(valuations[at])) continue;
      visit(transition.target * length + next, transition.marks);
    }
  };
  const auto successors = [&](std::size_t node) {
    std::vector<std::size_t> targets;
    for_each_edge(node, [&](std::size_t target, std::uint64_t) { targets.push_back(target); });
    return targets;
  };
  const auto is_accepting = [&](const std::vector<std::size_t>& component) {
    bool has_edge = false;
    std::uint64_t marks = 0;
    for (const std::size_t node : component) {
      for_each_edge(node, [&](std::size_t target, std::uint64_t of_edge) {
        if (!std::ranges::binary_search(component, target)) return;
        has_edge = true;
        marks |= of_edge;
      });
    }
    return has_edge && marks == automaton.all_marks();
  };
  std::vector<std::size_t> starts;
  for (const std::uint32_t state : automaton.initial) starts.push_back(state * length);
  return std::ranges::any_of(
      strong_components(automaton.states.size() * length, starts, successors), is_accepting);
}

bool accepts_whatever_comes(const LtlAutomaton& automaton,
                            const std::vector<std::uint64_t>& valuations) {
  std::set<std::uint32_t> states(automaton.initial.begin(), automaton.initial.end());
  for (const std::uint64_t valuation : valuations) {
    std::set<std::uint32_t> next;
    for (const std::uint32_t state : states) {
      for (const auto& transition : automaton.states[state]) {
        if (transition.letter.allows(valuation)) next.insert(transition.target);
      }
    }
    states = std::move(next);
  }
  return states.contains(automaton.universal);
}

// Line by line, in the order of the automaton, so that equal automata give the same bytes.

namespace {

// Strings have no escapes for line breaks.
std::string quoted(std::string_view text) {
  std::string line(text);
  for (char& c : line) c = c == '\n' || c == '\r' ? ' ' : c;
  return quote_name(line);
}

std::string label_text(const Letter& letter, std::size_t atoms) {
  std::string text;
  for (std::size_t atom = 0; atom < atoms; ++atom) {
    const bool is_positive = (letter.positive >> atom & 1) != 0;
    if (!is_positive && (letter.negative >> atom & 1) == 0) continue;
    text += fmt::format("{}{}{}", text.empty() ? "" : "&", is_positive ? "" : "!", atom);
  }
  return text.empty() ? "t" : text;
}

std::string acceptance(unsigned marks) {
  std::string text;
  for (unsigned mark = 0; mark < marks; ++mark) {
    text += fmt::format("{}Inf({})", mark == 0 ? "" : "&", mark);
  }
  const std::string name = marks == 0   ? "all"
                           : marks == 1 ? "Buchi"
                                        : fmt::format("generalized-Buchi {}", marks);
  return fmt::format("acc-name: {}\nAcceptance: {} {}\n", name, marks, marks == 0 ? "t" : text);
}

}  // namespace

void write_hoa(std::ostream& out, const LtlAutomaton& automaton, const FormulaScope& scope,
               std::string_view name) {
  out << "HOA: v1\n";
  if (!name.empty()) out << "name: " << quoted(name) << "\n";
  out << "tool: \"maide\" " << quoted(version()) << "\nStates: " << automaton.states.size() << "\n";
  for (const std::uint32_t state : automaton.initial) out << "Start: " << state << "\n";
  out << "AP: " << automaton.atoms.size();
  for (const Atom& atom : automaton.atoms)
    out << " " << quoted(to_string(make_formula(atom), scope));
  out << "\n"
      << acceptance(automaton.mark_count)
      << "properties: trans-labels explicit-labels trans-acc\n--BODY--\n";
  for (std::uint32_t state = 0; state < automaton.states.size(); ++state) {
    out << "State: " << state << "\n";
    for (const auto& transition : automaton.states[state]) {
      out << "  [" << label_text(transition.letter, automaton.atoms.size()) << "] "
          << transition.target;
      std::string marks;
      for (unsigned mark = 0; mark < automaton.mark_count; ++mark) {
        if ((transition.marks >> mark & 1) == 0) continue;
        marks += (marks.empty() ? "" : " ") + std::to_string(mark);
      }
      out << (marks.empty() ? "" : " {" + marks + "}") << "\n";
    }
  }
  out << "--END--\n";
}

}  // namespace maide
