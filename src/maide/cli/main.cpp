// The program `maide`. Everything is in run_command_line().
#include "maide/cli/command.hpp"

int main(int argc, char** argv) {
  maide::cli::prepare_process();
  return maide::cli::run_command_line(argc, argv);
}
