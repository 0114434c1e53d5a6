// maide-wrap-fastdds: speaks the protocol of docs/protocol.md.
#include "fastdds_wrapper.hpp"

int main(int argc, char** argv) {
  maide::fastdds::FastDdsWrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
