// Requests of programs and their answers: each has its number, so a late answer completes no other
// request. What rclcpp does was run: a future is completed by its own answer alone.
#include <gtest/gtest.h>

#include <string>

#include "maide/check/build/system_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"
#include "verdict_cases.hpp"

namespace maide {
namespace {

using test::H;
using test::V;

const std::string answers = "ask.serve -> request; ask.answer;";
const std::string answers_twice = answers + answers;
const std::string always =
    "loop { idle ask.serve -> request; if (served < 3) { served = served + 1; } ask.answer; }";
// The first request is served and not answered, for another one is served meanwhile.
const std::string loses_one = "ask.serve -> request; ask.serve -> request; ask.answer;";
const std::string gives_up =
    "ask.send; select { on ask.receive -> answer { stop; } timeout 100 { } } ";
const std::string receive = "ask.receive -> answer;";
const std::string last = "wait ask -> answer;";

// A client and a server.
std::string asked(const std::string& client, const std::string& server) {
  const bool is_marked = client.find("@got") != std::string::npos;
  return "services: {ask: {server: s, clients: c, with: {depth: 4}}}\nvariables: \"var served: "
         "0..3;\"\nprograms:\n  c: \"" +
         client + (is_marked ? "" : " @got skip;") + "\"\n  s: \"" + server +
         "\"\nproperties:\n  got: \"F c@got\"\n  one_served: \"G (c@got -> served >= 1)\"\n"
         "  two_served: \"G (c@got -> served >= 2)\"\n";
}

const test::VerdictCase request_systems[] = {
    // The answer to the request that was given up is late, and completes nothing.
    {"given_up", "deadlock", V, asked(gives_up + "ask.send; " + receive, answers)},
    {"given_up_answered", "deadlock", H, asked(gives_up + "ask.send; " + receive, always)},
    {"given_up", "two_served", H, asked(gives_up + "ask.send; " + receive + "@got skip;", always)},
    {"given_up_in_a_loop", "two_served", V,
     asked("repeat 2 { " + gives_up + " } @got skip;", always)},
    // Without a new request the old one is still waited for.
    {"waits_again", "deadlock", H, asked(gives_up + receive, answers)},
    {"waits_again_for_long", "deadlock", H,
     asked(gives_up + gives_up.substr(9) + receive, answers)},
    // A poll gives nothing up.
    {"polls", "deadlock", H,
     asked("ask.send; select { on ask.receive -> answer { } otherwise { } } ask.send; select { on "
           "ask.receive -> answer { } timeout 5 { } }",
           answers)},
    {"polls", "got", V,
     asked("ask.send; select { on ask.receive -> answer { } otherwise { ask.send; " + receive +
               receive + " } } @got skip;",
           answers)},
    // The last answer is there, and the oldest is not: the time-out comes.
    {"last_is_there", "deadlock", H,
     asked("ask.send; ask.send; select { on ask.receive -> answer { } timeout 9 { } }", loses_one)},
    // In the order in which they were sent.
    {"in_order", "deadlock", H, asked("ask.send; ask.send; " + receive + receive, answers_twice)},
    {"in_order", "one_served", H, asked("ask.send; ask.send; " + receive + "@got skip;", always)},
    {"in_order", "two_served", V, asked("ask.send; ask.send; " + receive + "@got skip;", always)},
    {"first_is_lost", "deadlock", V, asked("ask.send; ask.send; " + receive, loses_one)},
    {"first_is_lost", "got", V, asked("ask.send; ask.send; " + receive + "@got skip;", loses_one)},
    // The last one is waited for, whatever became of the others.
    {"last_of_two", "deadlock", H, asked("ask.send; ask.send; " + last, loses_one)},
    {"last_of_two", "two_served", H, asked("ask.send; ask.send; " + last + "@got skip;", always)},
    {"last_of_four", "deadlock", H,
     asked("repeat 4 { ask.send; } " + last, loses_one + answers_twice)},
    {"last_then_none", "deadlock", V,
     asked("ask.send; ask.send; " + last + receive, answers_twice)},
    {"last_in_a_select", "deadlock", H,
     asked("ask.send; ask.send; select { on ask!answer { } timeout 5 { } }", loses_one)},
    {"receive_without_arrow", "deadlock", H,
     asked("ask.send; ask.receive; skip; wait ask -> answer;", answers)},
    // The answer may become due between the time-out and the request that gives it up. It is taken,
    // and so is the next one; where it comes later it is thrown away, and the last receive waits.
    {"due_and_overdue", "deadlock", V,
     asked("ask.send; ask.receive; select { on ask.receive -> answer { } timeout 5 { ask.send; } } "
           "wait ask -> answer; ask.receive -> answer;",
           answers_twice)},
    {"never_asked", "deadlock", V, asked(receive, answers)},
};

class RequestSystems : public testing::TestWithParam<test::VerdictCase> {};

TEST_P(RequestSystems, HaveTheVerdictsThatTheyMustHave) { test::expect_verdict(GetParam()); }

INSTANTIATE_TEST_SUITE_P(All, RequestSystems, testing::ValuesIn(request_systems), test::name_of);

}  // namespace
}  // namespace maide
