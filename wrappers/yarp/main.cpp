// maide-wrap-yarp: speaks the protocol of docs/protocol.md.
#include <unistd.h>

#include <cstdlib>
#include <string_view>

#include "yarp_wrapper.hpp"

int main(int argc, char** argv) {
  // YARP tells of each port that opens and closes unless this is set when its library is loaded.
  const char* const quiet = std::getenv("YARP_QUIET");
  if (quiet == nullptr || std::string_view(quiet) != "1") {
    ::setenv("YARP_QUIET", "1", 1);
    ::execv("/proc/self/exe", argv);  // if that fails, it is noisy
  }
  maide::yarp_ports::YarpWrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
