// The commands, in the order in which a newcomer meets them.
#include <array>

#include "maide/cli/command.hpp"

namespace maide::cli {

std::span<const Command> command_table() {
  static constexpr std::array table{
      Command{"compare", "Tell whether two models are the same, and what tells them apart",
              "maide compare port.dot strict-1.dot\nmaide compare old.dot new.dot --json",
              set_up_compare},
      Command{"export", "Write a model in another tool's language",
              "maide export port.dot --to promela -o port.pml\n"
              "maide export strict-6.dot --to aut --lossy",
              set_up_export},
      Command{"doctor", "Tell what is usable on this machine, and what to install",
              "maide doctor\nmaide doctor --json", set_up_doctor},
  };
  return table;
}

}  // namespace maide::cli
