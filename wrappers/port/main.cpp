// maide-wrap-port: the reference port in a process of its own.
#include "port_wrapper.hpp"

int main(int argc, char** argv) {
  maide::port::PortWrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
