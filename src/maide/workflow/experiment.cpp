#include "maide/workflow/experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "maide/automata/minimize.hpp"
#include "maide/base/log.hpp"
#include "maide/conformance/chain_oracle.hpp"
#include "maide/conformance/known_words.hpp"
#include "maide/conformance/test_chain.hpp"
#include "maide/learn/cache.hpp"
#include "maide/learn/confirming_teacher.hpp"
#include "maide/learn/counting_oracle.hpp"
#include "maide/learn/learners.hpp"
#include "maide/learn/rpni.hpp"
#include "maide/learn/sul_oracle.hpp"
#include "maide/workflow/confirm_model.hpp"
#include "maide/workflow/paced_oracle.hpp"
#include "maide/workflow/run_counts.hpp"

namespace maide {
namespace {

// Inputs that the confirmation with longer waits may cost: a bounded share of the run.
std::uint64_t confirmation_budget(const Statistics& statistics) {
  return std::clamp<std::uint64_t>(statistics.total().symbols / 400, 20, 500);
}

const LearnerEntry& choose_algorithm(const std::string& name) {
  return name.empty() ? learners().front() : find_learner(name);
}

// The algorithm, or the one that stands in for it where a system answers no decision trees.
std::string choose_by_words(const std::string& name) {
  const LearnerEntry& wanted = choose_algorithm(name);
  if (wanted.by_words.empty()) return std::string(wanted.name);
  const auto log = name.empty() ? log_detail : log_note;  // who named one, wants to know
  log(fmt::format("the system answers no decision trees: {} instead of {}", wanted.by_words,
                  wanted.name));
  return std::string(wanted.by_words);
}

void tell_cached_words(CacheFile& file, const ExperimentOptions& options) {
  file.for_each([&](const Word& inputs, const Word& outputs) {
    std::vector<std::string> names;
    for (const Symbol output : outputs) names.push_back(file.outputs().name(output));
    options.on_cached_word(inputs, names);
  });
}

// One run: learner and teacher, again and again until no answer that they have seen is corrected.
class Run {
 public:
  Run(OutputOracle& system, const ExperimentOptions& options, const RunControl& control)
      : options_(options),
        control_(control),
        algorithm_(choose_algorithm(options.algorithm)),
        method_(options.test_method),
        counter_(system),
        progress_(control.progress, counter_),
        paced_(counter_, pace()) {
    if (!options.cache_file.empty()) {
      file_.emplace(options.cache_file, system.inputs(), options.fingerprint, &control);
      if (options.on_cached_word) tell_cached_words(*file_, options);
    }
    cache_.emplace(file_ ? Cache(paced_, *file_) : Cache(paced_));
    cache_->hold_votes(options.vote, [this](bool begins) {
      if (begins) phase_ = counter_.phase();
      counter_.set_phase(begins ? LearnPhase::confirmation : phase_);
    });
    control_.progress = &progress_;
    result_.algorithm = algorithm_.name;
    result_.test_method = method_.text();
  }

  ExperimentResult run() {
    try {
      use_what_is_known();
      while (!learn_once()) ++result_.restarts;
    } catch (const Interrupted&) {  // before a learner could begin
      result_.error = std::current_exception();
    }
    result_.contradictions = cache_->contradictions();
    result_.model.origin["algorithm"] = result_.algorithm;
    result_.model.origin["tests"] = result_.guarantee;
    result_.model.origin["seed"] = std::to_string(options_.testing.seed);
    Statistics statistics = counter_.statistics();
    statistics.at(LearnPhase::confirmation) += patient_counts_;
    fill_counts(result_, statistics, start_);
    result_.cache_hits = cache_->hits();
    return std::move(result_);
  }

 private:
  PaceOptions pace() {
    PaceOptions pace;
    if (options_.max_experiments != 0) pace.max_queries = options_.max_experiments;
    pace.after_portion = [this] { progress_.repeat(); };
    return pace;
  }

  std::unique_ptr<EquivalenceOracle> make_tests() {
    auto tests = method_.make({*cache_, &*cache_, options_.reference}, options_.testing);
    if (known_words_.empty() && options_.traces == nullptr) return tests;
    std::vector<std::unique_ptr<EquivalenceOracle>> links;
    if (!known_words_.empty()) links.push_back(std::make_unique<KnownWords>(*cache_, known_words_));
    if (options_.traces != nullptr) {
      auto traces = std::make_unique<LoggedTraces>(*cache_, *options_.traces);
      traces_ = traces.get();
      links.push_back(std::move(traces));
    }
    links.push_back(std::move(tests));
    return std::make_unique<ChainOracle>(std::move(links));
  }

  const Mealy* old_model() const { return old_model_ ? &*old_model_ : nullptr; }

  // A large log or old model takes its time.
  void use_what_is_known() {
    known_words_ = options_.known_words;
    old_model_ = options_.old_model;
    const bool has_log = options_.traces != nullptr && !options_.traces->inputs.empty();
    if (!old_model_ && has_log && algorithm_.make_from != nullptr) {
      old_model_ = learn_passively(*options_.traces, control_).machine;
    }
    const std::vector<Word> words =
        first_words(algorithm_, old_model(), cache_->inputs(), control_);
    known_words_.insert(known_words_.end(), words.begin(), words.end());
  }

  // False if it must be done again on a corrected cache.
  bool learn_once() {
    const auto tests = make_tests();
    ConfirmingTeacher confirming(*tests, *cache_);
    PhasedTeacher teacher(options_.confirm ? confirming : *tests, counter_);
    const auto learner = make_learner(algorithm_, *cache_, old_model(), control_);
    counter_.set_phase(LearnPhase::learning);
    bool is_over = true;
    try {
      run_learner(*learner, teacher, control_, [this](const Mealy& hypothesis, std::uint64_t) {
        ++result_.equivalence_queries;
        progress_.set_hypothesis(hypothesis.size());
        result_.hypotheses.push_back({hypothesis.size(), counter_.statistics()});
        if (options_.on_hypothesis) {
          options_.on_hypothesis(hypothesis, result_.equivalence_queries);
        }
      });
      result_.guarantee = teacher.guarantee();
      confirm(learner->hypothesis());
    } catch (const CacheCorrected&) {
      is_over = false;
    } catch (...) {
      result_.guarantee = teacher.guarantee();
      result_.error = std::current_exception();
    }
    result_.output_queries += learner->output_queries();
    if (traces_ != nullptr) result_.log_contradictions = traces_->contradictions();
    // A run that ends before its first hypothesis leaves the one before.
    if (learner->hypothesis().size() > 0) result_.model = breadth_first(learner->hypothesis());
    return is_over;
  }

  // A kept cache that answered everything was confirmed by the run that filled it.
  void confirm(const Mealy& model) {
    if (!options_.patient || counter_.statistics().total().queries == 0) return;
    const ConfirmationSettings settings{options_.vote, options_.testing.seed,
                                        confirmation_budget(counter_.statistics())};
    const std::uint64_t words =
        confirm_model(model, *options_.patient, *cache_, settings, patient_counts_, control_);
    result_.guarantee +=
        fmt::format("; {} words confirmed with longer waits ({})", words, options_.patient->waits);
  }

  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  const ExperimentOptions& options_;
  RunControl control_;
  const LearnerEntry& algorithm_;
  TestChain method_;
  CountingOracle counter_;
  CountedProgress progress_;
  PacedOracle paced_;
  std::optional<CacheFile> file_;
  std::optional<Cache> cache_;
  std::vector<Word> known_words_;            // each hypothesis is tested with these first
  std::optional<Mealy> old_model_;           // given, or what the log alone gives
  const LoggedTraces* traces_ = nullptr;     // of the present run
  LearnPhase phase_ = LearnPhase::learning;  // before a vote
  QueryCounts patient_counts_;
  ExperimentResult result_;
};

}  // namespace

ExperimentResult run_experiment(OutputOracle& system, const ExperimentOptions& options,
                                const RunControl& control) {
  return Run(system, options, control).run();
}

ExperimentResult run_experiment(IaTranslator& translator, const ExperimentOptions& options,
                                const RunControl& control) {
  ExperimentOptions completed = options;
  completed.fingerprint.merge(identify(translator));
  completed.on_cached_word = [&](const Word& inputs, const std::vector<std::string>& outputs) {
    translator.remember(inputs, outputs);
  };
  if (!translator.info().speaks_trees) completed.algorithm = choose_by_words(options.algorithm);
  SulOracle system(translator);
  return run_experiment(system, completed, control);
}

Fingerprint identify(const IaTranslator& translator) {
  const SulInfo& info = translator.info();
  Fingerprint result(info.options);
  result["the system"] = info.name;
  result["the translation"] = to_string(translator.translation());
  if (!info.bound.empty()) result["the bound"] = info.bound;
  for (const auto& [what, version] : info.versions) result["the version of " + what] = version;
  return result;
}

}  // namespace maide
