// Random sequences of calls on a pool of systems that die and of systems that come, also from
// another thread, while batches are run to their end or are stopped: each word is answered once,
// and rightly, and each death is counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/sul/simulated_sul.hpp"
#include "maide/sul/sul_pool.hpp"
#include "random_calls.hpp"

namespace maide::test {
namespace {

// A machine that dies after so many words.
class MortalSul : public SimulatedSul {
 public:
  explicit MortalSul(const Mealy& machine) : SimulatedSul(machine, "mortal") {}
  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override {
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (words_left == 0) {
        incidents_.add({"it died", "", ""});
        throw WrapperError("it died", "somewhere");
      }
      --words_left;
      const auto one = [&](std::size_t, SulAnswer answer) { sink(i, std::move(answer)); };
      SimulatedSul::run(batch.subspan(i, 1), one, control);
    }
  }
  SulIncidents incidents() const override { return incidents_; }
  std::size_t words_left = ~std::size_t{0};

 private:
  SulIncidents incidents_;
};

class PoolWorld {
 public:
  enum Kind : std::uint32_t {
    run,
    run_many,
    kill,
    stop_in_sink,
    stop_by_token,
    come,
    come_while_running,
    come_as_another
  };
  static constexpr std::uint32_t kinds = 8;

  explicit PoolWorld(std::uint64_t seed) : machine_(random_machine(seed, 8)) {
    std::vector<SulPool::Member> members;
    for (std::size_t i = 0; i < 2 + seed % 3; ++i) members.push_back(make_member());
    pool_ =
        std::make_unique<SulPool>(std::move(members), [this](std::string_view) { ++warnings_; });
  }

  void call(const Call& call) {
    switch (call.kind) {
      case run: run_words(1 + call.value % 4, call.value, End::never); break;
      case run_many: run_words(40 + call.value % 60, call.value, End::never); break;
      case stop_in_sink: run_words(60, call.value, End::in_sink); break;
      case stop_by_token: run_words(60, call.value, End::by_token); break;
      case come: pool_->admit(make_member()); break;
      case come_while_running: {
        // Made here, for the list of systems is this thread's.
        std::vector<SulPool::Member> members;
        for (std::size_t i = 0; i <= call.value % 3; ++i) {
          members.push_back(make_member());
          suls_.back()->words_left = call.value % 5 == 0 ? call.value % 7 : ~std::size_t{0};
          if (call.value % 5 == 0) mortal_.insert(suls_.size() - 1);
        }
        const std::jthread comer([&] {
          for (SulPool::Member& member : members) pool_->admit(std::move(member));
        });
        run_words(40 + call.value % 60, call.value, End::never);
        break;
      }
      case come_as_another: {
        SulPool::Member other{"other", std::make_unique<SimulatedSul>(machine_, "other")};
        try {
          pool_->admit(std::move(other));
          promise(false, "another system is refused");
        } catch (const UsageError&) {
          promise(other.sul != nullptr, "what is refused stays the caller's");
        }
        break;
      }
      default: {  // one of those that live dies soon
        MortalSul*& sul = suls_[call.value % suls_.size()];
        if (sul != nullptr) sul->words_left = call.value % 7;
        mortal_.insert(call.value % suls_.size());
      }
    }
    count_the_dead();
  }

  void finish() {
    if (pool_->size() > 0) run_words(30, 1, End::never);
  }

 private:
  enum class End : std::uint8_t { never, in_sink, by_token };
  struct Enough {};

  SulPool::Member make_member() {
    auto sul = std::make_unique<MortalSul>(machine_);
    suls_.push_back(sul.get());
    return {"m" + std::to_string(size_++), std::move(sul)};
  }

  void run_words(std::size_t count, std::uint64_t seed, End end) {
    Random random(seed);
    std::vector<SulQuery> batch;
    for (std::size_t i = 0; i < count; ++i) {
      batch.push_back({random_word(random, machine_.inputs().size(), 6), Translation::eager});
    }
    std::vector<int> times(count, 0);
    std::stop_source stop;
    RunControl control;
    control.stop = stop.get_token();
    std::size_t answered = 0;
    const auto sink = [&](std::size_t index, SulAnswer answer) {
      ++times.at(index);
      expect_answer(batch[index], answer);
      if (++answered <= seed % 20) return;
      if (end == End::in_sink) throw Enough{};
      if (end == End::by_token) stop.request_stop();
    };
    bool is_over = false;
    try {
      pool_->run(batch, sink, control);
      is_over = true;
    } catch (const WrapperError&) {
      promise(pool_->size() == 0, "a pool fails when all of its systems have");
    } catch (const Interrupted&) {
      promise(end == End::by_token, "a pool stops when it is told to");
    } catch (const Enough&) {
      promise(end == End::in_sink, "what the sink throws comes out");
    }
    for (const int count_of : times) {
      promise(count_of <= 1 && (!is_over || count_of == 1), "each word is answered once");
    }
  }

  // Once nobody else comes.
  void count_the_dead() {
    pool_->run({}, {}, {});  // takes in who has come
    forget_the_dead();
    promise(pool_->size() + mortal_.size() >= size_, "only those die that were to");
    promise(pool_->incidents().count == size_ - pool_->size(), "each death is counted once");
  }

  void expect_answer(const SulQuery& query, const SulAnswer& answer) const {
    const Word& word = std::get<Word>(query.inputs);
    const Word outputs = machine_.output_word(word);
    promise(answer.inputs == word && answer.steps.size() == word.size(), "the word is answered");
    for (std::size_t i = 0; i < word.size(); ++i) {
      promise(
          mealy_output(answer.steps[i], Translation::eager) == machine_.outputs().name(outputs[i]),
          "the answer is that of this word");
    }
  }

  // The pool owns them no more.
  void forget_the_dead() {
    if (pool_->size() == 0) std::ranges::fill(suls_, nullptr);
    if (pool_->size() == size_) return;
    for (const std::size_t index : mortal_) suls_[index] = nullptr;
  }

  Mealy machine_;
  std::vector<MortalSul*> suls_;  // null: it may be dead
  std::set<std::size_t> mortal_;  // that were told to die
  std::size_t size_ = 0;
  int warnings_ = 0;
  std::unique_ptr<SulPool> pool_;
};

std::string play_pool(const Scenario& scenario) {
  return play_calls(scenario, [](std::uint64_t seed) { return std::make_unique<PoolWorld>(seed); });
}

TEST(PoolCalls, KeepItsPromises) {
  expect_no_failure(
      RandomCalls{.scenarios = 150, .calls = 10, .kinds = PoolWorld::kinds, .values = 10000},
      play_pool);
}

}  // namespace
}  // namespace maide::test
