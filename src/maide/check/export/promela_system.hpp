// A whole system as Promela, for SPIN (Holzmann, "The SPIN Model Checker", 2003). Each automaton is
// a proctype. A model meets the programs on two rendezvous channels, its InChannel and its
// OutChannel, as in the paper. `quiet` is an output that a quiescent model offers again and again.
// An input beyond the bound is a message of its own, `beyond_write`; the purpose of the text
// chooses what it does.
//
// Invariant: one transition of the Promela is one step of the system. Every transition is a single
// rendezvous or expression followed by gotos, which cost nothing, so it is atomic by itself.
// (`atomic` could stand only where a rendezvous is received: a sender inside `atomic` takes its
// goto as a step of its own.) So the states of the text with Purpose::deadlock, explored without
// reduction, are those of the system and one more: the state before the processes are started.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/check/language/system.hpp"
#include "maide/formats/names.hpp"

namespace maide {

// What the programs of a system use of each of its models. An export writes that much of a model,
// and it tells whether a run may leave what was learned at all.
struct ModelUsage {
  struct Instance {
    std::set<Symbol> inputs;   // that are given
    std::set<Symbol> cutting;  // those of them that may be beyond what was learned, while the model
                               // says `stop`, as far as its automaton alone tells
    bool quiet = false;        // some program has an arm for it
  };

  explicit ModelUsage(const System& system);

  std::vector<Instance> instances;  // by model
  bool any_cut = false;             // else no run can be cut
};

// Names of a system as Promela identifiers. They are readable, distinct, and none of the words that
// SPIN or the text of a system uses itself.
class PromelaNames {
 public:
  PromelaNames();
  // The identifier of `name` with `prefix`; the same for the same pair.
  const std::string& of(std::string_view prefix, std::string_view name);

 private:
  std::map<std::pair<std::string, std::string>, std::string> known_;
  Identifiers identifiers_;
};

struct PromelaOptions {
  enum class Purpose : std::uint8_t {
    deadlock,  // invalid end states are the system's deadlocks; a cut is a self-loop, so the states
               // are those of the system before any cut
    cut,       // an assertion fails where a run leaves what was learned
    ltl,       // a never claim for the property; a cut makes the rest of the run satisfy everything
  };
  Purpose purpose = Purpose::deadlock;
  Formula formula;  // of Purpose::ltl; without X
};

// Which transition stands in a line of the text.
struct PromelaLine {
  enum class Kind : std::uint8_t { none, program_edge, model_transition };
  Kind kind = Kind::none;
  std::uint32_t owner = 0;   // program or model instance
  std::uint32_t index = 0;   // edge of the program
  StateId model_target = 0;  // of the model's transition
  bool is_beyond = false;    // the step goes beyond what was learned
};

struct PromelaSystem {
  std::string text;                // without the never claim
  std::vector<PromelaLine> lines;  // by line of the text, from 1; [0] is not used
  std::string claim;               // Purpose::ltl: the negated formula for `spin -f`
  std::size_t processes = 0;
};

// Throws UsageError if the system has more symbols or processes than SPIN can have (250), or what
// Promela has no form for (refuse_second_edition).
PromelaSystem write_promela(const System& system, const PromelaOptions& options = {});

}  // namespace maide
