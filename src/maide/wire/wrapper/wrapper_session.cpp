#include "maide/wire/wrapper/wrapper_session.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <exception>
#include <mutex>
#include <span>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/text.hpp"
#include "maide/sul/fatal_words.hpp"

namespace maide {
namespace {

// The call that the present thread makes, if it makes one.
struct CurrentCall {
  const StepRecorder* recorder = nullptr;
  const InstanceCall* call = nullptr;
};
thread_local CurrentCall current_call;

}  // namespace

StepRecorder::Caller::Caller(const StepRecorder& recorder, const InstanceCall& call) {
  current_call = {&recorder, &call};
}

StepRecorder::Caller::~Caller() { current_call = {}; }

std::size_t StepRecorder::end() const {
  return current_call.recorder == this ? current_call.call->end : 0;
}

std::uint64_t StepRecorder::content(std::uint64_t place) const {
  if (table_.values.empty()) return place;
  if (current_call.recorder != this || current_call.call->value == 0) {
    throw std::runtime_error("a message without a value, and payload=values gives each one");
  }
  return current_call.call->value;
}

void StepRecorder::record(const std::string& event) {
  const auto entry = table_.events.find(event);
  if (entry == table_.events.end()) {
    if (failure_.empty()) {
      failure_ = fmt::format("the wrapper reported event '{}', which it did not declare", event);
    }
    return;
  }
  last_event_ = std::chrono::steady_clock::now();
  if (entry->second.observed) events_.push_back({entry->second.actor, event});
}

void StepRecorder::report(std::string_view event) {
  const std::scoped_lock lock(mutex_);
  if (!closed_) record(symbol_name(event, end()));
}

void StepRecorder::message(std::uint64_t number) {
  const std::scoped_lock lock(mutex_);
  if (closed_) return;
  if (!table_.values.empty()) {
    if (number == 0 || number > table_.values.size()) {
      if (failure_.empty()) failure_ = fmt::format("message {} carries no value", number);
      return;
    }
    return record(symbol_name(table_.message_event, end(), table_.values[number - 1]));
  }
  if (!table_.tells_gaps) return record(symbol_name(table_.message_event, end()));
  std::uint64_t& last = last_numbers_[end()];
  const char* name = number == last + 1 ? "next" : number > last ? "gap" : "old";
  record(symbol_name(name, end()));
  last = std::max(last, number);
}

void StepRecorder::crashed(std::string_view reason) {
  const std::scoped_lock lock(mutex_);
  if (!closed_ && crash_reason_.empty()) crash_reason_ = reason.empty() ? "crashed" : reason;
}

void StepRecorder::failed(std::string_view reason) {
  const std::scoped_lock lock(mutex_);
  if (!closed_ && failure_.empty()) failure_ = reason.empty() ? "the wrapper failed" : reason;
}

std::vector<Event> StepRecorder::take_events() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(events_, {});
}

std::string StepRecorder::crash_reason() const {
  const std::scoped_lock lock(mutex_);
  return crash_reason_;
}

std::string StepRecorder::failure() const {
  const std::scoped_lock lock(mutex_);
  return failure_;
}

void StepRecorder::close() {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
}

namespace {

using Clock = std::chrono::steady_clock;

// How long an instance may wait for its first input. In a system that was left alone for longer
// than a word ever takes, a lease may have ended, or a connection.
constexpr std::chrono::seconds longest_prepared{10};

// What an option names; `usual` alone stands for `usual_names`, where the option allows that word.
std::vector<std::string> names_of(const OptionValues& options, std::string_view key,
                                  const std::vector<std::string>& usual_names) {
  std::vector<std::string> names = options.list(key);
  const bool is_usual = !usual_names.empty() && names == std::vector<std::string>{"usual"};
  return is_usual ? usual_names : names;
}

std::chrono::microseconds since(Clock::time_point start) {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start);
}

}  // namespace

std::vector<OptionSpec> full_option_table(const WrapperDescription& description) {
  std::vector<OptionSpec> table = description.options;
  for (OptionSpec& row : common_options::quiescence_rows(description.floor.count())) {
    table.push_back(std::move(row));
  }
  return table;
}

// One word's instance as the query player sees it.
class WrapperSession::Stepper : public SteppedSystem {
 public:
  Stepper(WrapperSession& session, const std::function<bool()>& is_aborted)
      : session_(session), is_aborted_(is_aborted) {}

  bool is_busy(Symbol input) override {
    return session_.actors_[session_.info_.inputs[input].actor].is_busy();
  }

  Outcome take(Symbol input, SulStep& step) override {
    const Clock::time_point start = Clock::now();
    start_call(input);
    StepRecorder& recorder = *session_.recorder_;
    const Quiescence::Verdict verdict =
        session_.quiescence_->wait([&] { return recorder.last_event(); }, [&] { return is_over(); },
                                   [&] { return session_.instance_->polls_in_vain(); });
    const Clock::time_point end = Clock::now();
    step.duration = std::chrono::duration_cast<std::chrono::microseconds>(end - start);
    session_.check_processes();
    Clock::time_point last_seen = std::max(start, recorder.last_event());
    step.events = recorder.take_events();
    for (std::uint32_t actor = 0; actor < session_.actors_.size(); ++actor) {
      if (session_.actors_[actor].is_busy()) step.busy.push_back(actor);
      last_seen = std::max(last_seen, session_.actors_[actor].last_return());
    }
    step.settling =
        std::chrono::duration_cast<std::chrono::microseconds>(std::max(end, last_seen) - last_seen);
    if (const std::string failure = recorder.failure(); !failure.empty()) {
      session_.check_dying_processes();
      throw std::runtime_error(failure);
    }
    if (!recorder.crash_reason().empty()) return Outcome::crash;
    switch (verdict) {
      case Quiescence::Verdict::hang: return Outcome::hang;
      case Quiescence::Verdict::aborted: return Outcome::aborted;
      case Quiescence::Verdict::quiescent: break;
    }
    return Outcome::quiescent;
  }

 private:
  bool is_over() const {
    session_.check_processes();
    return is_aborted_();
  }

  void start_call(Symbol input) {
    const SulInput& spec = session_.info_.inputs[input];
    session_.actors_[spec.actor].start([instance = session_.instance_.get(),
                                        call = session_.calls_[input],
                                        recorder = session_.recorder_] {
      const StepRecorder::Caller caller(*recorder, call);
      try {
        instance->call(call.input);
      } catch (const std::exception& error) {
        recorder->failed(error.what());
      } catch (...) {
        recorder->failed("unknown exception in " + call.input);
      }
    });
  }

  WrapperSession& session_;
  const std::function<bool()>& is_aborted_;
};

WrapperSession::WrapperSession(SystemWrapper& wrapper, Watchdog* watchdog)
    : wrapper_(wrapper), watchdog_(watchdog) {
  const WrapperDescription& description = wrapper.description();
  table_ = full_option_table(description);
  info_.name = description.name;
  info_.versions = description.versions;
}

WrapperSession::~WrapperSession() {
  try {
    end_instance();
  } catch (const std::exception&) {
    leave_instance_behind();  // whoever called end_instance() before has been told
  }
}

const SulInfo& WrapperSession::configure(const std::map<std::string, std::string>& given) {
  options_ = OptionValues(table_, given);
  const SystemSetup setup = wrapper_.configure(options_);
  if (setup.floor && std::ranges::none_of(
                         given, [](const auto& entry) { return same_key(entry.first, "floor"); })) {
    std::map<std::string, std::string> completed = given;
    completed["floor"] = std::to_string(setup.floor->count());
    options_ = OptionValues(table_, completed);
  }
  const FullSetup full(setup, options_);
  events_.message_event = setup.message_event;
  events_.tells_gaps = options_.has("payload") && options_.is("payload", "gap");
  events_.values = full.values;
  info_.options = options_.all();
  select_actors(full);
  select_events(full, setup.usual_events);
  select_inputs(full, setup);
  select_bound(full, setup);
  QuiescenceSettings settings;
  settings.observed = options_.is("quiescence", "observed");
  if (!settings.observed) settings.delay = std::chrono::milliseconds(options_.number("quiescence"));
  settings.floor = std::chrono::milliseconds(options_.number("floor"));
  settings.limit = step_limit_ = std::chrono::milliseconds(options_.number("step-limit"));
  quiescence_ = std::make_unique<Quiescence>(settings);
  processes_ = setup.processes;
  for (const pid_t process : processes_) quiescence_->watch_process(process);
  return info_;
}

// Leaves them where they are: whoever started them takes them away.
void WrapperSession::check_processes() const {
  for (const pid_t process : processes_) {
    siginfo_t ended{};
    const int result =
        ::waitid(P_PID, static_cast<id_t>(process), &ended, WEXITED | WNOHANG | WNOWAIT);
    if (result == 0 && ended.si_pid == 0) continue;
    std::string how = "is gone";
    if (result == 0) {
      how = ended.si_code == CLD_EXITED
                ? fmt::format("exited with status {}", ended.si_status)
                : fmt::format("was killed by signal {} ({})", ended.si_status,
                              ::strsignal(ended.si_status));
    }
    throw SystemProcessEnded(fmt::format("process {} of the system {}", process, how));
  }
}

// A process that dies closes its connections first: when something failed, its end may be near.
void WrapperSession::check_dying_processes() const {
  constexpr auto longest_death = std::chrono::milliseconds(100);
  const Clock::time_point start = Clock::now();
  while (!processes_.empty() && Clock::now() - start < longest_death) {
    check_processes();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void WrapperSession::select_actors(const FullSetup& full) {
  info_.actors = full.actors;
  for (const std::string& name : info_.actors) actors_.emplace_back(name);
}

std::uint32_t WrapperSession::actor_index(const std::string& name) const {
  const auto found = std::ranges::find(info_.actors, name);
  if (found == info_.actors.end()) {
    throw std::logic_error(fmt::format("the wrapper declares no actor '{}'", name));
  }
  return static_cast<std::uint32_t>(found - info_.actors.begin());
}

void WrapperSession::select_events(const FullSetup& full, const std::vector<std::string>& usual) {
  const std::vector<std::string> observed =
      options_.has("observe") ? names_of(options_, "observe", usual) : std::vector<std::string>();
  for (const FullSetup::Event& event : full.events) {
    if (is_end_output(event.name) || is_reserved_output(event.name)) {
      throw std::logic_error(fmt::format(
          "the wrapper declares event '{}', a name with a meaning of its own", event.name));
    }
    const bool is_observed =
        !options_.has("observe") || std::ranges::find(observed, event.reported) != observed.end();
    events_.events[event.name] = {actor_index(event.actor), is_observed};
    if (is_observed) info_.outputs.push_back({event.name, actor_index(event.actor)});
  }
}

void WrapperSession::select_inputs(const FullSetup& full, const SystemSetup& setup) {
  std::vector<std::string> wanted;
  if (options_.has("inputs")) {
    wanted = names_of(options_, "inputs", setup.usual_inputs);
  } else {
    for (const SystemSetup::Input& input : setup.inputs) wanted.push_back(input.name);
  }
  for (const std::string& name : wanted) {
    const std::size_t before = info_.inputs.size();
    for (const FullSetup::Input& input : full.inputs) {
      if (input.call.input != name) continue;
      info_.inputs.push_back({input.name, actor_index(input.actor), input.returns});
      calls_.push_back(input.call);
    }
    if (info_.inputs.size() == before) {
      throw UsageError(
          fmt::format("option inputs: there is no input '{}' with these options", name));
    }
  }
}

void WrapperSession::select_bound(const FullSetup& full, const SystemSetup& setup) {
  for (const LearningPurpose& purpose : setup.purposes) {
    for (LearningPurpose& one : full.purposes_for(purpose, false)) purposes_.push_back(one);
  }
  info_.bound = setup.bound;
  if (!setup.in_flight || !options_.has("size")) return;
  const MessagesInFlight& flight = *setup.in_flight;
  const auto size = static_cast<std::size_t>(options_.number("size"));
  if (flight.capacity != 0 && flight.capacity <= size) return;  // never binds
  std::vector<std::string> sends;
  for (const std::string& name : flight.sends) {
    const bool is_input =
        std::ranges::any_of(calls_, [&](const InstanceCall& call) { return call.input == name; });
    if (is_input) sends.push_back(name);
  }
  std::vector<std::string> receives;
  for (const std::string& event : flight.receives) {
    for (const FullSetup::Event& known : full.events) {
      if (known.reported != event || events_.events.at(known.name).observed) continue;
      throw UsageError(
          fmt::format("option observe: size={} counts messages in flight, so '{}' must be observed",
                      size, event));
    }
    for (std::string& name : full.base_names(event)) receives.push_back(std::move(name));
  }
  const bool absorbs = options_.has("at-bound") && options_.is("at-bound", "absorb");
  const LearningPurpose counter = LearningPurpose::in_flight(
      size, flight.capacity, sends, receives, absorbs ? AtBound::absorb : AtBound::refuse);
  for (LearningPurpose& one : full.purposes_for(counter, flight.is_shared)) {
    purposes_.push_back(std::move(one));
  }
  if (!info_.bound.empty()) info_.bound += ", ";
  info_.bound += fmt::format("at most {} in flight{}", counted(size, "message"),
                             full.readers() > 1 && !flight.is_shared ? " to each reader" : "");
}

void WrapperSession::start_instance() {
  const Watchdog::Guard guard(watchdog_, "the reset", step_limit_);
  const Clock::time_point start = Clock::now();
  MAIDE_CHECK(!instance_);
  if (teardown_.count() == 0) reset_began_ = start;
  recorder_ = std::make_shared<StepRecorder>(events_);
  try {
    instance_ = wrapper_.reset(*recorder_);
  } catch (const std::exception&) {
    check_dying_processes();
    throw;
  }
  is_fresh_ = true;
  ready_ = Clock::now();
  // By the same look at the clock: what was waited for is at least what it cost.
  reset_ = std::chrono::duration_cast<std::chrono::microseconds>(ready_ - start) +
           std::exchange(teardown_, {});
}

bool WrapperSession::is_prepared() const {
  return instance_ && is_fresh_ && Clock::now() - ready_ < longest_prepared &&
         recorder_->failure().empty() && recorder_->crash_reason().empty();
}

void WrapperSession::prepare() {
  if (is_prepared()) return;
  end_instance();
  try {
    start_instance();
  } catch (const std::exception&) {
    // The next query makes it, and is told if it cannot be made.
  }
}

SulAnswer WrapperSession::run(const SulQuery& query, const std::function<bool()>& is_aborted,
                              Clock::time_point arrived, const WordObserver& observer) {
  check_processes();
  if (!is_prepared()) {
    end_instance();
    start_instance();
  }
  MAIDE_CHECK(instance_ && recorder_ && is_fresh_);  // no word on an instance that had another
  is_fresh_ = false;
  if (observer.on_ready) observer.on_ready();
  Stepper stepper(*this, is_aborted);
  SulAnswer answer = play(stepper, query, info_, purposes_, observer.on_step);
  answer.reset_duration = reset_;
  const Clock::time_point waiting = std::max(arrived, reset_began_);
  answer.reset_wait =
      std::chrono::duration_cast<std::chrono::microseconds>(std::max(ready_, waiting) - waiting);
  if (answer.end == WordEnd::crash) answer.reason = recorder_->crash_reason();
  if (answer.end == WordEnd::hang) {
    answer.reason = fmt::format("did not come to rest within {} ms", step_limit_.count());
  }
  return answer;
}

// Its calls still use it, and the recorder, for as long as the process lives: never destroyed, but
// still pointed to, so that it is no leak.
void WrapperSession::leave_instance_behind() {
  static auto* left_behind =
      new std::vector<std::pair<std::shared_ptr<StepRecorder>, std::unique_ptr<SystemInstance>>>();
  static auto* mutex = new std::mutex();
  const std::scoped_lock lock(*mutex);
  left_behind->emplace_back(recorder_, std::move(instance_));
  MAIDE_CHECK(!instance_);
}

std::string WrapperSession::end_instance() {
  if (!instance_) return "";
  const Clock::time_point start = Clock::now();
  std::string stuck;
  recorder_->close();
  {
    const Watchdog::Guard guard(watchdog_, "the teardown of the system", step_limit_);
    instance_->shutdown();
  }
  for (std::uint32_t actor = 0; actor < actors_.size(); ++actor) {
    if (actors_[actor].wait_idle(start + step_limit_)) continue;
    if (!stuck.empty()) stuck += ", ";
    stuck += info_.actors[actor];
    actors_[actor] = ActorThread(info_.actors[actor]);  // the old one is left behind
  }
  if (stuck.empty()) {
    const Watchdog::Guard guard(watchdog_, "the teardown of the system", step_limit_);
    instance_.reset();
  } else {
    leave_instance_behind();
  }
  if (teardown_.count() == 0) reset_began_ = start;
  teardown_ += since(start);
  return stuck;
}

LocalSul::LocalSul(SystemWrapper& wrapper, const std::map<std::string, std::string>& options)
    : session_(wrapper) {
  session_.configure(options);
}

void LocalSul::run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
                   const RunControl& control) {
  for (std::size_t index = 0; index < batch.size(); ++index) {
    control.check("running words on the system");
    SulAnswer answer;
    try {
      answer = session_.run(batch[index], [&] { return control.should_stop(); });
    } catch (const Error&) {
      throw;
    } catch (const std::exception& error) {
      throw WrapperError(error.what(), session_.info().name + " in this process");
    }
    if (answer.end == WordEnd::aborted) control.check("running words on the system");
    sink(index, std::move(answer));
  }
}

}  // namespace maide
