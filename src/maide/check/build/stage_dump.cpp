#include "maide/check/build/stage_dump.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/free_beside.hpp"
#include "maide/base/hash.hpp"
#include "maide/base/json.hpp"
#include "maide/base/text.hpp"
#include "maide/base/text_cursor.hpp"
#include "maide/base/version.hpp"
#include "maide/check/build/build_system.hpp"
#include "maide/check/build/constant_settings.hpp"
#include "maide/check/build/declarations.hpp"
#include "maide/check/build/models.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/system/system_json.hpp"
#include "maide/check/tree/print.hpp"

namespace maide {
namespace {

constexpr std::array<std::string_view, 4> stage_names{"tree", "names", "models", "system"};
constexpr const char* stage_key = "maide_stage";

// ---- Names --------------------------------------------------------------------------------------

std::string place_of(const SourcePosition& position) {
  return fmt::format("{}:{}", position.line, position.column);
}

std::vector<std::string> names_of(const std::vector<End>& ends, const Declarations& file) {
  std::vector<std::string> names;
  for (const End& end : ends) {
    names.push_back(end.node.empty() ? file.programs[end.program].name : end.node);
  }
  return names;
}

// "size=6", in order.
std::vector<std::string> options_of(
    const std::vector<std::pair<std::string, std::string>>& options) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : options) texts.push_back(name + "=" + value);
  return texts;
}

Json json_of(const ModelRequest& request) {
  Json known{{"model", request.instance}};
  if (request.learn.empty()) known["file"] = request.file.string();
  if (!request.learn.empty()) known["learn"] = request.learn;
  if (!request.with.empty()) known["with"] = options_of(request.with);
  if (!request.learning.empty()) known["learning"] = options_of(request.learning);
  if (!request.values.empty()) known["values"] = request.values;
  return known;
}

// Where the model's automaton comes from: a built-in one is its name and options.
Json origin_of(const Declarations& file, std::size_t number) {
  const ModelOrigin& origin = file.origins[number];
  switch (origin.kind) {
    case ModelOrigin::Kind::asked: return json_of(origin.request);
    case ModelOrigin::Kind::copied: return {{"copy_of", file.models[origin.first].name}};
    case ModelOrigin::Kind::built_in:
      if (origin.built_in->option.empty()) return {{"use", origin.built_in->name}};
      return {{"use", origin.built_in->name}, {origin.built_in->option, origin.count}};
    case ModelOrigin::Kind::recursive_mutex: return {{"use", "mutex"}, {"recursive", true}};
    case ModelOrigin::Kind::condition:
      return {{"use", "condition"}, {"mutex", origin.of_condition->text()}};
    case ModelOrigin::Kind::queue:
      if (origin.size.is_unknown) return {{"use", "queue"}, {"depth", "unknown"}};
      return {{"use", "queue"}, {origin.size.drops_oldest ? "depth" : "size", origin.size.size}};
    case ModelOrigin::Kind::made: break;
  }
  const auto shape = file.shapes.find(static_cast<std::uint32_t>(number));
  if (shape == file.shapes.end()) return {{"use", "executor"}};
  Json depth = shape->second.depth;
  if (shape->second.is_depth_unknown) depth = "unknown";
  return {{"use", "service"}, {"depth", depth}, {"clients", shape->second.names}};
}

Json programs_of(const Declarations& file) {
  Json programs = Json::array();
  for (const ProgramDeclaration& program : file.programs) {
    Json added{{"name", program.name}, {"place", place_of(program.position)}};
    if (program.may_die) added["may_die"] = true;
    if (program.thread) {
      added["runs"] = program.execution;
      for (const program_syntax::Callback& callback : program.thread->callbacks) {
        added["callbacks"].push_back(callback.whole_name());
      }
    }
    programs.push_back(std::move(added));
  }
  return programs;
}

Json models_of(const Declarations& file) {
  Json models = Json::array();
  for (std::size_t number = 0; number < file.models.size(); ++number) {
    const ModelInstance& model = file.models[number];
    models.push_back({{"name", model.name},
                      {"place", place_of(model.position)},
                      {"from", origin_of(file, number)}});
  }
  return models;
}

Json topics_of(const Declarations& file) {
  Json topics = Json::array();
  for (const Topic& topic : file.names.topics) {
    Json added{
        {"name", topic.name}, {"place", place_of(topic.position)}, {"writers", topic.writer_names}};
    for (const Topic::Reader& reader : topic.readers) {
      added["readers"].push_back(reader.callback.empty() ? file.programs[reader.program].name
                                                         : reader.callback);
    }
    topics.push_back(std::move(added));
  }
  return topics;
}

Json services_of(const Declarations& file) {
  Json services = Json::array();
  for (const auto& [model, service] : file.names.services) {
    services.push_back({{"name", service.name},
                        {"server", names_of({service.server}, file)[0]},
                        {"clients", names_of(service.clients, file)}});
  }
  return services;
}

Json variables_of(const Declarations& file) {
  Json variables = Json::array();
  for (const auto& [name, variable] : file.names.variables) {
    variables.push_back({{"name", name},
                         {"members", member_count(variable.leaf.dimensions)},
                         {"place", place_of(variable.position)},
                         {"type", to_string(variable.type, file.words)},
                         {"initial", to_string(variable.initial, variable.type.kind, file.words)}});
  }
  return variables;
}

Json names_of(const Declarations& file) {
  Json constants = Json::object(), procedures = Json::object();
  for (const auto& [name, value] : file.names.constants) {
    constants[name] = to_string(value, file.words);
  }
  for (const auto& [name, procedure] : file.names.procedures) {
    procedures[name] = {{"place", place_of(procedure.position)},
                        {"parameters", procedure.parameters}};
  }
  return {{"constants", constants},        {"programs", programs_of(file)},
          {"models", models_of(file)},     {"topics", topics_of(file)},
          {"services", services_of(file)}, {"variables", variables_of(file)},
          {"procedures", procedures}};
}

Json json_of(const std::vector<ConstantSetting>& settings) {
  Json values = Json::object();
  for (const auto& [name, value] : settings) values[name] = value;
  return values;
}

// ---- Writing ------------------------------------------------------------------------------------

constexpr const char* writing = "writing the dump";

// Members and elements a line each, those of the third level and deeper in one.
template <typename Value>
void write(std::ostream& out, const Value& value, std::size_t level) {
  if (level > 3 || !value.is_structured() || value.empty()) {
    out << value;
    return;
  }
  out << (value.is_object() ? '{' : '[');
  for (auto member = value.begin(); member != value.end(); ++member) {
    out << (member == value.begin() ? "\n" : ",\n") << std::string(level, ' ');
    if (value.is_object()) out << Value(member.key()) << ": ";
    write(out, *member, level + 1);
  }
  out << '\n' << std::string(level - 1, ' ') << (value.is_object() ? '}' : ']');
}

// What `make` writes, in pieces, between which the control is heard.
void in_pieces(const RunControl& control, const std::function<void(std::string_view)>& take,
               const std::function<void(std::ostream&)>& make) {
  ChunkedStream pieces([&](std::string_view piece) {
    control.check(writing);
    take(piece);
  });
  make(pieces.stream());
  pieces.finish();
}

// Of all that the dump says but the sum itself, in the order of the members' names.
std::string sum_of(const nlohmann::json& content, const RunControl& control) {
  std::uint64_t sum = hash_start;
  in_pieces(
      control,
      [&](std::string_view piece) {
        for (const char byte : piece) sum = hash_step(sum, static_cast<unsigned char>(byte));
      },
      [&](std::ostream& out) { out << content; });
  return fmt::format("{:016x}", sum);
}

// `names` are those of the content in the order in which a person reads them.
std::string dump_text(const nlohmann::json& content, const Json& names, const RunControl& control) {
  std::string text;
  in_pieces(
      control, [&](std::string_view piece) { text += piece; },
      [&](std::ostream& out) {
        const char* before = "{\n";
        for (const char* const key :
             {stage_key, "version", "file", "set", "names", "answers", "system", "text", "sum"}) {
          const auto member = content.find(key);
          if (member == content.end()) continue;
          out << before << ' ' << Json(key) << ": ";
          if (std::string_view(key) == "names") {
            write(out, names, 2);
          } else {
            write(out, *member, 2);
          }
          before = ",\n";
        }
        out << "\n}\n";
      });
  return text;
}

// ---- Reading ------------------------------------------------------------------------------------

constexpr std::size_t large_dump = 16'000'000;  // bytes: to free what it says takes seconds

// What a dump says. Of a large one it is freed beside what comes next.
struct Content {
  Content() = default;
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() {
    if (is_large) free_beside(std::move(value));
  }
  nlohmann::json value;
  bool is_large = false;
};

// A dump of names, models or a system, and what it says.
class StageDump {
 public:
  StageDump(std::string_view text, const std::string& file, const RunControl& control)
      : file_(file), control_(control) {
    dump_.is_large = text.size() > large_dump;
    try {
      dump_.value = parse_sorted_json(text, file, control);
      stage_ = find_stage(dump_.value.at(stage_key).get<std::string>());
      const std::string sum = dump_.value.at("sum").get<std::string>();
      const std::string version_of = dump_.value.at("version").get<std::string>();
      if (version_of != version()) {
        fail(fmt::format("the dump is of maide {}, and this is {}: make it anew", version_of,
                         version()));
      }
      dump_.value.erase("sum");
      if (!stage_ || sum != sum_of(dump_.value, control))
        fail("the dump was changed: make it anew");
    } catch (const nlohmann::json::exception&) {
      fail("no dump of a stage that is whole: make it anew");
    }
  }

  Stage stage() const { return *stage_; }
  std::string text() const {
    return fmt::format("{}",
                       fmt::join(dump_.value.at("text").get<std::vector<std::string>>(), "\n"));
  }
  std::string file() const { return dump_.value.at("file").get<std::string>(); }

  // Of the constants.
  std::vector<ConstantSetting> settings() const {
    std::vector<ConstantSetting> settings;
    if (!dump_.value.contains("set")) return settings;
    for (const auto& [name, value] : dump_.value.at("set").items()) {
      settings.push_back({name, value.get<std::string>()});
    }
    return settings;
  }
  void check_settings(const std::vector<ConstantSetting>& wanted) const {
    if (wanted.empty() || nlohmann::json(json_of(wanted)) == nlohmann::json(json_of(settings()))) {
      return;
    }
    throw UsageError(fmt::format(
        "a dump has the values of its constants, and {} cannot be set: make it anew ({})",
        to_string(wanted), file_));
  }

  System system() const { return system_of(dump_.value.at("system"), control_); }
  // Asks for each request with the answer that the dump has.
  ModelSource source(const ModelSource& others) const {
    return [this, others](const ModelRequest& request) {
      for (const nlohmann::json& answer : dump_.value.at("answers")) {
        if (answer.at("request") != nlohmann::json(json_of(request))) continue;
        ModelRequest known = request;
        known.known = std::make_shared<const InterfaceAutomaton>(
            automaton_of(answer.at("automaton"), control_));
        return others(known);
      }
      throw ParseError(
          fmt::format("the dump {} has no model '{}' as it is asked for", file_, request.instance),
          request.position);
    };
  }
  void check_names(const Declarations& declared) const {
    if (dump_.value.at("names") != nlohmann::json(names_of(declared))) {
      fail("the names of the dump are not those of its file: make it anew");
    }
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw ParseError(message, {file_, 0, 0});
  }

  std::string file_;
  const RunControl& control_;
  Content dump_;
  std::optional<Stage> stage_;
};

// A file, or what an earlier stage made of it.
struct Source {
  std::string text, file;
  std::vector<ConstantSetting> settings;
  std::optional<StageDump> dump;

  Source(std::string_view given, const std::string& name, const RunControl& control,
         const std::vector<ConstantSetting>& wanted)
      : file(name), settings(wanted) {
    if (is_stage_dump(given)) {
      dump.emplace(given, name, control);
      dump->check_settings(wanted);
      text = dump->text();
      file = dump->file();
      settings = dump->settings();
    } else {
      text = with_settings(std::string(given), name, wanted);
    }
  }

  Declarations declare() const {
    Declarations declared = maide::declare(read_tree(text, file));
    if (dump) dump->check_names(declared);
    return declared;
  }
  ModelSource models(const ModelSource& others) const {
    return dump && dump->stage() == Stage::models ? dump->source(others) : others;
  }
};

}  // namespace

std::optional<Stage> find_stage(std::string_view name) {
  for (std::size_t stage = 0; stage < stage_names.size(); ++stage) {
    if (stage_names[stage] == name) return static_cast<Stage>(stage);
  }
  return std::nullopt;
}

std::string dump_stage(Stage stage, std::string_view text, const std::string& file,
                       const ModelSource& source, const RunControl& control,
                       const std::vector<ConstantSetting>& settings) {
  const Source from(text, file, control, settings);
  if (from.dump && from.dump->stage() == stage) return std::string(text);
  if (stage == Stage::tree) return format_system(from.text, from.file);
  const Declarations declared = from.declare();
  const Json names = names_of(declared);
  Content dump;
  dump.is_large = true;  // until its size is known
  nlohmann::json& content = dump.value;
  content = {{stage_key, stage_names[static_cast<std::size_t>(stage)]},
             {"version", version()},
             {"file", from.file},
             {"names", names},
             {"text", split(from.text, '\n')}};
  if (!from.settings.empty()) content["set"] = json_of(from.settings);
  if (stage != Stage::names) {
    const ModelSource asked = from.models(source);
    nlohmann::json answers = nlohmann::json::array();
    const ModelSource noted = [&](const ModelRequest& request) {
      InterfaceAutomaton automaton = asked(request);
      if (stage == Stage::models) {
        answers.push_back(
            {{"request", json_of(request)}, {"automaton", json_of(automaton, control)}});
      }
      return automaton;
    };
    Models models = find_models(declared, noted, {}, control);
    if (stage == Stage::models) content["answers"] = std::move(answers);
    if (stage == Stage::system) {
      System system = build_system(declared, std::move(models), {}, control);
      system.settings = from.settings;
      content["system"] = json_of(system, control);
    }
  }
  try {
    content["sum"] = sum_of(content, control);
    std::string written = dump_text(content, names, control);
    dump.is_large = written.size() > large_dump;
    return written;
  } catch (const nlohmann::json::type_error&) {
    throw UsageError(
        fmt::format("a dump is JSON, and not all names and texts here are UTF-8 ({})", file));
  }
}

bool is_stage_dump(std::string_view text) {
  text = without_byte_order_mark(text);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (!text.starts_with('{')) return false;
  const std::string key = std::string(stage_key) + '"';
  std::size_t depth = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (depth == 0) return false;
    if (c != '"') continue;
    if (depth == 1 && text.substr(at + 1).starts_with(key)) return true;
    while (++at < text.size() && text[at] != '"') at += text[at] == '\\' ? 1 : 0;
  }
  return false;
}

System parse_stage_dump(std::string_view text, const std::string& file, const ModelSource& source,
                        const RunControl& control, const std::vector<ConstantSetting>& settings) {
  const Source from(text, file, control, settings);
  if (from.dump->stage() == Stage::system) return from.dump->system();
  const Declarations declared = from.declare();
  System system =
      build_system(declared, find_models(declared, from.models(source), {}, control), {}, control);
  system.settings = from.settings;
  return system;
}

}  // namespace maide
