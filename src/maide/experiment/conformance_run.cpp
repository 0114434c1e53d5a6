#include "maide/experiment/conformance_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/conformance/identify/separating_words.hpp"
#include "maide/conformance/method/known_words.hpp"
#include "maide/conformance/method/standard_method.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/cache/cache_file.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "maide/learn/oracle/sul_oracle.hpp"

namespace maide {
namespace {

// A word is shortened piece by piece up to this length; a longer one is halved before.
constexpr std::size_t short_word = 16;
constexpr std::uint64_t most_halvings = 200;
constexpr std::size_t most_unsteady = 20;

// The model's inputs in the system's numbering.
std::vector<Symbol> match_inputs(const Mealy& model, const Alphabet& system,
                                 const std::string& name) {
  std::vector<Symbol> inputs;
  std::vector<std::string> missing;
  for (const std::string& input : model.inputs().names()) {
    const auto found = system.find(input);
    if (found) {
      inputs.push_back(*found);
    } else {
      missing.push_back(input);
    }
  }
  if (missing.empty()) return inputs;
  throw UsageError(
      fmt::format("the system {} lacks inputs that the model has: {} (the system's inputs are: {})",
                  name, join(missing), join(system.names())));
}

// The words of the log in the model's numbering, but those that others begin with, and those with
// an input that the model does not have; sorted.
std::vector<Word> match_words(const TraceLog& log, const Mealy& model) {
  std::vector<Word> words;
  for (const TraceLog::Trace& trace : log.traces) {
    Word word;
    for (const Symbol input : trace.inputs) {
      const auto known = model.inputs().find(log.inputs.name(input));
      if (!known) break;
      word.push_back(*known);
    }
    if (!word.empty() && word.size() == trace.inputs.size()) words.push_back(std::move(word));
  }
  if (words.empty()) throw UsageError(located("no word there has the model's inputs", log));
  return without_prefixes(std::move(words));
}

// Follows each word on the model, as the head of the header says.
class Judge : public OutputOracle {
 public:
  // Keeps the references. `model` must be complete, its states reachable.
  Judge(OutputOracle& system, const Mealy& model, std::vector<Symbol> inputs)
      : system_(system), model_(model), inputs_(std::move(inputs)) {
    const std::size_t transitions = model.size() * model.inputs().size();
    never_tried_.resize(transitions);
    for (StateId state = 0; state < model.size(); ++state) {
      for (Symbol input = 0; input < model.inputs().size(); ++input) {
        never_tried_[transition(state, input)] =
            is_never_tried(model.outputs().name(model.output(state, input)));
      }
    }
    failed_.resize(transitions);
    begin_again();
  }

  // Forgets all differences and what was covered.
  void begin_again() {
    states_.assign(model_.size(), false);
    states_[model_.initial()] = true;
    covered_.assign(failed_.size(), false);
    pairs_.assign(failed_.size() * model_.inputs().size(), false);
    failed_.assign(failed_.size(), false);
    unsteady_.clear();
  }

  using OutputOracle::ask;
  const Alphabet& inputs() const override { return model_.inputs(); }
  const Alphabet& outputs() const override { return system_.outputs(); }
  Symbol intern_output(std::string_view name) override { return system_.intern_output(name); }

  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control,
                               const PartialSink& on_early_end) override {
    std::vector<MealyAnswer> answers(batch.size());
    std::vector<Query> sent;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      Word word = to_system(std::get<Word>(batch[i]));
      if (word.empty()) {
        answers[i] = judge(std::get<Word>(batch[i]), {});
        continue;
      }
      sent.emplace_back(std::move(word));
      places.push_back(i);
    }
    const auto heard = [&](std::size_t index, const MealyAnswer& answer) {
      const std::size_t place = places[index];
      const MealyAnswer judged = judge(std::get<Word>(batch[place]), answer);
      if (on_early_end) on_early_end(place, judged);
    };
    const std::vector<MealyAnswer> given = system_.ask(sent, control, heard);
    for (std::size_t i = 0; i < given.size(); ++i) {
      answers[places[i]] = judge(std::get<Word>(batch[places[i]]), given[i]);
    }
    return answers;
  }

  // As it is sent: without what the model has as never tried.
  Word to_system(const Word& word) const {
    Word result;
    StateId state = model_.initial();
    for (const Symbol input : word) {
      if (!never_tried_[transition(state, input)]) result.push_back(inputs_[input]);
      state = model_.target(state, input);
    }
    return result;
  }

  // How many inputs lead to the first output that is not the model's; 0 if all are.
  std::size_t first_difference(const Word& word, const MealyAnswer& answer) const {
    StateId state = model_.initial();
    for (std::size_t i = 0; i < word.size(); ++i) {
      if (i >= answer.outputs.size() || !agrees(state, word[i], answer.outputs[i])) return i + 1;
      state = model_.target(state, word[i]);
    }
    return 0;
  }

  void add_failure(StateId state, Symbol input) { failed_[transition(state, input)] = true; }
  void add_unsteady(const Word& word) { unsteady_.insert(word); }

  void fill_in(ConformanceResult& result) const {
    const std::size_t inputs = model_.inputs().size();
    result.never_tried = never_tried_;
    result.covered = covered_;
    const auto count = [](const std::vector<bool>& marks) {
      return static_cast<std::uint64_t>(std::ranges::count(marks, true));
    };
    result.states = {count(states_), model_.size()};
    result.transitions = {count(covered_), never_tried_.size() - count(never_tried_)};
    result.pairs = {count(pairs_), 0};
    for (std::size_t i = 0; i < never_tried_.size(); ++i) {
      if (never_tried_[i]) continue;
      const StateId target =
          model_.target(static_cast<StateId>(i / inputs), static_cast<Symbol>(i % inputs));
      for (Symbol next = 0; next < inputs; ++next) {
        if (!never_tried_[transition(target, next)]) ++result.pairs.total;
      }
    }
  }

 private:
  std::size_t transition(StateId state, Symbol input) const {
    return std::size_t{state} * model_.inputs().size() + input;
  }
  const std::string& expected(StateId state, Symbol input) const {
    return model_.outputs().name(model_.output(state, input));
  }
  bool agrees(StateId state, Symbol input, Symbol output) const {
    return system_.outputs().name(output) == expected(state, input);
  }

  void cover(StateId state, Symbol input, std::optional<std::size_t>& last) {
    const std::size_t here = transition(state, input);
    covered_[here] = true;
    states_[model_.target(state, input)] = true;
    if (last) pairs_[*last * model_.inputs().size() + input] = true;
    last = here;
  }

  // The answer to the whole word, made of the system's to the word that was sent.
  MealyAnswer judge(const Word& word, const MealyAnswer& given) {
    MealyAnswer result = given;
    result.inputs.clear();
    result.outputs.clear();
    enum class Mode { agreeing, masked, different } mode = Mode::agreeing;
    StateId state = model_.initial();
    std::size_t place = 0;
    std::optional<std::size_t> last;  // transition
    for (const Symbol input : word) {
      const bool is_left_out = never_tried_[transition(state, input)];
      if (!is_left_out && place >= given.outputs.size() && mode != Mode::masked) break;
      result.inputs.push_back(input);
      const Symbol seen =
          is_left_out || place >= given.outputs.size() ? Symbol{0} : given.outputs[place++];
      if (!is_left_out && mode == Mode::agreeing) {
        if (agrees(state, input, seen)) {
          cover(state, input, last);
        } else {
          const bool is_known =
              failed_[transition(state, input)] || unsteady_.contains(result.inputs);
          mode = is_known ? Mode::masked : Mode::different;
        }
      }
      result.outputs.push_back(is_left_out || mode == Mode::masked
                                   ? system_.intern_output(expected(state, input))
                                   : seen);
      state = model_.target(state, input);
    }
    return result;
  }

  OutputOracle& system_;
  const Mealy& model_;
  std::vector<Symbol> inputs_;     // the model's -> the system's
  std::vector<bool> never_tried_;  // by transition, as all but the states
  std::vector<bool> states_, covered_, failed_;
  std::vector<bool> pairs_;  // by transition and next input
  std::set<Word> unsteady_;
};

class ConformanceRun {
 public:
  ConformanceRun(IaTranslator& translator, const Mealy& model, const ConformanceOptions& options,
                 const RunControl& control)
      : options_(options),
        control_(control),
        method_(options.test_method),
        system_(translator),
        counter_(system_),
        progress_(control.progress, counter_),
        portioned_(counter_, {.after_portion = [this] { progress_.repeat(); }}) {
    result_.model = breadth_first(minimize(model));
    std::vector<Symbol> inputs =
        match_inputs(result_.model, translator.inputs(), translator.info().name);
    for (const std::string& name : translator.inputs().names()) {
      if (!result_.model.inputs().find(name)) result_.other_inputs.push_back(name);
    }
    if (!options.cache_file.empty()) {
      file_.emplace(options.cache_file, translator.inputs(), identify(translator), &control);
    }
    const auto refusals = Cache::refusals_of(translator.info().has_actors);
    cache_.emplace(file_ ? Cache(portioned_, *file_, refusals) : Cache(portioned_, refusals));
    cache_->hold_votes(options.vote, [this](bool begins) {
      counter_.set_phase(begins ? LearnPhase::confirmation : LearnPhase::testing);
    });
    counter_.set_phase(LearnPhase::testing);
    control_.progress = &progress_;
    progress_.set_hypothesis(result_.model.size());
    result_.access.resize(result_.model.size());
    for (const Word& word : compute_state_cover(result_.model)) {
      result_.access[result_.model.run(word)] = word;
    }
    testing_ = options.testing;
    if (testing_.sizes.empty()) testing_.sizes = find_sizes(translator.info());
    if (testing_.budget.words == 0) testing_.budget = test_budget(options.reference != nullptr);
    if (options.words != nullptr) known_words_ = match_words(*options.words, result_.model);
    judge_.emplace(*cache_, result_.model, std::move(inputs));
    make_tests(*judge_);  // or it throws
  }

  ConformanceResult run() {
    try {
      while (search_again()) {
      }
    } catch (...) {
      result_.error = std::current_exception();
    }
    judge_->fill_in(result_);
    std::ranges::stable_sort(result_.failures,
                             [](const ConformanceFailure& left, const ConformanceFailure& right) {
                               return left.word.size() < right.word.size();
                             });
    const QueryCounts counts = counter_.statistics().total();
    result_.words = counts.queries + slower_words_;
    result_.symbols = counts.symbols + slower_symbols_;
    result_.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    return std::move(result_);
  }

 private:
  std::unique_ptr<EquivalenceOracle> make_tests(OutputOracle& oracle) {
    auto tests = method_.make({oracle, nullptr, options_.reference}, testing_);
    if (known_words_.empty()) return tests;
    std::vector<std::unique_ptr<EquivalenceOracle>> links;
    links.push_back(std::make_unique<KnownWords>(oracle, known_words_));
    links.push_back(std::move(tests));
    return std::make_unique<ChainOracle>(std::move(links));
  }

  // False when the run is over.
  bool search_again() {
    try {
      return search();
    } catch (const CacheCorrected&) {  // an answer that was judged was wrong
      judge_->begin_again();
      result_.failures.clear();
      result_.unsteady.clear();
      return true;
    }
  }

  bool search() {
    PaceOptions pace;
    if (options_.max_tests) pace.max_queries = *options_.max_tests;
    PortioningOracle limited(*judge_, pace);
    const auto tests = make_tests(limited);
    std::optional<Word> word;
    try {
      word = tests->find_counterexample(result_.model, control_);
    } catch (...) {
      result_.guarantee = tests->guarantee();
      throw;
    }
    if (!word) {
      result_.guarantee = tests->guarantee();
      judge_strength(tests->strength());
      return false;
    }
    const std::optional<Word> differs = ask_again(*word);
    if (!differs) return false;  // of `perfect`, which does not ask: it is known already
    report(shorten(*differs));
    if (result_.unsteady.size() >= most_unsteady) {
      throw Error(ExitStatus::inconclusive,
                  fmt::format("the system answers otherwise when it waits longer, in {} words",
                              result_.unsteady.size()));
    }
    return result_.failures.size() < options_.most_failures;
  }

  void judge_strength(const Strength& strength) {
    if (!method_.has("standard") && testing_.strength.empty()) return;
    const StrengthDemand demand = demand_of(result_.model, testing_.sizes, testing_.strength);
    result_.shortfall = describe_shortfall(strength, demand);
  }

  // The word up to the first difference; nothing if none is new.
  std::optional<Word> cut(const Word& word) {
    const std::vector<Query> batch{word};
    const std::size_t length =
        judge_->first_difference(word, judge_->ask(batch, control_, {}).front());
    if (length == 0) return std::nullopt;
    return head(word, length);
  }

  // The same, asked afresh. Votes decide if the system has another answer now.
  std::optional<Word> ask_again(const Word& word) {
    std::optional<Word> different = cut(word);
    if (different && options_.confirm) {
      cache_->ask_afresh(judge_->to_system(*different), control_);
    }
    return different;
  }

  Word shorten(Word word) {
    word = shorten_counterexample(*judge_, result_.model, std::move(word), most_halvings, control_);
    while (word.size() <= short_word || word.size() <= 2 * result_.model.size()) {
      std::optional<Word> shorter = find_shorter(word);
      if (!shorter) break;
      word = *std::move(shorter);
    }
    return word;
  }

  // Of all words with a shorter way into a state on the path, or with one piece left out, the
  // shortest that fails too.
  std::optional<Word> find_shorter(const Word& word) {
    std::vector<Query> batch;
    StateId state = result_.model.initial();
    for (std::size_t place = 0; place < word.size(); ++place) {
      if (result_.access[state].size() < place) {
        batch.emplace_back(joined(result_.access[state], tail(word, place)));
      }
      for (std::size_t end = place + 1; end < word.size(); ++end) {
        batch.emplace_back(joined(head(word, place), tail(word, end)));
      }
      state = result_.model.target(state, word[place]);
    }
    std::optional<Word> best;
    const std::vector<MealyAnswer> answers = judge_->ask(batch, control_, {});
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const Word& candidate = std::get<Word>(batch[i]);
      const std::size_t length = judge_->first_difference(candidate, answers[i]);
      if (length == 0 || length >= (best ? best->size() : word.size())) continue;
      best = head(candidate, length);
    }
    return best;
  }

  // Believes the difference at the end of the word, or not.
  void report(const Word& word) {
    if (options_.confirm) cache_->ask_afresh(judge_->to_system(word), control_);
    const std::vector<Query> batch{word};
    const MealyAnswer answer = judge_->ask(batch, control_, {}).front();
    ConformanceFailure failure;
    failure.word = word;
    failure.state = result_.model.run(head(word, word.size() - 1));
    failure.input = word.back();
    const Mealy& model = result_.model;
    failure.expected = model.outputs().name(model.output(failure.state, failure.input));
    failure.observed = answer.outputs.size() == word.size()
                           ? judge_->outputs().name(answer.outputs.back())
                           : std::string("nothing at all");
    if (options_.confirm && options_.slower && !differs_with_longer_waits(word)) {
      judge_->add_unsteady(word);
      result_.unsteady.push_back({word, failure.expected, failure.observed});
      return;
    }
    judge_->add_failure(failure.state, failure.input);
    result_.failures.push_back(std::move(failure));
  }

  bool differs_with_longer_waits(const Word& word) {
    if (!slower_) slower_ = options_.slower->open();
    const Word sent = judge_->to_system(word);
    const Word answer = slower_->ask(sent, control_);
    ++slower_words_;
    slower_symbols_ += sent.size();
    StateId state = result_.model.initial();
    std::size_t place = 0;
    for (const Symbol input : word) {
      const std::string& expected =
          result_.model.outputs().name(result_.model.output(state, input));
      state = result_.model.target(state, input);
      if (is_never_tried(expected)) continue;
      if (slower_->outputs().name(answer[place++]) != expected) return true;
    }
    return false;
  }

  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  const ConformanceOptions& options_;
  RunControl control_;
  TestChain method_;
  TestMethodOptions testing_;
  SulOracle system_;
  CountingOracle counter_;
  CountedProgress progress_;
  PortioningOracle portioned_;
  std::optional<CacheFile> file_;
  std::optional<Cache> cache_;
  std::vector<Word> known_words_;
  std::optional<Judge> judge_;
  std::unique_ptr<OutputOracle> slower_;
  std::uint64_t slower_words_ = 0, slower_symbols_ = 0;
  ConformanceResult result_;
};

}  // namespace

ConformanceResult test_conformance(IaTranslator& translator, const Mealy& model,
                                   const ConformanceOptions& options, const RunControl& control) {
  return ConformanceRun(translator, model, options, control).run();
}

}  // namespace maide
