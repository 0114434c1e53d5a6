#include "maide/learn/learner.hpp"

#include <array>
#include <utility>

#include "maide/automata/minimize.hpp"
#include "maide/base/text.hpp"
#include "maide/learn/lsharp/lsharp.hpp"
#include "maide/learn/lsharp/old_model.hpp"
#include "maide/learn/table/table_learners.hpp"
#include "maide/learn/tree/adt.hpp"
#include "maide/learn/tree/tree_learners.hpp"
#include "maide/learn/tree/ttt.hpp"

namespace maide {

LearnResult run_learner(Learner& learner, EquivalenceOracle& teacher, const RunControl& control,
                        const HypothesisObserver& observer) {
  LearnResult result;
  learner.start(control);
  while (true) {
    ++result.equivalence_queries;
    if (observer) observer(learner.hypothesis(), result.equivalence_queries);
    const auto counterexample = teacher.find_counterexample(learner.hypothesis(), control);
    if (!counterexample) break;
    learner.refine(*counterexample, control);
  }
  result.model = breadth_first(learner.hypothesis());
  return result;
}

Mealy learn(Learner& learner, EquivalenceOracle& teacher) {
  return std::move(run_learner(learner, teacher).model);
}

namespace {

template <typename Algorithm>
std::unique_ptr<Learner> make(OutputOracle& oracle) {
  return std::make_unique<Algorithm>(oracle);
}

std::unique_ptr<Learner> make_lsharp_by_words(OutputOracle& oracle) {
  return std::make_unique<LSharp>(oracle, Separation::separating_words);
}

template <Separation separation>
std::unique_ptr<Learner> make_lsharp_from(OutputOracle& oracle, const Mealy& old_model,
                                          const RunControl& control,
                                          std::span<const Word> first_words) {
  return std::make_unique<LSharp>(oracle, old_model, separation, control, first_words);
}

constexpr std::array table{
    LearnerEntry{"lsharp", "L#: observation tree and apartness, adaptive distinguishing sequences",
                 make<LSharp>, make_lsharp_from<Separation::adaptive>, "lsharp-sepseq"},
    LearnerEntry{"lsharp-sepseq", "L# with separating sequences, plain words", make_lsharp_by_words,
                 make_lsharp_from<Separation::separating_words>},
    LearnerEntry{"rs", "observation table, Rivest & Schapire's handling of counterexamples",
                 make<RivestSchapire>},
    LearnerEntry{"lmplus", "L*M+: observation table, Shahbaz's handling of counterexamples",
                 make<LmPlus>},
    LearnerEntry{"lstar", "L*M: observation table, all prefixes of a counterexample become rows",
                 make<LStar>},
    LearnerEntry{"suffix1by1", "observation table, suffixes of a counterexample one at a time",
                 make<SuffixOneByOne>},
    LearnerEntry{"op", "observation pack: discrimination tree, Rivest & Schapire's counterexamples",
                 make<ObservationPack>},
    LearnerEntry{"kv", "Kearns & Vazirani: discrimination tree, suffixes grown by one input each",
                 make<KearnsVazirani>},
    LearnerEntry{"ttt", "TTT: discrimination tree, nothing of a counterexample is kept", make<Ttt>},
    LearnerEntry{"tttlambda",
                 "TTT-lambda: discrimination tree, counterexamples name access words alone",
                 make<TttLambda>},
    LearnerEntry{"adt", "ADT: discrimination tree of adaptive distinguishing sequences, few resets",
                 make<Adt>, nullptr, "ttt"},
    LearnerEntry{
        "nstar",
        "for systems that answer the same word in several ways, by sampling (some 44 times "
        "as many words); the eager translation",
        nullptr, nullptr, "", "extra-states max-tests seed"},
};

}  // namespace

std::span<const LearnerEntry> learners() { return table; }

std::span<const LearnerEntry> deterministic_learners() {
  static_assert(table.back().is_nondeterministic());
  return std::span<const LearnerEntry>(table).first(table.size() - 1);
}

const LearnerEntry& find_learner(std::string_view name) {
  return name.empty() ? table.front() : find_row(learners(), "algorithm", name);
}

const LearnerEntry& find_deterministic_learner(std::string_view name) {
  return name.empty() ? table.front() : find_row(deterministic_learners(), "algorithm", name);
}

std::unique_ptr<Learner> make_learner(const LearnerEntry& algorithm, OutputOracle& oracle,
                                      const Mealy* old_model, const RunControl& control,
                                      std::span<const Word> first_words) {
  return old_model != nullptr && algorithm.make_from != nullptr
             ? algorithm.make_from(oracle, *old_model, control, first_words)
             : algorithm.make(oracle);
}

std::vector<Word> first_words(const LearnerEntry& algorithm, const Mealy* old_model,
                              const Alphabet& inputs, const RunControl& control) {
  if (old_model == nullptr || algorithm.make_from != nullptr) return {};
  return OldModel(*old_model, inputs, control).test_words();
}

}  // namespace maide
