// What the tests of every real middleware do: play words on a wrapper in this process, or learn
// from its own process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "connection_models.hpp"
#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/sul/sul.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"

namespace maide::test {

using SystemOptions = std::map<std::string, std::string>;

// Every word of `length` over so many inputs.
std::vector<SulQuery> all_words(std::size_t inputs, std::size_t length);

std::vector<std::string> outputs(const SulAnswer& answer);

// Words that `model` answers in its own way: every other machine of at most its size answers one of
// them otherwise (hybrid ADS). They go deeper than all words of a length can.
std::vector<SulQuery> telling_words(const Mealy& model);

// Plays the words on a system and fails the test unless it answers as `model`, over the same inputs
// in the same order.
void expect_answers(Sul& sul, const Mealy& model, std::span<const SulQuery> words);
// The same of all words of `length`.
void expect_answers(SystemWrapper& wrapper, const SystemOptions& options, const Mealy& model,
                    std::size_t length);

// Of a wrapper for DDS: the reader's depth alone decides what is kept, and ends that do not match
// give no message.
template <typename Wrapper>
void expect_qos_of_each_end() {
  const auto expect_one = [](SystemOptions options, const ConnectionModel& model) {
    options["inputs"] = "write,tryread";
    options["observe"] = "message,null";
    options["payload"] = "gap";
    Wrapper wrapper;
    expect_answers(wrapper, options, make_connection(model), 6);
  };
  const ConnectionModel three{3, WhenFull::drop_oldest, true};
  const ConnectionModel never{0, WhenFull::drop_newest, true};
  expect_one({{"depth", "9"}, {"sub_depth", "3"}}, three);
  expect_one({{"pub_depth", "9"}, {"sub_depth", "3"}, {"reliability", "reliable"}}, three);
  expect_one({{"reliability", "best_effort"}, {"sub_reliability", "reliable"}}, never);
  expect_one({{"durability", "volatile"}, {"sub_durability", "transient_local"}}, never);
}

// What is wrong with these options; "" if nothing is.
std::string usage_error_of(SystemWrapper& wrapper, const SystemOptions& options);

struct LearnedSystem {
  Mealy machine;
  InterfaceAutomaton automaton;
  std::uint64_t experiments = 0;  // words that were run
};

// Learns from maide-wrap-`name`, a process of its own; throws what ended a run early. An empty
// `algorithm` is the default.
LearnedSystem learn_system(const std::string& name, const SystemOptions& options,
                           std::string_view algorithm = "",
                           Translation translation = Translation::eager);

// A connection that behaves as a port of the paper does.
struct PortCase {
  std::string name;
  SystemOptions options;
  std::string reference;  // the port's model in tests/models
};

void PrintTo(const PortCase& tested, std::ostream* out);

// Fails the test unless maide-wrap-`system` is learned as that port, in its size.
void expect_port(const std::string& system, const PortCase& tested,
                 Translation translation = Translation::eager);

// Learns twenty times beside so many busy processes and fails the test unless each model has
// `states` states and the same text.
void expect_same_twenty_times(const std::string& name, const SystemOptions& options,
                              std::size_t states, std::size_t busy_processes);

}  // namespace maide::test
