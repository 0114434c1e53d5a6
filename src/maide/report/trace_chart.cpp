// Makes message sequence charts of counterexamples (trace_text.hpp).
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/json.hpp"
#include "maide/base/text.hpp"
#include "maide/check/rules/model_words.hpp"
#include "maide/check/system/trace_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/check/verdict/message_account.hpp"
#include "maide/check/verdict/on_its_way.hpp"
#include "maide/check/verdict/service_account.hpp"
#include "maide/report/trace_text.hpp"

namespace maide {
namespace {

using Kind = ProgramEdge::Kind;

// Threads give and take nothing, and what is on a wire is drawn between its ends.
bool has_lane(const ModelInstance& model) {
  return model.source != ModelInstance::Source::executor &&
         model.source != ModelInstance::Source::wire;
}

// What becomes of what is sent, by step.
struct Sendings {
  Sendings(const System& system, const Trace& trace, const std::vector<GlobalState>& states)
      : all(find_sent(system, trace, states)),
        sent(trace.steps.size()),
        ended(trace.steps.size(), nullptr) {
    for (const SentMessage& message : all) {
      sent[message.sent].push_back(&message);
      if (message.ended) ended[*message.ended] = &message;
    }
  }
  // The step sends something to that model that arrives later.
  bool sends_to(std::size_t step, std::uint32_t model) const {
    return std::ranges::any_of(sent[step],
                               [&](const auto* message) { return message->to == model; });
  }

  std::vector<SentMessage> all;
  std::vector<std::vector<const SentMessage*>> sent;
  std::vector<const SentMessage*> ended;  // null: nothing; one of them, where a death ends several
};

// Where the lanes of programs and models are.
class Lanes {
 public:
  Lanes(const System& system, const Trace& trace, const Sendings& sendings)
      : programs_(system.programs.size()) {
    const std::size_t count = programs_ + system.models.size();
    // The first program, the models, the other programs: good where all talk to each other.
    order_.push_back(0);
    for (std::size_t i = programs_; i < count; ++i) {
      if (has_lane(system.models[i - programs_])) order_.push_back(i);
    }
    for (std::size_t i = 1; i < programs_; ++i) order_.push_back(i);
    talk_.assign(count, std::vector<std::size_t>(count, 0));
    for (const SentMessage& message : sendings.all) {
      ++talk_[trace.steps[message.sent].actor][programs_ + message.to];
    }
    for (std::size_t at = 0; at < trace.steps.size(); ++at) {
      const Step& step = trace.steps[at];
      if (doer_of(system, step) == nobody) continue;
      for (const ModelUse& event : events_of(system, step)) {
        if (sendings.sends_to(at, event.model)) continue;
        ++talk_[step.actor][programs_ + event.model];
      }
    }
    order_.size() <= most_permuted ? try_all_orders() : swap_neighbours();
    lane_of_.resize(count);
    for (std::size_t lane = 0; lane < order_.size(); ++lane) lane_of_[order_[lane]] = lane;
  }

  std::size_t count() const { return order_.size(); }
  std::size_t of_program(std::size_t program) const { return lane_of_[program]; }
  std::size_t of_model(std::size_t model) const { return lane_of_[programs_ + model]; }

 private:
  static constexpr std::size_t most_permuted = 7;

  // The sum of all arrows' lengths.
  std::size_t length() const {
    std::size_t sum = 0;
    for (std::size_t a = 0; a < order_.size(); ++a) {
      for (std::size_t b = a + 1; b < order_.size(); ++b) {
        sum += (b - a) * (talk_[order_[a]][order_[b]] + talk_[order_[b]][order_[a]]);
      }
    }
    return sum;
  }

  // Keeps the first of the orders that are best, seen from the one at the start.
  void try_all_orders() {
    const std::vector<std::size_t> start = order_;
    std::vector<std::size_t> places(start.size()), best = start;
    for (std::size_t i = 0; i < places.size(); ++i) places[i] = i;
    std::size_t shortest = length();
    while (std::next_permutation(places.begin(), places.end())) {
      for (std::size_t i = 0; i < places.size(); ++i) order_[i] = start[places[i]];
      if (length() < shortest) shortest = length(), best = order_;
    }
    order_ = best;
  }

  void swap_neighbours() {
    for (std::size_t shortest = length(), before = shortest + 1; shortest < before;) {
      before = shortest;
      for (std::size_t i = 1; i < order_.size(); ++i) {
        std::swap(order_[i - 1], order_[i]);
        if (length() < shortest) {
          shortest = length();
        } else {
          std::swap(order_[i - 1], order_[i]);
        }
      }
    }
  }

  std::size_t programs_;
  std::vector<std::size_t> order_;              // parts by lane: programs, then models
  std::vector<std::vector<std::size_t>> talk_;  // messages between parts
  std::vector<std::size_t> lane_of_;
};

// The input that is given, or the output that is taken.
std::string label_of(const System& system, const ModelUse& event) {
  const InterfaceAutomaton& automaton = system.models[event.model].automaton;
  const Alphabet& names = event.kind == Kind::give ? automaton.inputs() : automaton.outputs();
  return file_word(system, event.model, names.name(event.index));
}

// What happens by itself: an arrival is an arrow from who sent it, all else one from the first
// model that it uses to the last, of those that have lanes.
SequenceChart::Message by_itself(const System& system, const Lanes& lanes, const Trace& trace,
                                 std::size_t at, const SentMessage* ended) {
  const Step& step = trace.steps[at];
  const int line = place_of(system, step).line;
  SequenceChart::Message message;
  message.label = describe_action(system, step);
  if (line != 0) message.place = fmt::format("line {}", line);
  if (ended != nullptr) {
    message.from = lanes.of_program(trace.steps[ended->sent].actor);
    message.to = lanes.of_model(ended->to);
    return message;
  }
  bool is_first = true;
  for (const ModelUse& use : uses_of(system, step)) {
    if (!has_lane(system.models[use.model])) continue;
    message.to = lanes.of_model(use.model);
    if (std::exchange(is_first, false)) message.from = message.to;
  }
  return message;
}

// A combined step that gives to one model, or takes from one, is an arrow; other ones are notes of
// the program, and so is what sends what arrives later.
SequenceChart::Message to_message(const System& system, const Lanes& lanes, const Step& step) {
  const ProgramEdge& edge = edge_of(system, step);
  const std::size_t program = lanes.of_program(step.actor);
  SequenceChart::Message message{program, program, "", fmt::format("line {}", edge.line), "", ""};
  if (edge.kind == Kind::choice) {
    message.label = edge.index == 0 ? "if" : "else";
    return message;
  }
  if (edge.kind == Kind::combined || edge.kind == Kind::act) {
    const StepText text = describe_step(system, step);
    message.label = text.event;
    if (!text.model.empty()) {
      const auto events = events_of(system, step);
      const ModelUse& event = events.front();
      (text.event[0] == '?' ? message.to : message.from) = lanes.of_model(event.model);
      message.label = label_of(system, events.front());
      for (const ModelUse& other : events.subspan(1)) {
        message.label += (other.kind == Kind::give ? "?" : "!") + label_of(system, other);
      }
    }
    if (step.is_beyond) message.remark = "never tried there";
    return message;
  }
  const ModelInstance& model = system.models[edge.model];
  const std::size_t lane = lanes.of_model(edge.model);
  switch (edge.kind) {
    case Kind::give:
      message.to = lane;
      message.label = label_of(system, edge);
      if (step.is_beyond) {
        message.remark = model.when_unexplored == WhenUnexplored::drop
                             ? "never tried there: dropped"
                             : "never tried there";
      }
      break;
    case Kind::take:
      message.from = lane;
      message.label = label_of(system, edge);
      break;
    default: message.label = model.name + " is quiet"; break;
  }
  return message;
}

// What a program that has not ended waits for: the first of it.
std::string describe_wait(const System& system, const Program& program, const ProgramEdge& edge) {
  if (edge.kind == Kind::choice) return "can go on";
  if (edge.kind == Kind::combined || edge.kind == Kind::act) {
    return "waits: " + describe_edge(system, program, edge);
  }
  switch (edge.kind) {
    case Kind::give:
    case Kind::take: return "waits: " + describe_use(system, edge);
    default: return fmt::format("waits: {} quiet", system.models[edge.model].name);
  }
}

// `counted`: the same of messages that are alike, if that is another text.
void add_remark(SequenceChart::Message& message, const std::string& text,
                const std::string& counted = "") {
  if (!counted.empty() && message.counted.empty()) message.counted = message.remark;
  const auto add = [](std::string& to, const std::string& more) {
    to += (to.empty() ? "" : "; ") + more;
  };
  if (!counted.empty() || !message.counted.empty()) {
    add(message.counted, counted.empty() ? text : counted);
  }
  add(message.remark, text);
}

// At each step in which a message was lost that some program would take.
void remark_on_losses(const System& system, const Trace& trace,
                      const std::vector<GlobalState>& states, SequenceChart& chart) {
  for (const auto& [model, account] : find_losses(system, trace, states)) {
    for (const auto& loss : account.losses) {
      add_remark(chart.messages[loss.step],
                 loss.count == 1 ? "one is lost" : fmt::format("{} are lost", loss.count));
    }
  }
}

// At each step in which a request or an answer was pushed out, with whose it was.
void remark_on_service_losses(const System& system, const Trace& trace,
                              const std::vector<GlobalState>& states, SequenceChart& chart) {
  for (const ServiceInstance& service : system.services) {
    for (const ServiceLoss& loss : find_service_losses(system, trace, states, service.model)) {
      const std::string& client = service.clients[loss.client];
      add_remark(chart.messages[loss.step],
                 (loss.count == 1 ? std::string("one is lost: ")
                                  : fmt::format("{} are lost: ", loss.count)) +
                     (loss.is_answer ? "the answer to " + client : client + "'s request"));
    }
  }
}

// The values that steps change: "n = 3, ok = true". Not where the step says it itself.
void remark_on_values(const System& system, const Trace& trace,
                      const std::vector<GlobalState>& states, SequenceChart& chart) {
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    std::vector<std::string> values, counted;
    for (const ChangedValue& changed :
         find_changes(system, states[at], states[at + 1], trace.steps[at].actor)) {
      values.push_back(changed.name + " = " + to_string(changed.value, changed.kind, system.words));
      const bool counts = changed.before && changed.kind == ValueKind::integer;
      counted.push_back(counts
                            ? fmt::format("{} + {}", changed.name, changed.value - *changed.before)
                            : values.back());
    }
    SequenceChart::Message& message = chart.messages[at];
    if (values.empty() || join(values) == message.label) continue;
    add_remark(message, join(values), join(counted));
  }
}

// Steps that are not shown are no messages. A loop of such steps alone is none in the chart.
void leave_out_hidden(const System& system, const Trace& trace, SequenceChart& chart) {
  std::erase_if(chart.messages, [&](const SequenceChart::Message& message) {
    return !is_shown(system, trace.steps[message.step]);
  });
  if (!chart.loop_start) return;
  const auto first = std::ranges::find_if(
      chart.messages,
      [&](const SequenceChart::Message& message) { return message.step >= *trace.loop_start; });
  chart.loop_start.reset();
  if (first != chart.messages.end()) {
    chart.loop_start = static_cast<std::size_t>(first - chart.messages.begin());
  }
}

// Says at the arrival when it was sent, and at the sending if it never arrives.
void remark_on(const System& system, const Trace& trace, const SentMessage& sent,
               const SequenceChart::Passage& passage, SequenceChart& chart) {
  SequenceChart::Message& sending = chart.messages[passage.sent];
  if (!passage.ended) {
    if (!trace.loop_start) add_remark(sending, "still on its way at the end");
  } else if (doer_of(system, trace.steps[*sent.ended]) == nobody) {
    add_remark(chart.messages[*passage.ended], fmt::format("sent at step {}", passage.sent + 1),
               fmt::format("sent {} steps before", *passage.ended - passage.sent));
  } else {
    add_remark(sending, fmt::format("lost at step {}", *passage.ended + 1),
               fmt::format("lost {} steps later", *passage.ended - passage.sent));
  }
}

// Each message that arrives later than it is sent. Its sending stays with the sender.
void add_passages(const System& system, const Trace& trace, const Lanes& lanes,
                  const Sendings& sendings, SequenceChart& chart) {
  std::map<std::size_t, std::size_t> rows;  // by step
  for (std::size_t row = 0; row < chart.messages.size(); ++row) {
    rows[chart.messages[row].step] = row;
  }
  for (const SentMessage& sent : sendings.all) {
    const std::size_t from = lanes.of_program(trace.steps[sent.sent].actor);
    const std::size_t to = lanes.of_model(sent.to);
    const auto begin = rows.find(sent.sent);
    if (begin == rows.end()) continue;
    SequenceChart::Passage passage{from, to, begin->second, {}, sent.is_lost};
    SequenceChart::Message& sending = chart.messages[passage.sent];
    if (sending.to == to) sending.to = sending.from;
    const auto end = sent.ended ? rows.find(*sent.ended) : rows.end();
    if (end != rows.end()) passage.ended = end->second;
    remark_on(system, trace, sent, passage, chart);
    chart.passages.push_back(passage);
  }
}

}  // namespace

SequenceChart make_trace_chart(const System& system, const Trace& trace, std::string title) {
  const std::vector<GlobalState> states = replay(system, trace);
  const Sendings sendings(system, trace, states);
  const Lanes lanes(system, trace, sendings);
  SequenceChart chart;
  chart.title = std::move(title);
  chart.loop_start = trace.loop_start;
  chart.lanes.resize(lanes.count());
  for (std::size_t i = 0; i < system.programs.size(); ++i) {
    chart.lanes[lanes.of_program(i)] = {system.programs[i].name, false};
  }
  for (std::size_t i = 0; i < system.models.size(); ++i) {
    if (!has_lane(system.models[i])) continue;
    chart.lanes[lanes.of_model(i)] = {system.models[i].name, true};
  }
  std::map<std::pair<std::uint32_t, int>, std::string> sources;  // by program and line
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    const Step& step = trace.steps[at];
    const bool is_by_itself = doer_of(system, step) == nobody;
    SequenceChart::Message message = is_by_itself
                                         ? by_itself(system, lanes, trace, at, sendings.ended[at])
                                         : to_message(system, lanes, step);
    message.step = at;
    if (const auto origin = origin_of(system, step)) {
      message.place = name_of_place(*origin);  // what stands there is no text of the system file
    } else if (!is_by_itself) {
      const int line = place_of(system, step).line;
      const auto [source, is_new] = sources.try_emplace({step.actor, line});
      if (is_new) source->second = source_line(system, system.programs[step.actor], line);
      message.source = source->second;
    }
    chart.messages.push_back(std::move(message));
  }
  remark_on_losses(system, trace, states, chart);
  remark_on_service_losses(system, trace, states, chart);
  remark_on_values(system, trace, states, chart);
  leave_out_hidden(system, trace, chart);
  add_passages(system, trace, lanes, sendings, chart);
  const GlobalState& last = states.back();
  if (last.is_cut) return chart;
  // Programs that go round in the loop have no end.
  std::vector<bool> goes_round(system.programs.size());
  for (std::size_t at = trace.loop_start.value_or(trace.steps.size()); at < trace.steps.size();
       ++at) {
    if (trace.steps[at].actor != nobody) goes_round[trace.steps[at].actor] = true;
  }
  for (std::size_t i = 0; i < system.programs.size(); ++i) {
    if (goes_round[i]) continue;
    const Program& program = system.programs[i];
    const ControlState control = last.programs[i];
    std::string note = "has ended";
    if (program.is_error(control)) {
      note = "error: " + program.errors[program.states[control].error].text;
    } else if (program.states[control].waits) {
      note = "no guard holds";
    } else if (!program.is_end(control)) {
      note = describe_wait(system, program, program.edges_of(control).front());
    }
    chart.notes.push_back({lanes.of_program(i), note});
  }
  return chart;
}

namespace {

struct Event {
  std::string actor, model, what;  // no actor: nobody; no model: a choice
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
    if (trace.contains("version") && trace["version"] != 1) version_ = 2;
    for (const Json& step : *steps) events_.push_back(event(step));
    make_lanes();
    for (const Event& event : events_) add_message(event);
    const std::string property = text(trace, "property");
    const std::string system = text(trace, "system");
    chart_.title = property + (property.empty() || system.empty() ? "" : " of ") + system;
    const auto settings = settings_of_trace(trace, file_);
    if (!settings.empty()) chart_.title += " with " + to_string(settings);
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
    const char* const who = version_ == 1 ? "program" : "actor";
    Event event{text(step, who), text(step, "model"), text(step, "event"), ""};
    if (!step.contains(who) || event.what.empty()) {
      fail("step " + std::to_string(events_.size() + 1) + " has no `" + who + "` or no `event`");
    }
    const auto line = step.find("line");
    if (line != step.end() && line->is_number_integer()) event.line = "line " + line->dump();
    return event;
  }

  void make_lanes() {
    std::vector<std::string> programs, models;
    const auto note = [](std::vector<std::string>& names, const std::string& name) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    };
    for (const Event& event : events_) {
      note(programs, event.actor.empty() ? nobodys_lane : event.actor);
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
    message.from = message.to =
        lanes_.at({false, event.actor.empty() ? nobodys_lane : event.actor});
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

  // Without the system it is not known which models a step of nobody uses.
  static constexpr const char* nobodys_lane = "(by itself)";

  const std::string& file_;
  int version_ = 1;
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
