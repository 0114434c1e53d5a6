// The reader of automata against damaged files: random edits of good ones, with fixed seeds. It
// throws ParseError, or gives an automaton that is written and read back unchanged.
#include <gtest/gtest.h>

#include <array>
#include <sstream>

#include "maide/check/ltl/ltl_automaton.hpp"
#include "random_formula.hpp"

namespace maide {
namespace {

constexpr std::array<std::string_view, 34> fragments{"HOA: v1",
                                                     "States: ",
                                                     "Start: ",
                                                     "AP: 1 \"p@a0\"",
                                                     "Acceptance: ",
                                                     "Inf(",
                                                     "Fin(",
                                                     "--BODY--",
                                                     "--END--",
                                                     "State: ",
                                                     "[",
                                                     "]",
                                                     "{",
                                                     "}",
                                                     "0",
                                                     "1",
                                                     "63",
                                                     "99999999999",
                                                     "!",
                                                     "&",
                                                     "|",
                                                     "(",
                                                     ")",
                                                     "t",
                                                     "f",
                                                     "@a",
                                                     "Alias: @a ",
                                                     "\"",
                                                     "/*",
                                                     "*/",
                                                     "\\",
                                                     "name:",
                                                     "Unknown: 1",
                                                     "\xff"};

std::string write(const LtlAutomaton& automaton, const FormulaScope& scope) {
  std::ostringstream out;
  write_hoa(out, automaton, scope, "a \"name\"");
  return out.str();
}

TEST(FuzzHoa, DamagedFilesAreRefusedOrUnderstood) {
  const test::FormulaAtoms atoms;
  Random random(31);
  int accepted = 0;
  constexpr int rounds = 20000;
  for (int round = 0; round < rounds; ++round) {
    std::string text = write(translate(test::random_formula(random, 3)), atoms.scope());
    for (std::uint64_t edits = random.between(1, 4); edits > 0; --edits) {
      const std::size_t place = random.below(text.size() + 1);
      const std::size_t length = std::min<std::size_t>(random.below(12), text.size() - place);
      switch (random.below(4)) {
        case 0:
          if (place < text.size()) text[place] = static_cast<char>(random.below(256));
          break;
        case 1: text.erase(place, length); break;
        case 2: text.insert(random.below(text.size() + 1), text.substr(place, length)); break;
        default: text.replace(place, length, fragments[random.below(fragments.size())]);
      }
    }
    try {
      const LtlAutomaton automaton = read_hoa(text, "f.hoa", atoms.scope());
      ++accepted;
      const std::string written = write(automaton, atoms.scope());
      ASSERT_EQ(read_hoa(written, "f.hoa", atoms.scope()), automaton) << text;
    } catch (const ParseError& error) {
      ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << text;
    }
  }
  EXPECT_GT(accepted, rounds / 100);
  EXPECT_LT(accepted, rounds);
}

}  // namespace
}  // namespace maide
