#include "maide/report/trace_file_chart.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/json.hpp"

namespace maide {
namespace {

struct Event {
  std::string program, model, what;  // no model: a choice
  std::string line;
};

class ChartReader {
 public:
  explicit ChartReader(const std::string& file) : file_(file) {}

  SequenceChart read(const Json& trace) {
    const auto steps = trace.find("steps");
    if (!trace.is_object() || steps == trace.end() || !steps->is_array()) {
      fail("this is no trace: it has no list of `steps`");
    }
    for (const Json& step : *steps) events_.push_back(event(step));
    make_lanes();
    for (const Event& event : events_) add_message(event);
    const std::string property = text(trace, "property");
    const std::string system = text(trace, "system");
    chart_.title = property + (property.empty() || system.empty() ? "" : " of ") + system;
    const auto loop = trace.find("loop_start");
    if (loop != trace.end() && !loop->is_null()) {
      if (!loop->is_number_unsigned() || loop->get<std::size_t>() >= events_.size()) {
        fail("`loop_start` is no step of the trace");
      }
      chart_.loop_start = loop->get<std::size_t>();
    }
    return std::move(chart_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw UsageError(message + " (" + file_ + ")");
  }

  // The text there; "" if it is null or not there.
  std::string text(const Json& object, const char* key) const {
    const auto value = object.find(key);
    if (value == object.end() || value->is_null()) return "";
    if (!value->is_string()) fail(std::string("`") + key + "` is no text");
    return value->get<std::string>();
  }

  Event event(const Json& step) const {
    if (!step.is_object()) fail("a step is no object");
    Event event{text(step, "program"), text(step, "model"), text(step, "event"), ""};
    if (event.program.empty() || event.what.empty()) {
      fail("step " + std::to_string(events_.size() + 1) + " has no `program` or no `event`");
    }
    const auto line = step.find("line");
    if (line != step.end() && line->is_number_integer()) event.line = "line " + line->dump();
    return event;
  }

  void make_lanes() {
    std::vector<std::string> programs, models;
    const auto note = [](std::vector<std::string>& names, const std::string& name) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    for (const Event& event : events_) {
      note(programs, event.program);
      if (!event.model.empty()) note(models, event.model);
    }
    if (!programs.empty()) add_lane(programs.front(), false);
    for (const std::string& model : models) add_lane(model, true);
    for (std::size_t i = 1; i < programs.size(); ++i) add_lane(programs[i], false);
  }

  void add_lane(const std::string& name, bool is_model) {
    lanes_[{is_model, name}] = chart_.lanes.size();
    chart_.lanes.push_back({name, is_model});
  }

  void add_message(const Event& event) {
    SequenceChart::Message message;
    message.from = message.to = lanes_.at({false, event.program});
    message.place = event.line;
    message.label = event.what;
    const bool meets = !event.model.empty() && (event.what[0] == '?' || event.what[0] == '!');
    if (meets) {
      message.label = event.what.substr(1);
      (event.what[0] == '?' ? message.to : message.from) = lanes_.at({true, event.model});
    } else if (!event.model.empty()) {
      message.label = event.model + " is " + event.what;
    }
    chart_.messages.push_back(std::move(message));
  }

  const std::string& file_;
  std::vector<Event> events_;
  std::map<std::pair<bool, std::string>, std::size_t> lanes_;  // (is a model, name)
  SequenceChart chart_;
};

}  // namespace

SequenceChart chart_of_trace(std::string_view text, const std::string& file) {
  const Json trace = Json::parse(text, nullptr, false);
  if (trace.is_discarded()) throw UsageError("this is no JSON (" + file + ")");
  return ChartReader(file).read(trace);
}

}  // namespace maide
