// A SystemSetup describes one writer, one reader, and messages without values. This is what the
// options `writers`, `readers` and `payload` make of it: all actors, inputs and events.
//
//   write  ->  write(go) write(stop) write2(go) write2(stop)     writers=2 payload=values:go,stop
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "maide/sul/learning_purpose.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"

namespace maide {

// "write", "write2", "write2(go)". `end` counts from 0. The value may stand behind the name.
std::string symbol_name(std::string_view name, std::size_t end, std::string_view value = {});

// What the instance is asked when an input is given.
struct InstanceCall {
  std::string input;        // its name in the setup
  std::size_t end = 0;      // which of several writers or readers makes it, from 0
  std::uint64_t value = 0;  // number of the value that it writes, from 1; 0: no value
};

class FullSetup {
 public:
  enum class Side : std::uint8_t { writer, reader, neither };
  struct Input {
    std::string name, actor;
    Side side = Side::neither;  // of the actor
    InstanceCall call;
    std::vector<std::string> returns;  // as they are observed
  };
  struct Event {
    std::string name, actor;  // as it is observed: `next2`, `message(go)`
    Side side = Side::neither;
    std::string base;  // of the first end, without a value: `next`, `message`
    std::size_t end = 0;
    std::string reported;  // its name in the setup: `message`
  };

  // Throws UsageError for combinations that make no sense, and std::logic_error for a setup that
  // contradicts itself.
  FullSetup(SystemSetup setup, const OptionValues& options);

  std::vector<std::string> actors;
  std::vector<Input> inputs;
  std::vector<Event> events;
  std::vector<std::string> values;  // of payload=values, in the order of their numbers
  // An event of the setup as it is observed, by the first end and without a value: itself, or
  // next, gap, ...
  std::vector<std::string> base_names(const std::string& event) const;

  // Of a purpose over one writer and one reader, without values, the purposes for all writers and
  // each reader; `shared`: one for all readers.
  std::vector<LearningPurpose> purposes_for(const LearningPurpose& purpose, bool shared) const;
  std::size_t readers() const { return readers_; }

 private:
  Side side_of(const std::string& actor) const;
  std::size_t ends_of(const std::string& actor) const;
  bool carries_value(const std::string& input) const;
  std::vector<std::string> observed_names(const std::string& event, std::size_t end) const;
  void add_inputs();
  void add_events();
  LearningPurpose purpose_for(const LearningPurpose& purpose,
                              const std::vector<std::size_t>& readers) const;
  // All names of an input or event that a purpose for these readers has.
  std::vector<std::string> names_in_purpose(const std::string& name, bool is_input,
                                            const std::vector<std::size_t>& readers) const;

  SystemSetup setup_;
  std::size_t writers_ = 1, readers_ = 1;
  bool tells_gaps_ = false;
};

}  // namespace maide
