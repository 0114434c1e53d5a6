#include "maide/join/at_rest.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "maide/base/json.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/rules/model_words.hpp"
#include "maide/check/system/trace_file.hpp"
#include "maide/check/verdict/check_system.hpp"

namespace maide {
namespace {

std::optional<Trace> without_arrivals(const System& system, const std::string& property,
                                      const Trace& trace, const System& at_rest) {
  Json file = trace_file_to_json(system, property, trace);
  Json steps = Json::array();
  std::optional<std::size_t> loop_start;
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    if (trace.loop_start == at) loop_start = steps.size();
    if (doer_of(system, trace.steps[at]) != nobody) steps.push_back(file["steps"][at]);
  }
  if (loop_start == steps.size()) return std::nullopt;  // nobody alone goes round
  file["steps"] = std::move(steps);
  if (loop_start) file["loop_start"] = *loop_start;
  try {
    TraceFile read = parse_trace(file.dump(), at_rest.file, at_rest);
    if (!property.empty() &&
        !find_flaw_in_parts(at_rest, find_property(at_rest, property), read.trace).empty()) {
      return std::nullopt;
    }
    return std::move(read.trace);
  } catch (const ParseError&) {
    return std::nullopt;
  } catch (const UsageError&) {
    return std::nullopt;
  }
}

}  // namespace

std::optional<RestingRun> find_run_at_rest(const System& system, const std::string& property,
                                           const Trace& trace, const System& at_rest,
                                           const RunControl& control) {
  if (auto same = without_arrivals(system, property, trace, at_rest)) {
    return RestingRun{std::move(*same), false};
  }
  if (property.empty()) return std::nullopt;
  NativeEngine engine;
  CheckRequest request;
  request.properties = {property};
  request.options.control = control;
  CheckReport report = check_system(at_rest, engine, request);
  control.check("looking for a run without late messages");
  for (PropertyResult& result : report.properties) {
    if (result.name == property && result.trace) return RestingRun{std::move(*result.trace), true};
  }
  return std::nullopt;
}

std::string describe_late_message(const System& system, const Trace& trace) {
  constexpr const char* reason = "a late message";
  const std::vector<GlobalState> states = replay(system, trace);
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    if (doer_of(system, trace.steps[at]) == nobody) continue;
    for (std::size_t index = 0; index < system.models.size(); ++index) {
      const ModelInstance& wire = system.models[index];
      const bool is_held = wire.source == ModelInstance::Source::wire &&
                           states[at].models[index] < wire.state_texts.size();
      if (!is_held || wire.state_texts[states[at].models[index]].empty()) continue;
      const WireEnds ends = ends_of_wire(wire.name);
      return fmt::format("{} (at step {} {} is on its way from {} to {})", reason, at + 1,
                         wire.state_texts[states[at].models[index]], ends.writer, ends.model);
    }
  }
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    const Step& step = trace.steps[at];
    const bool arrives = !events_of(system, step).empty() || !lost_by(system, step).empty();
    if (step.actor != nobody || arrives) continue;
    return fmt::format("what comes by itself (step {}: {})", at + 1, describe_action(system, step));
  }
  return reason;
}

}  // namespace maide
