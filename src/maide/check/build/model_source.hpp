// What a system file names but does not contain - model files, models to be learned - is asked of a
// ModelSource, so that checking knows nothing of learning.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/base/error.hpp"

namespace maide {

// When messages arrive in the system that is read.
enum class Deliveries : std::uint8_t {
  as_said,  // late, but where the file or its models say otherwise
  at_rest,  // at once: what can be played step by step on a real system, which comes to rest
            // between
};

// What the system file says about where a model comes from: a file, or a system to be learned.
struct ModelRequest {
  std::string instance;
  std::filesystem::path file;                             // relative to the system file's folder
  std::string learn;                                      // the system; empty: `file` is meant
  std::vector<std::pair<std::string, std::string>> with;  // its options, in order
  // How it is learned, where that is not left to the defaults: names and values of options of
  // `maide learn`, in order.
  std::vector<std::pair<std::string, std::string>> learning;
  // What programs write, "3" or "3,go", where the model is to carry these values: with `write(3)`
  // in place of `write`. Empty: the model as it is learned.
  std::vector<std::string> values;
  SourcePosition position;  // of `file:` or `learn:`
  // The answer, where the system comes from a dump that has it; else null. Then nothing is read,
  // and nobody is asked.
  std::shared_ptr<const InterfaceAutomaton> known;
};

using ModelSource = std::function<InterfaceAutomaton(const ModelRequest&)>;

// Reads model files; a model to be learned is a ParseError that says to learn it first.
InterfaceAutomaton read_requested_model(const ModelRequest& request);

}  // namespace maide
