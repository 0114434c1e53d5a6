// maide-wrap-zeromq: speaks the protocol of docs/protocol.md.
#include "zeromq_wrapper.hpp"

int main(int argc, char** argv) {
  maide::zeromq::ZeroMqWrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
