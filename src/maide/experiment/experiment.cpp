#include "maide/experiment/experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/base/hash.hpp"
#include "maide/base/log.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/random.hpp"
#include "maide/base/text.hpp"
#include "maide/base/version.hpp"
#include "maide/conformance/method/known_words.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/experiment/known_models.hpp"
#include "maide/experiment/pacing.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/equivalence_oracle.hpp"
#include "maide/learn/oracle/error_outputs.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "maide/learn/oracle/sul_oracle.hpp"
#include "maide/learn/passive/rpni.hpp"

namespace maide {
namespace {

// Says once if the outputs do not end: a length, an identifier or a time in an output makes a state
// of each value, and the run goes on for ever.
class OutputWatch : public OracleDecorator {
 public:
  // Keeps a reference to `system`.
  explicit OutputWatch(OutputOracle& system) : OracleDecorator(system) {}

  using OutputOracle::ask;
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control,
                               const PartialSink& on_early_end) override {
    std::vector<MealyAnswer> answers = system_.ask(batch, control, on_early_end);
    for (const MealyAnswer& answer : answers) look_at(answer);
    const std::size_t known = outputs().size();
    // A machine shows its outputs early; these still come.
    constexpr std::size_t many = 200, words_for_one = 20;
    if (!was_said_ && known >= many && known * words_for_one >= words_) {
      was_said_ = true;
      log_warning(fmt::format(
          "new outputs come without end: {} in {} words, the last '{}' and '{}', mostly to {}. Let "
          "the wrapper say a few classes in place of values (lengths, identifiers, times)",
          known, words_, beginning(outputs().names()[known - 2]),
          beginning(outputs().names()[known - 1]), most_giving_input()));
    }
    return answers;
  }

 private:
  // What is shown of an output, which may be a whole list or a page.
  static std::string beginning(const std::string& output) {
    constexpr std::size_t most_shown = 60;  // characters
    std::string_view rest = output;
    for (std::size_t shown = 0; shown < most_shown && !rest.empty(); ++shown) take_character(rest);
    return rest.empty() ? output : output.substr(0, output.size() - rest.size()) + "...";
  }

  void look_at(const MealyAnswer& answer) {
    ++words_;
    new_by_input_.resize(inputs().size());
    for (std::size_t i = 0; i < answer.outputs.size(); ++i) {
      if (answer.outputs[i] < seen_) continue;
      seen_ = std::size_t{answer.outputs[i]} + 1;
      ++new_by_input_[answer.inputs[i]];
    }
  }
  const std::string& most_giving_input() const {
    const auto most = std::ranges::max_element(new_by_input_);
    return inputs().name(static_cast<Symbol>(most - new_by_input_.begin()));
  }

  std::uint64_t words_ = 0;
  std::size_t seen_ = 0;                     // outputs below this are known
  std::vector<std::uint64_t> new_by_input_;  // how many outputs each input gave first
  bool was_said_ = false;
};

// Believes no counterexample before the system has shown it twice: the word is asked again, fresh,
// not from the cache. If the two answers differ the cache holds its votes, and if the first one was
// wrong, throws CacheCorrected. One query for each counterexample; none for one that a kept cache
// answers, which the run that asked for it has confirmed.
class ConfirmingTeacher : public EquivalenceOracle {
 public:
  // Keeps both references.
  ConfirmingTeacher(EquivalenceOracle& teacher, Cache& cache) : teacher_(teacher), cache_(cache) {}

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override {
    std::optional<Word> counterexample = teacher_.find_counterexample(hypothesis, control);
    if (counterexample && !cache_.is_kept(*counterexample)) {
      cache_.ask_afresh(*counterexample, control);
    }
    return counterexample;
  }
  std::string guarantee() const override { return teacher_.guarantee(); }
  Strength strength() const override { return teacher_.strength(); }
  TestCost cost_of_missing() const override { return teacher_.cost_of_missing(); }

 private:
  EquivalenceOracle& teacher_;
  Cache& cache_;
};

// Inputs that the confirmation with longer waits may cost: a bounded share of the inputs that the
// run took, from the system and from a kept cache.
std::uint64_t confirmation_budget(std::uint64_t symbols) {
  return std::clamp<std::uint64_t>(symbols / 400, 20, 500);
}

// Under which a cache keeps that the model was confirmed so.
std::string confirmation_name(const Mealy& model, const std::string& waits) {
  const Mealy machine = breadth_first(model);
  std::uint64_t hash = hash_start;
  for (StateId state = 0; state < machine.size(); ++state) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      hash = hash_step(hash, machine.target(state, input));
      hash = hash_step(hash, hash_text(machine.outputs().name(machine.output(state, input))));
    }
  }
  return fmt::format("a model of {} states, {:016x}, {}", machine.size(), hash, waits);
}

// "depth", "queue_size", "max-samples": not "step-limit", "max-blocking-time".
bool names_length(std::string key) {
  constexpr std::array lengths{"bound",  "buffer",   "capacity", "depth",  "history",
                               "hwm",    "inflight", "length",   "queue",  "queued",
                               "rcvhwm", "samples",  "size",     "sndhwm", "window"};
  std::replace(key.begin(), key.end(), '-', '_');
  const std::vector<std::string_view> words = split(key, '_');
  return std::ranges::any_of(words, [&](std::string_view word) {
    return std::ranges::find(lengths, word) != lengths.end();
  });
}

const LearnerEntry& choose_algorithm(const std::string& name) {
  return find_deterministic_learner(name);
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

// Returns how many inputs there are.
std::uint64_t tell_cached_words(CacheFile& file, const ExperimentOptions& options) {
  std::uint64_t symbols = 0;
  file.for_each([&](const Word& inputs, const Word& outputs) {
    symbols += inputs.size();
    std::vector<std::string> names;
    for (const Symbol output : outputs) names.push_back(file.outputs().name(output));
    options.on_cached_word(inputs, names);
  });
  return symbols;
}

// One run: learner and teacher, again and again until no answer that they have seen is corrected.
class Run {
 public:
  Run(OutputOracle& system, const ExperimentOptions& options, const RunControl& control)
      : options_(options),
        control_(control),
        algorithm_(choose_algorithm(options.algorithm)),
        method_(options.test_method),
        watch_(system),
        counter_(watch_),
        progress_(control.progress, counter_),
        portioned_(counter_, pace()) {
    if (!options.testing.strength.empty()) parse_demand(options.testing.strength, {});
    if (!options.cache_file.empty()) {
      file_.emplace(options.cache_file, system.inputs(), options.fingerprint, &control);
      if (options.on_cached_word) kept_symbols_ = tell_cached_words(*file_, options);
    }
    const auto refusals = Cache::refusals_of(options.has_refusals);
    cache_.emplace(file_ ? Cache(portioned_, *file_, refusals) : Cache(portioned_, refusals));
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
    name_system();
    result_.contradictions = cache_->contradictions();
    result_.model.origin["algorithm"] = result_.algorithm;
    result_.model.origin["tests"] = result_.guarantee;
    result_.model.origin["seed"] = std::to_string(options_.testing.seed);
    result_.model.origin["maide"] = version();
    name_error_outputs();
    judge_strength();
    Statistics statistics = counter_.statistics();
    statistics.at(LearnPhase::confirmation) += slower_counts_;
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
    auto tests = method_.make({oracle(), &*cache_, options_.reference}, options_.testing);
    if (known_words_.empty() && options_.traces == nullptr) return tests;
    std::vector<std::unique_ptr<EquivalenceOracle>> links;
    if (!known_words_.empty()) {
      links.push_back(std::make_unique<KnownWords>(oracle(), known_words_));
    }
    if (options_.traces != nullptr) {  // what a log shows behind an error output is asked
      OutputOracle& asked = errors_ ? static_cast<OutputOracle&>(errors_->check) : *cache_;
      auto traces = std::make_unique<LoggedTraces>(asked, *options_.traces);
      traces_ = traces.get();
      links.push_back(std::move(traces));
    }
    links.push_back(std::move(tests));
    return std::make_unique<ChainOracle>(std::move(links));
  }

  // What learner and tests ask.
  OutputOracle& oracle() {
    if (errors_) return errors_->oracle;
    return *cache_;
  }

  void name_error_outputs() {
    if (options_.error_outputs.empty()) return;
    std::vector<std::string> names;
    for (const std::string& name : options_.error_outputs) {
      names.push_back(quote_shell_word(name));
      const ErrorOutputs named({name});
      const std::vector<std::string>& seen = cache_->outputs().names();
      if (std::ranges::none_of(seen,
                               [&](const std::string& output) { return named.contains(output); })) {
        log_warning("no output was '" + name + "', which was to end the session");
      }
    }
    result_.model.origin["error_outputs"] = join(names, " ");
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
    if (old_model_) prepare_old_model();
  }

  void prepare_old_model() {
    known_words_ = options_.known_words;
    const std::vector<Word> words =
        first_words(algorithm_, old_model(), cache_->inputs(), control_);
    known_words_.insert(known_words_.end(), words.begin(), words.end());
    // Where the tests are no such words, L# needs fewer of its own.
    if (!options_.old_model && !is_identified_) return;
    if (!method_.has("standard") && !method_.has("hads")) return;
    verifying_words_ = verifying_words(*old_model_, cache_->inputs(), options_.testing.seed);
    const auto most = options_.testing.max_tests;
    if (most && verifying_words_.size() > *most) verifying_words_.clear();
  }

  // Of several known models the one that the system seems to have is the old model.
  void identify_system() {
    if (options_.known_models.empty() || options_.old_model) return;
    counter_.set_phase(LearnPhase::learning);
    const SingledOut single = single_out(options_.known_models, oracle(), control_);
    suspect_ = &options_.known_models[single.model];
    result_.identified = {"", options_.known_models.size(), single.words};
    old_model_ = suspect_->machine;
    is_identified_ = single.is_possible;
    prepare_old_model();
  }

  // A model that was suspected, and passed all tests.
  void name_system() {
    if (suspect_ == nullptr || result_.error) return;
    const bool is_it = !find_distinguishing_word(suspect_->machine, result_.model);
    result_.identified->name = is_it ? suspect_->name : "";
  }

  // False if it must be done again on a corrected cache.
  bool learn_once() {
    tested_ = {};
    errors_.reset();
    if (!options_.error_outputs.empty()) errors_.emplace(*cache_, options_.error_outputs);
    try {
      identify_system();
    } catch (const CacheCorrected&) {
      return false;
    } catch (...) {
      result_.error = std::current_exception();
      return true;
    }
    const auto tests = make_tests();
    ConfirmingTeacher confirming(*tests, *cache_);
    EquivalenceOracle& confirmed = options_.confirm ? confirming : *tests;
    std::optional<ErrorOutputTest> with_errors;
    if (errors_) with_errors.emplace(confirmed, errors_->check, options_.testing.seed);
    PhasedTeacher teacher(with_errors ? *with_errors : confirmed, counter_);
    const auto learner =
        make_learner(algorithm_, oracle(), old_model(), control_, verifying_words_);
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
      tested_.strength = teacher.strength();
      tested_.cost_of_missing = teacher.cost_of_missing();
      confirm(learner->hypothesis());
      ask_sample(learner->hypothesis());
    } catch (const CacheCorrected&) {
      is_over = false;
    } catch (...) {
      result_.guarantee = teacher.guarantee();
      tested_.strength = teacher.strength();
      result_.error = std::current_exception();
    }
    result_.output_queries += learner->output_queries();
    if (traces_ != nullptr) result_.log_contradictions = traces_->contradictions();
    // A run that ends before its first hypothesis leaves the one before.
    if (learner->hypothesis().size() > 0) result_.model = breadth_first(learner->hypothesis());
    return is_over;
  }

  void judge_strength() {
    const TestMethodOptions& testing = options_.testing;
    tested_.standard = demand_of(result_.model, testing.sizes);
    tested_.demand = demand_of(result_.model, testing.sizes, testing.strength);
    tested_.budget = testing.whole_budget();
    tested_.is_weak = !describe_shortfall(tested_.strength, tested_.standard).empty();
    if (tested_.shortfall().empty()) tested_.cost_of_missing = {};
    result_.model.origin[std::string(strength_key)] =
        to_string(StatedStrength{tested_.strength, tested_.is_weak});
    result_.strength = tested_;
  }

  // Unless a run with the same cache has confirmed the model before.
  void confirm(const Mealy& model) {
    if (!options_.slower) return;
    const std::string name = confirmation_name(model, options_.slower->waits);
    if (const auto before = file_ ? file_->find_confirmed(name) : std::nullopt) {
      result_.guarantee +=
          fmt::format("; {} words confirmed with longer waits ({}) by a run before", *before,
                      options_.slower->waits);
      return;
    }
    const std::uint64_t symbols = counter_.statistics().total().symbols + kept_symbols_;
    const ConfirmationSettings settings{options_.vote, options_.testing.seed,
                                        confirmation_budget(symbols)};
    const std::uint64_t words =
        confirm_model(model, *options_.slower, *cache_, settings, slower_counts_, control_);
    if (file_) {
      file_->add_confirmed(name, words);
      file_->commit();
    }
    result_.guarantee +=
        fmt::format("; {} words confirmed with longer waits ({})", words, options_.slower->waits);
  }

  // Throws CacheCorrected: the run has to be done again.
  void ask_sample(const Mealy& model) {
    if (!file_ || cache_->misses() > 0 || is_sampled_) return;
    is_sampled_ = true;
    counter_.set_phase(LearnPhase::confirmation);
    Random random(options_.testing.seed);
    const std::size_t voted_on = cache_->contradictions().size();
    std::vector<Word> wrong;
    for (std::size_t count = 0; count < options_.sample; ++count) {
      const Word word = random_walk(model, random);
      try {
        cache_->ask_afresh(word, control_);
        if (is_answered_so(word, model)) continue;
      } catch (const CacheCorrected&) {  // it is one of the wrong ones
      }
      wrong.push_back(word);
    }
    if (wrong.empty()) return;
    const std::string shown = to_string(wrong.front(), model.inputs());
    if (cache_->contradictions().size() > voted_on + 1) {
      throw Error(
          ExitStatus::inconclusive,
          fmt::format("the system answers \"{}\" and other words otherwise than it did: the "
                      "cache is another system's, or an older version's; delete it ({})",
                      shown, options_.cache_file.string()));
    }
    known_words_.insert(known_words_.end(), wrong.begin(), wrong.end());
    throw CacheCorrected(shown);
  }
  // Of at most 30 inputs.
  static Word random_walk(const Mealy& model, Random& random) {
    Word word(1 + random.below(std::min<std::uint64_t>(2 * model.size(), 30)));
    for (Symbol& input : word) input = static_cast<Symbol>(random.below(model.inputs().size()));
    return word;
  }
  // As the cache has it.
  bool is_answered_so(const Word& word, const Mealy& model) {
    const Word outputs = cache_->ask(word, control_), expected = model.output_word(word);
    return std::ranges::equal(outputs, expected, [&](Symbol given, Symbol meant) {
      return cache_->outputs().name(given) == model.outputs().name(meant);
    });
  }

  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  const ExperimentOptions& options_;
  RunControl control_;
  const LearnerEntry& algorithm_;
  TestChain method_;
  OutputWatch watch_;
  CountingOracle counter_;
  CountedProgress progress_;
  PortioningOracle portioned_;
  std::optional<CacheFile> file_;
  std::optional<Cache> cache_;
  struct ErrorOracles {
    ErrorOracles(OutputOracle& system, const std::vector<std::string>& names)
        : check(system, ErrorOutputs(names)), oracle(check) {}
    ErrorOutputCheck check;
    ErrorAwareOracle oracle;
  };
  std::optional<ErrorOracles> errors_;       // of the present run, if error outputs are known
  std::vector<Word> known_words_;            // each hypothesis is tested with these first
  std::optional<Mealy> old_model_;           // given, or what the log alone gives
  std::vector<Word> verifying_words_;        // of the old model
  const KnownModel* suspect_ = nullptr;      // of several
  bool is_identified_ = false;               // nothing has contradicted it so far
  const LoggedTraces* traces_ = nullptr;     // of the present run
  LearnPhase phase_ = LearnPhase::learning;  // before a vote
  TestedStrength tested_;                    // of the present run's model
  QueryCounts slower_counts_;
  std::uint64_t kept_symbols_ = 0;  // in the cache when the run began
  bool is_sampled_ = false;
  ExperimentResult result_;
};

}  // namespace

ExperimentResult run_experiment(OutputOracle& system, const ExperimentOptions& options,
                                const RunControl& control) {
  return Run(system, options, control).run();
}

ExperimentResult run_experiment(IaTranslator& translator, const ExperimentOptions& options,
                                const RunControl& control) {
  if (!options.error_outputs.empty() && translator.translation() == Translation::av) {
    throw UsageError("outputs that end the session need the eager translation");
  }
  ExperimentOptions completed = options;
  completed.fingerprint.merge(identify(translator));
  // What a plain system calls "refused" is an output like any other.
  completed.has_refusals = translator.info().has_actors;
  completed.on_cached_word = [&](const Word& inputs, const std::vector<std::string>& outputs) {
    translator.remember(inputs, outputs);
  };
  if (completed.testing.sizes.empty()) completed.testing.sizes = find_sizes(translator.info());
  if (completed.testing.budget.words == 0) {
    completed.testing.budget = test_budget(options.reference != nullptr);
  }
  if (!translator.info().speaks_trees) completed.algorithm = choose_by_words(options.algorithm);
  SulOracle system(translator);
  return run_experiment(system, completed, control);
}

std::vector<std::size_t> find_sizes(const SulInfo& info) {
  std::vector<std::size_t> sizes;
  std::size_t most = std::numeric_limits<std::size_t>::max();
  if (const auto size = info.options.find("size"); size != info.options.end()) {
    const std::size_t number = parse_number<std::size_t>(size->second).value_or(0);
    if (number > 0) most = number;
  }
  const auto add = [&](std::string_view text) {
    const auto number = parse_number<std::size_t>(text);
    if (number && *number > 0 && *number <= most) sizes.push_back(*number);
  };
  for (const auto& [key, value] : info.options) {
    if (names_length(key)) add(value);
  }
  std::string bound = info.bound;
  std::replace(bound.begin(), bound.end(), ',', ' ');
  for (const std::string_view word : split(bound, ' ')) add(word);  // "at most 6 messages"
  return sizes;
}

TestCost test_budget(bool is_in_memory) {
  return is_in_memory ? TestCost{1'000'000, 30'000'000} : TestCost{20'000, 1'000'000};
}

void require_test_option(const std::string& algorithm, const std::string& test_method,
                         std::string_view option) {
  const LearnerEntry& learner = find_learner(algorithm);
  if (learner.test_options.empty()) {
    if (!find_test_option(option).is_of_run) TestChain(test_method).require(option);
    return;
  }
  const std::vector<std::string_view> own = split(learner.test_options, ' ');
  if (std::ranges::find(own, option) != own.end()) return;
  throw UsageError(fmt::format("the tests of {} have no option '{}'; they have: {}", learner.name,
                               option, learner.test_options));
}

Fingerprint identify(const IaTranslator& translator) {
  const SulInfo& info = translator.info();
  Fingerprint result(identifying_options(info));
  result["the system"] = info.name;
  result["the translation"] = to_string(translator.translation());
  if (!info.bound.empty()) result["the bound"] = info.bound;
  for (const auto& [what, version] : info.versions) result["the version of " + what] = version;
  return result;
}

namespace {

double to_seconds(std::chrono::microseconds duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

void CountedProgress::on_progress(const Progress& progress) {
  last_ = progress;
  repeat();
}

void CountedProgress::set_hypothesis(std::size_t states) {
  last_ = {};
  last_.states = states;
}

void CountedProgress::repeat() {
  if (observer_ == nullptr) return;
  if (last_.total == 0) last_.phase = to_string(counter_.phase());
  const QueryCounts counts = counter_.statistics().total();
  last_.words = counts.queries;
  last_.symbols = counts.symbols;
  observer_->on_progress(last_);
}

void fill_counts(ExperimentResult& result, const Statistics& statistics,
                 std::chrono::steady_clock::time_point start) {
  const QueryCounts total = statistics.total();
  result.experiments = total.queries;
  result.symbols = total.symbols;
  result.resets = total.resets;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.seconds_in_system = to_seconds(total.in_system);
  result.seconds_in_reset = to_seconds(total.in_reset);
  result.seconds_in_reset_wait = to_seconds(total.in_reset_wait);
  result.seconds_in_settling = to_seconds(total.in_settling);
  result.seconds_in_learner = std::max(0.0, result.seconds - to_seconds(total.asking));
  result.statistics = statistics;
}

}  // namespace maide
