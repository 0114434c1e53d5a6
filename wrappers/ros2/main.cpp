// maide-wrap-ros2: speaks the protocol of docs/protocol.md.
#include "ros2_wrapper.hpp"

int main(int argc, char** argv) {
  maide::ros2::Ros2Wrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
