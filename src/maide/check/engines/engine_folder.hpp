// The temporary folder of an engine that other programs do the work of (spin_engine.hpp,
// ltsmin_engine.hpp): these write, compile and run there what Maide gives them.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/base/run_control.hpp"
#include "maide/base/subprocess.hpp"

namespace maide {

class EngineFolder {
 public:
  // `engine`: its name, for messages. Keeps a reference to `control`, which stops what runs.
  EngineFolder(std::string engine, const RunControl& control)
      : engine_(std::move(engine)), control_(control) {}

  const std::filesystem::path& path() const { return folder_.path(); }

  SubprocessResult run(const std::vector<std::string>& command,
                       std::optional<std::chrono::milliseconds> limit = std::nullopt) const;
  // `what` the command is, "a C compiler". Throws UsageError if it is not there.
  SubprocessResult start_tool(const std::vector<std::string>& command,
                              const std::string& what) const;
  // One that has to succeed and to leave the file `product` behind. Throws UsageError.
  SubprocessResult run_tool(const std::vector<std::string>& command, const std::string& what,
                            const std::string& product) const;

 private:
  std::string engine_;
  const RunControl& control_;
  TempDir folder_{"maide-check-"};
};

// The first lines of what a program complained about, as one line.
std::string complaint(const SubprocessResult& result);

}  // namespace maide
