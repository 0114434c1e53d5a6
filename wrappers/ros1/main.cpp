// maide-wrap-ros1: speaks the protocol of docs/protocol.md.
#include "ros1_wrapper.hpp"

int main(int argc, char** argv) {
  maide::ros1::Ros1Wrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
