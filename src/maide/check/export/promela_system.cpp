#include "maide/check/export/promela_system.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "maide/base/error.hpp"
#include "maide/base/text_cursor.hpp"
#include "maide/check/export/promela_text.hpp"

namespace maide {
namespace {

constexpr std::size_t longest_name = 40;  // of a name's bytes in its identifier

// What the text itself uses, what the translator of formulas reads, and what C makes of it.
std::vector<std::string_view> reserved_words() {
  const auto promela = promela_reserved();
  std::vector<std::string_view> words(promela.begin(), promela.end());
  words.insert(words.end(), {"InChannel", "OutChannel", "quiet", "event", "cut", "idling"});
  words.insert(words.end(), {"none", "is_halted", "no_more_deaths", "survival"});
  words.insert(words.end(), {"and", "or", "not", "next", "strong", "cond_expr", "R"});
  words.insert(words.end(), {"const", "define", "ifdef", "include"});
  return words;
}

// Labels with a meaning for SPIN, and the names of labels and macros of the text: s0, p0, is_cut.
// Of bytes that are not ASCII some are left out of identifiers, so they might hide one of these.
bool may_have_a_meaning(std::string_view word) {
  for (const std::string_view prefix : {"end", "accept", "progress", "T0", "is_cut", "never"}) {
    if (word.starts_with(prefix)) return true;
  }
  if (word.size() > 1 && (word[0] == 's' || word[0] == 'p') &&
      std::all_of(word.begin() + 1, word.end(), is_digit)) {
    return true;
  }
  return std::any_of(word.begin(), word.end(),
                     [](char c) { return static_cast<unsigned char>(c) >= 0x80; });
}

}  // namespace

PromelaNames::PromelaNames() : identifiers_(reserved_words()) {}

const std::string& PromelaNames::of(std::string_view prefix, std::string_view name) {
  const auto [entry, is_new] =
      known_.try_emplace({std::string(prefix), std::string(name)}, std::string());
  if (is_new) entry->second = another(prefix, name);
  return entry->second;
}

std::string PromelaNames::another(std::string_view prefix, std::string_view name) {
  std::string word = std::string(prefix) + std::string(name.substr(0, longest_name));
  if (may_have_a_meaning(word)) word.insert(0, "n_");
  return identifiers_.unique(word);
}

std::string promela_comment(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 32 || c == '/' || c == '\\') c = c == '/' ? '|' : ' ';
  }
  return text;
}

void PromelaText::line(const std::string& text, const PromelaLine& meaning) {
  result_.text += text;
  result_.text += '\n';
  result_.lines.push_back(meaning);
}

void PromelaText::heading(const System& system, PromelaOptions::Purpose purpose) {
  const auto describe = [&] {
    switch (purpose) {
      case PromelaOptions::Purpose::deadlock: return "deadlocks are its invalid end states";
      case PromelaOptions::Purpose::error: return "an assertion fails at an error";
      case PromelaOptions::Purpose::cut:
        return "an assertion fails where a run leaves what was learned";
      case PromelaOptions::Purpose::ltl: return "for a never claim";
    }
    return "";
  };
  line(fmt::format("/* {}: {} */", promela_comment(system.file), describe()));
}

void PromelaText::idling(std::string_view head, bool has_events) {
  line("");
  line(fmt::format("{} idling() {{", head));
  line(fmt::format("end_idle: do :: atomic {{ timeout -> {} }} od",
                   has_events ? "event = 0" : "skip"));
  line("}");
}

namespace {

// In SPIN's words, over p0, p1, ...; each literal holds in a cut run.
std::string claim_text(const Formula& formula, const std::vector<Atom>& atoms, bool has_cuts) {
  using Operator = FormulaNode::Operator;
  const auto literal = [&](const Atom& atom, const char* sign) {
    const auto number = std::lower_bound(atoms.begin(), atoms.end(), atom) - atoms.begin();
    return fmt::format("({}p{}{})", sign, number, has_cuts ? " || is_cut" : "");
  };
  const auto part = [&](const Formula& operand) { return claim_text(operand, atoms, has_cuts); };
  const auto binary = [&](const char* op) {
    return fmt::format("({} {} {})", part(formula->left), op, part(formula->right));
  };
  switch (formula->op) {
    case Operator::truth: return "true";
    case Operator::falsity: return has_cuts ? "is_cut" : "false";
    case Operator::atom: return literal(formula->atom, "");
    case Operator::negation: return literal(formula->left->atom, "!");
    case Operator::conjunction: return binary("&&");
    case Operator::disjunction: return binary("||");
    case Operator::until:
      return formula->left->op == Operator::truth ? fmt::format("(<> {})", part(formula->right))
                                                  : binary("U");
    case Operator::release:
      return formula->left->op == Operator::falsity ? fmt::format("([] {})", part(formula->right))
                                                    : binary("V");
    default: throw UsageError("SPIN checks no formula with X");
  }
}

}  // namespace

void PromelaText::claim(const Formula& formula, const std::vector<std::string>& expressions,
                        bool has_cuts) {
  line("");
  for (std::size_t number = 0; number < expressions.size(); ++number) {
    line(fmt::format("#define p{} ({})", number, expressions[number]));
  }
  if (has_cuts) line("#define is_cut (cut)");
  result_.claim =
      "!(" + claim_text(negation_normal_form(formula), atoms_of(formula), has_cuts) + ")";
}

PromelaSystem write_promela(const System& system, const PromelaOptions& options) {
  bool has_steps = uses_second_edition(system);
  for (const Atom& atom : options.formula ? atoms_of(options.formula) : std::vector<Atom>{}) {
    has_steps =
        has_steps || atom.kind == Atom::Kind::expression || atom.program != Atom::any_program;
  }
  return has_steps ? write_promela_steps(system, options)
                   : write_promela_rendezvous(system, options);
}

}  // namespace maide
