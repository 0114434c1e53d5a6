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
#include <numeric>
#include <string>
#include <vector>

#include "busy_machine.hpp"
#include "cyclonedds_wrapper.hpp"
#include "maide/wire/local_sul.hpp"

namespace {

using Milliseconds = std::chrono::duration<double, std::milli>;

constexpr maide::Symbol write = 0, tryread = 1;

struct Summary {
  double mean = 0, median = 0;
};

Summary summarize(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return {std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size()),
          *middle};
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
  const Summary reset = summarize(resets), step = summarize(steps);
  fmt::print("{:>10} {:>7} {:>7} {:>9.3f} {:>9.3f} {:>9.3f} {:>9.3f} {:>9.3f}\n", quiescence,
             trials, wrong, reset.mean, reset.median, step.mean, step.median,
             all.count() / static_cast<double>(trials));
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t trials = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 2000;
  const maide::test::BusyMachine load(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 0);
  fmt::print("{:>10} {:>7} {:>7} {:>19} {:>19} {:>9}\n", "quiescence", "words", "wrong",
             "reset mean, median", "step mean, median", "word (ms)");
  for (const char* quiescence : {"0", "1", "5", "observed"}) measure(quiescence, trials);
}
