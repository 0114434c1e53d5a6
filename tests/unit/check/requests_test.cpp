// Requests of programs and their answers: each has its number, so a late answer completes no other
// request. What rclcpp does was run: a future is completed by its own answer alone.
#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide {
namespace {

constexpr const char* V = "violated";
constexpr const char* H = "holds";

struct RequestSystem {
  const char* name;
  const char* property;
  const char* verdict;
  std::string client, server;
};
void PrintTo(const RequestSystem& system, std::ostream* out) { *out << system.name; }

const std::string once = "ask.serve -> request; ask.answer;";
const std::string twice = once + once;
const std::string always =
    "loop { idle ask.serve -> request; if (served < 3) { served = served + 1; } ask.answer; }";
// The first request is served and not answered, for another one is served meanwhile.
const std::string loses_one = "ask.serve -> request; ask.serve -> request; ask.answer;";
const std::string gives_up =
    "ask.send; select { on ask.receive -> answer { stop; } timeout 100 { } } ";
const std::string receive = "ask.receive -> answer;";
const std::string last = "wait ask -> answer;";

const RequestSystem request_systems[] = {
    // The answer to the request that was given up is late, and completes nothing.
    {"given_up", "deadlock", V, gives_up + "ask.send; " + receive, once},
    {"given_up_answered", "deadlock", H, gives_up + "ask.send; " + receive, always},
    {"given_up", "two_served", H, gives_up + "ask.send; " + receive + "@got skip;", always},
    {"given_up_in_a_loop", "two_served", V, "repeat 2 { " + gives_up + " } @got skip;", always},
    // Without a new request the old one is still waited for.
    {"waits_again", "deadlock", H, gives_up + receive, once},
    {"waits_again_for_long", "deadlock", H, gives_up + gives_up.substr(9) + receive, once},
    // A poll gives nothing up.
    {"polls", "deadlock", H,
     "ask.send; select { on ask.receive -> answer { } otherwise { } } ask.send; select { on "
     "ask.receive -> answer { } timeout 5 { } }",
     once},
    {"polls", "got", V,
     "ask.send; select { on ask.receive -> answer { } otherwise { ask.send; " + receive + receive +
         " } } @got skip;",
     once},
    // In the order in which they were sent.
    {"in_order", "deadlock", H, "ask.send; ask.send; " + receive + receive, twice},
    {"in_order", "one_served", H, "ask.send; ask.send; " + receive + "@got skip;", always},
    {"in_order", "two_served", V, "ask.send; ask.send; " + receive + "@got skip;", always},
    {"first_is_lost", "deadlock", V, "ask.send; ask.send; " + receive, loses_one},
    {"first_is_lost", "got", V, "ask.send; ask.send; " + receive + "@got skip;", loses_one},
    // The last one is waited for, whatever became of the others.
    {"last_of_two", "deadlock", H, "ask.send; ask.send; " + last, loses_one},
    {"last_of_two", "two_served", H, "ask.send; ask.send; " + last + "@got skip;", always},
    {"last_of_four", "deadlock", H, "repeat 4 { ask.send; } " + last, loses_one + twice},
    {"last_then_none", "deadlock", V, "ask.send; ask.send; " + last + receive, twice},
    {"last_in_a_select", "deadlock", H,
     "ask.send; ask.send; select { on ask!answer { } timeout 5 { } }", loses_one},
    {"receive_without_arrow", "deadlock", H, "ask.send; ask.receive; skip; wait ask -> answer;",
     once},
    {"never_asked", "deadlock", V, receive, once},
};

System system_of(const RequestSystem& requests) {
  return parse_system(
      "services: {ask: {server: s, clients: c, with: {depth: 4}}}\n"
      "variables: \"var served: 0..3;\"\n"
      "programs:\n  c: \"" +
          requests.client + "\"\n  s: \"" + requests.server +
          " \"\nproperties:\n"
          "  got: \"F c@got\"\n"
          "  one_served: \"G (c@got -> served >= 1)\"\n"
          "  two_served: \"G (c@got -> served >= 2)\"\n",
      "s.yaml", test::test_model);
}

class RequestSystems : public testing::TestWithParam<RequestSystem> {};

TEST_P(RequestSystems, HaveTheVerdictsThatTheyMustHave) {
  RequestSystem requests = GetParam();
  if (requests.client.find("@got") == std::string::npos) requests.client += "@got skip;";
  const System system = system_of(requests);
  NativeEngine engine;
  for (const Reduction reduction :
       {Reduction::none, Reduction::calls, Reduction::order, Reduction::full}) {
    CheckRequest request;
    request.properties = {requests.property};
    request.options.reduction = reduction;
    const CheckReport report = check_system(system, engine, request);
    EXPECT_EQ(to_string(report.properties.at(0).verdict), std::string(requests.verdict))
        << to_string(reduction);
  }
}

INSTANTIATE_TEST_SUITE_P(All, RequestSystems, testing::ValuesIn(request_systems),
                         [](const testing::TestParamInfo<RequestSystem>& system) {
                           return std::string(system.param.name) + "_" + system.param.property;
                         });

}  // namespace
}  // namespace maide
