#include "maide/check/tree/schema.hpp"

#include <algorithm>

#include "maide/base/text.hpp"

namespace maide {
namespace {

using enum FieldKind;

constexpr Key keys[] = {
    {"", "a system file", "", "", "a system to check", map},
    {"holes", "", "", "", "what the file leaves out, in words: nothing \"holds\" then", texts},
    {"constants", "'constants'", "", "", "names for numbers and words", entries},
    {"constants/*", "constant", "", "", "its value: an expression over those before it", number},

    {"models", "'models'", "", "", "connections, mutexes, semaphores, queues", entries,
     NameKind::declared},
    {"models/*", "model", "", "", "one of `file`, `learn` and `use`, and what belongs to it", map},
    {"models/*/file", "", "", "", "a model file, beside the system file", text},
    {"models/*/learn", "", "", "", "a system to be learned, as in `maide learn`", text},
    {"models/*/use", "", "mutex|semaphore|condition|queue", "", "a built-in model", word},
    {"models/*/with", "", "", "",
     "options of the system; of a mutex `recursive`, of a condition `mutex`, of a "
     "semaphore `count`, of a queue `size` or `depth`",
     options},
    {"models/*/learning", "", "", "", "how it is learned: options of `maide learn`", options},
    {"models/*/when_unexplored", "", "stop|wait|drop", "stop",
     "what an input does that was never tried", word},
    {"models/*/when_weak", "", "inconclusive|accept", "inconclusive",
     "what becomes of a \"holds\" that rests on a weak model", word},
    {"models/*/delivery", "", "late|at_once|acknowledged", "by what the model is of",
     "when what is sent arrives", word},
    {"models/*/loses", "", "true|false", "false", "whether messages may be lost on their way",
     word},
    {"models/*/stream", "", "", "`mqtt` of MQTT",
     "what is late comes in one order with what says the same", text},
    {"models/*/ends", "'ends'", "", "", "who stands at which end: an actor, and names", entries},
    {"models/*/ends/*", "", "", "", "in order: the second writer's `write` is `write2`", names},

    {"topics", "'topics'", "", "", "connections with several readers or writers", entries,
     NameKind::declared},
    {"topics/*", "topic", "", "", "its ends, and one of `file`, `learn` and `use`", map},
    {"topics/*/writers", "", "", "", "programs and nodes that write; `anybody`", names},
    {"topics/*/readers", "", "", "", "programs, nodes and callbacks that read; `anybody`", names},
    {"topics/*/values", "", "", "none", "what anybody writes: `[go, halt]`, `0..3`", texts},
    {"topics/*/fair", "", "true|false", "false",
     "whether anybody writes again and again on runs of formulas", word},
    {"topics/*/file", "", "", "", "a model file, beside the system file", text},
    {"topics/*/learn", "", "", "", "a system to be learned, as in `maide learn`", text},
    {"topics/*/use", "", "mutex|semaphore|queue", "", "a built-in model", word},
    {"topics/*/with", "", "", "", "options of the system or of the queue", options},
    {"topics/*/readers_with", "'readers_with'", "", "", "options of one reader alone", entries,
     NameKind::reference},
    {"topics/*/readers_with/*", "a reader's options", "", "", "in place of those of `with`",
     options},
    {"topics/*/learning", "", "", "", "how it is learned: options of `maide learn`", options},
    {"topics/*/when_unexplored", "", "stop|wait|drop", "stop",
     "what an input does that was never tried", word},
    {"topics/*/when_weak", "", "inconclusive|accept", "inconclusive",
     "what becomes of a \"holds\" that rests on a weak model", word},
    {"topics/*/delivery", "", "late|at_once|acknowledged", "by what the topic is of",
     "when what is written arrives", word},
    {"topics/*/loses", "", "true|false", "where best effort is said",
     "whether messages may be lost on their way", word},
    {"topics/*/stream", "", "", "`mqtt` of MQTT",
     "what is late comes in one order with what says the same", text},
    {"topics/*/discovery", "", "done|any", "done",
     "whether ends know each other at the start, or meet at any time", word},
    {"topics/*/durability", "", "volatile|transient_local", "volatile",
     "where ends meet: whether the newest that was written before comes then", word},
    {"topics/*/deliver", "", "one|all", "all", "whether one reader gets a message, or all do",
     word},

    {"services", "'services'", "", "", "requests and answers, as ROS 2 has them", entries,
     NameKind::declared},
    {"services/*", "service", "", "", "its ends", map},
    {"services/*/server", "", "", "", "the program or node that answers; `anybody`", names},
    {"services/*/clients", "", "", "", "programs and nodes that ask; `anybody`", names},
    {"services/*/fair", "", "true|false", "false",
     "whether anybody asks again and again on runs of formulas", word},
    {"services/*/may_not_answer", "", "true|false", "false",
     "of the server `anybody`: whether requests may stay without an answer", word},
    {"services/*/learn", "'learn' of a service", "ros2", "", "what the rules are those of", word},
    {"services/*/delivery", "", "late|at_once|acknowledged", "by where its ends are",
     "when requests and answers arrive", word},
    {"services/*/loses", "", "true|false", "false", "whether they may be lost on their way", word},
    {"services/*/stream", "", "", "", "what is late comes in one order with what says the same",
     text},
    {"services/*/with", "'with' of a service, which is made by its rules,", "", "",
     "options of the rules", map},
    {"services/*/with/depth", "", "unknown", "10", "requests and answers that are kept", number},
    {"services/*/with/kind", "", "service", "", "may be said", word},
    {"services/*/with/rmw", "", "cyclonedds|fastrtps", "", "the middleware below", word},

    {"procedures", "'procedures'", "", "", "statements that programs call", entries,
     NameKind::head},
    {"procedures/*", "procedure", "", "", "its statements", procedure},
    {"variables", "", "", "", "shared variables: `var n: 0..3; var ok: bool;`", variables},

    {"programs", "'programs'", "", "", "control programs", entries, NameKind::declared},
    {"programs/*", "program", "", "", "its statements", program},
    {"programs/*", "program", "", "", "its statements, and what else is said of it", map},
    {"programs/*/do", "", "", "", "its statements", program},
    {"programs/*/may_die", "", "true|false", "false", "whether it may end at any time", word},
    {"programs/*/may_restart", "", "true|false", "false",
     "whether its process then begins anew, and how often", number},
    {"programs/*/process", "", "", "one of its own", "the process that it is in, by any name",
     text},

    {"executors", "'executors'", "", "", "what runs callbacks", entries},
    {"executors/*", "executor", "", "", "how many threads run callbacks, and in which order", map},
    {"executors/*/kind", "", "single|multi", "", "one thread or several", word},
    {"executors/*/threads", "", "", "", "of `multi`: how many", number},
    {"executors/*/order", "", "any|rounds", "any",
     "of `single`: any order, or that of rclcpp (Humble)", word},
    {"executors/*/main", "", "", "`spin;`",
     "of `single`: the program that spins it, behind the starts of its nodes", callback},
    {"executors/*/may_die", "", "true|false", "false", "whether its process may end at any time",
     word},
    {"executors/*/may_restart", "", "true|false", "false",
     "whether its process then begins anew, and how often", number},
    {"executors/*/process", "", "", "one of its own", "the process that it is in, by any name",
     text},

    {"nodes", "'nodes'", "", "", "programs that consist of callbacks", entries, NameKind::declared},
    {"nodes/*", "node", "", "", "its callbacks and who runs them", map},
    {"nodes/*/executor", "", "", "one of its own, with one thread", "who runs the callbacks", text},
    {"nodes/*/groups", "'groups'", "", "", "callback groups", entries},
    {"nodes/*/groups/*", "a group", "exclusive|reentrant", "",
     "whether its callbacks run one at a time", word},
    {"nodes/*/clients", "'clients'", "", "", "what its clients do with answers", entries,
     NameKind::reference},
    {"nodes/*/clients/*", "a client", "", "the node's own", "the group of the client", name},
    {"nodes/*/clients/*", "a client", "", "", "its group and code of its own", map},
    {"nodes/*/clients/*/group", "", "", "the node's own", "the group of the client", text},
    {"nodes/*/clients/*/do", "", "", "", "what is done with an answer", callback},
    {"nodes/*/variables", "", "", "", "variables of the node", variables},
    {"nodes/*/clock", "", "", "", "the topic by which its timers go, in place of time", name},
    {"nodes/*/start", "", "", "", "its constructor: what runs before any of its callbacks",
     callback},
    {"nodes/*/threads", "'threads'", "", "", "threads of its own, which `run` begins", entries},
    {"nodes/*/threads/*", "thread", "", "", "its statements", callback},
    {"nodes/*/threads/*", "thread", "", "", "its statements, and how many may run at once", map},
    {"nodes/*/threads/*/count", "", "", "1", "copies that may run at once", number},
    {"nodes/*/threads/*/do", "", "", "", "its statements", callback},
    {"nodes/*/callbacks", "'callbacks'", "", "", "what the node does", entries},
    {"nodes/*/callbacks/*", "callback", "", "",
     "one of `takes`, `timer` and `serves`, and what is done", map},
    {"nodes/*/callbacks/*/takes", "", "", "", "the topic's input that it waits for", taken},
    {"nodes/*/callbacks/*/timer", "", "", "", "a period in milliseconds; `once 500`: it comes once",
     timer},
    {"nodes/*/callbacks/*/when", "", "", "true", "where this does not hold it does not start",
     number},
    {"nodes/*/callbacks/*/serves", "", "", "", "the service whose requests it answers", name},
    {"nodes/*/callbacks/*/group", "", "", "the node's own", "its callback group", text},
    {"nodes/*/callbacks/*/do", "", "unknown", "", "its statements", callback},
    {"nodes/*/callbacks/*/do", "'do'", "", "", "an output, and what is done when it came", entries,
     NameKind::output},
    {"nodes/*/callbacks/*/do/*", "what is done", "", "", "its statements", callback},

    {"properties", "'properties'", "", "", "what must hold", entries},
    {"properties/*", "property", "", "", "a formula of linear-time temporal logic", formula},
    {"properties/*", "property", "", "",
     "one of `ltl`, `always`, `possible`, `always_possible` and `never`", map},
    {"properties/*/ltl", "", "", "", "a formula of linear-time temporal logic", formula},
    {"properties/*/always", "", "", "", "an expression that holds in each state", formula},
    {"properties/*/possible", "", "", "", "an expression that holds in some state of some run",
     formula},
    {"properties/*/always_possible", "", "", "",
     "an expression to which some run comes from every state", formula},
    {"properties/*/never", "", "", "", "a file with an automaton of bad runs (HOA)", text},
    {"properties/*/fairness", "", "none|weak|strong", "weak", "which runs count", word},
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
    case timer: return "a number, or `once` and a number";
    case name: return "a name";
    case names: return "a name, or a list";
    case texts: return "a text, or a list";
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
