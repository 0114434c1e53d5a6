// `mpirun -n 4 maide check SYSTEM.yaml`: the ranks that search one system together. MPI itself is
// in a module (mpi/), which is loaded where this process is one of several.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "maide/check/search/ranks.hpp"

namespace maide::cli {

// This process was started by mpirun, or by srun, and is not the first of its ranks. Known before
// MPI is.
bool is_later_rank();

// The module for MPI, where it is installed.
std::optional<std::filesystem::path> find_mpi_module();

// The ranks of this process, as long as the result lives; null if it was started alone. Throws
// UsageError if it was not, and there is no module for MPI. At most once in a process.
std::unique_ptr<Ranks> open_ranks();

// Rank 0's searches; the others' end when it is destroyed.
class FirstRank {
 public:
  explicit FirstRank(Ranks* ranks) : ranks_(ranks) {}  // null: there are no others
  FirstRank(const FirstRank&) = delete;
  FirstRank& operator=(const FirstRank&) = delete;
  ~FirstRank();

 private:
  Ranks* ranks_;
};

}  // namespace maide::cli
