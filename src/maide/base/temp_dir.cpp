// mkdtemp makes name and folder in one step, so that nobody can slip in between.
#include "maide/base/temp_dir.hpp"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include "maide/base/write_failure.hpp"

namespace maide {

TempDir::TempDir(std::string_view prefix) {
  std::error_code error;
  std::filesystem::path parent = std::filesystem::temp_directory_path(error);
  if (error) parent = "/tmp";
  std::string name = (parent / prefix).string() + "XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) {
    const int reason = errno;
    throw_write_failure("cannot make a temporary folder: " +
                            std::generic_category().message(reason) + " (" + parent.string() + ")",
                        reason);
  }
  path_ = name;
}

TempDir::~TempDir() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace maide
