// A folder of one's own under the system's folder for temporary files, gone with the object.
#pragma once

#include <filesystem>
#include <string_view>

namespace maide {

class TempDir {
 public:
  // Makes "<tmp>/<prefix>XXXXXX", readable by its owner alone. Throws UsageError if it cannot,
  // Error (inconclusive) where the disk is full.
  explicit TempDir(std::string_view prefix = "maide-");
  // Removes the folder with all that is in it.
  ~TempDir();
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;

  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace maide
