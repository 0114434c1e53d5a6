#include "maide/check/ltl/ltl_automaton.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <ostream>
#include <set>
#include <utility>

#include "maide/base/invariant.hpp"
#include "maide/base/version.hpp"
#include "maide/formats/names.hpp"

namespace maide {
namespace {

// The automaton together with a run, as a graph: a node is a state and the position that it reads.
class RunGraph {
 public:
  RunGraph(const LtlAutomaton& automaton, const std::vector<std::uint64_t>& valuations,
           std::size_t loop)
      : automaton_(automaton), valuations_(valuations), loop_(loop) {}

  std::size_t size() const { return automaton_.states.size() * valuations_.size(); }
  std::size_t node(std::uint32_t state, std::size_t at) const {
    return state * valuations_.size() + at;
  }
  std::size_t edge_count(std::size_t node) const { return transitions(node).size(); }
  // Of the node's transition of that number: whether it can be taken, where it leads, its marks.
  bool is_edge(std::size_t node, std::size_t number) const {
    return transitions(node)[number].letter.allows(valuations_[node % valuations_.size()]);
  }
  std::size_t target(std::size_t from, std::size_t number) const {
    const std::size_t next = from % valuations_.size() + 1;
    return node(transitions(from)[number].target, next < valuations_.size() ? next : loop_);
  }
  std::uint64_t marks(std::size_t node, std::size_t number) const {
    return transitions(node)[number].marks;
  }

 private:
  const std::vector<LtlAutomaton::Transition>& transitions(std::size_t node) const {
    return automaton_.states[node / valuations_.size()];
  }

  const LtlAutomaton& automaton_;
  const std::vector<std::uint64_t>& valuations_;
  std::size_t loop_;
};

// Tarjan's search (SIAM J. Comput. 1972) for a component with an edge inside and every mark. The
// stack is a vector: runs may be long.
class ComponentSearch {
 public:
  ComponentSearch(const RunGraph& graph, std::uint64_t all_marks)
      : graph_(graph), all_(all_marks), index_(graph.size()), component_(graph.size()) {}

  bool is_accepting_from(std::size_t root) {
    if (index_[root] != 0) return false;
    enter(root);
    while (!calls_.empty()) {
      Call& call = calls_.back();
      if (call.edge == graph_.edge_count(call.node)) {
        if (leave()) return true;
        continue;
      }
      MAIDE_CHECK(call.low <= index_[call.node] && component_[call.node] == 0);
      const std::size_t edge = call.edge++;
      if (!graph_.is_edge(call.node, edge)) continue;
      const std::size_t target = graph_.target(call.node, edge);
      if (index_[target] == 0) {
        enter(target);
      } else if (component_[target] == 0) {
        call.low = std::min(call.low, index_[target]);
      }
    }
    MAIDE_CHECK(open_.empty());  // every component that was entered is closed
    return false;
  }

 private:
  struct Call {
    std::size_t node, edge, low;
  };

  void enter(std::size_t node) {
    index_[node] = ++visited_;
    open_.push_back(node);
    calls_.push_back({node, 0, index_[node]});
  }

  // Ends the last call; true if it closes a component that accepts.
  bool leave() {
    const Call call = calls_.back();
    calls_.pop_back();
    if (!calls_.empty()) calls_.back().low = std::min(calls_.back().low, call.low);
    if (call.low != index_[call.node]) return false;
    ++components_;
    std::vector<std::size_t> nodes;
    do {
      nodes.push_back(open_.back());
      component_[open_.back()] = components_;
      open_.pop_back();
    } while (nodes.back() != call.node);
    bool has_edge = false;
    std::uint64_t marks = 0;
    for (const std::size_t node : nodes) {
      for (std::size_t edge = 0; edge < graph_.edge_count(node); ++edge) {
        if (!graph_.is_edge(node, edge)) continue;
        if (component_[graph_.target(node, edge)] != components_) continue;
        has_edge = true;
        marks |= graph_.marks(node, edge);
      }
    }
    return has_edge && marks == all_;
  }

  const RunGraph& graph_;
  std::uint64_t all_;
  std::vector<std::size_t> index_;      // 0: not yet visited
  std::vector<std::size_t> component_;  // 0: not yet closed
  std::size_t visited_ = 0, components_ = 0;
  std::vector<std::size_t> open_;
  std::vector<Call> calls_;
};

}  // namespace

std::uint64_t LtlAutomaton::all_marks() const {
  return mark_count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << mark_count) - 1;
}

namespace {

bool accepts_everything(const LtlAutomaton& automaton, std::uint32_t state) {
  const auto& transitions = automaton.states[state];
  return std::any_of(transitions.begin(), transitions.end(), [&](const auto& transition) {
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
  return std::all_of(automaton.initial.begin(), automaton.initial.end(), is_state) &&
         std::all_of(automaton.states.begin(), automaton.states.end(), [&](const auto& state) {
           return std::all_of(state.begin(), state.end(), is_good);
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

namespace {

// Whether a path of at least one transition to another state comes back to `state`.
bool comes_back(const LtlAutomaton& automaton, std::uint32_t state) {
  std::vector<bool> seen(automaton.states.size(), false);
  std::vector<std::uint32_t> open;
  const auto follow = [&](std::uint32_t from) {
    for (const auto& transition : automaton.states[from]) {
      if (transition.target == from || seen[transition.target]) continue;
      seen[transition.target] = true;
      open.push_back(transition.target);
    }
  };
  follow(state);
  while (!open.empty() && !seen[state]) {
    const std::uint32_t from = open.back();
    open.pop_back();
    follow(from);
  }
  return seen[state];
}

}  // namespace

std::vector<bool> find_waiting(const LtlAutomaton& automaton) {
  constexpr std::size_t most_states = 1000;
  std::vector<bool> waiting(automaton.states.size(), false);
  if (automaton.states.size() > most_states) return waiting;
  std::uint64_t events = 0;
  for (std::size_t i = 0; i < automaton.atoms.size(); ++i) {
    if (automaton.atoms[i].is_event()) events |= std::uint64_t{1} << i;
  }
  for (std::uint32_t state = 0; state < automaton.states.size(); ++state) {
    std::uint64_t marks = 0, letters = 0;
    bool may_stay = false;
    for (const auto& transition : automaton.states[state]) {
      letters |= transition.letter.positive | transition.letter.negative;
      if (transition.target != state) continue;
      marks |= transition.marks;
      may_stay = may_stay || transition.letter == Letter();
    }
    waiting[state] = may_stay && marks != automaton.all_marks() && (letters & events) == 0 &&
                     !comes_back(automaton, state);
  }
  return waiting;
}

bool accepts(const LtlAutomaton& automaton, const std::vector<std::uint64_t>& valuations,
             std::size_t loop) {
  MAIDE_CHECK(loop < valuations.size());
  const RunGraph graph(automaton, valuations, loop);
  ComponentSearch search(graph, automaton.all_marks());
  return std::any_of(automaton.initial.begin(), automaton.initial.end(), [&](std::uint32_t state) {
    return search.is_accepting_from(graph.node(state, 0));
  });
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

std::string atom_text(const Atom& atom, const FormulaScope& scope) {
  FormulaNode node;
  node.op = FormulaNode::Operator::atom;
  node.atom = atom;
  return to_string(std::make_shared<const FormulaNode>(node), scope);
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
  for (const Atom& atom : automaton.atoms) out << " " << quoted(atom_text(atom, scope));
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
