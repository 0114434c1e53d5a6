// Lines of JSON as messages. Nothing is believed: every member's type, every name and every number
// is checked before it is used.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/json.hpp"
#include "maide/wire/protocol.hpp"

namespace maide::protocol {
namespace {

// The start of a line that was not understood, for the error.
std::string excerpt(std::string_view line) {
  constexpr std::size_t longest = 60;
  std::string text(line.substr(0, longest));
  for (char& letter : text) {
    if (static_cast<unsigned char>(letter) < 0x20 || static_cast<unsigned char>(letter) >= 0x7f) {
      letter = '?';
    }
  }
  return text + (line.size() > longest ? "..." : "");
}

Json parse_object(std::string_view line) {
  Json json = Json::parse(line, nullptr, false);
  if (json.is_discarded()) throw ProtocolError("a line is not JSON: " + excerpt(line));
  if (!json.is_object()) throw ProtocolError("a line is not a JSON object: " + excerpt(line));
  return json;
}

const Json* find(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found == json.end() || found->is_null() ? nullptr : &*found;
}

const Json& member(const Json& json, const char* key) {
  const Json* found = find(json, key);
  if (found == nullptr) throw ProtocolError(fmt::format("'{}' is missing", key));
  return *found;
}

std::string to_text(const Json& json, const char* what) {
  if (!json.is_string()) throw ProtocolError(fmt::format("'{}' is not a string", what));
  return json.get<std::string>();
}

std::string text_member(const Json& json, const char* key) {
  return to_text(member(json, key), key);
}

std::string text_member(const Json& json, const char* key, const char* otherwise) {
  const Json* found = find(json, key);
  return found == nullptr ? otherwise : to_text(*found, key);
}

bool flag_member(const Json& json, const char* key) {
  const Json* found = find(json, key);
  if (found == nullptr) return false;
  if (!found->is_boolean()) throw ProtocolError(fmt::format("'{}' is not true or false", key));
  return found->get<bool>();
}

std::uint64_t to_number(const Json& json, const char* what, std::uint64_t most) {
  // A number that was written -1 is no unsigned one.
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() > most) {
    throw ProtocolError(fmt::format("'{}' is not a whole number from 0 to {}", what, most));
  }
  return json.get<std::uint64_t>();
}

std::int64_t signed_member(const Json& json, const char* key, std::int64_t otherwise) {
  const Json* found = find(json, key);
  if (found == nullptr) return otherwise;
  if (!found->is_number_integer()) throw ProtocolError(fmt::format("'{}' is not a number", key));
  return found->get<std::int64_t>();
}

// A duration in microseconds; 0 if it is not there.
std::chrono::microseconds duration_member(const Json& json, const char* key) {
  constexpr std::uint64_t most = std::uint64_t{1} << 50;
  const Json* found = find(json, key);
  if (found == nullptr) return {};
  return std::chrono::microseconds(to_number(*found, key, most));
}

std::uint64_t id_member(const Json& json) {
  return to_number(member(json, "id"), "id", ~std::uint64_t{0});
}

// An absent list is empty.
const Json& list_member(const Json& json, const char* key) {
  static const Json empty = Json::array();
  const Json* found = find(json, key);
  if (found == nullptr) return empty;
  if (!found->is_array()) throw ProtocolError(fmt::format("'{}' is not a list", key));
  return *found;
}

std::vector<std::string> texts_member(const Json& json, const char* key) {
  std::vector<std::string> texts;
  for (const Json& item : list_member(json, key)) texts.push_back(to_text(item, key));
  return texts;
}

std::map<std::string, std::string> map_member(const Json& json, const char* key) {
  std::map<std::string, std::string> map;
  const Json* found = find(json, key);
  if (found == nullptr) return map;
  if (!found->is_object()) throw ProtocolError(fmt::format("'{}' is not an object", key));
  for (const auto& [name, value] : found->items()) map[name] = to_text(value, key);
  return map;
}

template <typename Value, std::size_t size>
using Names = std::array<std::pair<const char*, Value>, size>;

template <typename Value, std::size_t size>
Value find_name(const std::string& name, const char* what, const Names<Value, size>& names) {
  for (const auto& [known, value] : names) {
    if (name == known) return value;
  }
  throw ProtocolError(fmt::format("unknown {} '{}'", what, excerpt(name)));
}

constexpr Names<OptionSpec::Kind, 4> kind_names = {{{"choice", OptionSpec::Kind::choice},
                                                    {"list", OptionSpec::Kind::list},
                                                    {"integer", OptionSpec::Kind::integer},
                                                    {"text", OptionSpec::Kind::text}}};
constexpr Names<ErrorCode, 4> code_names = {{{"option", ErrorCode::option},
                                             {"token", ErrorCode::token},
                                             {"protocol", ErrorCode::protocol},
                                             {"system", ErrorCode::system}}};
constexpr Names<StepStatus, 5> status_names = {{{"taken", StepStatus::taken},
                                                {"refused", StepStatus::refused},
                                                {"unexplored", StepStatus::unexplored},
                                                {"absorbed", StepStatus::absorbed},
                                                {"delta", StepStatus::delta}}};
constexpr Names<WordEnd, 4> end_names = {{{"complete", WordEnd::complete},
                                          {"crash", WordEnd::crash},
                                          {"hang", WordEnd::hang},
                                          {"aborted", WordEnd::aborted}}};
constexpr Names<Translation, 2> translation_names = {
    {{"eager", Translation::eager}, {"av", Translation::av}}};
constexpr Names<AtBound, 2> at_bound_names = {
    {{"refuse", AtBound::refuse}, {"absorb", AtBound::absorb}}};

// ---- From the wrapper ----

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
  }
  hello.needs_token = flag_member(json, "needs_token");
  for (const Json& row : list_member(json, "options")) {
    OptionSpec spec;
    spec.key = text_member(row, "key");
    spec.kind = find_name(text_member(row, "kind", "text"), "kind of option", kind_names);
    spec.default_value = text_member(row, "default", "");
    spec.allowed = texts_member(row, "allowed");
    spec.least = signed_member(row, "least", 0);
    spec.most = signed_member(row, "most", -1);
    spec.help = text_member(row, "help", "");
    hello.options.push_back(std::move(spec));
  }
  return hello;
}

std::uint32_t actor_of(const std::string& name, const SulInfo& info) {
  const auto found = std::find(info.actors.begin(), info.actors.end(), name);
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
  if (row.is_string() || find(row, "actor") == nullptr) return {name, 0};
  return {name, actor_of(text_member(row, "actor"), info)};
}

void check_output_name(const std::string& name) {
  const bool has_bad_letter = std::any_of(name.begin(), name.end(), [](char letter) {
    return letter == ',' || static_cast<unsigned char>(letter) < 0x20;
  });
  if (name.empty() || has_bad_letter) {
    throw ProtocolError(fmt::format("'{}' cannot be the name of an output", excerpt(name)));
  }
}

Info decode_info(const Json& json) {
  Info message;
  SulInfo& info = message.info;
  info.actors = texts_member(json, "actors");
  if (info.actors.empty()) info.actors = {"system"};
  for (const Json& row : list_member(json, "inputs")) {
    const auto [name, actor] = decode_named(row, info, "input");
    const bool is_known = std::any_of(info.inputs.begin(), info.inputs.end(),
                                      [&](const SulInput& input) { return input.name == name; });
    if (is_known) throw ProtocolError(fmt::format("input '{}' comes twice", excerpt(name)));
    info.inputs.push_back(
        {name, actor, row.is_string() ? std::vector<std::string>() : texts_member(row, "returns")});
  }
  if (info.inputs.empty()) throw ProtocolError("the system has no inputs");
  for (const Json& row : list_member(json, "outputs")) {
    const auto [name, actor] = decode_named(row, info, "output");
    check_output_name(name);
    info.outputs.push_back({name, actor});
  }
  info.options = map_member(json, "options");
  info.bound = text_member(json, "bound", "");
  message.open_outputs = flag_member(json, "open_outputs");
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
    if (is_reserved_output(event.output)) {
      throw ProtocolError(
          fmt::format("event '{}' has a name with a meaning of its own", event.output));
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
  std::stable_sort(step.events.begin(), step.events.end(),
                   [](const Event& left, const Event& right) { return left.actor < right.actor; });
  for (const std::string& actor : texts_member(json, "busy")) {
    step.busy.push_back(actor_of(actor, info));
  }
  std::sort(step.busy.begin(), step.busy.end());
  step.duration = duration_member(json, "us");
  step.settling = std::min(step.duration, duration_member(json, "settling_us"));
  return step;
}

Symbol input_symbol(const std::string& name, const SulInfo& info, Translation translation) {
  for (Symbol input = 0; input < info.inputs.size(); ++input) {
    if (info.inputs[input].name == name) return input;
  }
  if (translation == Translation::av && name == delta) {
    return static_cast<Symbol>(info.inputs.size());
  }
  throw ProtocolError(fmt::format("unknown input '{}'", excerpt(name)));
}

// The inputs that a tree's steps answer: must be the path that their outputs lead along.
Word path_of(const BasicDecisionTree<std::string>& tree, const std::vector<SulStep>& steps,
             Translation translation, bool is_complete) {
  Word path;
  std::size_t node = 0;
  for (const SulStep& step : steps) {
    if (node >= tree.nodes.size()) throw ProtocolError("an answer has more steps than its query");
    path.push_back(tree.nodes[node].input);
    const std::string output = mealy_output(step, translation);
    std::size_t next = tree.nodes.size();
    for (const auto& [branch, target] : tree.nodes[node].branches) {
      if (branch == output) next = target;
    }
    node = next;
  }
  if (is_complete && node < tree.nodes.size()) {
    throw ProtocolError("an answer has fewer steps than its query");
  }
  return path;
}

Answer decode_answer(const Json& json, const AnswerContext& context) {
  Answer message;
  message.id = id_member(json);
  const SulQuery* query = context.find_query(message.id);
  if (query == nullptr) {
    throw ProtocolError(fmt::format("an answer to query {}, which was not asked", message.id));
  }
  SulAnswer& answer = message.answer;
  for (const Json& step : list_member(json, "steps")) {
    answer.steps.push_back(decode_step(step, context.info(), context.open_outputs()));
  }
  answer.end = find_name(text_member(json, "end", "complete"), "end", end_names);
  answer.reset_duration = duration_member(json, "reset_us");
  answer.reset_wait = find(json, "reset_wait_us") != nullptr
                          ? duration_member(json, "reset_wait_us")
                          : answer.reset_duration;
  const bool is_complete = answer.end == WordEnd::complete;
  if (const Word* word = std::get_if<Word>(&query->inputs)) {
    if (answer.steps.size() > word->size() ||
        (is_complete && answer.steps.size() != word->size())) {
      throw ProtocolError(fmt::format("query {} has {} inputs, its answer {} steps", message.id,
                                      word->size(), answer.steps.size()));
    }
    answer.inputs.assign(word->begin(),
                         word->begin() + static_cast<std::ptrdiff_t>(answer.steps.size()));
  } else {
    const auto& tree = std::get<BasicDecisionTree<std::string>>(query->inputs);
    answer.inputs = path_of(tree, answer.steps, query->translation, is_complete);
  }
  return message;
}

ErrorReport decode_error(const Json& json) {
  ErrorReport error;
  error.code = find_name(text_member(json, "code", "protocol"), "error code", code_names);
  error.message = text_member(json, "message", "");
  std::replace(error.message.begin(), error.message.end(), '\n', ' ');
  if (error.message.empty()) error.message = "an error without a message";
  if (find(json, "id") != nullptr) error.id = id_member(json);
  return error;
}

// ---- To the wrapper ----

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
    const Json* branches = find(row, "branches");
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
  run.query.translation =
      find_name(text_member(json, "translation", "eager"), "translation", translation_names);
  if (find(json, "tree") != nullptr) {
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

}  // namespace

FromWrapper decode_from_wrapper(std::string_view line, const AnswerContext& context) {
  const Json json = parse_object(line);
  const std::string type = text_member(json, "type");
  if (type == "answer") return decode_answer(json, context);
  if (type == "hello") return decode_hello(json);
  if (type == "info") return decode_info(json);
  if (type == "ok") return Ok{};
  if (type == "error") return decode_error(json);
  if (type == "leaving") return Leaving{text_member(json, "reason", "")};
  throw ProtocolError(fmt::format("unknown type '{}' of line", excerpt(type)));
}

ToWrapper decode_to_wrapper(std::string_view line, const SulInfo& info) {
  const Json json = parse_object(line);
  const std::string type = text_member(json, "type");
  if (type == "run") return decode_run(json, info);
  if (type == "configure") return Configure{map_member(json, "options")};
  if (type == "purpose") return decode_purpose(json);
  if (type == "cancel") return Cancel{};
  if (type == "bye") return Bye{};
  if (type == "token") return Token{text_member(json, "token")};
  throw ProtocolError(fmt::format("unknown type '{}' of line", excerpt(type)));
}

}  // namespace maide::protocol
