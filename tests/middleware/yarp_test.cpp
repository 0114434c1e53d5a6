// Words played on YARP's ports, each a fact that a control programmer had better know. What does
// not answer the same every time is not here (docs/middleware/yarp.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "maide/wire/client/wrapper_proxy.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

using test::SystemOptions;
using Steps = std::vector<std::pair<std::string, std::string>>;  // an input, what it brings

struct YarpFact {
  std::string name;
  SystemOptions options;  // inputs, and the events that are observed, come from the steps
  std::string observe;
  Steps steps;
};

void PrintTo(const YarpFact& fact, std::ostream* out) { *out << fact.name; }

class YarpFacts : public testing::TestWithParam<YarpFact> {};

TEST_P(YarpFacts, Hold) {
  const YarpFact& fact = GetParam();
  SystemOptions options = fact.options;
  options["observe"] = fact.observe;
  SulQuery query{Word(), Translation::eager};
  std::vector<std::string> names, expected;
  for (const auto& [input, output] : fact.steps) {
    const auto known = std::find(names.begin(), names.end(), input);
    std::get<Word>(query.inputs).push_back(static_cast<Symbol>(known - names.begin()));
    if (known == names.end()) names.push_back(input);
    expected.push_back(output);
  }
  for (const std::string& name : names) {
    options["inputs"] += (options["inputs"].empty() ? "" : ",") + name;
  }
  const auto sul = spawn_wrapper({MAIDE_BINARY_DIR "/bin/maide-wrap-yarp"}, options);
  for (int repetition = 0; repetition < 5; ++repetition) {
    sul->run(std::span(&query, 1),
             [&](std::size_t, const SulAnswer& answer) {
               EXPECT_EQ(test::outputs(answer), expected) << "repetition " << repetition;
             },
             {});
  }
}

const SystemOptions port{{"kind", "port"}};
const SystemOptions ten_messages{{"kind", "strict"}, {"size", "10"}};

INSTANTIATE_TEST_SUITE_P(
    Port, YarpFacts,
    testing::Values(
        YarpFact{"AnInterruptWaitsForTheWrite",
                 port,
                 "message,written,failed,done",
                 {{"write", "quiet"},
                  {"interrupt", "quiet"},
                  {"read", "written,message,done"},
                  {"write", "failed"}}},
        YarpFact{"AnInterruptedReaderGivesUp",
                 port,
                 "message,null",
                 {{"read", "quiet"}, {"interrupt_reader", "null"}, {"read", "null"}}},
        YarpFact{"AnInterruptedReaderDiscardsWhatIsWritten",
                 port,
                 "message,written",
                 {{"interrupt_reader", "quiet"},
                  {"write", "written"},
                  {"resume_reader", "quiet"},
                  {"read", "quiet"}}},
        YarpFact{"APendingWriteOutlivesAnInterruptOfTheReader",
                 port,
                 "message,written,null",
                 {{"write", "quiet"},
                  {"interrupt_reader", "quiet"},
                  {"read", "null"},
                  {"resume_reader", "quiet"},
                  {"read", "written,message"}}},
        YarpFact{"AfterAnInterruptedReadAWriteIsLost",
                 port,
                 "message,written,null",
                 {{"read", "quiet"},
                  {"interrupt_reader", "null"},
                  {"resume_reader", "quiet"},
                  {"write", "written"}}},
        YarpFact{"AClosedReaderTakesAndLosesAPendingWrite",
                 port,
                 "message,written,closed_reader",
                 {{"write", "quiet"}, {"close_reader", "written,closed_reader"}}},
        YarpFact{"AClosedWriterWaitsForTheRead",
                 port,
                 "message,written,closed",
                 {{"write", "quiet"}, {"close", "quiet"}, {"read", "written,message,closed"}}},
        YarpFact{"ADisconnectionWaitsForTheRead",
                 port,
                 "message,written,disconnected",
                 {{"write", "quiet"},
                  {"disconnect", "quiet"},
                  {"read", "written,message,disconnected"}}},
        YarpFact{"AWriteToNobodySucceeds",
                 port,
                 "message,written,disconnected,connected",
                 {{"disconnect", "disconnected"},
                  {"write", "written"},
                  {"connect", "connected"},
                  {"write", "quiet"},
                  {"read", "written,message"}}},
        YarpFact{"OverTheCarrierLocalMessagesAreEmpty",
                 {{"kind", "port"}, {"carrier", "local"}},
                 "message,empty",
                 {{"write", "quiet"}, {"read", "empty"}}},
        YarpFact{"OverTheCarrierFastTcpAWriteDoesNotWait",
                 {{"kind", "port"}, {"carrier", "fast_tcp"}},
                 "message,written",
                 {{"write", "written"}, {"read", "message"}}}),
    [](const auto& tested) { return tested.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Strict, YarpFacts,
    testing::Values(YarpFact{"WhatWasKeptComesBackAfterTheResume",
                             ten_messages,
                             "message,null",
                             {{"write", "quiet"},
                              {"interrupt_reader", "quiet"},
                              {"read", "null"},
                              {"resume_reader", "quiet"},
                              {"read", "message"}}},
                    YarpFact{"AWriteWhileInterruptedStopsTheWriterForGood",
                             ten_messages,
                             "message,written,done",
                             {{"interrupt", "done"},
                              {"write", "written"},
                              {"resume", "quiet"},
                              {"write", "quiet"},
                              {"read", "quiet"}}},
                    YarpFact{"OverTheCarrierLocalAllMessagesAreTheLast",
                             {{"kind", "strict"}, {"carrier", "local"}, {"payload", "gap"}},
                             "message",
                             {{"write", "quiet"},
                              {"write", "quiet"},
                              {"write", "quiet"},
                              {"read", "gap"},
                              {"read", "old"},
                              {"read", "old"}}}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace maide
