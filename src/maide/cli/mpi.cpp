#include "maide/cli/mpi.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <own_wrappers.hpp>  // made by the build
#include <string>
#include <string_view>

#include "maide/base/error.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/experiment/open_system.hpp"

namespace maide::cli {
namespace {

constexpr const char* module_name = "maide-mpi.so";

// What Open MPI, MPICH and its kin, and PMIx tell a process of its rank.
constexpr std::array<const char*, 3> rank_variables{"OMPI_COMM_WORLD_RANK", "PMI_RANK",
                                                    "PMIX_RANK"};

const char* rank_variable() {
  for (const char* variable : rank_variables) {
    if (std::getenv(variable) != nullptr) return variable;
  }
  return nullptr;
}

}  // namespace

bool is_later_rank() {
  const char* variable = rank_variable();
  return variable != nullptr && std::string_view(std::getenv(variable)) != "0";
}

std::optional<std::filesystem::path> find_mpi_module() { return find_own_file(module_name); }

std::unique_ptr<Ranks> open_ranks() {
  const char* variable = rank_variable();
  if (variable == nullptr) return nullptr;
  const auto path = find_mpi_module();
  if (!path) {
    throw UsageError(
        fmt::format("this is a rank of mpirun ({} is set), but {} is neither beside maide nor in "
                    "../libexec/maide: {}",
                    variable, module_name, mpi_advice));
  }
  // MPI loads parts of its own, which look for its symbols.
  void* module = ::dlopen(path->c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (module == nullptr) throw UsageError(std::string("MPI cannot be loaded: ") + ::dlerror());
  using Open = Ranks* (*)();
  const auto open = reinterpret_cast<Open>(::dlsym(module, "maide_mpi_ranks_1"));
  if (open == nullptr) {
    throw UsageError(fmt::format("{} is of another version of maide", path->string()));
  }
  std::unique_ptr<Ranks> ranks(open());
  if (ranks->size() == 1) return nullptr;
  return ranks;
}

FirstRank::~FirstRank() {
  if (ranks_ != nullptr) end_searches(*ranks_);
}

}  // namespace maide::cli
