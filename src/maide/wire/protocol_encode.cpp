// Messages as lines of JSON. Members that have their default value are left out, as a hand-written
// wrapper would do.
#include <nlohmann/json.hpp>

#include "maide/base/json.hpp"
#include "maide/wire/protocol.hpp"

namespace maide::protocol {
namespace {

const char* kind_name(OptionSpec::Kind kind) {
  switch (kind) {
    case OptionSpec::Kind::choice: return "choice";
    case OptionSpec::Kind::list: return "list";
    case OptionSpec::Kind::integer: return "integer";
    case OptionSpec::Kind::text: break;
  }
  return "text";
}

const char* code_name(ErrorCode code) {
  switch (code) {
    case ErrorCode::option: return "option";
    case ErrorCode::token: return "token";
    case ErrorCode::system: return "system";
    case ErrorCode::protocol: break;
  }
  return "protocol";
}

const char* status_name(StepStatus status) {
  switch (status) {
    case StepStatus::refused: return "refused";
    case StepStatus::unexplored: return "unexplored";
    case StepStatus::absorbed: return "absorbed";
    case StepStatus::delta: return "delta";
    case StepStatus::taken: break;
  }
  return "taken";
}

const char* end_name(WordEnd end) {
  switch (end) {
    case WordEnd::crash: return "crash";
    case WordEnd::hang: return "hang";
    case WordEnd::aborted: return "aborted";
    case WordEnd::complete: break;
  }
  return "complete";
}

Json option_json(const OptionSpec& spec) {
  Json row = {{"key", spec.key}, {"kind", kind_name(spec.kind)}, {"default", spec.default_value}};
  if (!spec.allowed.empty()) row["allowed"] = spec.allowed;
  if (spec.most >= spec.least) {
    row["least"] = spec.least;
    row["most"] = spec.most;
  }
  row["help"] = spec.help;
  return row;
}

const std::string& input_name(Symbol input, const SulInfo& info) {
  static const std::string delta_name = delta;
  return input < info.inputs.size() ? info.inputs[input].name : delta_name;
}

Json word_json(const Word& word, const SulInfo& info) {
  Json names = Json::array();
  for (const Symbol input : word) names.push_back(input_name(input, info));
  return names;
}

Json step_json(const SulStep& step, const SulInfo& info) {
  Json json = Json::object();
  if (step.status != StepStatus::taken) json["status"] = status_name(step.status);
  json["events"] = Json::array();
  for (const Event& event : step.events) {
    json["events"].push_back({info.actors[event.actor], event.output});
  }
  for (const std::uint32_t actor : step.busy) json["busy"].push_back(info.actors[actor]);
  json["us"] = step.duration.count();
  if (step.settling.count() != 0) json["settling_us"] = step.settling.count();
  return json;
}

}  // namespace

std::string encode(const Hello& hello) {
  Json json = {{"type", "hello"},           {"protocol", version},
               {"name", hello.name},        {"versions", Json::object()},
               {"features", Json::array()}, {"options", Json::array()}};
  for (const auto& [part, number] : hello.versions) json["versions"][part] = number;
  if (hello.speaks_trees) json["features"].push_back("trees");
  if (hello.speaks_purposes) json["features"].push_back("purposes");
  if (hello.speaks_av) json["features"].push_back("av");
  if (hello.needs_token) json["needs_token"] = true;
  for (const OptionSpec& spec : hello.options) json["options"].push_back(option_json(spec));
  return to_json_line(json);
}

std::string encode(const Info& message) {
  const SulInfo& info = message.info;
  Json json = {{"type", "info"}, {"actors", info.actors}, {"inputs", Json::array()}};
  for (const SulInput& input : info.inputs) {
    Json row = {{"name", input.name}, {"actor", info.actors[input.actor]}};
    if (!input.returns.empty()) row["returns"] = input.returns;
    json["inputs"].push_back(std::move(row));
  }
  json["outputs"] = Json::array();
  for (const SulOutput& output : info.outputs) {
    json["outputs"].push_back({{"name", output.name}, {"actor", info.actors[output.actor]}});
  }
  json["options"] = Json::object();
  for (const auto& [key, value] : info.options) json["options"][key] = value;
  if (!info.bound.empty()) json["bound"] = info.bound;
  if (message.open_outputs) json["open_outputs"] = true;
  return to_json_line(json);
}

std::string encode(const Ok&) { return R"({"type":"ok"})"; }

std::string encode(const Answer& message, const SulInfo& info, const SulQuery& query) {
  const SulAnswer& answer = message.answer;
  Json json = {{"type", "answer"}, {"id", message.id}};
  if (!std::holds_alternative<Word>(query.inputs)) json["inputs"] = word_json(answer.inputs, info);
  json["steps"] = Json::array();
  for (const SulStep& step : answer.steps) json["steps"].push_back(step_json(step, info));
  if (answer.end != WordEnd::complete) json["end"] = end_name(answer.end);
  json["reset_us"] = answer.reset_duration.count();
  json["reset_wait_us"] = answer.reset_wait.count();
  return to_json_line(json);
}

std::string encode(const ErrorReport& error) {
  Json json = {{"type", "error"}, {"code", code_name(error.code)}, {"message", error.message}};
  if (error.id) json["id"] = *error.id;
  return to_json_line(json);
}

std::string encode(const Leaving& leaving) {
  return to_json_line({{"type", "leaving"}, {"reason", leaving.reason}});
}

std::string encode(const Token& token) {
  return to_json_line({{"type", "token"}, {"token", token.token}});
}

std::string encode(const Configure& configure) {
  Json json = {{"type", "configure"}, {"options", Json::object()}};
  for (const auto& [key, value] : configure.options) json["options"][key] = value;
  return to_json_line(json);
}

std::string encode(const LearningPurpose& purpose) {
  const InterfaceAutomaton& automaton = purpose.automaton();
  Json transitions = Json::array();
  for (StateId state = 0; state < automaton.size(); ++state) {
    for (const auto& transition : automaton.transitions(state)) {
      transitions.push_back({state, automaton.name(transition.action), transition.target});
    }
  }
  return to_json_line({{"type", "purpose"},
                       {"at_bound", purpose.at_bound() == AtBound::absorb ? "absorb" : "refuse"},
                       {"inputs", automaton.inputs().names()},
                       {"outputs", automaton.outputs().names()},
                       {"states", automaton.size()},
                       {"initial", automaton.initial()},
                       {"transitions", std::move(transitions)}});
}

std::string encode(const Run& run, const SulInfo& info) {
  Json json = {{"type", "run"}, {"id", run.id}};
  if (run.query.translation == Translation::av) json["translation"] = "av";
  if (const Word* word = std::get_if<Word>(&run.query.inputs)) {
    json["word"] = word_json(*word, info);
    return to_json_line(json);
  }
  Json nodes = Json::array();
  for (const auto& node : std::get<BasicDecisionTree<std::string>>(run.query.inputs).nodes) {
    Json row = {{"input", input_name(node.input, info)}};
    if (!node.branches.empty()) {
      row["branches"] = Json::object();
      for (const auto& [output, next] : node.branches) row["branches"][output] = next;
    }
    nodes.push_back(std::move(row));
  }
  json["tree"] = std::move(nodes);
  return to_json_line(json);
}

std::string encode(const Cancel&) { return R"({"type":"cancel"})"; }
std::string encode(const Bye&) { return R"({"type":"bye"})"; }

}  // namespace maide::protocol
