// The system under learning, opened a second time with longer waits: what confirms a model.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "maide/base/run_control.hpp"
#include "maide/learn/output_oracle.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

struct SystemAccess;
struct SystemSpec;

struct PatientSystem {
  std::function<std::unique_ptr<OutputOracle>()> open;
  std::string waits;  // how it is opened, for messages: "floor=10"
};

// The options with which a system waits longer: a floor of 10 ms more where quiescence is observed,
// four times a fixed delay and 10 ms more. Nothing for a system without such options.
std::map<std::string, std::string> longer_waits(const std::map<std::string, std::string>& options);

// The wrapper of `spec`, which is open as `sul`, with longer waits, and with the learning purpose
// of a file unless that is empty. Nothing for a simulation, for a system without waits, and for one
// that runs by itself (tcp, exec): nobody knows whether a second one can run beside it.
std::optional<PatientSystem> make_patient_system(const SystemSpec& spec, const SystemAccess& access,
                                                 const Sul& sul,
                                                 const std::filesystem::path& purpose,
                                                 const RunControl& control);

}  // namespace maide
