// Messages as lines of JSON, and lines as messages. Members that have their default value are left
// out, as a hand-written wrapper would do.
#include "maide/wire/protocol/protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/json.hpp"
#include "maide/base/text.hpp"
#include "maide/sul/fatal_words.hpp"
#include "maide/sul/query_player.hpp"
#include "maide/wire/protocol/json_members.hpp"

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
  if (hello.dials_again) json["dials_again"] = true;
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
  for (const auto& [part, number] : message.versions) json["versions"][part] = number;
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

// Lines of a client as messages, checked as those of a wrapper are: neither side believes the
// other.

namespace {

Symbol input_symbol(const std::string& name, const SulInfo& info, Translation translation) {
  for (Symbol input = 0; input < info.inputs.size(); ++input) {
    if (info.inputs[input].name == name) return input;
  }
  if (translation == Translation::av && name == delta) {
    return static_cast<Symbol>(info.inputs.size());
  }
  throw ProtocolError(fmt::format("unknown input '{}'", excerpt(name)));
}

// No path comes back to a node: a query ends. Nodes are taken away once nothing leads to them
// (A. B. Kahn, "Topological sorting of large networks", CACM 1962); on a cycle some remain.
void check_ends(const BasicDecisionTree<std::string>& tree) {
  std::vector<std::size_t> leading(tree.nodes.size(), 0);
  for (const auto& node : tree.nodes) {
    for (const auto& branch : node.branches) ++leading[branch.second];
  }
  std::vector<std::size_t> free;
  for (std::size_t node = 0; node < leading.size(); ++node) {
    if (leading[node] == 0) free.push_back(node);
  }
  std::size_t taken = 0;
  for (; !free.empty(); ++taken) {
    const std::size_t node = free.back();
    free.pop_back();
    for (const auto& branch : tree.nodes[node].branches) {
      if (--leading[branch.second] == 0) free.push_back(branch.second);
    }
  }
  if (taken < tree.nodes.size()) throw ProtocolError("a decision tree goes in a circle");
}

BasicDecisionTree<std::string> decode_tree(const Json& json, const SulInfo& info,
                                           Translation translation) {
  BasicDecisionTree<std::string> tree;
  for (const Json& row : json) {
    auto& node = tree.nodes.emplace_back();
    node.input = input_symbol(text_member(row, "input"), info, translation);
    const Json* branches = find_member(row, "branches");
    if (branches == nullptr) continue;
    if (!branches->is_object()) throw ProtocolError("'branches' is not an object");
    for (const auto& [output, next] : branches->items()) {
      const std::uint64_t target = to_number(next, "branches", json.size() - 1);
      node.branches.emplace_back(output, static_cast<std::uint32_t>(target));
    }
  }
  check_ends(tree);
  return tree;
}

Run decode_run(const Json& json, const SulInfo& info) {
  Run run;
  run.id = id_member(json);
  run.announce = flag_member(json, "announce");
  run.query.translation =
      find_name(text_member(json, "translation", "eager"), "translation", translation_names);
  if (find_member(json, "tree") != nullptr) {
    run.query.inputs = decode_tree(list_member(json, "tree"), info, run.query.translation);
    return run;
  }
  member(json, "word");
  Word word;
  for (const std::string& name : texts_member(json, "word")) {
    word.push_back(input_symbol(name, info, run.query.translation));
  }
  run.query.inputs = std::move(word);
  return run;
}

Purpose decode_purpose(const Json& json) {
  constexpr std::uint64_t most_states = 1'000'000;
  const std::uint64_t states = to_number(member(json, "states"), "states", most_states);
  if (states == 0) throw ProtocolError("a purpose without states");
  try {
    InterfaceAutomaton automaton(Alphabet(texts_member(json, "inputs")),
                                 Alphabet(texts_member(json, "outputs")), states);
    const auto to_state = [&](const Json& number) {
      return static_cast<StateId>(to_number(number, "transitions", states - 1));
    };
    automaton.set_initial(to_state(member(json, "initial")));
    for (const Json& row : list_member(json, "transitions")) {
      if (!row.is_array() || row.size() != 3) {
        throw ProtocolError("a transition is not [from, action, to]");
      }
      const std::string name = to_text(row[1], "transitions");
      const bool is_input = name.starts_with('?');
      if (!is_input && !name.starts_with('!')) {
        throw ProtocolError("an action does not begin with ? or !");
      }
      const Alphabet& alphabet = is_input ? automaton.inputs() : automaton.outputs();
      automaton.add_transition(to_state(row[0]),
                               {is_input ? Action::Kind::input : Action::Kind::output,
                                alphabet.at(name.substr(1), "action")},
                               to_state(row[2]));
    }
    return {LearningPurpose(std::move(automaton), find_name(text_member(json, "at_bound", "refuse"),
                                                            "at_bound", at_bound_names))};
  } catch (const UsageError& error) {
    throw ProtocolError(error.what());
  }
}

ErrorReport decode_error(const Json& json) {
  ErrorReport error;
  error.code = find_name(text_member(json, "code", "protocol"), "error code", code_names);
  error.message = one_line(text_member(json, "message", ""));
  if (error.message.empty()) error.message = "an error without a message";
  if (find_member(json, "id") != nullptr) error.id = id_member(json);
  return error;
}

}  // namespace

ToWrapper decode_to_wrapper(std::string_view line, const SulInfo& info) {
  const Json json = parse_object(line);
  const std::string type = text_member(json, "type");
  if (type == "run") return decode_run(json, info);
  if (type == "configure") return Configure{map_member(json, "options")};
  if (type == "purpose") return decode_purpose(json);
  if (type == "cancel") return Cancel{};
  if (type == "bye") return Bye{};
  if (type == "token") return Token{text_member(json, "token")};
  if (type == "error") return decode_error(json);
  throw ProtocolError(fmt::format("unknown type '{}' of line", excerpt(type)));
}

// Lines of a wrapper as messages. Nothing is believed: every member's type, every name and every
// number is checked before it is used.

namespace {

Hello decode_hello(const Json& json) {
  const std::int64_t spoken = signed_member(json, "protocol", 0);
  if (spoken != version) {
    throw ProtocolError(fmt::format(
        "the wrapper speaks version {} of the protocol, Maide version {}", spoken, version));
  }
  Hello hello;
  hello.name = text_member(json, "name");
  hello.versions = map_member(json, "versions");
  for (const std::string& feature : texts_member(json, "features")) {
    hello.speaks_trees = hello.speaks_trees || feature == "trees";
    hello.speaks_purposes = hello.speaks_purposes || feature == "purposes";
    hello.speaks_av = hello.speaks_av || feature == "av";
    hello.announces_steps = hello.announces_steps || feature == "announce";
  }
  hello.needs_token = flag_member(json, "needs_token");
  hello.dials_again = flag_member(json, "dials_again");
  for (const Json& row : list_member(json, "options")) {
    OptionSpec spec;
    spec.key = text_member(row, "key");
    spec.kind = find_name(text_member(row, "kind", "text"), "kind of option", kind_names);
    spec.default_value = text_member(row, "default", "");
    spec.allowed = texts_member(row, "allowed");
    spec.least = signed_member(row, "least", 0);
    spec.most = signed_member(row, "most", -1);
    spec.help = text_member(row, "help", "");
    spec.keeps_more = text_member(row, "keeps_more", "");
    hello.options.push_back(std::move(spec));
  }
  return hello;
}

std::uint32_t actor_of(const std::string& name, const SulInfo& info) {
  const auto found = std::ranges::find(info.actors, name);
  if (found == info.actors.end()) {
    throw ProtocolError(fmt::format("unknown actor '{}'", excerpt(name)));
  }
  return static_cast<std::uint32_t>(found - info.actors.begin());
}

// Of "name" or {"name": ..., "actor": ...}; the first actor is the default.
std::pair<std::string, std::uint32_t> decode_named(const Json& row, const SulInfo& info,
                                                   const char* what) {
  const std::string name = row.is_string() ? row.get<std::string>() : text_member(row, "name");
  if (name.empty()) throw ProtocolError(fmt::format("an {} without a name", what));
  if (row.is_string() || find_member(row, "actor") == nullptr) return {name, 0};
  return {name, actor_of(text_member(row, "actor"), info)};
}

void check_output_name(const std::string& name) {
  const bool has_bad_letter = std::ranges::any_of(
      name, [](char letter) { return letter == ',' || static_cast<unsigned char>(letter) < 0x20; });
  if (name.empty() || has_bad_letter) {
    throw ProtocolError(fmt::format("'{}' cannot be the name of an output", excerpt(name)));
  }
}

[[noreturn]] void refuse_reserved(const std::string& name, const char* what) {
  throw ProtocolError(fmt::format("{} '{}' has a name with a meaning of its own", what, name));
}

Info decode_info(const Json& json) {
  Info message;
  SulInfo& info = message.info;
  info.actors = texts_member(json, "actors");
  info.names_actors = !info.actors.empty();
  if (info.actors.empty()) info.actors = {"system"};
  for (const Json& row : list_member(json, "inputs")) {
    const auto [name, actor] = decode_named(row, info, "input");
    if (std::ranges::find(info.inputs, name, &SulInput::name) != info.inputs.end())
      throw ProtocolError(fmt::format("input '{}' comes twice", excerpt(name)));
    if (name == delta) refuse_reserved(name, "input");
    info.inputs.push_back(
        {name, actor, row.is_string() ? std::vector<std::string>() : texts_member(row, "returns")});
  }
  if (info.inputs.empty()) throw ProtocolError("the system has no inputs");
  for (const Json& row : list_member(json, "outputs")) {
    const auto [name, actor] = decode_named(row, info, "output");
    check_output_name(name);
    if (is_reserved_output(name) || is_end_output(name)) refuse_reserved(name, "output");
    info.outputs.push_back({name, actor});
  }
  info.options = map_member(json, "options");
  info.bound = text_member(json, "bound", "");
  message.open_outputs = flag_member(json, "open_outputs");
  message.versions = map_member(json, "versions");
  return message;
}

// Of "output", or ["actor", "output"].
Event decode_event(const Json& json, const SulInfo& info, bool open_outputs) {
  Event event;
  const SulOutput* known = nullptr;
  if (json.is_string()) {
    event.output = json.get<std::string>();
  } else if (json.is_array() && json.size() == 2) {
    event.actor = actor_of(to_text(json[0], "events"), info);
    event.output = to_text(json[1], "events");
  } else {
    throw ProtocolError("an event is neither \"output\" nor [\"actor\", \"output\"]");
  }
  for (const SulOutput& output : info.outputs) {
    if (output.name == event.output) known = &output;
  }
  if (known == nullptr) {
    if (!open_outputs) {
      throw ProtocolError(fmt::format("unknown event '{}'", excerpt(event.output)));
    }
    check_output_name(event.output);
    if (is_reserved_output(event.output) || is_end_output(event.output)) {
      refuse_reserved(event.output, "event");
    }
    return event;
  }
  if (json.is_string()) event.actor = known->actor;
  if (event.actor != known->actor) {
    throw ProtocolError(fmt::format("event '{}' of actor '{}', but it belongs to '{}'",
                                    event.output, info.actors[event.actor],
                                    info.actors[known->actor]));
  }
  return event;
}

SulStep decode_step(const Json& json, const SulInfo& info, bool open_outputs) {
  SulStep step;
  step.status = find_name(text_member(json, "status", "taken"), "status", status_names);
  const Json& events = list_member(json, "events");
  if (events.size() > max_events) {
    throw ProtocolError(
        fmt::format("a step has {} events, more than {}", events.size(), max_events));
  }
  for (const Json& event : events) {
    step.events.push_back(decode_event(event, info, open_outputs));
  }
  const bool has_events = !step.events.empty();
  if (has_events && step.status != StepStatus::taken && step.status != StepStatus::delta) {
    throw ProtocolError("a step that the system did not take has events");
  }
  // The canonical order is no wrapper's business to get right.
  std::ranges::stable_sort(step.events, {}, &Event::actor);
  for (const std::string& actor : texts_member(json, "busy")) {
    step.busy.push_back(actor_of(actor, info));
  }
  std::ranges::sort(step.busy);
  step.duration = duration_member(json, "us");
  step.settling = std::min(step.duration, duration_member(json, "settling_us"));
  return step;
}

const SulQuery& query_of(std::uint64_t id, const AnswerContext& context, const char* what) {
  const SulQuery* query = context.find_query(id);
  if (query == nullptr) {
    throw ProtocolError(fmt::format("{} query {}, which was not asked", what, id));
  }
  return *query;
}

// The inputs that these steps answer: of a tree, the path that their outputs lead along.
Word path_of(const SulQuery& query, std::uint64_t id, const SulAnswer& answer) {
  Word path;
  QueryCursor cursor(query);
  for (const SulStep& step : answer.steps) {
    const std::optional<Symbol> input = cursor.input();
    if (!input) {
      throw ProtocolError(fmt::format("the answer to query {} has {} steps, more than the query",
                                      id, answer.steps.size()));
    }
    path.push_back(*input);
    cursor.advance(step);
  }
  if (answer.end == WordEnd::complete && cursor.input()) {
    throw ProtocolError(fmt::format("the answer to query {} has {} steps, fewer than the query", id,
                                    answer.steps.size()));
  }
  return path;
}

Answer decode_answer(const Json& json, const AnswerContext& context) {
  Answer message;
  message.id = id_member(json);
  const SulQuery& query = query_of(message.id, context, "an answer to");
  SulAnswer& answer = message.answer;
  answer.end = find_name(text_member(json, "end", "complete"), "end", end_names);
  answer.reason = one_line(text_member(json, "reason", ""));
  const Json& steps = list_member(json, "steps");
  for (const Json& step : steps) {
    // What a dying system says is of no interest, not even whether it makes sense.
    const bool is_last = is_fatal(answer.end) && &step == &steps.back();
    answer.steps.push_back(is_last ? SulStep()
                                   : decode_step(step, context.info(), context.open_outputs()));
  }
  answer.reset_duration = duration_member(json, "reset_us");
  answer.reset_wait = find_member(json, "reset_wait_us") != nullptr
                          ? duration_member(json, "reset_wait_us")
                          : answer.reset_duration;
  answer.inputs = path_of(query, message.id, answer);
  if (!is_fatal(answer.end)) return message;
  if (answer.steps.empty()) throw ProtocolError("a word ends before its first step");
  mark_fatal_step(answer, context.info());
  return message;
}

Step decode_announcement(const Json& json, const AnswerContext& context) {
  Step message;
  message.id = id_member(json);
  query_of(message.id, context, "a step of");
  message.step = decode_step(json, context.info(), context.open_outputs());
  return message;
}

Ready decode_ready(const Json& json, const AnswerContext& context) {
  const Ready message{id_member(json)};
  query_of(message.id, context, "a reset for");
  return message;
}

Leaving decode_leaving(const Json& json) {
  Leaving message{one_line(text_member(json, "reason", "")), {}};
  if (find_member(json, "id") != nullptr) message.id = id_member(json);
  return message;
}

class NoQueries : public AnswerContext {
 public:
  const SulInfo& info() const override { return info_; }
  bool open_outputs() const override { return false; }
  const SulQuery* find_query(std::uint64_t) const override { return nullptr; }

 private:
  SulInfo info_;
};

}  // namespace

FromWrapper decode_from_wrapper(std::string_view line) {
  return decode_from_wrapper(line, NoQueries());
}

FromWrapper decode_from_wrapper(std::string_view line, const AnswerContext& context) {
  const Json json = parse_object(line);
  const std::string type = text_member(json, "type");
  if (type == "answer") return decode_answer(json, context);
  if (type == "step") return decode_announcement(json, context);
  if (type == "ready") return decode_ready(json, context);
  if (type == "hello") return decode_hello(json);
  if (type == "info") return decode_info(json);
  if (type == "ok") return Ok{};
  if (type == "error") return decode_error(json);
  if (type == "leaving") return decode_leaving(json);
  throw ProtocolError(fmt::format("unknown type '{}' of line", excerpt(type)));
}

}  // namespace maide::protocol
