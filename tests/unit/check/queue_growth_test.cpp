// Queues that have too many states to make them all: what programs see of one is what they see of
// the whole, and who gives up says so.
#include "maide/check/build/queue_growth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <stop_token>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/random.hpp"
#include "maide/base/run_control.hpp"
#include "maide/check/build/build_system.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide {
namespace {

constexpr QueueLimits grows_all{0, 1'000'000, 3'000'000, 2'000'000};

System read(const std::string& text, const QueueLimits& limits = {},
            const RunControl& control = {}) {
  const Declarations declared = declare(read_tree(text, "s.yaml"));
  return build_system(declared, find_models(declared, test::test_model, limits), limits, control);
}

CheckReport check(const System& system, Reduction reduction) {
  NativeEngine engine;
  CheckRequest request;
  request.options.reduction = reduction;
  return check_system(system, engine, request);
}

// What each property came to. Of what was visited without reductions, how much.
std::vector<std::string> verdicts(const System& system, Reduction reduction) {
  std::vector<std::string> result;
  for (const PropertyResult& property : check(system, reduction).properties) {
    result.push_back(property.name + " " + to_string(property.verdict));
    if (reduction == Reduction::none) {
      result.back() += " " + std::to_string(property.states) + " states, " +
                       std::to_string(property.transitions) + " steps";
    }
  }
  return result;
}

class ProgramMaker {
 public:
  explicit ProgramMaker(Random& random) : random_(random) {}

  // Writes into that queue at the end of each round.
  std::string program(const std::string& queue) {
    return "var x: 0..2; loop { " + block(3) + queue + ".write(x); }";
  }

 private:
  std::string some_queue() { return random_.chance(0.5) ? "p" : "q"; }
  std::string value() { return random_.chance(0.5) ? "x" : std::to_string(random_.below(3)); }
  std::string read() { return some_queue() + ".read -> message(x)"; }
  std::string write() { return some_queue() + ".write(" + value() + ")"; }

  // One that reads, one that writes, or both.
  std::string arms() {
    const bool reads = random_.chance(0.7), writes = !reads || random_.chance(0.5);
    std::string arms;
    for (const std::string& arm : {reads ? read() : "", writes ? write() : ""}) {
      if (arm.empty()) continue;
      arms += (random_.chance(0.3) ? "when (n == 1) on " : "on ") + arm + " { } ";
    }
    return arms + (random_.chance(0.5) ? "otherwise { n = x % 2; } " : "");
  }

  std::string statement() {
    switch (random_.below(7)) {
      case 0:
      case 1: return write() + "; ";
      case 2: return read() + "; ";
      case 3: return "x = (x + 1) % 3; ";
      case 4: return "if * { " + write() + "; } else { x = any 0..2; } ";
      case 5: return "if (x == " + std::to_string(random_.below(3)) + ") { " + read() + "; } ";
      default: return "select { " + arms() + "} ";
    }
  }

  std::string block(std::uint64_t most) {
    std::string block;
    for (std::uint64_t left = 1 + random_.below(most); left > 0; --left) block += statement();
    return block;
  }

  Random& random_;
};

std::string random_system(Random& random) {
  std::string text = "models:\n";
  for (const std::string queue : {"p", "q"}) {
    text += "  " + queue + ": {use: queue, with: {" + (random.chance(0.3) ? "depth" : "size") +
            ": " + std::to_string(1 + random.below(2)) + "}}\n";
  }
  text += "variables: \"var n: 0..1;\"\nprograms:\n";
  ProgramMaker maker(random);
  text += "  a: \"" + maker.program("p") + "\"\n  b: \"" + maker.program("q") + "\"\n";
  return text + "properties:\n  reads: {ltl: \"G F q!message\", fairness: weak}\n" +
         "  low: {always: \"n == 0\"}\n";
}

TEST(QueueGrowth, VerdictsAndStatesAreThoseOfTheWholeQueue) {
  Random random(23);
  std::size_t violated = 0, holding = 0, smaller = 0;
  for (int round = 0; round < 150; ++round) {
    const std::string text = random_system(random);
    SCOPED_TRACE(text);
    const System whole = read(text), grown = read(text, grows_all);
    EXPECT_FALSE(whole.models[0].is_grown);
    EXPECT_TRUE(grown.models[0].is_grown);
    smaller += grown.models[0].automaton.size() < whole.models[0].automaton.size() ? 1 : 0;
    for (const Reduction reduction : {Reduction::none, Reduction::full}) {
      const auto expected = verdicts(whole, reduction);
      ASSERT_EQ(verdicts(grown, reduction), expected);
      for (const std::string& verdict : expected) {
        violated += verdict.find("violated") != std::string::npos ? 1 : 0;
        holding += verdict.find("holds") != std::string::npos ? 1 : 0;
      }
    }
  }
  EXPECT_GT(violated, 100u);
  EXPECT_GT(holding, 100u);
  EXPECT_GT(smaller, 30u);
}

// Ten places over eight values: 2.4e9 states, of which a sender that counts reaches a hundred or
// so.
const std::string counting =
    "models:\n  q: {use: queue, with: {size: 10}}\n"
    "programs:\n  sender: \"var k: 0..7; loop { q.write(k); k = (k + 1) % 8; }\"\n"
    "  reader: \"var last: 0..7 = 7; loop { q.read -> message(var k); "
    "if (k != (last + 1) % 8) { last = 8; } last = k; }\"\n";

TEST(QueueGrowth, ALargeQueueHasTheStatesThatAreMet) {
  const System system = read(counting);
  ASSERT_TRUE(system.models[0].is_grown);
  // Kept 0 to 10 messages, or 0 to 9 behind one that is due, from each of eight on; a read that
  // waits; and all else.
  EXPECT_LE(system.models[0].automaton.size(), 8u * 22u + 2u);
  const CheckReport report = check(system, Reduction::none);
  EXPECT_EQ(report.verdict, Verdict::holds);
  EXPECT_TRUE(std::any_of(report.assumptions.begin(), report.assumptions.end(),
                          [](const std::string& line) {
                            return line.find("a queue of size 10") != std::string::npos;
                          }));
  EXPECT_EQ(check(system, Reduction::full).verdict, Verdict::holds);
}

TEST(QueueGrowth, WhoGivesUpSaysSo) {
  const System system = read(counting, {200'000, 50, 2'000'000});
  const CheckReport report = check(system, Reduction::none);
  EXPECT_EQ(report.verdict, Verdict::inconclusive);
  EXPECT_NE(report.properties[0].reason.find("q was made with the"), std::string::npos)
      << report.properties[0].reason;
  // What is found before is found.
  const System wrong = read(
      "models:\n  q: {use: queue, with: {size: 10}}\n"
      "programs:\n  a: \"var k: 0..7; k = any 0..7; q.write(k); if (k == 3) { k = 8; }\"\n",
      {200'000, 5, 2'000'000});
  EXPECT_EQ(check(wrong, Reduction::none).verdict, Verdict::violated);
}

// When time is up the queue has the states that were met, and the verdict says that others were
// not. Who is told to stop makes no system.
TEST(QueueGrowth, TimeAndStopEndTheSearch) {
  RunControl late;
  late.deadline = std::chrono::steady_clock::now();
  const System system = read(counting, {}, late);
  EXPECT_LE(system.models[0].automaton.size(), 12u);
  EXPECT_EQ(check(system, Reduction::none).verdict, Verdict::inconclusive);
  std::stop_source source;
  source.request_stop();
  RunControl stopped;
  stopped.stop = source.get_token();
  EXPECT_THROW(read(counting, {}, stopped), Interrupted);
}

// Each of 24 runs of callbacks does something with the service in each of its states. Only those
// that are met are made.
TEST(QueueGrowth, AServiceOfManyRunsHeedsTheTime) {
  RunControl late;
  late.deadline = std::chrono::steady_clock::now();
  const System system = read(
      "services: {s: {server: n, clients: n}}\n"
      "topics: {t: {writers: w, readers: n, use: queue, with: {size: 8}}}\n"
      "programs: {w: \"loop { t.write; }\"}\n"
      "executors: {e: {kind: multi, threads: 8}}\n"
      "nodes: {n: {executor: e, groups: {g: reentrant}, clients: {s: g}, callbacks: {"
      "on: {takes: t.read, group: g, do: \"s.send; wait s -> answer;\"}, "
      "sv: {serves: s, group: g, do: \"s.answer;\"}}}}\n",
      {}, late);
  EXPECT_LE(system.models[0].automaton.size(), 100u);
  EXPECT_TRUE(system.models[0].is_grown) << "cut, as a verdict says";
}

TEST(QueueGrowth, EachModelThatIsMadeWholeHasTheStatesThatAreMet) {
  QueueLimits limits;
  limits.searched_first = 0;
  const System system = read(
      "services: {first: {server: p, clients: q, delivery: at_once}, second: {server: r, clients: "
      "s, delivery: at_once}}\n"
      "programs:\n"
      "  p: \"loop { idle first.serve -> request; first.answer; }\"\n"
      "  q: \"first.send; first.receive -> answer;\"\n"
      "  r: \"loop { idle second.serve -> request; second.answer; }\"\n"
      "  s: \"repeat 2 { second.send; second.receive -> answer; }\"\n",
      limits);
  ASSERT_EQ(system.models.size(), 2U);
  for (const ModelInstance& model : system.models) {
    EXPECT_FALSE(model.is_grown) << model.name;
    EXPECT_EQ(model.state_texts.size(), model.automaton.size()) << model.name;
    EXPECT_FALSE(model.automaton.origin.contains("bound")) << model.name;
  }
}

TEST(QueueGrowth, ATopicsQueueIsMadeWhole) {
  const std::string topic =
      "topics:\n  t: {use: queue, with: {size: 10}, writers: [a], readers: [b]}\n"
      "programs:\n  a: \"var k: 0..7; loop { t.write(k); k = (k + 1) % 8; }\"\n"
      "  b: \"loop { t.read -> message; }\"\n";
  EXPECT_NE(test::error_of([&] { read(topic); }).find("has more than 200000 states"),
            std::string::npos);
}

}  // namespace
}  // namespace maide
