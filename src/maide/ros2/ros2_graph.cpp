#include "maide/ros2/ros2_graph.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/base/text.hpp"
#include "maide/check/rules/built_in_models.hpp"
#include "maide/experiment/open_system.hpp"

namespace maide {
namespace {

constexpr std::string_view action_part = "/_action/";

bool ends_with_any(const std::string& name, std::initializer_list<std::string_view> ends) {
  return std::ranges::any_of(ends, [&](std::string_view end) { return name.ends_with(end); });
}

// What every node has, whatever its program does.
bool is_of_every_node(const std::string& name) {
  return ends_with_any(
      name, {"/rosout", "/parameter_events", "/describe_parameters", "/get_parameter_types",
             "/get_parameters", "/list_parameters", "/set_parameters", "/set_parameters_atomically",
             "/get_type_description"});
}

bool is_hidden(const std::string& node) {
  return node.substr(node.rfind('/') + 1).starts_with('_');
}

void drop_hidden(Ros2Graph& graph) {
  const auto is_hidden_end = [](const Ros2End& end) { return is_hidden(end.node); };
  std::erase_if(graph.nodes, [](const Ros2Node& node) { return is_hidden(node.name); });
  std::set<std::string> actions;
  const auto note_action = [&](const std::string& name) {
    const std::size_t at = name.find(action_part);
    if (at != std::string::npos) actions.insert(name.substr(0, at));
    return at != std::string::npos || is_of_every_node(name);
  };
  std::erase_if(graph.topics, [&](Ros2Topic& topic) {
    std::erase_if(topic.publishers, is_hidden_end);
    std::erase_if(topic.subscriptions, is_hidden_end);
    return note_action(topic.name) || (topic.publishers.empty() && topic.subscriptions.empty());
  });
  std::erase_if(graph.services, [&](Ros2Service& service) {
    std::erase_if(service.servers, is_hidden);
    std::erase_if(service.clients, is_hidden);
    return note_action(service.name) || (service.servers.empty() && service.clients.empty());
  });
  if (graph.actions.empty()) graph.actions.assign(actions.begin(), actions.end());
}

std::optional<double> time_of(const Json& json, const char* key) {
  if (!json.contains(key)) return std::nullopt;
  return json.at(key).get<double>();
}

Ros2End end_from(const Json& json) {
  Ros2End end;
  end.node = json.at("node").get<std::string>();
  end.type = json.value("type", "");
  end.qos.reliability = json.at("reliability").get<std::string>();
  end.qos.durability = json.at("durability").get<std::string>();
  end.qos.history = json.value("history", "unknown");
  if (json.contains("depth")) end.qos.depth = json.at("depth").get<std::uint32_t>();
  end.qos.deadline = time_of(json, "deadline");
  end.qos.lifespan = time_of(json, "lifespan");
  end.qos.liveliness = json.value("liveliness", "automatic");
  end.qos.lease = time_of(json, "lease");
  return end;
}

Json to_json(const Ros2End& end) {
  Json json{{"node", end.node},
            {"type", end.type},
            {"reliability", end.qos.reliability},
            {"durability", end.qos.durability},
            {"history", end.qos.history}};
  if (end.qos.depth) json["depth"] = *end.qos.depth;
  if (end.qos.deadline) json["deadline"] = *end.qos.deadline;
  if (end.qos.lifespan) json["lifespan"] = *end.qos.lifespan;
  json["liveliness"] = end.qos.liveliness;
  if (end.qos.lease) json["lease"] = *end.qos.lease;
  return json;
}

}  // namespace

// ---- reading ------------------------------------------------------------------------------------

Ros2Graph read_ros2_graph(const Json& json, const std::string& file) {
  Ros2Graph graph;
  try {
    graph.rmw = json.value("rmw", "");
    graph.domain = json.value("domain", 0U);
    graph.is_settled = json.value("settled", true);
    for (const Json& node : json.at("nodes")) {
      graph.nodes.push_back({node.at("name").get<std::string>(), node.value("process", "")});
    }
    for (const Json& json_topic : json.at("topics")) {
      Ros2Topic topic{json_topic.at("name").get<std::string>(), {}, {}};
      for (const Json& end : json_topic.at("publishers")) topic.publishers.push_back(end_from(end));
      for (const Json& end : json_topic.at("subscriptions")) {
        topic.subscriptions.push_back(end_from(end));
      }
      graph.topics.push_back(std::move(topic));
    }
    for (const Json& service : json.at("services")) {
      Ros2Service read{service.at("name").get<std::string>(), service.value("type", ""),
                       service.at("servers").get<std::vector<std::string>>(),
                       service.at("clients").get<std::vector<std::string>>(), std::nullopt};
      if (service.contains("depth")) read.depth = service.at("depth").get<std::uint32_t>();
      graph.services.push_back(std::move(read));
    }
    if (json.contains("actions")) {
      graph.actions = json.at("actions").get<std::vector<std::string>>();
    }
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("this is no graph of ROS 2: {} ({})", error.what(), file));
  }
  drop_hidden(graph);
  return graph;
}

Json ros2_graph_to_json(const Ros2Graph& graph) {
  Json nodes = Json::array(), topics = Json::array(), services = Json::array();
  for (const Ros2Node& node : graph.nodes) {
    nodes.push_back({{"name", node.name}, {"process", node.process}});
  }
  for (const Ros2Topic& topic : graph.topics) {
    Json json{
        {"name", topic.name}, {"publishers", Json::array()}, {"subscriptions", Json::array()}};
    for (const Ros2End& end : topic.publishers) json["publishers"].push_back(to_json(end));
    for (const Ros2End& end : topic.subscriptions) json["subscriptions"].push_back(to_json(end));
    topics.push_back(std::move(json));
  }
  for (const Ros2Service& service : graph.services) {
    Json json{{"name", service.name},
              {"type", service.type},
              {"servers", service.servers},
              {"clients", service.clients}};
    if (service.depth) json["depth"] = *service.depth;
    services.push_back(std::move(json));
  }
  return {{"rmw", graph.rmw},        {"domain", graph.domain}, {"settled", graph.is_settled},
          {"nodes", nodes},          {"topics", topics},       {"services", services},
          {"actions", graph.actions}};
}

Ros2Graph observe_ros2_graph(double quiet, const RunControl& control) {
  const auto wrapper = find_wrapper("ros2");
  if (!wrapper) {
    throw UsageError(
        "the wrapper for ROS 2 is not there (maide-wrap-ros2): source ROS 2's setup.bash, then "
        "configure and build maide again");
  }
  SubprocessOptions options;
  options.time_limit = std::chrono::milliseconds(static_cast<std::int64_t>(quiet * 2000) + 90'000);
  const SubprocessResult result = run_program(
      {wrapper->string(), "--graph", fmt::format("--quiet={}", quiet)}, options, control);
  if (!result.succeeded()) {
    // Behind what the middleware itself may have said.
    const std::string prefix = "maide-wrap-ros2: ";
    const std::size_t said = result.err.rfind(prefix);
    std::string reason =
        one_line(said == std::string::npos ? result.err : result.err.substr(said + prefix.size()));
    if (result.timed_out) reason = "it does not end";
    if (reason.empty()) reason = fmt::format("it ended with {}", result.exit_status);
    throw WrapperError("cannot read the graph: " + reason, wrapper->string());
  }
  return read_ros2_graph(parse_json(result.out, wrapper->string()), wrapper->string());
}

namespace {

// A machine with these names, for reading a system file without learning its models. Any output may
// follow any input; but nothing follows the first `writes` inputs, and the first `returns` outputs
// never come.
InterfaceAutomaton any_machine(const std::vector<std::string>& inputs,
                               const std::vector<std::string>& outputs, Symbol writes,
                               Symbol returns) {
  InterfaceAutomaton automaton(Alphabet(std::span<const std::string>(inputs)),
                               Alphabet(std::span<const std::string>(outputs)), 1);
  const StateId due = automaton.add_state();
  for (Symbol input = 0; input < inputs.size(); ++input) {
    automaton.add_transition(0, {Action::Kind::input, input}, input < writes ? 0 : due);
  }
  for (Symbol output = returns; output < outputs.size(); ++output) {
    automaton.add_transition(due, {Action::Kind::output, output}, 0);
  }
  return automaton;
}

// Of a topic of ROS 2, with the values that programs write.
InterfaceAutomaton any_topic(const std::vector<std::string>& values) {
  const auto with_values = [&](const std::string& name) {
    std::vector<std::string> names;
    for (const std::string& value : values) names.push_back(name + "(" + value + ")");
    return names.empty() ? std::vector<std::string>{name} : names;
  };
  const Actor writer{"writer", with_values("write"), {"written"}};
  Actor reader{"reader",
               {"read", "tryread", "unsubscribe", "subscribe"},
               {"next", "gap", "old", "null", "unsubscribed"}};
  for (const std::string& message : with_values("message")) reader.outputs.push_back(message);
  const auto both = [](std::vector<std::string> names, const std::vector<std::string>& others) {
    names.insert(names.end(), others.begin(), others.end());
    return names;
  };
  InterfaceAutomaton automaton =
      any_machine(both(writer.inputs, reader.inputs), both(writer.outputs, reader.outputs),
                  static_cast<Symbol>(writer.inputs.size()), 1);
  automaton.actors = {writer, reader};
  return automaton;
}

// Of kind=service, with one or two clients.
InterfaceAutomaton any_service() {
  std::vector<std::string> inputs{"serve",  "start", "stop", "tryserve", "handle",
                                  "answer", "ask",   "wait", "call",     "burst"};
  std::vector<std::string> outputs{"request",     "request_gap", "handled",
                                   "handled_gap", "none",        "down"};
  for (const std::string client : {"", "2"}) {
    for (const char* input : {"send", "receive", "tryreceive", "ready"}) {
      inputs.push_back(input + client);
    }
    for (const char* output : {"answer", "null", "present", "absent", "pending", "answer_gap"}) {
      outputs.push_back(output + client);
    }
  }
  return any_machine(inputs, outputs, 0, 0);
}

std::string option_of(const Ros2Options& options, const std::string& end, const std::string& key,
                      const std::string& otherwise) {
  for (const std::string& name : {end + "-" + key, key}) {
    const auto option = options.find(name);
    if (option != options.end() && option->second != "both") return option->second;
  }
  return otherwise;
}

}  // namespace

Ros2Qos ros2_qos_of(const Ros2Options& options, const std::string& end) {
  Ros2Qos qos;
  qos.reliability = option_of(options, end, "reliability", "reliable");
  qos.durability = option_of(options, end, "durability", "volatile");
  qos.history = option_of(options, end, "history", "keep_last");
  qos.depth = parse_number<std::uint32_t>(option_of(options, end, "depth", "10"));
  // What the middleware takes for it, it does not say.
  if (qos.history == "system_default") qos.depth.reset();
  return qos;
}

namespace {

Ros2Graph graph_of_system(const std::string& text, const std::string& file,
                          KeptModelPath kept_model_path, const RunControl& control) {
  std::map<std::string, Ros2Options> options;  // by model
  const ModelSource source = [&](const ModelRequest& request) {
    if (request.learn.empty()) {
      InterfaceAutomaton model = read_requested_model(request);
      const auto sul = model.origin.find("sul");
      if (sul == model.origin.end()) return model;
      const std::vector<std::string> words = split_shell_words(sul->second);
      if (words.empty() || words.front() != "ros2") return model;
      options[request.instance] = parse_system_spec("ros2", std::span(words).subspan(1)).options;
      return model;
    }
    if (request.learn == "ros2") {
      std::vector<std::string> words;
      for (const auto& [key, value] : request.with) words.push_back(key + "=" + value);
      options[request.instance] = parse_system_spec("ros2", words).options;
    }
    const std::filesystem::path kept =
        kept_model_path(std::filesystem::path(file).parent_path(), request);
    if (!request.values.empty() || !std::filesystem::exists(kept)) {
      const auto kind = std::ranges::find_if(
          request.with, [](const auto& option) { return option.first == "kind"; });
      const bool is_service = kind != request.with.end() && kind->second == "service";
      return is_service ? any_service() : any_topic(request.values);
    }
    ModelRequest as_file = request;
    as_file.learn.clear();
    as_file.file = kept;
    return read_requested_model(as_file);
  };
  const System system = parse_system(text, file, source, control);
  Ros2Graph graph;
  for (const TopicInstance& instance : system.topics) {
    Ros2Topic topic{instance.name, {}, {}};
    for (const TopicInstance::Reader& reader : instance.readers) {
      const std::string& model = system.models[reader.model].name;
      const auto known = options.find(model);
      if (known == options.end()) continue;
      const std::string node =
          model.substr(instance.name.size() + 1, model.size() - instance.name.size() - 2);
      topic.subscriptions.push_back({node, "", ros2_qos_of(known->second, "sub")});
      for (const std::string& writer : instance.writer_names) {
        topic.publishers.push_back({writer, "", ros2_qos_of(known->second, "pub")});
      }
    }
    if (!topic.subscriptions.empty()) graph.topics.push_back(std::move(topic));
  }
  for (const ServiceInstance& service : system.services) {
    graph.services.push_back(
        {service.name,
         "",
         {service.server},
         service.clients,
         parse_number<std::uint32_t>(system.models[service.model].automaton.origin.at("depth"))});
  }
  return graph;
}

}  // namespace

Ros2Graph read_ros2_file(const std::filesystem::path& file, KeptModelPath kept_model_path,
                         const RunControl& control) {
  const std::string text = read_file(file, control);
  if (file.extension() == ".json") {
    const Json json = parse_json(text, file.string());
    const bool is_result = json.is_object() && json.contains("graph");
    return read_ros2_graph(is_result ? json.at("graph") : json, file.string());
  }
  return graph_of_system(text, file.string(), kept_model_path, control);
}

// ---- findings -----------------------------------------------------------------------------------

std::string find_mismatch(const Ros2End& publisher, const Ros2End& subscription) {
  const Ros2Qos& offered = publisher.qos;
  const Ros2Qos& asked = subscription.qos;
  const auto differ = [&](const std::string& offers, const std::string& asks) {
    return fmt::format("{} offers {}, and {} asks for {}", publisher.node, offers,
                       subscription.node, asks);
  };
  if (!publisher.type.empty() && !subscription.type.empty() &&
      publisher.type != subscription.type) {
    return differ(publisher.type, subscription.type);
  }
  if (offered.reliability == "best_effort" && asked.reliability == "reliable") {
    return differ("best_effort", "reliable");
  }
  if (offered.durability == "volatile" && asked.durability == "transient_local") {
    return differ("volatile", "transient_local");
  }
  const auto time = [](const std::optional<double>& seconds) {
    return seconds ? fmt::format("{} s", *seconds) : std::string("none");
  };
  const auto is_longer = [](const std::optional<double>& a, const std::optional<double>& b) {
    return b && (!a || *a > *b);
  };
  if (is_longer(offered.deadline, asked.deadline)) {
    return differ("deadline " + time(offered.deadline), time(asked.deadline));
  }
  if (offered.liveliness == "automatic" && asked.liveliness == "manual_by_topic") {
    return differ("liveliness automatic", "manual_by_topic");
  }
  if (is_longer(offered.lease, asked.lease)) {
    return differ("lease " + time(offered.lease), time(asked.lease));
  }
  return "";
}

bool hears_history(const Ros2Qos& publisher, const Ros2Qos& subscription) {
  return publisher.durability == "transient_local" && subscription.durability == "transient_local";
}

namespace {

class Examination {
 public:
  explicit Examination(const Ros2Graph& graph) : graph_(graph) {}

  std::vector<Ros2Finding> run() {
    for (const Ros2Topic& topic : graph_.topics) examine(topic);
    for (const Ros2Service& service : graph_.services) examine(service);
    std::ranges::stable_sort(findings_,
                             [](const auto& a, const auto& b) { return a.kind < b.kind; });
    return std::move(findings_);
  }

 private:
  using Kind = Ros2Finding::Kind;

  static constexpr std::uint32_t all = ~0U;  // messages

  void add(Kind kind, const std::string& where, const std::string& text) {
    const auto is_same = [&](const Ros2Finding& finding) {
      return finding.kind == kind && finding.where == where && finding.text == text;
    };
    if (std::ranges::none_of(findings_, is_same)) {
      findings_.push_back({kind, where, text});
    }
  }

  void examine(const Ros2Topic& topic) {
    if (topic.publishers.empty()) add(Kind::no_end, topic.name, "nobody publishes it");
    if (topic.subscriptions.empty()) add(Kind::no_end, topic.name, "nobody subscribes to it");
    std::vector<std::string> forgotten;  // who gets nothing old
    for (const Ros2End& subscription : topic.subscriptions) {
      bool hears = false, hears_old = false;
      std::optional<std::uint32_t> most_old = 0;  // none: nobody knows
      for (const Ros2End& publisher : topic.publishers) {
        const std::string mismatch = find_mismatch(publisher, subscription);
        if (!mismatch.empty()) {
          add(Kind::no_match, topic.name, mismatch + ": they never match, and nobody is told");
          continue;
        }
        hears = true;
        if (publisher.qos.lifespan) {
          add(Kind::loss, topic.name,
              fmt::format("what {} published {} s ago is thrown away before {} sees it (lifespan)",
                          publisher.node, *publisher.qos.lifespan, subscription.node));
        }
        if (!hears_history(publisher.qos, subscription.qos)) continue;
        hears_old = true;
        const auto kept = history_of(publisher.qos, subscription.qos);
        most_old = most_old && kept ? std::optional(std::max(*most_old, *kept)) : std::nullopt;
      }
      if (!hears) continue;
      add(Kind::loss, topic.name, describe_loss(subscription));
      if (hears_old) {
        add(Kind::late, topic.name,
            fmt::format("{} gets {} once more when it starts again (transient_local), and acts "
                        "twice",
                        subscription.node, describe_history(most_old)));
      } else {
        forgotten.push_back(subscription.node);
      }
    }
    if (forgotten.empty()) return;
    add(Kind::late, topic.name,
        fmt::format("{} get{} nothing of what was published before {} there", join(forgotten),
                    forgotten.size() == 1 ? "s" : "",
                    forgotten.size() == 1 ? "it was" : "they were"));
  }

  // How many messages a late subscription gets of one publisher, at most; none: nobody knows.
  static std::optional<std::uint32_t> history_of(const Ros2Qos& publisher,
                                                 const Ros2Qos& subscription) {
    std::uint32_t least = all;
    for (const Ros2Qos& end : {publisher, subscription}) {
      if (end.history == "keep_all") continue;
      if (!end.depth) return std::nullopt;
      least = std::min(least, std::max(*end.depth, 1U));
    }
    return least;
  }

  static std::string describe_history(std::optional<std::uint32_t> kept) {
    if (!kept) return "the newest messages";
    if (*kept == all) return "all messages";
    return *kept == 1 ? "the newest message" : fmt::format("the newest {} messages", *kept);
  }

  static std::string describe_loss(const Ros2End& subscription) {
    const Ros2Qos& qos = subscription.qos;
    std::string text = subscription.node;
    if (qos.history == "keep_all") {
      text += " keeps all messages";
    } else if (!qos.depth) {
      text +=
          " keeps the newest messages, and nobody knows how many: a longer burst loses the oldest";
    } else {
      const std::uint32_t depth = std::max(*qos.depth, 1U);
      text += fmt::format(
          " keeps {}: of a burst of {} or more that comes before its callback "
          "runs, the oldest {} lost",
          depth == 1 ? "the newest message" : fmt::format("the newest {}", depth), depth + 1,
          depth == 1 ? "is" : "are");
    }
    return text + (qos.reliability == "best_effort" ? "; best_effort: more on the way" : "");
  }

  void examine(const Ros2Service& service) {
    if (service.servers.empty()) {
      add(Kind::no_end, service.name,
          fmt::format("it has no server: {} wait{} for ever", join(service.clients),
                      service.clients.size() == 1 ? "s" : ""));
    }
    if (service.clients.empty() || service.servers.empty()) return;
    if (service.servers.size() > 1) {
      add(Kind::no_end, service.name,
          fmt::format("it has {} servers ({}): each answers", service.servers.size(),
                      join(service.servers)));
    }
    // In ROS 2 services keep ten, unless a program says otherwise.
    const std::uint32_t depth = service.depth.value_or(10);
    const std::string known = service.depth ? "" : " (if its depth is 10, as by default)";
    add(Kind::loss, service.name,
        fmt::format("of {} requests that come before {} spins, the oldest is lost, and its client "
                    "waits for ever{}",
                    depth + 1, service.servers.front(), known));
    if (service.clients.size() < 2) return;
    add(Kind::loss, service.name,
        fmt::format("{} get all answers: {} to others push out one that a client has not taken, "
                    "and it waits for ever{}",
                    join(service.clients), depth, known));
  }

  const Ros2Graph& graph_;
  std::vector<Ros2Finding> findings_;
};

}  // namespace

std::vector<Ros2Finding> examine_ros2_graph(const Ros2Graph& graph) {
  return Examination(graph).run();
}

}  // namespace maide
