// What a word on Cyclone DDS costs, and how often a verdict of quiescence is wrong:
//
//   bench_cyclonedds [TRIALS] [BUSY]
//
// plays TRIALS words (default 2000) with each way to wait for quiescence, beside BUSY processes
// (default 0) that take all the time they get, and prints one row each. A word counts as wrong if
// its outputs are not those of a queue of two messages that drops the oldest.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

#include "busy_machine.hpp"
#include "cyclonedds_wrapper.hpp"
#include "maide/wire/local_sul.hpp"

namespace {

using Milliseconds = std::chrono::duration<double, std::milli>;

constexpr maide::Symbol write = 0, tryread = 1;

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void measure(const std::string& quiescence, std::size_t trials) {
  maide::cyclonedds::CycloneDdsWrapper wrapper;
  maide::LocalSul sul(wrapper, {{"depth", "2"},
                                {"payload", "gap"},
                                {"inputs", "write,tryread"},
                                {"observe", "message,null"},
                                {"quiescence", quiescence}});
  const maide::Word word{write, tryread, tryread, write, write, write, tryread, tryread};
  const std::vector<std::string> expected{"quiet", "next",  "null", "quiet",
                                          "quiet", "quiet", "gap",  "next"};
  const std::vector<maide::SulQuery> batch(trials, {word, maide::Translation::eager});
  std::size_t wrong = 0;
  std::vector<double> resets, steps;
  const auto start = std::chrono::steady_clock::now();
  sul.run(batch,
          [&](std::size_t, const maide::SulAnswer& answer) {
            std::vector<std::string> outputs;
            for (const maide::SulStep& step : answer.steps) {
              outputs.push_back(maide::mealy_output(step, maide::Translation::eager));
              steps.push_back(Milliseconds(step.duration).count());
            }
            resets.push_back(Milliseconds(answer.reset_duration).count());
            wrong += outputs != expected;
          },
          {});
  const Milliseconds all = std::chrono::steady_clock::now() - start;
  fmt::print("{:>10} {:>8} {:>8} {:>14.3f} {:>14.3f} {:>12.3f}\n", quiescence, trials, wrong,
             median(resets), median(steps), all.count() / static_cast<double>(trials));
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t trials = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 2000;
  const maide::test::BusyMachine load(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 0);
  fmt::print("{:>10} {:>8} {:>8} {:>14} {:>14} {:>12}\n", "quiescence", "words", "wrong",
             "reset ms (med)", "step ms (med)", "word ms");
  for (const char* quiescence : {"0", "1", "5", "observed"}) measure(quiescence, trials);
}
