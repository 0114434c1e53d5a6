// Line by line, in the order of the automaton, so that equal automata give the same bytes.
#include <fmt/format.h>

#include <ostream>

#include "maide/base/version.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "maide/formats/names.hpp"

namespace maide {
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
