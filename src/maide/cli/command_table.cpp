// The commands, in the order in which a newcomer meets them.
#include <array>

#include "maide/cli/command.hpp"

namespace maide::cli {

std::span<const Command> command_table() {
  static constexpr std::array table{
      Command{"doctor", "Tell what is usable on this machine, and what to install",
              "maide doctor\nmaide doctor --json", set_up_doctor},
  };
  return table;
}

}  // namespace maide::cli
