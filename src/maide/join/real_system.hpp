// The real systems behind the models of a system file, and random runs to try on them. Each system
// is opened anew with longer waits than those that its model was learned with. So what it does
// confirms or refutes the model, and does not depend on how long somebody waited.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "maide/base/random.hpp"
#include "maide/base/run_control.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/system/trace.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/ros2/replayed_nodes.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

// What a system file asks for, by instance: filled as the file is read.
using ModelRequests = std::map<std::string, ModelRequest>;

// There is a system behind it: it comes from a file, was learned, or is a service with `learn:`
// whose ends are programs.
bool is_real(const ModelInstance& model);

// What was asked for the instance; of a member of an array, for the array. Throws UsageError.
const ModelRequest& request_of(const ModelInstance& instance, const ModelRequests& requests);

// Notes in `requests` what `source` is asked for. Keeps a reference to `requests`.
ModelSource record_requests(ModelSource source, ModelRequests& requests);

// The system that an instance stands for: the one that `learn:` names, or the one that its file
// says it was learned from (`sul`), with the options that it was learned with. Throws UsageError
// that names the instance if there is none.
SystemSpec find_system_of(const ModelInstance& instance, const ModelRequest& request);

// An instance of a model, or a whole topic with all its ends, and the system behind it.
struct RealSystem {
  std::string instance;     // or the topic
  std::string description;  // "cyclonedds history=keep_last, with floor=10"
  std::unique_ptr<Sul> sul;
  std::vector<Symbol> inputs;  // of the model -> of the system; none for a topic
  std::size_t jobs = 1;
  std::shared_ptr<const ReplayedNodes> nodes;  // it stands for these, with all their connections
};

// The nodes of the system, to be played. Throws UsageError for what cannot be played, with its
// place.
std::shared_ptr<const ReplayedNodes> find_nodes(const System& system,
                                                const ModelRequests& requests);

struct RealSystemOptions {
  std::size_t jobs = 0;  // systems behind each instance; 0: the default (default_jobs())
  std::string token_file;
  RunControl control;
  std::shared_ptr<const ReplayedNodes> nodes{};  // one system stands for these; none: for no node
  // Options of every system, in place of those with which its model was learned: {"rmw",
  // "fastrtps"}.
  std::map<std::string, std::string> settings{};
};

// Opens the systems of the models that some program uses, in the order of the models; null for the
// others. A topic's stands at the model of its first reader, that of nodes at their first model. A
// version that is not the one that was learned is a warning in the log. Throws UsageError (also if
// a system has not all inputs of its model, and for a topic whose readers have options of their
// own) and WrapperError.
std::vector<std::unique_ptr<RealSystem>> open_real_systems(const System& system,
                                                           const ModelRequests& requests,
                                                           const RealSystemOptions& options);

// ---- Random runs ----
//
// Random runs of a composed system, as a robot's programs would run. Chance decides who steps next,
// so with probability one every program that can go on goes on.

// A run of at most `most_steps` steps; shorter where nothing can happen any more, or where only an
// input that was never tried could. First the program is drawn, then its step, all alike. With
// `of_nodes`, callbacks start as executors of rclcpp pick them. O(steps x programs x edges).
Trace draw_run(const System& system, std::size_t most_steps, Random& random, bool of_nodes = false);

}  // namespace maide
