// Messages as lines of JSON. Members that have their default value are left out, as a hand-written
// wrapper would do.
#include <nlohmann/json.hpp>

#include "maide/base/json.hpp"
#include "maide/wire/protocol/json_members.hpp"
#include "maide/wire/protocol/protocol.hpp"

namespace maide::protocol {

Json option_json(const OptionSpec& spec) {
  Json row = {
      {"key", spec.key}, {"kind", name_of(spec.kind, kind_names)}, {"default", spec.default_value}};
  if (!spec.allowed.empty()) row["allowed"] = spec.allowed;
  if (spec.most >= spec.least) {
    row["least"] = spec.least;
    row["most"] = spec.most;
  }
  row["help"] = spec.help;
  if (!spec.keeps_more.empty()) row["keeps_more"] = spec.keeps_more;
  return row;
}

namespace {

const std::string& input_name(Symbol input, const SulInfo& info) {
  static const std::string delta_name = delta;
  return input < info.inputs.size() ? info.inputs[input].name : delta_name;
}

Json word_json(const Word& word, const SulInfo& info) {
  Json names = Json::array();
  for (const Symbol input : word) names.push_back(input_name(input, info));
  return names;
}

void add_step(Json& json, const SulStep& step, const SulInfo& info) {
  if (step.status != StepStatus::taken) json["status"] = name_of(step.status, status_names);
  json["events"] = Json::array();
  for (const Event& event : step.events) {
    json["events"].push_back({info.actors[event.actor], event.output});
  }
  for (const std::uint32_t actor : step.busy) json["busy"].push_back(info.actors[actor]);
  json["us"] = step.duration.count();
  if (step.settling.count() != 0) json["settling_us"] = step.settling.count();
}

Json step_json(const SulStep& step, const SulInfo& info) {
  Json json = Json::object();
  add_step(json, step, info);
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
  if (hello.announces_steps) json["features"].push_back("announce");
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
  if (answer.end != WordEnd::complete) json["end"] = name_of(answer.end, end_names);
  if (!answer.reason.empty()) json["reason"] = answer.reason;
  json["reset_us"] = answer.reset_duration.count();
  json["reset_wait_us"] = answer.reset_wait.count();
  return to_json_line(json);
}

std::string encode(const Ready& ready) {
  return to_json_line({{"type", "ready"}, {"id", ready.id}});
}

std::string encode(const Step& message, const SulInfo& info) {
  Json json = {{"type", "step"}, {"id", message.id}};
  add_step(json, message.step, info);
  return to_json_line(json);
}

std::string encode(const ErrorReport& error) {
  Json json = {
      {"type", "error"}, {"code", name_of(error.code, code_names)}, {"message", error.message}};
  if (error.id) json["id"] = *error.id;
  return to_json_line(json);
}

std::string encode(const Leaving& leaving) {
  Json json = {{"type", "leaving"}, {"reason", leaving.reason}};
  if (leaving.id) json["id"] = *leaving.id;
  return to_json_line(json);
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
                       {"at_bound", name_of(purpose.at_bound(), at_bound_names)},
                       {"inputs", automaton.inputs().names()},
                       {"outputs", automaton.outputs().names()},
                       {"states", automaton.size()},
                       {"initial", automaton.initial()},
                       {"transitions", std::move(transitions)}});
}

std::string encode(const Run& run, const SulInfo& info) {
  Json json = {{"type", "run"}, {"id", run.id}};
  if (run.announce) json["announce"] = true;
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
