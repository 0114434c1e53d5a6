// Random sequences of calls on the cache, with its file and its votes. Some answers of the system
// are observed wrongly. What the cache says is the system's, and nothing that is known is asked.
// What was wrong comes right once it is asked often enough.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/cache/cache_file.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "random_calls.hpp"

namespace maide::test {
namespace {

// Plays a machine; some of its answers to words are wrong.
class LyingOracle : public MealyOracle {
 public:
  using MealyOracle::ask;
  using MealyOracle::MealyOracle;
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control,
                               const PartialSink& sink) override {
    words += batch.size();
    std::vector<MealyAnswer> answers = MealyOracle::ask(batch, control, sink);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      MealyAnswer& answer = answers[i];
      // The path through a tree would be that of what really happened.
      if (answer.outputs.empty() || lies == 0 || !std::holds_alternative<Word>(batch[i])) continue;
      Symbol& output = answer.outputs[place % answer.outputs.size()];
      if (outputs().name(output) == "refused") continue;  // of that nobody is in doubt
      --lies;
      do {
        output = static_cast<Symbol>((output + 1) % outputs().size());
      } while (outputs().name(output) == "refused");
    }
    return answers;
  }
  std::uint64_t words = 0;  // that came here
  std::uint32_t lies = 0;   // of the answers to come so many are wrong
  std::uint32_t place = 0;  // where in the word
};

class CacheWorld {
 public:
  enum Kind : std::uint32_t { ask, ask_tree, ask_afresh, reopen, test, lie };
  static constexpr std::uint32_t kinds = 6;

  explicit CacheWorld(std::uint64_t seed)
      : has_refusals_(seed % 2 == 1),  // of every other system
        machine_(two_outputs(random_machine(seed, 12), has_refusals_ ? seed : 0)),
        oracle_(machine_),
        path_(directory_.path() / "cache") {
    open();
  }

  void call(const Call& call) {
    Random random(call.value);
    switch (call.kind) {
      case ask: ask_words(random); break;
      case ask_tree: ask_one_tree(random); break;
      case ask_afresh: ask_again(random_word(random, inputs(), 8)); break;
      case reopen: open(); break;
      case test: test_consistency(random); break;
      default:
        oracle_.lies = 1;
        oracle_.place = call.value;
        has_lied_ = true;
    }
    cache_->check_invariants();
  }

  // What was answered wrongly comes right once it is asked often enough.
  void finish() {
    oracle_.lies = 0;
    for (const Word& word : words_) {
      for (int i = 0; i < 12; ++i) ask_again(word);
    }
    for (const Word& word : words_) {
      const Word outputs = answer_to(word);
      promise(outputs == truth(word), "the majority is right in the end");
    }
    cache_->check_invariants();
    open();
    const std::uint64_t before = oracle_.words;
    for (const Word& word : words_) {
      promise(cache_->is_kept(word), "the file has what the cache had");
      promise(answer_to(word) == truth(word), "the file says what the cache said");
    }
    promise(oracle_.words == before, "what is known is not asked");
  }

 private:
  // With a seed some inputs are refused, which changes nothing.
  static Mealy two_outputs(Mealy machine, std::uint64_t seed = 0) {
    while (machine.outputs().size() < 2) machine.intern_output("another");
    if (seed == 0) return machine;
    Random random(seed);
    const Symbol refused = machine.intern_output("refused");
    for (StateId state = 0; state < machine.size(); ++state) {
      for (Symbol input = 0; input < machine.inputs().size(); ++input) {
        if (random.chance(0.3)) machine.set_transition(state, input, refused, state);
      }
    }
    return machine;
  }
  // The words that the cache knows when it knows this one.
  std::vector<Word> known_by(const Word& word) {
    if (!has_refusals_) return {word};
    const std::vector<std::string> outputs = names(cache_->ask(word), cache_->outputs());
    std::vector<Word> all;
    Word given;
    for (std::size_t i = 0; i < word.size(); ++i) {
      given.push_back(word[i]);
      if (outputs[i] != "refused") continue;
      all.push_back(given);
      given.pop_back();
    }
    all.push_back(given);
    return all;
  }
  std::size_t inputs() const { return machine_.inputs().size(); }

  // By name, for the cache numbers outputs in its own way.
  std::vector<std::string> names(const Word& outputs, const Alphabet& alphabet) const {
    std::vector<std::string> result;
    for (const Symbol output : outputs) result.push_back(alphabet.name(output));
    return result;
  }
  Word truth(const Word& word) const {
    Word outputs;
    for (const Symbol output : machine_.output_word(word)) {
      outputs.push_back(cache_->intern_output(machine_.outputs().name(output)));
    }
    return outputs;
  }

  void open() {
    cache_.reset();
    file_.reset();
    file_ = std::make_unique<CacheFile>(path_, machine_.inputs(), Fingerprint{{"kind", "test"}});
    cache_ = std::make_unique<Cache>(oracle_, *file_, Cache::refusals_of(has_refusals_));
    cache_->hold_votes({});
    has_run_.clear();
  }

  Word answer_to(const Word& word) {
    while (true) {
      try {
        Word outputs = cache_->ask(std::vector<Query>{word})[0].outputs;
        has_run_.insert(word);
        return outputs;
      } catch (const CacheCorrected&) {
        has_run_.clear();
      }
    }
  }

  void ask_words(Random& random) {
    std::vector<Query> batch;
    for (std::size_t i = 1 + random.below(5); i > 0; --i) {
      Word word = random_word(random, inputs(), 8);
      if (random.chance(0.5) && !batch.empty()) {
        word = joined(std::get<Word>(batch.back()), word);  // the other is a prefix of it
      }
      batch.emplace_back(word);
    }
    random.shuffle(batch);
    for (const Query& query : batch) words_.insert(std::get<Word>(query));
    std::vector<MealyAnswer> answers;
    try {
      answers = cache_->ask(batch);
    } catch (const CacheCorrected&) {
      has_run_.clear();
      return;
    }
    const std::uint64_t before = oracle_.words;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const Word& word = std::get<Word>(batch[i]);
      has_run_.insert(word);
      promise(answers[i].inputs == word, "the whole word is answered");
      promise(has_lied_ || answers[i].outputs == truth(word), "the answer is the system's");
      if (has_refusals_ && has_lied_) continue;  // asking some as they are may correct others
      promise(cache_->ask(word) == answers[i].outputs, "it is answered again alike");
    }
    // Of what may be asked without what is refused, some is asked as it is.
    promise(has_refusals_ || oracle_.words == before, "what is known is not asked");
  }

  // A chain with branches to all outputs, and a leaf that ends after some.
  void ask_one_tree(Random& random) {
    DecisionTree tree;
    const std::size_t length = 1 + random.below(5);
    for (std::size_t i = 0; i < length; ++i) {
      auto& node = tree.nodes.emplace_back();
      node.input = static_cast<Symbol>(random.below(inputs()));
      if (i + 1 == length) break;
      for (const std::string& name : machine_.outputs().names()) {
        if (random.chance(0.8)) {
          node.branches.emplace_back(cache_->intern_output(name),
                                     static_cast<std::uint32_t>(i + 1));
        }
      }
    }
    try {
      const MealyAnswer answer = cache_->ask(std::vector<Query>{tree})[0];
      promise(answer.inputs.size() == answer.outputs.size(), "the path is answered");
      promise(has_lied_ || answer.outputs == truth(answer.inputs), "the path is the system's");
      std::size_t node = 0;
      for (std::size_t i = 0; i < answer.inputs.size(); ++i) {
        promise(answer.inputs[i] == tree.nodes.at(node).input, "the path is one of the tree");
        std::size_t next = tree.nodes.size();
        for (const auto& [output, below] : tree.nodes[node].branches) {
          if (output == answer.outputs[i]) next = below;
        }
        promise((next == tree.nodes.size()) == (i + 1 == answer.inputs.size()),
                "it ends where there is no branch");
        node = next;
      }
      words_.insert(answer.inputs);
      has_run_.insert(answer.inputs);
    } catch (const CacheCorrected&) {
      has_run_.clear();
    }
  }

  void ask_again(const Word& word) {
    words_.insert(word);
    const std::uint64_t before = oracle_.words;
    try {
      cache_->ask_afresh(word);
    } catch (const CacheCorrected&) {
      has_run_.clear();
    }
    promise(oracle_.words > before, "the system is asked, whatever is known");
  }

  // Against all that was asked in this run, by hand.
  void test_consistency(Random& random) {
    if (has_refusals_ && has_lied_) return;
    const Mealy hypothesis = two_outputs(
        random_mealy({.states = random.between(1, 4), .inputs = inputs(), .outputs = 2}, random));
    if (!(hypothesis.inputs() == machine_.inputs())) return;
    std::optional<Word> least;
    std::set<Word> all;
    for (const Word& word : has_run_) {
      for (const Word& known : known_by(word)) all.insert(known);
    }
    for (const Word& word : all) {
      const std::vector<std::string> known = names(cache_->ask(word), cache_->outputs());
      const std::vector<std::string> guess =
          names(hypothesis.output_word(word), hypothesis.outputs());
      const auto place = std::mismatch(known.begin(), known.end(), guess.begin()).first;
      if (place == known.end()) continue;
      const Word wrong = head(word, static_cast<std::size_t>(place - known.begin()) + 1);
      if (!least || std::pair(wrong.size(), wrong) < std::pair(least->size(), *least))
        least = wrong;
    }
    const auto found = cache_->make_consistency_test()->find_counterexample(hypothesis);
    promise(found == least, "the consistency test finds the least known word");
  }

  bool has_refusals_;
  Mealy machine_;
  LyingOracle oracle_;
  TempDir directory_;
  std::filesystem::path path_;
  std::unique_ptr<CacheFile> file_;
  std::unique_ptr<Cache> cache_;
  std::set<Word> words_;    // asked at any time
  std::set<Word> has_run_;  // answered since the cache was opened or corrected
  bool has_lied_ = false;
};

std::string play_cache(const Scenario& scenario) {
  return play_calls(scenario,
                    [](std::uint64_t seed) { return std::make_unique<CacheWorld>(seed); });
}

// Sequences that failed once.
TEST(CacheCallRegressions, StayMended) {
  const std::vector<Scenario> scenarios{
      {7, {{5, 8717}, {1, 3}}},  // a wrong answer is due while a tree is asked
  };
  for (const Scenario& scenario : scenarios) EXPECT_EQ(play_cache(scenario), "");
}

TEST(CacheCalls, KeepItsPromises) {
  expect_no_failure(
      RandomCalls{.scenarios = 150, .calls = 25, .kinds = CacheWorld::kinds, .values = 10000},
      play_cache);
}

}  // namespace
}  // namespace maide::test
