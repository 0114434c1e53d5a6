// maide-wrap-cyclonedds: speaks the protocol of docs/protocol.md.
#include "cyclonedds_wrapper.hpp"

int main(int argc, char** argv) {
  maide::cyclonedds::CycloneDdsWrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
