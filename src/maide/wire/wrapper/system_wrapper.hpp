// The SDK in which a wrapper for a middleware is written: the paper's System Wrapper. A wrapper is
// one file with a class. The class describes itself and its options. From the options it says which
// actors, inputs and events there are. It makes fresh instances, whose `call` is the real, blocking
// call.
//
// The SDK does the rest. It gives every actor a thread of its own, collects events until the system
// is quiescent, drops those that are not observed, plays words and decision trees, and speaks the
// protocol (docs/protocol.md). A wrapper ends with
//
//   int main(int argc, char** argv) {
//     MyWrapper wrapper;
//     return maide::run_wrapper(wrapper, argc, argv);
//   }
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "maide/sul/learning_purpose.hpp"
#include "maide/wire/wrapper/wrapper_options.hpp"

namespace maide {

// What a wrapper says of itself before any option is set.
struct WrapperDescription {
  std::string name;                             // "port", "cyclonedds"
  std::string summary;                          // one line for --help
  std::map<std::string, std::string> versions;  // wrapper, middleware: part of the fingerprint
  // Its own options and those of common_options that it supports; the SDK adds quiescence_rows.
  std::vector<OptionSpec> options;
  // The default of option `floor`. A timer of the middleware's protocol may still be due while
  // every thread sleeps; this is how long after the last thing seen. 0 for systems without such
  // timers.
  std::chrono::milliseconds floor{0};
};

// What `size=` bounds. With capacity <= size the bound never binds.
struct MessagesInFlight {
  std::vector<std::string> sends = {"write"};       // inputs that put a message into flight
  std::vector<std::string> receives = {"message"};  // events that take one out
  std::size_t capacity = 0;  // messages that the system itself keeps at most; 0: no limit
  bool is_shared = false;    // of several readers, one gets a message; else each gets it
};

// What the system is once its options are set. Everything is listed; the SDK picks what
// `inputs=` and `observe=` name.
//
// With the rows of common_options::ends() there may be several writers and readers. The setup
// describes one writer and one reader all the same. The SDK adds the others: actors `writer2`,
// inputs `write2`, events `message2`, each with a thread and a bound of its own.
struct SystemSetup {
  struct Input {
    std::string name;
    std::string actor;
    std::vector<std::string> returns;  // events by which its call may return; empty: never blocks
  };
  struct Event {
    std::string name;
    std::string actor;
  };

  std::vector<std::string> actors;  // in the canonical order
  std::vector<Input> inputs;
  std::vector<Event> events;
  // The event that EventSink::message reports. payload=gap replaces it by `next` and `gap`, and by
  // `old` where messages can come again. payload=values replaces it by `message(V)` for each value.
  // Both replace it everywhere, in `observe=` and `returns`, too.
  std::string message_event = "message";
  bool messages_come_again = false;
  std::optional<MessagesInFlight> in_flight;  // set it if the table has `size`
  // The actors that each further writer, or reader, has too.
  std::vector<std::string> of_writer = {"writer"}, of_reader = {"reader"};
  std::vector<LearningPurpose> purposes;  // further ones
  std::string bound;                      // of the further ones, in words
  // The default of option `floor` with these options, if it is not the wrapper's usual one.
  std::optional<std::chrono::milliseconds> floor;
  // What `usual` stands for in `inputs=` and `observe=`, where the table's rows allow that word:
  // for a system whose other options decide what there is.
  std::vector<std::string> usual_inputs, usual_events;
  // Other processes that belong to the system: children that configure() started (ServiceProcess: a
  // broker, a name server). Quiescence watches them too; when one dies the wrapper ends and the
  // client starts it anew.
  std::vector<pid_t> processes;
};

// Where an instance reports what happens. Any thread may call these, from within a call or a
// callback of the middleware; none blocks for long. Valid as long as the instance lives.
class EventSink {
 public:
  virtual ~EventSink() = default;
  // An event by its name in SystemSetup::events.
  virtual void report(std::string_view event) = 0;
  // The message event. `number` is what the message carries: content().
  virtual void message(std::uint64_t number) = 0;
  // What a call writes into its message. `place`: the message's place among those sent since the
  // reset, from 1. That it is, but for payload=values: there it is the number of the call's value.
  virtual std::uint64_t content(std::uint64_t place) const = 0;
  // Which of several writers, or readers, makes the call that this thread is in, from 0. What is
  // reported within the call is an event of that end.
  virtual std::size_t end() const = 0;
  // The system itself has died: the word ends here as a crash.
  virtual void crashed(std::string_view reason) = 0;
};

// One fresh instance of the system: ports opened and connected, nothing in flight.
class SystemInstance {
 public:
  // Called after shutdown(), when every call has returned. Stops all callbacks.
  virtual ~SystemInstance() = default;
  // Makes the call that `input` stands for, on its actor's own thread; blocks as the real call
  // does. Reports its return ("written") before it ends. An exception ends the word with an error.
  // The input's name is that of the setup, whichever end (EventSink::end()) makes the call.
  virtual void call(std::string_view input) = 0;
  // From another thread: lets every blocked call return soon, now and for all later calls. What is
  // still reported is dropped. If a call stays blocked the process ends and is replaced.
  virtual void shutdown() = 0;
  // True if the call that sleeps now will find nothing until the next input. A call that sleeps for
  // a set time means "not quiescent yet". Some calls block by sleeping and looking, again and
  // again; their sleep counts as rest if this says true. Asked from another thread while all
  // threads sleep.
  virtual bool polls_in_vain() const { return false; }
};

class SystemWrapper {
 public:
  virtual ~SystemWrapper() = default;
  // Must not start anything: a listening wrapper forks for each client after it.
  virtual const WrapperDescription& description() const = 0;
  // Called once, before the first reset, with checked values. Throws UsageError for combinations
  // that make no sense. Keeps what it needs; may start what all words share.
  virtual SystemSetup configure(const OptionValues& options) = 0;
  // A fresh instance, ready for its first input. Throws any std::exception if it cannot.
  virtual std::unique_ptr<SystemInstance> reset(EventSink& sink) = 0;
};

// The main function of a wrapper's executable: --help, --list-options, --self-test, the protocol
// over standard input and output, or --listen HOST:PORT. Returns the exit status.
int run_wrapper(SystemWrapper& wrapper, int argc, char** argv);

// Is the middleware of a wrapper usable on this machine? One real word answers that: a reset with
// the default options and each input once, in the order in which the wrapper lists them (a write,
// then a read). For `maide doctor`; a wrapper's executable runs it as --self-test.

// What was found, in one line: "cyclonedds 0.10.2: write -> quiet, read -> message". Throws
// WrapperError, one line, if the word did not end well or nothing at all was observed. Ends the
// process with status 4 if the reset, or the end of it, hangs.
std::string run_self_test(SystemWrapper& wrapper);

}  // namespace maide
