#include "maide/wire/wrapper/step_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace maide {

void StepRecorder::record(std::string_view event) {
  const auto entry = table_.events.find(event);
  if (entry == table_.events.end()) {
    if (failure_.empty()) {
      failure_ = fmt::format("the wrapper reported event '{}', which it did not declare", event);
    }
    return;
  }
  last_event_ = std::chrono::steady_clock::now();
  if (entry->second.observed) events_.push_back({entry->second.actor, std::string(event)});
}

void StepRecorder::report(std::string_view event) {
  const std::scoped_lock lock(mutex_);
  if (!closed_) record(event);
}

void StepRecorder::message(std::uint64_t number) {
  const std::scoped_lock lock(mutex_);
  if (closed_) return;
  if (!table_.tells_gaps) {
    record(table_.message_event);
    return;
  }
  record(number == last_number_ + 1 ? "next" : number > last_number_ ? "gap" : "old");
  last_number_ = std::max(last_number_, number);
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
