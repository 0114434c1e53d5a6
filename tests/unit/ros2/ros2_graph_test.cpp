// Graphs of ROS 2 without ROS 2: which ends match, what a graph loses, and the system file that is
// made of it.
#include "maide/ros2/ros2_graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/rules/built_in_models.hpp"
#include "maide/check/tree/print.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/join/learned_models.hpp"

namespace maide {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const std::string graph_file = std::string(MAIDE_SOURCE_DIR) + "/tests/systems/ros2-graph.json";

Ros2Graph graph() { return read_ros2_file(graph_file, kept_model_path, {}); }

Ros2End end(const std::string& reliability, const std::string& durability) {
  Ros2End result{"a", "T", {}};
  result.qos.reliability = reliability;
  result.qos.durability = durability;
  return result;
}

bool match(const Ros2End& publisher, const Ros2End& subscription) {
  return find_mismatch(publisher, subscription).empty();
}

// The tables of ROS 2's page on QoS.
TEST(Ros2Match, FollowsReliabilityAndDurability) {
  for (const std::string offered : {"reliable", "best_effort"}) {
    for (const std::string asked : {"reliable", "best_effort"}) {
      EXPECT_EQ(match(end(offered, "volatile"), end(asked, "volatile")),
                offered == "reliable" || asked == "best_effort");
    }
  }
  for (const std::string offered : {"volatile", "transient_local"}) {
    for (const std::string asked : {"volatile", "transient_local"}) {
      EXPECT_EQ(match(end("reliable", offered), end("reliable", asked)),
                offered == "transient_local" || asked == "volatile");
    }
  }
  EXPECT_TRUE(match(end("unknown", "unknown"), end("reliable", "transient_local")));
}

TEST(Ros2Match, FollowsTimesLivelinessAndTypes) {
  const std::vector<std::optional<double>> times{std::nullopt, 1.0, 2.0};
  for (const auto& offered : times) {
    for (const auto& asked : times) {
      Ros2End publisher = end("reliable", "volatile"), subscription = publisher;
      publisher.qos.deadline = offered;
      subscription.qos.deadline = asked;
      const bool is_kept = !asked || (offered && *offered <= *asked);
      EXPECT_EQ(match(publisher, subscription), is_kept);
      std::swap(publisher.qos.deadline, publisher.qos.lease);
      std::swap(subscription.qos.deadline, subscription.qos.lease);
      EXPECT_EQ(match(publisher, subscription), is_kept);
    }
  }
  Ros2End publisher = end("reliable", "volatile"), subscription = publisher;
  subscription.qos.liveliness = "manual_by_topic";
  EXPECT_FALSE(match(publisher, subscription));
  EXPECT_TRUE(match(subscription, publisher));
  subscription = publisher;
  subscription.type = "U";
  EXPECT_EQ(find_mismatch(publisher, subscription), "a offers T, and a asks for U");
}

TEST(Ros2Graph, LeavesOutWhatEveryNodeHas) {
  const Ros2Graph read = graph();
  EXPECT_EQ(read.nodes.size(), 7U);  // not the daemon
  EXPECT_EQ(read.topics.size(), 5U);
  EXPECT_EQ(read.services.size(), 2U);
  EXPECT_THAT(read.actions, ElementsAre("/drive"));
  const Ros2Graph again = read_ros2_graph(ros2_graph_to_json(read), "again");
  EXPECT_EQ(ros2_graph_to_json(again), ros2_graph_to_json(read));
}

TEST(Ros2Graph, RefusesWhatIsNone) {
  for (const char* text : {"[]", "{}", R"({"nodes": [{}], "topics": [], "services": []})",
                           R"({"nodes": [], "topics": [{"name": 1}], "services": []})"}) {
    EXPECT_THROW(read_ros2_graph(Json::parse(text), "bad.json"), UsageError) << text;
  }
}

std::vector<std::string> findings_of(const Ros2Graph& graph, Ros2Finding::Kind kind) {
  std::vector<std::string> lines;
  for (const Ros2Finding& finding : examine_ros2_graph(graph)) {
    if (finding.kind == kind) lines.push_back(finding.where + ": " + finding.text);
  }
  return lines;
}

TEST(Ros2Findings, AreThoseOfTheGraph) {
  using Kind = Ros2Finding::Kind;
  EXPECT_THAT(findings_of(graph(), Kind::no_match),
              ElementsAre("/health: /camera offers best_effort, and /operator/desk asks for "
                          "reliable: they never match, and nobody is told"));
  EXPECT_THAT(findings_of(graph(), Kind::no_end),
              ElementsAre("/heat: nobody subscribes to it",
                          "/dock: it has no server: /planner waits for ever"));
  EXPECT_THAT(
      findings_of(graph(), Kind::loss),
      ElementsAre(
          HasSubstr("/image: /detector keeps the newest messages, and nobody knows how many"),
          HasSubstr("/image: /operator/logger keeps the newest 5: of a burst of 6 or more"),
          HasSubstr("/found: /planner"), HasSubstr("/order: /planner"),
          HasSubstr("/lookup: of 11 requests"),
          HasSubstr("/lookup: /detector, /operator/desk get all answers: 10 to others")));
  EXPECT_THAT(findings_of(graph(), Kind::late),
              ElementsAre(HasSubstr("/image: /detector, /operator/logger get nothing"),
                          HasSubstr("/found: /planner gets nothing"),
                          HasSubstr("/order: /planner gets the newest messages once more")));
}

// A late joiner gets what both ends keep; what is older than the lifespan is gone.
TEST(Ros2Findings, SayHowManyMessagesComeAgain) {
  const auto late = [](std::optional<std::uint32_t> published, std::uint32_t subscribed) {
    Ros2Graph graph;
    Ros2End publisher{"/sender", "", {}}, subscription{"/planner", "", {}};
    publisher.qos.durability = subscription.qos.durability = "transient_local";
    publisher.qos.depth = published;
    publisher.qos.lifespan = 0.5;
    subscription.qos.depth = subscribed;
    graph.topics.push_back({"/order", {publisher}, {subscription}});
    EXPECT_THAT(findings_of(graph, Ros2Finding::Kind::loss),
                Contains("/order: what /sender published 0.5 s ago is thrown away before /planner "
                         "sees it (lifespan)"));
    return findings_of(graph, Ros2Finding::Kind::late);
  };
  EXPECT_THAT(late(1, 10), ElementsAre(HasSubstr("/planner gets the newest message once more")));
  EXPECT_THAT(late(10, 3), ElementsAre(HasSubstr("gets the newest 3 messages once more")));
  EXPECT_THAT(late(std::nullopt, 3), ElementsAre(HasSubstr("gets the newest messages once more")));
}

// The depth of the publisher is that of the history that a late subscription gets.
TEST(Ros2System, HasBothDepthsUnderTransientLocal) {
  using Depths = std::vector<std::optional<std::uint32_t>>;
  const auto written = [](const std::string& durability, const Depths& published) {
    Ros2Graph graph;
    Ros2End publisher{"/sender", "", {}}, subscription{"/planner", "", {}};
    publisher.qos.durability = subscription.qos.durability = durability;
    subscription.qos.depth = 10;
    graph.nodes = {{"/sender", ""}, {"/planner", ""}};
    graph.topics.push_back({"/order", {}, {subscription}});
    for (const auto& depth : published) {
      publisher.qos.depth = depth;
      graph.topics.back().publishers.push_back(publisher);
    }
    return write_ros2_system(graph);
  };
  EXPECT_THAT(written("transient_local", {1}), HasSubstr("pub-depth: 1, sub-depth: 10"));
  EXPECT_THAT(written("transient_local", {10}), HasSubstr("with: {depth: 10"));
  EXPECT_THAT(written("volatile", {1, 2}), HasSubstr("with: {depth: 10"));
  EXPECT_THAT(written("volatile", {1, 2}), Not(HasSubstr("keep different numbers")));
  EXPECT_THAT(written("transient_local", {1, 2}), HasSubstr("keep different numbers"));
  const std::string unknown = written("transient_local", {std::nullopt});
  EXPECT_THAT(unknown, HasSubstr("pub-depth: unknown, sub-depth: 10"));
  const System system = parse_system(unknown, "s.yaml", [](const ModelRequest& request) {
    return ros2_topic_of_unknown_depth(request).value();
  });
  EXPECT_THAT(system.remarks, Contains(HasSubstr("'depth: unknown'")));
}

// Where ROS 2 would learn a model, a queue of that depth.
InterfaceAutomaton without_ros2(const ModelRequest& request) {
  if (const auto unknown = ros2_topic_of_unknown_depth(request)) return *unknown;
  EXPECT_EQ(request.with.front(), (std::pair<std::string, std::string>("depth", "5")));
  return make_queue({5, true, {}});
}

TEST(Ros2System, IsLaidOutAndReadAndAsksForDepths) {
  const std::string text = write_ros2_system(graph());
  EXPECT_EQ(format_system(text, "s.yaml"), text);
  const System system = parse_system(text, "s.yaml", without_ros2);
  EXPECT_THAT(system.remarks,
              ElementsAre(HasSubstr("'depth: unknown'"), HasSubstr("'do: unknown'")));
  EXPECT_EQ(system.topics.size(), 3U);
  ASSERT_EQ(system.services.size(), 1U);
  EXPECT_EQ(system.services[0].server, "map");
  EXPECT_THAT(system.services[0].clients, ElementsAre("detector", "desk"));
  for (const char* line :
       {"# /health: /camera offers best_effort, and /operator/desk asks for reliable: they never",
        "# /heat is left out: nobody subscribes to it", "# /dock is left out: it has no server",
        "# action /drive is left out", "# idle is left out",
        "logger: {depth: 5, sub-reliability: best_effort}",
        "with: {depth: unknown, durability: transient_local}",
        "# camera, detector, map, planner are in one process"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
}

// What is learned and replayed is over the middleware of the graph.
TEST(Ros2System, NamesTheMiddleware) {
  Ros2Graph own = graph();
  EXPECT_THAT(write_ros2_system(own), Not(HasSubstr("rmw:")));
  own.rmw = "rmw_fastrtps_cpp";
  const std::string text = write_ros2_system(own);
  EXPECT_THAT(text, HasSubstr("logger: {depth: 5, sub-reliability: best_effort, rmw: fastrtps}"));
  const System system = parse_system(text, "s.yaml", without_ros2);
  EXPECT_EQ(system.models.front().automaton.origin.at("rmw"), "fastrtps");
  own.rmw = "rmw_zenoh_cpp";
  EXPECT_THAT(write_ros2_system(own),
              HasSubstr("# the models are those of rmw_cyclonedds_cpp: those of rmw_zenoh_cpp"));
}

// A file that nobody filled in is not said to hold.
TEST(Ros2System, IsInconclusiveAsLongAsCallbacksAreUnknown) {
  const System system = parse_system(write_ros2_system(graph()), "s.yaml", without_ros2);
  NativeEngine engine;
  const CheckReport report = check_system(system, engine, {});
  EXPECT_EQ(report.verdict, Verdict::inconclusive);
  EXPECT_EQ(report.properties.front().reason, "what camera.tick does is not known (do: unknown)");
}

TEST(Ros2System, OfBestEffortSaysSo) {
  const System system = parse_system(
      "topics: {image: {writers: camera, readers: detector, learn: ros2, with: {kind: topic, "
      "depth: "
      "unknown, reliability: best_effort}}}\n"
      "programs: {camera: \"image.write;\", detector: \"image.read -> message;\"}\n",
      "s.yaml", without_ros2);
  NativeEngine engine;
  EXPECT_THAT(
      check_system(system, engine, {}).assumptions,
      Contains(HasSubstr("image: what is sent arrives some time later, in order, or is lost")));
}

// A name that a node, a topic and a service have; nodes of two namespaces; two subscriptions.
TEST(Ros2System, NamesAreTheFilesOwn) {
  Ros2Graph graph;
  graph.nodes = {{"/a/scan", ""}, {"/b/scan", ""}, {"/scan", ""}};
  const Ros2End writer{"/scan", "T", {}}, reader{"/a/scan", "T", {}}, other{"/b/scan", "T", {}};
  graph.topics = {{"/scan", {writer}, {reader, reader, other}}, {"/a/scan", {other}, {writer}}};
  graph.services = {{"/scan", "S", {"/scan"}, {"/a/scan", "/a/scan"}, 3}};
  const std::string text = write_ros2_system(graph);
  const System system = parse_system(text, "s.yaml", [](const ModelRequest&) {
    return make_queue({10, true, {}});
  });
  ASSERT_EQ(system.topics.size(), 2U);
  EXPECT_EQ(system.topics[0].readers.size(), 3U);
  EXPECT_THAT(text, HasSubstr("[a_scan.on_scan_topic, a_scan.on_scan_topic_2, b_scan]"));
  EXPECT_THAT(text, HasSubstr("with: {depth: 3}"));
}

// Names that are none to YAML, and those of callbacks that a node's client has.
TEST(Ros2System, NamesAreWords) {
  const Ros2End null{"/null", "T", {}}, reader{"/b", "T", {}};
  Ros2Graph graph;
  graph.nodes = {{"/null", ""}, {"/b", ""}, {"/a", ""}};
  graph.topics = {{"/null", {null}, {reader}}, {"/chatter", {null}, {reader}}};
  graph.services = {{"/tick", "S", {"/b"}, {"/a"}, 3}, {"/on_chatter", "S", {"/a"}, {"/b"}, 3}};
  const System system = parse_system(write_ros2_system(graph), "s.yaml", [](const ModelRequest&) {
    return make_queue({10, true, {}});
  });
  EXPECT_EQ(system.topics.size(), 2U);
  EXPECT_EQ(system.services.size(), 2U);
}

// One publisher reaches both, the other one alone: two topics.
TEST(Ros2System, PublishersThatReachOthersAreTopicsOfTheirOwn) {
  Ros2Graph graph;
  Ros2End reliable{"/a", "T", {}}, quick{"/b", "T", {}}, strict{"/c", "T", {}}, lax{"/d", "T", {}};
  quick.qos.reliability = lax.qos.reliability = "best_effort";
  graph.topics = {{"/t", {reliable, quick}, {strict, lax}}};
  const std::string text = write_ros2_system(graph);
  EXPECT_THAT(text, HasSubstr("writers: a"));
  EXPECT_THAT(text, HasSubstr("t_2: {writers: b, readers: d"));
  EXPECT_THAT(text, HasSubstr("# /t: /b offers best_effort, and /c asks for reliable"));
  EXPECT_THAT(text, HasSubstr("# /t is several topics here"));
}

TEST(Ros2System, IsReadBackByTheDoctor) {
  const TempDir folder;
  const std::filesystem::path file = folder.path() / "s.yaml";
  write_file_atomically(file, write_ros2_system(graph()));
  const Ros2Graph read = read_ros2_file(file, kept_model_path, {});
  ASSERT_EQ(read.topics.size(), 3U);
  EXPECT_EQ(read.topics[0].name, "image");
  ASSERT_EQ(read.topics[0].subscriptions.size(), 2U);
  EXPECT_EQ(read.topics[0].subscriptions[0].node, "detector");
  EXPECT_FALSE(read.topics[0].subscriptions[0].qos.depth);
  EXPECT_EQ(read.topics[0].subscriptions[1].qos.depth, 5U);
  EXPECT_EQ(read.topics[0].subscriptions[1].qos.reliability, "best_effort");
  EXPECT_EQ(read.topics[2].publishers[0].qos.durability, "transient_local");
  EXPECT_EQ(read.services[0].clients.size(), 2U);
  EXPECT_FALSE(read.services[0].depth);
}

// Programs write values; a topic keeps what the middleware takes for its default.
TEST(Ros2System, OfValuesAndDefaultsIsReadByTheDoctor) {
  const TempDir folder;
  const std::filesystem::path file = folder.path() / "s.yaml";
  write_file_atomically(file, R"(topics:
  order: {writers: desk, readers: robot, learn: ros2, with: {kind: topic, history: system_default}}
programs:
  desk: "loop { order.write(go); order.write(halt); }"
  robot: "loop { order.read -> message(go); }"
)");
  EXPECT_THAT(findings_of(read_ros2_file(file, kept_model_path, {}), Ros2Finding::Kind::loss),
              ElementsAre(HasSubstr("order: robot keeps the newest messages, and nobody knows")));
}

TEST(Ros2System, OfALearnedServiceIsReadByTheDoctor) {
  const TempDir folder;
  const std::filesystem::path file = folder.path() / "s.yaml";
  write_file_atomically(file, R"(models:
  map: {learn: ros2, with: {kind: service, depth: 10}}
topics:
  order: {writers: desk, readers: robot, learn: ros2, with: {kind: topic, depth: 3}}
programs:
  desk: "order.write; map.send; map.receive -> answer;"
  robot: "order.read -> message;"
)");
  EXPECT_THAT(findings_of(read_ros2_file(file, kept_model_path, {}), Ros2Finding::Kind::loss),
              ElementsAre(HasSubstr("order: robot keeps the newest 3")));
}

ModelRequest topic(std::vector<std::pair<std::string, std::string>> with) {
  ModelRequest request;
  request.learn = "ros2";
  request.with = std::move(with);
  return request;
}

TEST(Ros2Unknown, IsTheSubscriptionsDepth) {
  EXPECT_TRUE(ros2_topic_of_unknown_depth(topic({{"depth", "unknown"}, {"kind", "topic"}})));
  EXPECT_TRUE(ros2_topic_of_unknown_depth(topic({{"depth", "3"}, {"sub_depth", "unknown"}})));
  EXPECT_FALSE(ros2_topic_of_unknown_depth(topic({{"depth", "3"}})));
  EXPECT_FALSE(ros2_topic_of_unknown_depth(topic({{"depth", "unknown"}, {"sub-depth", "3"}})));
  EXPECT_FALSE(ros2_topic_of_unknown_depth(topic({})));
  EXPECT_THROW(ros2_topic_of_unknown_depth(topic({{"depth", "unknown"}, {"take", "all"}})),
               UsageError);
  EXPECT_THROW(ros2_topic_of_unknown_depth(
                   topic({{"depth", "unknown"}, {"pub-reliability", "best_effort"}})),
               UsageError);
}

}  // namespace
}  // namespace maide
