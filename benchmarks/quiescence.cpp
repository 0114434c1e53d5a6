// How often each way of waiting for quiescence is wrong, and what it costs: observed threads beside
// fixed delays, on an idle machine and under load. The work is a token that four threads hand on,
// with random computing in between; a verdict is wrong if the token was still going round.
//
//   bench_quiescence [TRIALS] [BUSY_PROCESSES]
#include "maide/wire/observe/quiescence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>
#include <vector>

#include "busy_machine.hpp"
#include "maide/wire/observe/socket_scan.hpp"
#include "maide/wire/observe/thread_scan.hpp"
#include "thread_chain.hpp"

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

double microseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

void measure(const std::string& name, const maide::QuiescenceSettings& settings,
             std::size_t trials) {
  maide::Quiescence quiescence(settings);
  maide::test::ThreadChain chain(4, 1);
  maide::Random random(1);
  std::vector<double> waits;
  std::size_t wrong = 0;
  for (std::size_t trial = 0; trial < trials; ++trial) {
    chain.start(1 + random.below(12));
    const Clock::time_point start = Clock::now();
    quiescence.wait([] { return Clock::time_point(); }, [] { return false; });
    waits.push_back(microseconds_since(start));
    if (!chain.is_done()) ++wrong;
    while (!chain.is_done()) std::this_thread::yield();
  }
  fmt::print("  {:<16} {:>6} wrong of {}  ({:.2f} %), median {:.0f} us\n", name, wrong, trials,
             100.0 * static_cast<double>(wrong) / static_cast<double>(trials), median(waits));
}

void measure_all(std::size_t trials) {
  maide::QuiescenceSettings settings;
  settings.limit = 60s;
  measure("observed", settings, trials);
  settings.observed = false;
  for (const auto delay : {1ms, 5ms, 20ms}) {
    settings.delay = delay;
    measure(fmt::format("fixed {} ms", delay.count()), settings,
            trials / static_cast<std::size_t>(delay.count()));
  }
}

// What one look costs, by the number of threads that sleep.
void measure_scans() {
  for (const std::size_t threads : {2U, 8U, 32U}) {
    const maide::test::ThreadChain chain(threads, 1);
    std::this_thread::sleep_for(50ms);
    maide::ThreadScan scan;
    maide::SocketScan sockets;
    maide::SocketPicture picture;
    std::vector<double> scans, pictures;
    for (int trial = 0; trial < 2000; ++trial) {
      Clock::time_point start = Clock::now();
      if (!scan.begin() || !scan.end()) continue;
      scans.push_back(microseconds_since(start));
      start = Clock::now();
      sockets.take(picture);
      pictures.push_back(microseconds_since(start));
    }
    fmt::print("  {:>2} threads: both passes {:.0f} us, a look at the descriptors {:.0f} us\n",
               threads, median(scans), median(pictures));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t trials = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 2000;
  const std::size_t busy = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 4;
  fmt::print("one look:\n");
  measure_scans();
  fmt::print("idle:\n");
  measure_all(trials);
  fmt::print("beside {} busy processes:\n", busy);
  const maide::test::BusyMachine load(busy);
  measure_all(trials);
}
