// What the death of programs does to models: to those at whose ends they stand, to wires from them
// and to them, to services; and what it does to them that a process begins anew.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "maide/check/rules/life.hpp"
#include "maide/check/system/model_actions.hpp"

namespace maide {

// Who dies in one step.
struct Dying {
  std::vector<std::uint32_t> programs;
  std::vector<std::string> nodes;           // whose callbacks they run
  std::vector<std::uint32_t> own_models{};  // that begin anew by it
};

// One, or one for each thing that it may leave behind.
std::vector<Uses> ways_to_die(const Dying& who, const Names& names, ModelActions& actions);
// The death of a whole process, which `how` says: Kind::die or die_for_new. `at_once`: all know of
// it, so that its services are there no more.
std::vector<Uses> ways_to_die(const Life& life, LifeRules::Operation::Kind how, bool at_once,
                              const Names& names, ModelActions& actions);
// Its ends are there again as in the beginning.
Uses when_begins_anew(const Life& life, const Names& names, ModelActions& actions);

}  // namespace maide
