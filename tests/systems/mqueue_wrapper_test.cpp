// The wrapper of docs/writing-a-wrapper.md: real queues of the kernel, learned like any middleware.
#include <gtest/gtest.h>

#include "maide/experiment/learn_model.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"

namespace maide {
namespace {

LearnedModel learn_queue(std::map<std::string, std::string> options) {
  const auto sul = spawn_wrapper({MAIDE_MQUEUE_WRAPPER}, std::move(options));
  LearnedModel learned = learn_model(*sul, Translation::eager, {});
  if (learned.experiment.error) std::rethrow_exception(learned.experiment.error);
  return learned;
}

// A message more than it keeps waits with its writer: that is a state of its own.
TEST(MqueueWrapper, PushesBack) {
  for (const std::size_t depth : {1, 2, 4}) {
    const LearnedModel learned = learn_queue({{"depth", std::to_string(depth)},
                                              {"inputs", "write,tryread"},
                                              {"observe", "message,null"},
                                              {"payload", "gap"}});
    EXPECT_EQ(learned.mealy_states, depth + 2) << depth;
  }
}

TEST(MqueueWrapper, ShowsWhenAWriteReturns) {
  const LearnedModel learned = learn_queue({{"depth", "1"}, {"observe", "message,written"}});
  EXPECT_EQ(learned.mealy_states, 4U);  // empty, full, a write blocked, a read blocked
}

}  // namespace
}  // namespace maide
