// Collects the events of one word, from any thread. It keeps the observed events, under the names
// that they have for the observer, and drops the others. It remembers when the last event came,
// observed or not: any event is a sign of life.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "maide/sul/sul.hpp"
#include "maide/wire/wrapper/full_setup.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"

namespace maide {

// Which events there are, and which are observed; made once from options and setup.
struct EventTable {
  struct Entry {
    std::uint32_t actor = 0;
    bool observed = false;
  };
  std::map<std::string, Entry, std::less<>> events;
  std::string message_event;
  bool tells_gaps = false;          // payload=gap
  std::vector<std::string> values;  // payload=values, by number
};

class StepRecorder : public EventSink {
 public:
  explicit StepRecorder(const EventTable& table) : table_(table) {}

  // As long as it lives, its thread makes this call: what is reported is the event of its end.
  class Caller {
   public:
    // Keeps references.
    Caller(const StepRecorder& recorder, const InstanceCall& call);
    ~Caller();
    Caller(const Caller&) = delete;
    Caller& operator=(const Caller&) = delete;
  };

  void report(std::string_view event) override;
  void message(std::uint64_t number) override;
  std::uint64_t content(std::uint64_t place) const override;
  std::size_t end() const override;
  void crashed(std::string_view reason) override;
  // The wrapper itself failed: the word ends in an error.
  void failed(std::string_view reason);

  // The events since the last call, in the order in which they came.
  std::vector<Event> take_events();
  std::chrono::steady_clock::time_point last_event() const { return last_event_; }
  // Why the system crashed, or the wrapper failed; "" if it did not.
  std::string crash_reason() const;
  std::string failure() const;
  // From now on everything is dropped.
  void close();

 private:
  void record(const std::string& event);  // with the mutex held

  const EventTable& table_;
  mutable std::mutex mutex_;
  std::vector<Event> events_;
  std::map<std::size_t, std::uint64_t> last_numbers_;  // by the end that received them
  std::string crash_reason_, failure_;
  bool closed_ = false;
  std::atomic<std::chrono::steady_clock::time_point> last_event_{};
};

}  // namespace maide
