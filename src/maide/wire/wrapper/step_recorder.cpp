#include "maide/wire/wrapper/step_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

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

}  // namespace maide
