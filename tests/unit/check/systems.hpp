// Small systems for tests: port models written by hand, system files as text.
#pragma once

#include <string>

#include "maide/automata/interface_automaton.hpp"
#include "maide/check/build/system_file.hpp"

namespace maide::test {

// A model source for texts: `file: NAME` is tests/models/NAME.
inline InterfaceAutomaton test_model(const ModelRequest& request) {
  ModelRequest local = request;
  local.file = std::string(MAIDE_SOURCE_DIR) + "/tests/models/" + request.file.filename().string();
  return read_requested_model(local);
}

// A system of these programs, over instances `via` (strict port of two) and `sync` (buffered port).
inline System system_of(const std::string& programs, const std::string& properties = "",
                        const std::string& when_unexplored = "stop") {
  return parse_system("models:\n  via: {file: strict-2.dot, when_unexplored: " + when_unexplored +
                          "}\n  sync: {file: buffered.dot}\nprograms:\n" + programs +
                          (properties.empty() ? "" : "properties:\n" + properties),
                      "system.yaml", test_model);
}

// What the error says that `call` throws; "" if it throws none.
template <typename Call>
std::string error_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

inline Property deadlock_property() {
  Property property;
  property.name = "deadlock";
  property.kind = Property::Kind::deadlock;
  return property;
}

}  // namespace maide::test
