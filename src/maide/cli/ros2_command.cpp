// `maide ros2 import`: a system file from a running graph of ROS 2, and `maide doctor ros2`: what
// such a graph loses.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/log.hpp"
#include "maide/base/text.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/join/learned_models.hpp"
#include "maide/report/sequence_chart.hpp"
#include "maide/ros2/ros2_graph.hpp"

namespace maide::cli {

namespace {

constexpr std::size_t report_width = 100;

struct Ros2Arguments {
  std::string action;
  std::string output;
  std::string graph;
  double settle = ros2_settle_seconds;
};

Ros2Graph graph_of(const std::string& file, double settle, Context& context) {
  Ros2Graph graph = file.empty() ? observe_ros2_graph(settle, context.control())
                                 : read_ros2_file(file, kept_model_path, context.control());
  if (!graph.is_settled) {
    log_note("the graph still changed, or a node had not told its name: it is as it was then");
  }
  if (graph.topics.empty() && graph.services.empty()) {
    if (!file.empty()) throw UsageError("there is no topic and no service of ROS 2 (" + file + ")");
    throw UsageError(fmt::format(
        "nobody publishes, subscribes or serves in domain {} over {} (others: set ROS_DOMAIN_ID or "
        "RMW_IMPLEMENTATION; slow ones: --settle SECONDS)",
        graph.domain, graph.rmw));
  }
  return graph;
}

ExitStatus run_import(const Ros2Arguments& arguments, Context& context) {
  const Ros2Graph graph = graph_of(arguments.graph, arguments.settle, context);
  const std::string text = write_ros2_system(graph);
  if (arguments.output.empty()) {
    context.print_data(text);
  } else {
    write_file_atomically(arguments.output, text);
    context.print(fmt::format("{}: {}, {}, {}; its first lines say what to fill in\n",
                              arguments.output, counted(graph.topics.size(), "topic"),
                              counted(graph.services.size(), "service"),
                              counted(graph.nodes.size(), "node")));
  }
  context.set_result({{"graph", ros2_graph_to_json(graph)}, {"system", text}});
  return ExitStatus::ok;
}

std::string_view title_of(Ros2Finding::Kind kind) {
  switch (kind) {
    case Ros2Finding::Kind::no_match: return "Never match";
    case Ros2Finding::Kind::no_end: return "Lack an end";
    case Ros2Finding::Kind::loss: return "What can be lost";
    case Ros2Finding::Kind::late: return "Who comes late, or starts again";
  }
  return "";
}

std::string_view name_of(Ros2Finding::Kind kind) {
  switch (kind) {
    case Ros2Finding::Kind::no_match: return "no_match";
    case Ros2Finding::Kind::no_end: return "no_end";
    case Ros2Finding::Kind::loss: return "loss";
    case Ros2Finding::Kind::late: return "late";
  }
  return "";
}

}  // namespace

ExitStatus run_ros2_doctor(const std::string& file, double settle, Context& context) {
  const Ros2Graph graph = graph_of(file, settle, context);
  const std::vector<Ros2Finding> findings = examine_ros2_graph(graph);
  std::string text;
  Json list = Json::array();
  std::size_t unmatched = 0;
  std::optional<Ros2Finding::Kind> kind;
  for (const Ros2Finding& finding : findings) {
    if (kind != finding.kind) {
      text += fmt::format("{}{}\n", kind ? "\n" : "", title_of(finding.kind));
    }
    kind = finding.kind;
    text += wrap(finding.where + ": " + finding.text, report_width, 2);
    unmatched += finding.kind == Ros2Finding::Kind::no_match ? 1 : 0;
    list.push_back(
        {{"kind", name_of(finding.kind)}, {"where", finding.where}, {"text", finding.text}});
  }
  text += unmatched == 0 ? "\nAll ends match.\n"
                         : fmt::format("\n{} of ends never match{}.\n", counted(unmatched, "pair"),
                                       unmatched == 1 ? "es" : "");
  context.print(text);
  context.set_result({{"matches", unmatched == 0}, {"findings", list}});
  return unmatched == 0 ? ExitStatus::ok : ExitStatus::violated;
}

RunFunction set_up_ros2(CommandLine& line) {
  auto arguments = std::make_shared<Ros2Arguments>();
  line.add("ACTION", arguments->action,
           "import: a system file with the graph's topics and services, and nodes whose callbacks "
           "are to be filled in")
      .required()
      .one_of({"import"});
  line.add("-o,--output", arguments->output, "Write the system file there (default: print it)")
      .no_default();
  line.add("--graph", arguments->graph,
           "Take the graph from this file, which --json printed, in place of the running one")
      .no_default();
  add_settle_option(line, arguments->settle);
  return [arguments](Context& context) { return run_import(*arguments, context); };
}

Argument add_settle_option(CommandLine& line, double& settle) {
  return line
      .add("--settle", settle,
           "Read the running graph when nothing of it has changed for so many seconds")
      .number_between(0, 600)
      .value_name("SECONDS");
}

}  // namespace maide::cli
