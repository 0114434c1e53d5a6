#include "maide/check/tree/schema.hpp"

#include <algorithm>

#include "maide/base/text.hpp"

namespace maide {
namespace {

using enum FieldKind;

constexpr Key keys[] = {
    {"", map, "a system file", "", "", "a system to check"},
    {"constants", entries, "'constants'", "", "", "names for numbers and words"},
    {"constants/*", number, "constant", "", "", "its value: an expression over those before it"},

    {"models", entries, "'models'", "", "", "connections, mutexes, semaphores, queues",
     NameKind::declared},
    {"models/*", map, "model", "", "", "one of `file`, `learn` and `use`, and what belongs to it"},
    {"models/*/file", text, "", "", "", "a model file, beside the system file"},
    {"models/*/learn", text, "", "", "", "a system to be learned, as in `maide learn`"},
    {"models/*/use", word, "", "mutex|semaphore|queue", "", "a built-in model"},
    {"models/*/with", options, "", "", "",
     "options of the system; of a semaphore `count`, of a queue `size` or `depth`"},
    {"models/*/learning", options, "", "", "", "how it is learned: options of `maide learn`"},
    {"models/*/when_unexplored", word, "", "stop|wait|drop", "stop",
     "what an input does that was never tried"},
    {"models/*/when_weak", word, "", "inconclusive|accept", "inconclusive",
     "what becomes of a \"holds\" that rests on a weak model"},
    {"models/*/ends", entries, "'ends'", "", "", "who stands at which end: an actor, and names"},
    {"models/*/ends/*", names, "", "", "", "in order: the second writer's `write` is `write2`"},

    {"topics", entries, "'topics'", "", "", "connections with several readers or writers",
     NameKind::declared},
    {"topics/*", map, "topic", "", "", "its ends, and one of `file`, `learn` and `use`"},
    {"topics/*/writers", names, "", "", "", "programs and nodes that write"},
    {"topics/*/readers", names, "", "", "", "programs, nodes and callbacks that read"},
    {"topics/*/file", text, "", "", "", "a model file, beside the system file"},
    {"topics/*/learn", text, "", "", "", "a system to be learned, as in `maide learn`"},
    {"topics/*/use", word, "", "mutex|semaphore|queue", "", "a built-in model"},
    {"topics/*/with", options, "", "", "", "options of the system or of the queue"},
    {"topics/*/readers_with", entries, "'readers_with'", "", "", "options of one reader alone",
     NameKind::reference},
    {"topics/*/readers_with/*", options, "a reader's options", "", "",
     "in place of those of `with`"},
    {"topics/*/learning", options, "", "", "", "how it is learned: options of `maide learn`"},
    {"topics/*/when_unexplored", word, "", "stop|wait|drop", "stop",
     "what an input does that was never tried"},
    {"topics/*/when_weak", word, "", "inconclusive|accept", "inconclusive",
     "what becomes of a \"holds\" that rests on a weak model"},
    {"topics/*/deliver", word, "", "one|all", "all",
     "whether one reader gets a message, or all do"},

    {"services", entries, "'services'", "", "", "requests and answers, as ROS 2 has them",
     NameKind::declared},
    {"services/*", map, "service", "", "", "its ends"},
    {"services/*/server", names, "", "", "", "the program or node that answers"},
    {"services/*/clients", names, "", "", "", "programs and nodes that ask"},
    {"services/*/learn", word, "'learn' of a service", "ros2", "", "what the rules are those of"},
    {"services/*/with", map, "'with' of a service, which is made by its rules,", "", "",
     "options of the rules"},
    {"services/*/with/depth", number, "", "unknown", "10", "requests and answers that are kept"},
    {"services/*/with/kind", word, "", "service", "", "may be said"},
    {"services/*/with/rmw", word, "", "cyclonedds|fastrtps", "", "the middleware below"},

    {"procedures", entries, "'procedures'", "", "", "statements that programs call",
     NameKind::head},
    {"procedures/*", procedure, "procedure", "", "", "its statements"},
    {"variables", variables, "", "", "", "shared variables: `var n: 0..3; var ok: bool;`"},

    {"programs", entries, "'programs'", "", "", "control programs", NameKind::declared},
    {"programs/*", program, "program", "", "", "its statements"},
    {"programs/*", map, "program", "", "", "its statements, and what else is said of it"},
    {"programs/*/do", program, "", "", "", "its statements"},
    {"programs/*/may_die", word, "", "true|false", "false", "whether it may end at any time"},

    {"executors", entries, "'executors'", "", "", "what runs callbacks"},
    {"executors/*", map, "executor", "", "", "how many threads run callbacks, and in which order"},
    {"executors/*/kind", word, "", "single|multi", "", "one thread or several"},
    {"executors/*/threads", number, "", "", "", "of `multi`: how many"},
    {"executors/*/order", word, "", "any|rounds", "any",
     "of `single`: any order, or that of rclcpp (Humble)"},

    {"nodes", entries, "'nodes'", "", "", "programs that consist of callbacks", NameKind::declared},
    {"nodes/*", map, "node", "", "", "its callbacks and who runs them"},
    {"nodes/*/executor", text, "", "", "one of its own, with one thread", "who runs the callbacks"},
    {"nodes/*/groups", entries, "'groups'", "", "", "callback groups"},
    {"nodes/*/groups/*", word, "a group", "exclusive|reentrant", "",
     "whether its callbacks run one at a time"},
    {"nodes/*/clients", entries, "'clients'", "", "", "what its clients do with answers",
     NameKind::reference},
    {"nodes/*/clients/*", name, "a client", "", "the node's own", "the group of the client"},
    {"nodes/*/clients/*", map, "a client", "", "", "its group and code of its own"},
    {"nodes/*/clients/*/group", text, "", "", "the node's own", "the group of the client"},
    {"nodes/*/clients/*/do", callback, "", "", "", "what is done with an answer"},
    {"nodes/*/variables", variables, "", "", "", "variables of the node"},
    {"nodes/*/callbacks", entries, "'callbacks'", "", "", "what the node does"},
    {"nodes/*/callbacks/*", map, "callback", "", "",
     "one of `takes`, `timer` and `serves`, and what is done"},
    {"nodes/*/callbacks/*/takes", taken, "", "", "", "the topic's input that it waits for"},
    {"nodes/*/callbacks/*/timer", number, "", "", "", "a period in milliseconds"},
    {"nodes/*/callbacks/*/serves", name, "", "", "", "the service whose requests it answers"},
    {"nodes/*/callbacks/*/group", text, "", "", "the node's own", "its callback group"},
    {"nodes/*/callbacks/*/do", callback, "", "unknown", "", "its statements"},
    {"nodes/*/callbacks/*/do", entries, "'do'", "", "", "an output, and what is done when it came",
     NameKind::output},
    {"nodes/*/callbacks/*/do/*", callback, "what is done", "", "", "its statements"},

    {"properties", entries, "'properties'", "", "", "what must hold"},
    {"properties/*", formula, "property", "", "", "a formula of linear-time temporal logic"},
    {"properties/*", map, "property", "", "", "one of `ltl`, `always` and `never`"},
    {"properties/*/ltl", formula, "", "", "", "a formula of linear-time temporal logic"},
    {"properties/*/always", formula, "", "", "", "an expression that holds in each state"},
    {"properties/*/never", text, "", "", "", "a file with an automaton of bad runs (HOA)"},
    {"properties/*/fairness", word, "", "none|weak|strong", "weak", "which runs count"},
};

}  // namespace

std::span<const Key> system_keys() { return keys; }

std::vector<const Key*> keys_at(std::string_view path) {
  std::vector<const Key*> found;
  for (const Key& key : keys) {
    if (key.path == path) found.push_back(&key);
  }
  return found;
}

std::vector<std::string> keys_below(std::string_view path) {
  const std::string head = path.empty() ? "" : std::string(path) + "/";
  std::vector<std::string> names;
  for (const Key& key : keys) {
    if (key.path.empty() || !key.path.starts_with(head)) continue;
    const std::string name(key.path.substr(head.size()));
    if (name.find('/') != std::string::npos) continue;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

std::vector<std::string> values_of(const Key& key) {
  std::vector<std::string> values;
  if (key.values.empty()) return values;
  for (const std::string_view value : split(key.values, '|')) values.emplace_back(value);
  return values;
}

namespace {

std::string_view describe(FieldKind kind) {
  switch (kind) {
    case entries:
    case map: return "a map";
    case options: return "a map of options";
    case number: return "a number";
    case name: return "a name";
    case names: return "a name, or a list";
    case program:
    case procedure:
    case callback: return "statements";
    case variables: return "declarations";
    case taken: return "`topic.input`, or `topic.input -> output`";
    case formula: return "a formula";
    case word:
    case text: return "a text";
  }
  return "";
}

}  // namespace

std::string write_key_table(std::string_view path) {
  std::string table = "| key | what stands there | without it | |\n|---|---|---|---|\n";
  for (const std::string& name : keys_below(path)) {
    const std::string below = path.empty() ? name : std::string(path) + "/" + name;
    std::string what, standard, help;
    for (const Key* key : keys_at(below)) {
      const std::vector<std::string> values = values_of(*key);
      std::string one = key->kind == word ? "" : std::string(describe(key->kind));
      for (const std::string& value : values) {
        one += (one.empty() ? "" : key->kind == word ? ", " : ", or ") + ("`" + value + "`");
      }
      what += (what.empty() ? "" : "; or ") + one;
      if (!key->standard.empty()) standard = key->standard;
      if (help.empty()) help = key->help;
    }
    table += "| `" + (name == "*" ? "NAME" : name) + "` | " + what + " | " + standard + " | " +
             help + " |\n";
  }
  return table;
}

}  // namespace maide
