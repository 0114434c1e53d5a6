// Several wrappers at once: the same run as with one, also when one of them goes away.
#include <gtest/gtest.h>

#include <sstream>

#include "listening_wrapper.hpp"
#include "maide/base/error.hpp"
#include "maide/experiment/learn_model.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

const std::vector<std::string> port_options{"kind=strict", "size=4", "payload=gap"};

OpenedSystem open(const std::string& sul, std::size_t jobs) {
  SystemAccess access;
  access.jobs = jobs;
  return open_system(parse_system_spec(sul, port_options), access);
}

const std::string port = "exec:" MAIDE_BINARY_DIR "/bin/maide-wrap-port";

LearnedModel learn(const OpenedSystem& system, const ExperimentOptions& options = {}) {
  LearnedModel learned = learn_model(*system.sul, Translation::eager, options);
  if (learned.experiment.error) std::rethrow_exception(learned.experiment.error);
  return learned;
}

std::string to_text(const LearnedModel& learned) {
  std::ostringstream text;
  write_dot(text, *learned.model);
  return text.str();
}

TEST(Jobs, TheRunIsTheSameWhateverTheirNumber) {
  const LearnedModel expected = learn(open(port, 1));
  for (const std::size_t jobs : {2U, 4U, 8U}) {
    const OpenedSystem system = open(port, jobs);
    EXPECT_EQ(count_systems(*system.sul), jobs);
    const LearnedModel learned = learn(system);
    EXPECT_EQ(to_text(learned), to_text(expected));
    EXPECT_EQ(learned.experiment.symbols, expected.experiment.symbols);
    EXPECT_EQ(learned.experiment.resets, expected.experiment.resets);
    EXPECT_EQ(learned.experiment.cache_hits, expected.experiment.cache_hits);
  }
}

TEST(Jobs, AHostThatGoesAwayLeavesItsWordsToTheOthers) {
  test::ListeningWrapper first, second;
  const OpenedSystem system = open("tcp://" + first.address() + "," + second.address(), 0);
  EXPECT_EQ(count_systems(*system.sul), 2U);
  ExperimentOptions options;
  std::uint64_t rounds = 0;
  options.on_hypothesis = [&](const Mealy&, std::uint64_t round) {
    rounds = round;
    if (round == 2) first.kill();
  };
  const LearnedModel learned = learn(system, options);
  EXPECT_GE(rounds, 2U);  // the tests of the last round went to the other one
  EXPECT_EQ(to_text(learned), to_text(learn(open(port, 1))));
  second.kill();
  EXPECT_THROW(learn(system), WrapperError);
}

TEST(Jobs, AreDealtToTheHostsAndAreEnoughForAll) {
  const test::ListeningWrapper first, second;
  const std::string both = "tcp://" + first.address() + ",tcp://" + second.address();
  EXPECT_EQ(count_systems(*open(both, 5).sul), 5U);
  EXPECT_THROW(open(both, 1), UsageError);
  EXPECT_THROW(open("tcp://" + first.address() + ",", 0), UsageError);
  EXPECT_THROW(open(port, most_jobs + 1), UsageError);
}

TEST(Jobs, ByDefaultAProgramOfAnybodysRunsAlone) {
  EXPECT_EQ(default_jobs(parse_system_spec(port, {})), 1U);
  EXPECT_EQ(default_jobs(parse_system_spec("sim:port.dot", {})), 1U);
  EXPECT_EQ(default_jobs(parse_system_spec("tcp://a:1,b:2,c:3", {})), 3U);
  EXPECT_GE(default_jobs(parse_system_spec("port", {})), 1U);
}

}  // namespace
}  // namespace maide
