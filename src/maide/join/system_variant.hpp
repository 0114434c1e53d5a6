// A system with something changed: other numbers behind `repeat` and other constants in its text,
// another model behind an instance. The rest stays as it was read. What is learned with an option
// that is a constant's value is learned anew if that is another.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

// The text of the system file; "" if it is not known.
const std::string& text_of(const System& system);

// A `repeat` of a program.
struct Repeat {
  int line = 0, column = 0;  // in the system file
  std::uint32_t count = 0;
};

// Those of the programs that stand in the system file, in the order of the file.
std::vector<Repeat> find_repeats(const System& system);

// A number under `constants:`.
struct NumberConstant {
  std::string name;
  int line = 0, column = 0;  // of its value, in the system file
  std::int64_t value = 0;
};

// Those that are written as numbers, in the order of the file.
std::vector<NumberConstant> find_constants(const System& system);

struct SystemVariant {
  std::vector<Repeat> repeats;                       // with their new counts
  std::map<std::string, InterfaceAutomaton> models;  // by instance
  std::vector<NumberConstant> constants;             // with their new values
  std::string text{};                                // of the whole file; empty: as it was read
  Deliveries deliveries = Deliveries::as_said;
};

// Nothing if there is no such system: its model lacks an input that programs give, its `repeat` is
// not where it should be, or the file is wrong with that constant. `learn` makes the models that
// are then learned with other options; without `learn` there are none.
std::optional<System> make_variant(const System& system, const SystemVariant& variant,
                                   const ModelSource& learn = {}, const RunControl& control = {});

// A model of its own stands behind it: not a rule of services or executors, nor a variable.
bool has_model(const ModelInstance& instance);

// The models in use, and the model files in their folders (50 at most), by the names that a system
// file would have for them. What is no interface automaton is left.
std::map<std::string, InterfaceAutomaton> find_models_nearby(const System& system);

// ---- Changes of the text ----
//
// Those of nodes and depths that are cures in C++: a callback group for a client or a callback of
// its own, an executor with more threads, a longer queue. Each is a system file's text with the
// change in it.

struct NodeChange {
  std::string node;         // whose cure it is
  std::string text;         // of the whole file
  std::string description;  // "detector: the client of lookup in a callback group of its own, ..."
  std::string lines;        // what is new in the file: "nodes: {detector: {groups: ...}}"
};

// Of each node the smallest changes first. None of a file without nodes.
std::vector<NodeChange> list_node_changes(const System& system);

// A depth or size of a service, a topic or a built-in queue.
struct DepthPlace {
  std::string section, name, option;  // "services", "lookup", "depth"
  std::int64_t value = 0;
};
// Those whose value is known at once, in the order of the file.
std::vector<DepthPlace> find_depths(const System& system);
std::string with_depth(const std::string& text, const DepthPlace& place, std::int64_t value);

}  // namespace maide
