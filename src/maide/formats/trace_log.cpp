#include "maide/formats/trace_log.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ostream>

#include "maide/base/error.hpp"
#include "maide/base/json.hpp"
#include "maide/base/text.hpp"

namespace maide {
namespace {

// parse_json() counts lines from the first of its text.
Json parse_line(std::string_view line, const std::string& file, int number) {
  try {
    return parse_json(line, file);
  } catch (const ParseError& error) {
    throw ParseError("not a trace in JSON", {file, number, error.position().column});
  }
}

}  // namespace

std::string located(const std::string& what, const TraceLog& log) {
  return log.file.empty() ? what : what + " (" + log.file + ")";
}

TraceLog read_trace_log(std::string_view text, const std::string& file, const RunControl& control) {
  TraceLog log;
  log.file = file;
  int number = 0;
  for (const std::string_view line : split_lines(text)) {
    if (++number % 256 == 0) control.check("reading the log");
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    const Json json = parse_line(line, file, number);
    const auto is_name = [](const Json& name) {
      return name.is_string() && !name.get_ref<const std::string&>().empty();
    };
    const auto is_step = [&](const Json& step) {
      return step.is_array() && step.size() == 2 && is_name(step[0]) && is_name(step[1]);
    };
    if (!json.is_array() || !std::ranges::all_of(json, is_step)) {
      throw ParseError("a trace is an array of pairs [\"input\", \"output\"]", {file, number, 0});
    }
    TraceLog::Trace& trace = log.traces.emplace_back();
    for (const Json& step : json) {
      trace.inputs.push_back(log.inputs.intern(step[0].get_ref<const std::string&>()));
      trace.outputs.push_back(log.outputs.intern(step[1].get_ref<const std::string&>()));
    }
  }
  return log;
}

void write_trace_log(std::ostream& out, const TraceLog& log) {
  for (const TraceLog::Trace& trace : log.traces) {
    Json line = Json::array();
    for (std::size_t i = 0; i < trace.inputs.size(); ++i) {
      line.push_back({log.inputs.name(trace.inputs[i]), log.outputs.name(trace.outputs[i])});
    }
    out << to_json_line(line) << '\n';
  }
}

}  // namespace maide
