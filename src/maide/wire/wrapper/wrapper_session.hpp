// Connects a SystemWrapper with whoever asks it questions, over the wire (wrapper_server.hpp) or in
// the same process (`LocalSul`). It sets the options, resets, gives each actor its thread, and
// plays queries on the instance.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "maide/sul/query_player.hpp"
#include "maide/sul/sul.hpp"
#include "maide/wire/observe/quiescence.hpp"
#include "maide/wire/wrapper/actor_thread.hpp"
#include "maide/wire/wrapper/full_setup.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"

namespace maide {

// Collects the events of one word, from any thread. It keeps the observed events, under the names
// that they have for the observer, and drops the others. It remembers when the last event came,
// observed or not: any event is a sign of life.

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

// The wrapper's options, and those that the SDK adds.
std::vector<OptionSpec> full_option_table(const WrapperDescription& description);

// A process of the system's (SystemSetup::processes) has died; this one had better be replaced.
class SystemProcessEnded : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Told how far a word has come; either may be empty.
struct WordObserver {
  std::function<void()> on_ready;  // the reset is done
  StepObserver on_step;
};

class WrapperSession {
 public:
  // Keeps references. `watchdog`, if there is one, sees resets and teardowns that never end.
  explicit WrapperSession(SystemWrapper& wrapper, Watchdog* watchdog = nullptr);
  ~WrapperSession();
  WrapperSession(const WrapperSession&) = delete;
  WrapperSession& operator=(const WrapperSession&) = delete;

  const std::vector<OptionSpec>& option_table() const { return table_; }
  // Once, before anything else. Throws UsageError, one clear line.
  const SulInfo& configure(const std::map<std::string, std::string>& given);
  bool is_configured() const { return quiescence_ != nullptr; }
  const SulInfo& info() const { return info_; }
  void ignore_socket(int descriptor) { quiescence_->ignore_socket(descriptor); }
  void add_purpose(const LearningPurpose& purpose) { purposes_.push_back(purpose); }

  // Plays one query from a fresh reset, which prepare() may have made; `is_aborted` is asked often.
  // `arrived`: since when the query has waited. The instance stays until the next call or
  // end_instance(). Throws SystemProcessEnded if a process of the system died, other
  // std::runtime_errors if the wrapper failed.
  SulAnswer run(const SulQuery& query, const std::function<bool()>& is_aborted,
                std::chrono::steady_clock::time_point arrived = std::chrono::steady_clock::now(),
                const WordObserver& observer = {});

  // Makes the instance for the next query, if none is there: nobody waits for it yet. One that
  // cannot be made, or has waited for too long when the query comes, is made then.
  void prepare();

  // Shuts the instance down, if there is one. Returns the actors whose calls could not be unblocked
  // ("" if all could): then the instance is abandoned, and the process had better be replaced.
  // Throws what the instance's shutdown() throws.
  std::string end_instance();

 private:
  class Stepper;
  void check_processes() const;
  void check_dying_processes() const;
  void start_instance();
  bool is_prepared() const;
  void leave_instance_behind();
  void select_actors(const FullSetup& full);
  void select_events(const FullSetup& full, const std::vector<std::string>& usual);
  void select_inputs(const FullSetup& full, const SystemSetup& setup);
  void select_bound(const FullSetup& full, const SystemSetup& setup);
  std::uint32_t actor_index(const std::string& name) const;

  SystemWrapper& wrapper_;
  Watchdog* watchdog_;
  std::vector<OptionSpec> table_;
  OptionValues options_;
  SulInfo info_;
  EventTable events_;
  std::vector<InstanceCall> calls_;  // by input
  std::vector<LearningPurpose> purposes_;
  std::vector<pid_t> processes_;
  std::unique_ptr<Quiescence> quiescence_;
  std::chrono::milliseconds step_limit_{0};

  std::vector<ActorThread> actors_;
  std::shared_ptr<StepRecorder> recorder_;  // shared with calls that may outlive their word
  std::unique_ptr<SystemInstance> instance_;
  bool is_fresh_ = false;  // no input was given to the instance
  // Of the last instance: its teardown is part of the next reset's time.
  std::chrono::microseconds teardown_{0};
  std::chrono::microseconds reset_{0};                 // the time of this one's
  std::chrono::steady_clock::time_point reset_began_;  // with the teardown, if there was one
  std::chrono::steady_clock::time_point ready_;
};

// A SystemWrapper as a Sul in this very process: no wire, no protection. For tests, and to measure
// what the wire costs; a system that hangs or crashes here takes the process with it.
class LocalSul : public Sul {
 public:
  // Keeps a reference to `wrapper`, which must be used once only. Throws UsageError for options
  // that the wrapper does not take.
  explicit LocalSul(SystemWrapper& wrapper, const std::map<std::string, std::string>& options = {});

  const SulInfo& info() const override { return session_.info(); }
  void add_purpose(const LearningPurpose& purpose) override { session_.add_purpose(purpose); }
  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override;

 private:
  WrapperSession session_;
};

}  // namespace maide
