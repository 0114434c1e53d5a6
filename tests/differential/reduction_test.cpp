// Reductions against the same engine without any, which other tests hold against the meaning of
// systems: the same verdict for every property, each kind of fairness, and never a larger graph.
// Whatever is left out, several threads find, count and show the same as one, and several ranks
// find the same. Formulas with assumptions of fairness have the verdicts of their plain automata.
#include "maide/check/reduce/reduction.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "explicit_checker.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/engines/export/promela_system.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "mailbox_ranks.hpp"
#include "random_system.hpp"

namespace maide {
namespace {

constexpr std::size_t node_limit = 800;

EngineOptions with(Reduction reduction) {
  EngineOptions options;
  options.reduction = reduction;
  return options;
}

// Threads of the second run of each search. Two states are worth one, so that small systems need
// several.
constexpr unsigned most_threads = 4;
EngineOptions with(Reduction reduction, unsigned threads) {
  EngineOptions options = with(reduction);
  options.threads = threads;
  options.states_a_thread = 2;
  return options;
}

// A formula over the system's labels and events, without X.
class RandomFormula {
 public:
  RandomFormula(const System& system, Random& random) : system_(system), random_(random) {}

  // Assumptions of fairness and what follows from them, one such formula or two. Few: a plain
  // automaton of many is large.
  std::string text_with_assumptions() {
    std::string assumptions = assumption();
    if (random_.chance(0.6)) assumptions += " && " + assumption();
    switch (random_.below(5)) {
      case 0: return "!(" + assumptions + " && " + assumption() + ")";
      case 1:
        return "(" + assumptions + " -> " + text(1) + ") && (" + assumption() + " -> " + text(1) +
               ")";
      default: return assumptions + " -> " + text(2);
    }
  }

  std::string text(int depth) {
    if (depth == 0 || random_.chance(0.1)) return atom();
    switch (random_.below(8)) {
      case 0: return "G " + text(depth - 1);
      case 1: return "F " + text(depth - 1);
      case 2: return "G F " + text(depth - 1);
      case 3: return "!" + text(depth - 1);
      case 4: return "(" + text(depth - 1) + " U " + text(depth - 1) + ")";
      case 5: return "(" + text(depth - 1) + " && " + text(depth - 1) + ")";
      case 6: return "(" + text(depth - 1) + " R " + text(depth - 1) + ")";
      default: return "(" + text(depth - 1) + " -> " + text(depth - 1) + ")";
    }
  }

 private:
  std::string assumption() {
    switch (random_.below(6)) {
      case 0: return "F G " + atom();
      case 1: return "(G F " + atom() + " || G F " + atom() + ")";
      case 2: return "(G F (" + atom() + " && " + atom() + ") -> G F " + atom() + ")";
      default: return "(G F " + atom() + " -> G F " + atom() + ")";
    }
  }
  std::string atom() {
    const Program& program = system_.programs[random_.below(system_.programs.size())];
    const std::string label =
        program.labels.empty() ? "end" : program.labels[random_.below(program.labels.size())];
    const ModelInstance& model = system_.models[random_.below(system_.models.size())];
    const std::string atoms[] = {model.name + ".i0", model.name + "!o0", program.name + "@end",
                                 program.name + "@" + label, program.name + "@" + label};
    return (random_.chance(0.4) ? "!" : "") + atoms[random_.below(5)];
  }

  const System& system_;
  Random& random_;
};

// Compares, and adds up what was saved.
class Comparison {
 public:
  void check(const System& system, const Property& property) {
    NativeEngine engine;
    const PropertyResult all = engine.check(system, property, with(Reduction::none));
    const bool is_cycle = property.kind == Property::Kind::stuck ||
                          (property.kind == Property::Kind::ltl && !invariant_of(property));
    if (is_cycle) {
      check_threads_for_cycle(system, property);
    } else {
      check_threads(system, property);
    }
    check_ranks(system, property, all, is_cycle);
    ++(all.verdict == Verdict::holds ? holds_ : violated_);
    for (const Reduction reduction : {Reduction::calls, Reduction::order, Reduction::full}) {
      const PropertyResult reduced = engine.check(system, property, with(reduction));
      ASSERT_EQ(reduced.verdict, all.verdict)
          << to_string(reduction) << " of " << property.name << ", fairness "
          << static_cast<int>(property.fairness) << "\n"
          << write_promela(system).text;
      if (all.verdict == Verdict::holds) {
        EXPECT_LE(reduced.states, all.states);
        all_states_ += all.states;
        reduced_states_ += reduced.states;
      } else if (all.trace && !all.trace->loop_start) {
        EXPECT_EQ(reduced.trace->loop_start, all.trace->loop_start);
      }
    }
  }
  // All that a result tells but its time and its memory.
  void check_threads(const System& system, const Property& property) {
    NativeEngine engine;
    const unsigned threads = 2 + holds_ % (most_threads - 1);
    for (const Reduction reduction :
         {Reduction::none, Reduction::calls, Reduction::order, Reduction::full}) {
      const PropertyResult one = engine.check(system, property, with(reduction, 1));
      const PropertyResult several = engine.check(system, property, with(reduction, threads));
      ASSERT_EQ(several.verdict, one.verdict) << write_promela(system).text;
      EXPECT_EQ(several.states, one.states);
      EXPECT_EQ(several.transitions, one.transitions);
      EXPECT_EQ(several.stays_within_learned, one.stays_within_learned);
      EXPECT_EQ(several.trace.has_value(), one.trace.has_value());
      if (one.trace) {
        EXPECT_EQ(several.trace->steps, one.trace->steps);
      }
    }
  }
  // In a search for a cycle one thread may find another run than several do, which all find the
  // same.
  void check_threads_for_cycle(const System& system, const Property& property) {
    NativeEngine engine;
    for (const Reduction reduction :
         {Reduction::none, Reduction::calls, Reduction::order, Reduction::full}) {
      const PropertyResult one = engine.check(system, property, with(reduction, 1));
      const PropertyResult two = engine.check(system, property, with(reduction, 2));
      const PropertyResult more = engine.check(system, property, with(reduction, most_threads));
      ASSERT_EQ(two.verdict, one.verdict)
          << to_string(reduction) << " of " << property.name << ", fairness "
          << static_cast<int>(property.fairness) << "\n"
          << write_promela(system).text;
      EXPECT_EQ(two.remarkable.has_value(), one.remarkable.has_value());
      if (one.verdict == Verdict::holds) {
        EXPECT_EQ(two.states, one.states) << property.name;
        EXPECT_EQ(two.transitions, one.transitions) << property.name;
      }
      ASSERT_EQ(more.verdict, two.verdict);
      EXPECT_EQ(more.states, two.states);
      EXPECT_EQ(more.transitions, two.transitions);
      expect_same(more.trace, two.trace);
      expect_same(more.remarkable, two.remarkable);
    }
  }
  static void expect_same(const std::optional<Trace>& left, const std::optional<Trace>& right) {
    ASSERT_EQ(left.has_value(), right.has_value());
    if (!left) return;
    EXPECT_EQ(left->steps, right->steps);
    EXPECT_EQ(left->loop_start, right->loop_start);
  }
  // 1 to 4 ranks, each with 1 or 2 threads: all counts where nothing is left out and the search
  // comes to its end; the verdict, and the length of a shortest run.
  void check_ranks(const System& system, const Property& property, const PropertyResult& all,
                   bool is_cycle) {
    NativeEngine engine;
    test::RanksOfThreads ranks(1 + checks_ % 4);
    for (const Reduction reduction :
         {Reduction::none, Reduction::calls, Reduction::order, Reduction::full}) {
      EngineOptions options = with(reduction, 1 + checks_ % 2);
      options.ranks = ranks.first();
      const PropertyResult several = engine.check(system, property, options);
      ASSERT_EQ(several.verdict, all.verdict)
          << to_string(reduction) << " of " << property.name << "\n"
          << write_promela(system).text;
      const PropertyResult one = engine.check(system, property, with(reduction, 1));
      ASSERT_EQ(several.trace.has_value(), one.trace.has_value());
      if (one.trace && !is_cycle) {
        EXPECT_EQ(several.trace->steps.size(), one.trace->steps.size());
      }
      if (reduction != Reduction::none || all.verdict != Verdict::holds) continue;
      EXPECT_EQ(several.states, all.states);
      EXPECT_EQ(several.transitions, all.transitions);
      EXPECT_EQ(several.stays_within_learned, all.stays_within_learned);
    }
    ++checks_;
  }
  void check_cut(const System& system) {
    NativeEngine engine;
    {
      test::RanksOfThreads ranks(2 + checks_ % 3);
      EngineOptions options = with(Reduction::none, 1);
      options.ranks = ranks.first();
      const CutResult found = engine.find_cut(system, options);
      const CutResult alone = engine.find_cut(system, with(Reduction::none));
      EXPECT_EQ(found.verdict, alone.verdict);
      if (alone.trace) {
        EXPECT_EQ(found.trace->steps.size(), alone.trace->steps.size());
      }
      ++checks_;
    }
    const CutResult several = engine.find_cut(system, with(Reduction::none, most_threads));
    const CutResult all = engine.find_cut(system, with(Reduction::none));
    ++(all.verdict == Verdict::holds ? holds_ : violated_);
    EXPECT_EQ(several.verdict, all.verdict);
    if (all.trace) {
      EXPECT_EQ(several.trace->steps, all.trace->steps);
    }
    for (const Reduction reduction : {Reduction::calls, Reduction::order, Reduction::full}) {
      const CutResult reduced = engine.find_cut(system, with(reduction));
      ASSERT_EQ(reduced.verdict, all.verdict) << write_promela(system).text;
      if (all.trace) {
        EXPECT_EQ(reduced.trace->steps.size(), all.trace->steps.size());
      }
    }
  }
  // Both verdicts were seen often, and less than `percent` of the states were needed.
  void expect_use(int least, std::uint64_t percent) const {
    EXPECT_GE(holds_, least);
    EXPECT_GE(violated_, least);
    EXPECT_LT(reduced_states_ * 100, all_states_ * percent);
  }

 private:
  int holds_ = 0, violated_ = 0;
  unsigned checks_ = 0;
  std::uint64_t all_states_ = 0, reduced_states_ = 0;
};

class Reductions : public testing::TestWithParam<int> {
 protected:
  // Systems that are not large; half of them cannot deadlock.
  System next_system() {
    is_live_ = !is_live_;
    while (true) {
      System system = test::random_system(random_, {2, 4, 3, 0.8, 0.8, has_mailboxes_ ? 0.7 : 0});
      const test::ExplicitChecker size(system, node_limit);
      if (size.is_complete() && !(is_live_ && size.shortest_deadlock())) return system;
    }
  }
  Property property_of(const System& system, const std::string& text, Fairness fairness) {
    const std::vector<ProgramInterface> interfaces = system.interfaces();
    Property property;
    property.name = text;
    property.formula =
        parse_formula(ScalarText(text, text, {"f", 1, 1}), {system.programs, interfaces});
    property.fairness = fairness;
    return property;
  }
  Random random_{static_cast<std::uint64_t>(9000 + GetParam())};
  Comparison comparison_;

 private:
  bool is_live_ = false;
  bool has_mailboxes_ = GetParam() % 2 == 1;
};

TEST_P(Reductions, Deadlock) {
  Property property;
  property.name = "deadlock";
  property.kind = Property::Kind::deadlock;
  for (int i = 0; i < 100 && !HasFatalFailure(); ++i) comparison_.check(next_system(), property);
  comparison_.expect_use(10, 90);
}

TEST_P(Reductions, Cut) {
  for (int i = 0; i < 100 && !HasFatalFailure(); ++i) comparison_.check_cut(next_system());
}

TEST_P(Reductions, Invariant) {
  for (int i = 0; i < 100 && !HasFatalFailure(); ++i) {
    const System system = next_system();
    RandomFormula formula(system, random_);
    const std::string left = formula.text(0), right = formula.text(0);
    const std::string text = "G (" + left + (random_.chance(0.5) ? " || " : " && ") + right + ")";
    comparison_.check(system, property_of(system, text, Fairness::weak));
  }
  comparison_.expect_use(10, 100);
}

TEST_P(Reductions, Stuck) {
  Property property;
  property.name = "stuck";
  property.kind = Property::Kind::stuck;
  for (int i = 0; i < 100 && !HasFatalFailure(); ++i) comparison_.check(next_system(), property);
  comparison_.expect_use(1, 100);
}

TEST_P(Reductions, Formulas) {
  for (int i = 0; i < 100 && !HasFatalFailure(); ++i) {
    const System system = next_system();
    const std::string text = RandomFormula(system, random_).text(3);
    for (const Fairness fairness : {Fairness::none, Fairness::weak, Fairness::strong}) {
      comparison_.check(system, property_of(system, text, fairness));
    }
  }
  comparison_.expect_use(10, 100);
}

TEST_P(Reductions, Assumptions) {
  std::size_t steps = 0, steps_by_plain_automata = 0;
  for (int i = 0; i < 60 && !HasFatalFailure(); ++i) {
    const System system = next_system();
    const std::string text = RandomFormula(system, random_).text_with_assumptions();
    for (const Fairness fairness : {Fairness::none, Fairness::weak, Fairness::strong}) {
      const Property property = property_of(system, text, fairness);
      comparison_.check(system, property);
      Property plain = property;
      plain.kind = Property::Kind::never;
      plain.never = std::make_shared<LtlAutomaton>(
          translate(make_formula(FormulaNode::Operator::negation, property.formula)));
      const PropertyResult wanted = NativeEngine().check(system, plain, {});
      const PropertyResult result = NativeEngine().check(system, property, {});
      ASSERT_EQ(result.verdict, wanted.verdict) << text << "\n" << write_promela(system).text;
      if (result.verdict == Verdict::holds) {
        EXPECT_LE(result.states, wanted.states) << text;
      } else {
        steps += result.trace->steps.size();
        steps_by_plain_automata += wanted.trace->steps.size();
      }
    }
  }
  comparison_.expect_use(10, 100);
  // Both searches show a run that was made short, not a shortest one.
  EXPECT_LE(10 * steps, 11 * steps_by_plain_automata);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Reductions, testing::Range(0, 2));
INSTANTIATE_TEST_SUITE_P(Many, Reductions, testing::Range(2, 8));

}  // namespace
}  // namespace maide
