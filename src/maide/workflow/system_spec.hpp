// What a person types for a system under learning: `SUL [KEY=VALUE ...]`. SUL is `sim:FILE` (a
// model, simulated), the name of a wrapper ("port", "cyclonedds"), `tcp://HOST:PORT,...` (wrappers
// that listen), or `exec:PROGRAM ARGS` (any program that speaks the protocol).
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "maide/base/shell_words.hpp"

namespace maide {

struct SystemSpec {
  enum class Kind { simulated, wrapper, tcp, program };
  Kind kind = Kind::wrapper;
  std::string text;                            // as typed: "sim:coffee.dot"
  std::string target;                          // the file, the wrapper's name, "HOST:PORT,..."
  std::vector<std::string> command;            // of `exec:`: the program and its arguments
  std::map<std::string, std::string> options;  // KEY=VALUE, keys with '-' for '_'
};

// Throws UsageError: an unknown scheme, an empty target, a word without '=', a key given twice.
SystemSpec parse_system_spec(const std::string& sul, std::span<const std::string> key_values);

// The system and its options in one line, as a model keeps them; split_shell_words() undoes it.
std::string origin_of(const SystemSpec& spec, const std::map<std::string, std::string>& options);

}  // namespace maide
