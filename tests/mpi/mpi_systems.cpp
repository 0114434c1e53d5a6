// Random systems, each searched by the ranks of mpirun and by rank 0 alone: says on how many both
// agree, and ends with 1 at the first on which they do not. mpi_systems SEED COUNT
#include <fmt/format.h>

#include <cstdint>
#include <cstdlib>
#include <string>

#include "maide/base/random.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/cli/mpi.hpp"
#include "random_system.hpp"

namespace maide {
namespace {

// Nothing if both find and count the same.
std::string difference(const System& system, Property::Kind kind, Reduction reduction,
                       Ranks& ranks) {
  NativeEngine engine;
  Property property;
  property.kind = kind;
  EngineOptions options;
  options.threads = 1;
  options.reduction = reduction;
  const PropertyResult alone = engine.check(system, property, options);
  options.ranks = &ranks;
  options.states_a_thread = 2;  // so that a small system has many rounds
  const PropertyResult together = engine.check(system, property, options);
  if (alone.verdict != together.verdict) return "another verdict";
  const bool is_shortest = kind == Property::Kind::deadlock;
  if (is_shortest && alone.trace && alone.trace->steps.size() != together.trace->steps.size()) {
    return "a run of another length";
  }
  const bool are_counts_equal =
      alone.states == together.states && alone.transitions == together.transitions;
  if (reduction == Reduction::none && !alone.trace && !are_counts_equal) return "another count";
  return "";
}

int compare(Ranks& ranks, std::uint64_t seed, int count) {
  Random random(seed);
  test::RandomSystemSize size;
  size.most_models = 3;
  size.most_programs = 4;
  size.counters = 0.8;
  size.loops = 0.9;
  size.mailboxes = 0.5;
  Property deadlock;
  deadlock.kind = Property::Kind::deadlock;
  int violated = 0;
  for (int i = 0; i < count;) {
    const System system = test::random_system(random, size);
    const bool has_one = NativeEngine().check(system, deadlock, {}).verdict == Verdict::violated;
    if (has_one && violated >= count / 2) continue;  // half of them cannot
    violated += has_one ? 1 : 0;
    ++i;
    for (const auto kind : {Property::Kind::deadlock, Property::Kind::stuck}) {
      for (const Reduction reduction : {Reduction::none, Reduction::order, Reduction::full}) {
        const std::string found = difference(system, kind, reduction, ranks);
        if (found.empty()) continue;
        fmt::print("system {} of seed {}, {}{}: {}\n", i, seed, to_string(reduction),
                   kind == Property::Kind::stuck ? ", stuck" : "", found);
        return 1;
      }
    }
  }
  fmt::print("{} systems agree on {} ranks, {} violated\n", count, ranks.size(), violated);
  return 0;
}

}  // namespace
}  // namespace maide

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto ranks = maide::cli::open_ranks();
  if (ranks == nullptr) return 2;
  if (ranks->rank() > 0) {
    maide::serve_searches(*ranks);
    return 0;
  }
  const maide::cli::FirstRank first(ranks.get());
  return maide::compare(*ranks, std::strtoull(argv[1], nullptr, 10), std::atoi(argv[2]));
}
