// Lines of a wrapper as messages. Nothing is believed: every member's type, every name and every
// number is checked before it is used.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "maide/base/text.hpp"
#include "maide/sul/fatal_words.hpp"
#include "maide/sul/query_player.hpp"
#include "maide/wire/protocol/json_members.hpp"
#include "maide/wire/protocol/protocol.hpp"

namespace maide::protocol {
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
  if (row.is_string() || find_member(row, "actor") == nullptr) return {name, 0};
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

ErrorReport decode_error(const Json& json) {
  ErrorReport error;
  error.code = find_name(text_member(json, "code", "protocol"), "error code", code_names);
  error.message = one_line(text_member(json, "message", ""));
  if (error.message.empty()) error.message = "an error without a message";
  if (find_member(json, "id") != nullptr) error.id = id_member(json);
  return error;
}

}  // namespace

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
