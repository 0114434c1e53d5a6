#include "maide/conformance/method/standard_method.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "maide/automata/alphabet.hpp"
#include "maide/base/log.hpp"
#include "maide/base/numbers.hpp"
#include "maide/conformance/identify/separating_words.hpp"
#include "maide/conformance/method/complete_method.hpp"
#include "maide/conformance/suite/loop_suites.hpp"
#include "maide/conformance/suite/random_identifier_suite.hpp"
#include "maide/conformance/suite/test_suite.hpp"
#include "maide/learn/counterexample.hpp"
#include "maide/learn/oracle/error_outputs.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide {
namespace {

// More than one extra state is tested for where that costs at most so many tests.
constexpr std::uint64_t cheap_tests = 5000;
// Random tests of a hypothesis that is tested for `extra_states_without_random`.
constexpr std::uint64_t few_random_tests = 200;
// Inputs that may be spent on a guess, beside the tests of a hypothesis that is small.
constexpr std::uint64_t growth_symbols = 2000;
// Samples cost at most this share of what the suites before them cost, unless the hypothesis is
// tiny; chains behind other ways and ladders likewise.
constexpr std::uint64_t share_of_samples = 24, share_of_ways = 12, share_of_ladders = 2;
// Chains are drawn again as long as all of a state are of so many inputs on average.
constexpr std::uint64_t cheap_chain = 1000;
// Counterexamples of at most so many inputs beyond an access word are not shortened.
constexpr std::size_t short_enough = 8;
// A circuit of more inputs is not drawn: it would take hundreds of megabytes.
constexpr std::uint64_t longest_circuit = 1 << 23;

std::size_t longest_access(const Mealy& hypothesis) {
  return compute_state_cover(hypothesis).back().size();
}

}  // namespace

// One equivalence query: a hypothesis, and what is left of the budget.
class StandardMethod::Query {
 public:
  Query(StandardMethod& method, const Mealy& hypothesis, const RunControl& control)
      : method_(method),
        options_(method.options_),
        hypothesis_(hypothesis),
        control_(control),
        identifiers_(hads_identifiers.compute(hypothesis, Random(options_.seed))),
        is_error_(find_error_outputs(hypothesis, method.oracle_)),
        loops_(hypothesis, identifiers_, is_error_),
        left_(options_.budget),
        demand_(demand_of(hypothesis, options_.sizes, options_.strength)) {
    if (options_.max_tests) left_.words = std::min(left_.words, *options_.max_tests);
  }

  std::optional<Word> run() {
    trying_ = "testing long words";
    if (auto word = grow()) return word;
    trying_ = "testing extra states";
    std::optional<Word> word = run_base();
    trying_ = "testing inputs that loop";
    if (!word) word = run_loops();
    if (!word) return std::nullopt;
    strength_ = {};  // it is refuted, whatever ends the shortening
    guarantee_.clear();
    const std::uint64_t most_queries = 64 + 2 * word->size();
    return shorten_counterexample(method_.oracle_, hypothesis_, *std::move(word), most_queries,
                                  control_);
  }

  const std::string& guarantee() const { return guarantee_; }
  const Strength& strength() const { return strength_; }
  const TestCost& missing() const { return missing_; }

 private:
  std::optional<Word> ask(TestSuite& suite, TestCost most, bool whole_words = false) {
    TestRunner runner(method_.oracle_, {.max_tests = std::min(most.words, left_.words),
                                        .batch_size = options_.batch_size,
                                        .max_symbols = std::min(most.symbols, left_.symbols),
                                        .phase = trying_,
                                        .whole_words = whole_words});
    std::optional<Word> word = runner.run(suite, hypothesis_, control_);
    left_.words -= std::min(left_.words, runner.last_tests());
    left_.symbols -= std::min(left_.symbols, runner.last_symbols());
    was_complete_ = runner.last_was_complete();
    return word;
  }
  std::uint64_t spent() const { return options_.budget.symbols - left_.symbols; }
  // A part of what is left.
  TestCost part_of_rest(std::uint64_t divisor) const {
    return {left_.words / divisor, left_.symbols / divisor};
  }
  static bool fits(const TestSuite& suite, TestCost limit) {
    return *suite.size() <= limit.words && *suite.symbols() <= limit.symbols;
  }
  void miss(std::uint64_t words, std::uint64_t symbols) {
    missing_.words = saturating_sum(missing_.words, words);
    missing_.symbols = saturating_sum(missing_.symbols, symbols);
  }

  std::optional<Word> grow() {
    GrowthSuite suite(loops_, options_.sizes, growth_symbols + sizes_cost());
    return ask(suite, left_, true);
  }
  std::uint64_t sizes_cost() const {
    std::uint64_t cost = 0;
    for (const std::size_t size : options_.sizes) cost += 8 * size;
    return cost;
  }

  // How deep the complete suite goes.
  std::size_t choose_extra_states(const IdentifierSuite& suite, std::size_t most) const {
    const TestCost limit = part_of_rest(2);
    std::size_t extra = 0;
    for (std::size_t next = 1; next <= most; ++next) {
      const bool is_wanted = next <= demand_.extra_states || suite.size_up_to(next) <= cheap_tests;
      const bool is_paid =
          suite.size_up_to(next) <= limit.words && suite.symbols_up_to(next) <= limit.symbols;
      if (!is_wanted || !is_paid) break;
      extra = next;
    }
    return extra;
  }

  std::optional<Word> run_base() {
    const std::size_t most = std::max(options_.extra_states, demand_.extra_states);
    IdentifierSuite complete(hypothesis_, identifiers_, most, is_error_);
    const std::size_t extra = choose_extra_states(complete, most);
    const TestCost paid = part_of_rest(2);
    const std::uint64_t complete_tests =
        complete.symbols_up_to(extra) <= paid.symbols ? complete.size_up_to(extra) : paid.words / 2;
    const bool is_deep = extra >= extra_states_without_random;
    const std::uint64_t wanted = is_deep ? few_random_tests : demand_.random;
    const std::uint64_t random_count =
        std::min(wanted, left_.words - std::min(left_.words, complete_tests));
    const InfixLaw law;
    RandomIdentifierSuite random(hypothesis_, identifiers_, law, method_.random_.split(),
                                 method_.counterexamples_);
    AlternatingSuite tests({random, random_count}, {complete, complete_tests},
                           hypothesis_.size() * hypothesis_.inputs().size());
    log_detail(fmt::format("{} random tests and {} of hybrid ADS, for {} states", random_count,
                           complete_tests, hypothesis_.size()));
    if (auto word = ask(tests, left_)) return word;
    strength_.extra_states = complete.complete_for();
    strength_.random = tests.made_of_first();
    guarantee_ = describe_passed(complete, tests.made_of_second(), hads_identifiers, hypothesis_) +
                 "; " + describe_passed(strength_.random, hads_identifiers, law);
    if (strength_.extra_states < demand_.extra_states) {
      miss(complete.size_up_to(demand_.extra_states) - tests.made_of_second(),
           complete.symbols_up_to(demand_.extra_states));
    }
    if (strength_.random < wanted) {
      const std::uint64_t missing = wanted - strength_.random;
      miss(missing, saturating_product(missing, 10 + longest_access(hypothesis_)));
    }
    return std::nullopt;
  }

  // Where no input loops, what is demanded of those that do is met.
  std::optional<Word> run_loops() {
    const auto loops_in = [&](const auto& start) { return !loops_.of(start.state).empty(); };
    if (std::ranges::none_of(loops_.states(), loops_in)) {
      strength_.chained = demand_.chained;
      strength_.pumped = demand_.pumped;
      guarantee_ += "; in no state an input loops";
      return std::nullopt;
    }
    std::optional<Word> word = run_chains();
    if (!word) word = run_pumps();
    if (!word) word = run_samples();
    return word;
  }

  ChainSuite make_chains(std::size_t order) {
    return {loops_, loops_.states(), order, ChainSuite::long_piece, method_.random_.split()};
  }

  // All words of as many looping inputs as the budget pays for, twice at least; of one more,
  // some.
  std::optional<Word> run_chains() {
    const TestCost limit = part_of_rest(2);
    std::size_t order = 0;
    while (order < demand_.chained && fits(make_chains(order + 1), limit)) {
      ++order;
    }
    if (order > 0) {
      ChainSuite suite = make_chains(order);
      if (auto word = ask(suite, left_)) return word;
      if (was_complete_) strength_.chained = order;
      const std::uint64_t average = *suite.symbols() / hypothesis_.size() + 1;
      for (std::uint64_t i = 0; i < std::clamp<std::uint64_t>(cheap_chain / average, 1, 4); ++i) {
        ChainSuite again(loops_, loops_.states(), order, ChainSuite::short_piece,
                         method_.random_.split());
        if (auto word = ask(again, part_of_rest(4))) return word;
      }
    }
    if (order < demand_.chained) {
      const ChainSuite whole = make_chains(demand_.chained);
      miss(*whole.size(), *whole.symbols());
      if (auto word = run_some_chains(order + 1, limit)) return word;
    }
    guarantee_ += fmt::format("; in each state every word of {} looping inputs", strength_.chained);
    return std::nullopt;
  }

  std::optional<Word> run_some_chains(std::size_t order, TestCost limit) {
    std::uint64_t circuit = 1;
    for (std::size_t i = 0; i < order; ++i) {
      circuit = saturating_product(circuit, hypothesis_.inputs().size());
    }
    if (circuit > longest_circuit) return std::nullopt;
    const ChainSuite one(loops_, loops_.states(), order, ChainSuite::short_piece, Random(0), 1);
    const std::uint64_t pieces =
        std::min(limit.symbols / std::max<std::uint64_t>(*one.symbols(), 1),
                 limit.words / std::max<std::uint64_t>(*one.size(), 1));
    ChainSuite suite(loops_, loops_.states(), order, ChainSuite::short_piece,
                     method_.random_.split(), std::max<std::uint64_t>(pieces, 1));
    return ask(suite, limit);
  }

  // As often as is demanded, or half of it, or a quarter, ..., as the budget pays for; where it
  // pays for all, also once less and once more than the sizes that are named, and as often.
  std::optional<Word> run_pumps() {
    const std::size_t most = longest_test / 4;
    std::vector<std::size_t> counts{std::min(demand_.pumped, most)};
    for (const std::size_t size : options_.sizes) {
      for (const std::size_t count : {size - 1, size, size + 1, 2 * size}) {
        if (count > 0 && count < counts.front()) counts.push_back(count);
      }
    }
    std::ranges::sort(counts);
    counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
    const auto is_paid = [&] { return fits(PumpSuite(loops_, counts), left_); };
    if (!is_paid()) {
      counts = {std::min(demand_.pumped, most)};
      if (!is_paid()) {
        const PumpSuite whole(loops_, counts);
        miss(*whole.size(), *whole.symbols());
      }
      while (counts.back() > 1 && !is_paid()) counts.back() /= 2;
    }
    PumpSuite suite(loops_, counts);
    if (auto word = ask(suite, left_)) return word;
    if (was_complete_) strength_.pumped = counts.back();
    guarantee_ +=
        fmt::format(", and each repeated {} times before each other input", strength_.pumped);
    return std::nullopt;
  }

  std::optional<Word> run_samples() {
    const std::uint64_t before = spent();
    ChainSuite ways(loops_, loops_.ways(), std::max<std::size_t>(strength_.chained, 1),
                    ChainSuite::short_piece, method_.random_.split());
    if (auto word = ask(ways, {left_.words, before / share_of_ways})) return word;
    LadderSuite ladders(loops_, demand_.pumped);
    if (auto word = ask(ladders, {left_.words, before / share_of_ladders})) return word;
    LoopSampler sampler(loops_, demand_.pumped, method_.random_.split());
    // A hypothesis of very few states is the likeliest to miss something.
    const std::size_t states = hypothesis_.size();
    const std::size_t halvings = std::min<std::size_t>(states <= 3 ? states : 2 * states, 63);
    const std::uint64_t symbols =
        std::max(before / share_of_samples,
                 std::min(2 * sampler.enough(), options_.budget.symbols >> halvings));
    return ask(sampler, {left_.words, symbols});
  }

  StandardMethod& method_;
  const StandardMethodOptions& options_;
  const Mealy& hypothesis_;
  const RunControl& control_;
  StateIdentifiers identifiers_;
  std::vector<bool> is_error_;  // by output, or empty
  LoopingInputs loops_;
  TestCost left_;
  StrengthDemand demand_;
  std::string_view trying_ = "testing";  // what the tests are, for progress
  bool was_complete_ = false;            // the last suite
  Strength strength_;
  TestCost missing_;
  std::string guarantee_;
};

StandardMethod::StandardMethod(OutputOracle& oracle, StandardMethodOptions options)
    : oracle_(oracle),
      options_(std::move(options)),
      random_(options_.seed),
      random_walk_(oracle, {.seed = options_.seed, .batch_size = options_.batch_size}) {
  if (!options_.strength.empty()) parse_demand(options_.strength, {});
}

std::optional<Word> StandardMethod::find_counterexample(const Mealy& hypothesis,
                                                        const RunControl& control) {
  guarantee_ = "not tested to the end";
  strength_ = {};
  missing_ = {};
  Query query(*this, hypothesis, control);
  std::optional<Word> counterexample;
  try {
    counterexample = query.run();
    if (!counterexample && hypothesis.inputs().find(delta_input).has_value()) {
      counterexample = random_walk_.find_counterexample(hypothesis, control);
    }
  } catch (...) {  // what the suites before have established stays
    strength_ = query.strength();
    if (!query.guarantee().empty()) guarantee_ += "; " + query.guarantee();
    throw;
  }
  if (counterexample) {
    counterexamples_.push_back(*counterexample);
    guarantee_ = "refuted by a test";
    return counterexample;
  }
  guarantee_ = query.guarantee();
  if (hypothesis.inputs().find(delta_input).has_value()) {
    guarantee_ += "; " + random_walk_.guarantee();
  }
  strength_ = query.strength();
  missing_ = query.missing();
  return std::nullopt;
}

namespace {

// Words that may be counterexamples, asked one by one.
class Shortening {
 public:
  Shortening(OutputOracle& oracle, const Mealy& hypothesis, Word word, std::uint64_t most_queries,
             const RunControl& control)
      : runner_(oracle, {.batch_size = 1}),
        hypothesis_(hypothesis),
        word_(std::move(word)),
        queries_left_(most_queries),
        control_(control) {}

  // The last inputs, 1, 2, 4, ... of them, behind the word that reaches their state in a shorter
  // way.
  void cut_front() {
    const std::vector<StateId> states = states_along(hypothesis_, word_);
    const std::vector<Word> cover = compute_state_cover(hypothesis_);
    std::vector<const Word*> access(hypothesis_.size());
    for (const Word& word : cover) access[hypothesis_.run(word)] = &word;
    const Word whole = word_;
    for (std::size_t last = 1; last < whole.size(); last *= 2) {
      const std::size_t place = whole.size() - last;
      const Word& shorter = *access[states[place]];
      if (shorter.size() < place && accept(joined(shorter, tail(whole, place)))) return;
    }
  }

  // Leaves out pieces, half of it, a quarter, ..., one input, as long as it remains one.
  void leave_out() {
    for (std::size_t piece = word_.size() / 2; piece > 0 && queries_left_ > 0; piece /= 2) {
      for (std::size_t end = word_.size(); end >= piece && queries_left_ > 0;) {
        Word shorter = head(word_, end - piece);
        shorter.insert(shorter.end(), word_.begin() + static_cast<std::ptrdiff_t>(end),
                       word_.end());
        if (accept(std::move(shorter))) {
          end = std::min(end - piece, word_.size());
        } else {
          end -= piece;
        }
      }
    }
  }

  const Word& word() const { return word_; }

 private:
  bool accept(Word word) {
    if (word.empty() || queries_left_ == 0) return false;
    --queries_left_;
    struct One : TestSuite {
      explicit One(Word word) : word_(std::move(word)) {}
      bool next(Word& word) override {
        word = std::move(word_);
        return !std::exchange(is_made_, true);
      }
      std::optional<std::uint64_t> size() const override { return 1; }
      Word word_;
      bool is_made_ = false;
    } suite(std::move(word));
    std::optional<Word> difference = runner_.run(suite, hypothesis_, control_);
    if (!difference || difference->size() >= word_.size()) return false;
    word_ = *std::move(difference);
    return true;
  }

  TestRunner runner_;
  const Mealy& hypothesis_;
  Word word_;
  std::uint64_t queries_left_;
  const RunControl& control_;
};

}  // namespace

Word shorten_counterexample(OutputOracle& oracle, const Mealy& hypothesis, Word word,
                            std::uint64_t most_queries, const RunControl& control) {
  const std::size_t enough = longest_access(hypothesis) + short_enough;
  if (word.size() <= enough) return word;
  Shortening shortening(oracle, hypothesis, std::move(word), most_queries, control);
  shortening.cut_front();
  if (shortening.word().size() > enough) shortening.leave_out();
  return shortening.word();
}

}  // namespace maide
