// What the wire costs: the same words on the reference port in this process, over a child's pipes,
// and over TCP to loopback; one word at a time, and pipelined.
//
//   bench_wire MAIDE-WRAP-PORT [WORDS]
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "maide/base/random.hpp"
#include "maide/wire/client/child_process.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"
#include "maide/wire/protocol/line_io.hpp"
#include "maide/wire/wrapper/wrapper_session.hpp"
#include "port_wrapper.hpp"

namespace {

using Clock = std::chrono::steady_clock;

std::vector<maide::SulQuery> make_words(std::size_t count) {
  maide::Random random(1);
  std::vector<maide::SulQuery> words(count);
  for (maide::SulQuery& query : words) {
    maide::Word word(random.between(1, 10));
    for (maide::Symbol& symbol : word) symbol = static_cast<maide::Symbol>(random.below(2));
    query.inputs = std::move(word);
  }
  return words;
}

// Microseconds a word, in batches of this size.
double time_words(maide::Sul& sul, const std::vector<maide::SulQuery>& words, std::size_t batch) {
  const Clock::time_point start = Clock::now();
  for (std::size_t from = 0; from < words.size(); from += batch) {
    const std::size_t size = std::min(batch, words.size() - from);
    sul.run(std::span(words).subspan(from, size), [](std::size_t, maide::SulAnswer) {}, {});
  }
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count() /
         static_cast<double>(words.size());
}

// The port that a listening wrapper took.
std::string read_address(const maide::ChildProcess& wrapper) {
  maide::LineSplitter lines;
  std::string bytes;
  while (true) {
    if (maide::read_some(wrapper.output.get(), bytes) == maide::ReadResult::some) {
      lines.append(bytes);
    }
    if (const auto line = lines.take_line()) return line->substr(line->rfind(' ') + 1);
    std::this_thread::yield();
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: bench_wire MAIDE-WRAP-PORT [WORDS]\n");
    return 2;
  }
  const std::string program = argv[1];
  const auto words = make_words(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 2000);
  // The time of a step is the system's; a delay of 0 ms leaves the wire alone to be seen.
  for (const std::string quiescence : {"observed", "0"}) {
    const std::map<std::string, std::string> options = {{"kind", "strict"},
                                                        {"quiescence", quiescence}};
    maide::port::PortWrapper wrapper;
    maide::LocalSul local(wrapper, options);
    const auto pipes = maide::spawn_wrapper({program}, options);
    const maide::ChildProcess listening({program, "--listen", "127.0.0.1:0"});
    const auto tcp = maide::connect_tcp(read_address(listening), "", options);
    fmt::print("quiescence={}, {} words, microseconds a word:\n", quiescence, words.size());
    for (const std::size_t batch : {std::size_t{1}, words.size()}) {
      const double in_process = time_words(local, words, batch);
      const double over_pipes = time_words(*pipes, words, batch);
      const double over_tcp = time_words(*tcp, words, batch);
      fmt::print(
          "  {:<14} in this process {:.0f}, over pipes {:.0f} ({:.2f} times), over TCP {:.0f} "
          "({:.2f} times)\n",
          batch == 1 ? "one at a time:" : "pipelined:", in_process, over_pipes,
          over_pipes / in_process, over_tcp, over_tcp / in_process);
    }
  }
}
