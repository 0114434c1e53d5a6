#include "maide/check/build/deliveries.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/check/rules/system_options.hpp"

namespace maide {
namespace {

using Options = SystemOptions;

std::optional<std::uint32_t> number_of(const Options& options, const std::string& name) {
  const auto place = options.find(name);
  if (place == options.end()) return std::nullopt;
  const std::string& text = place->second;
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number == 0) return std::nullopt;
  return number;
}

bool is_dds(const Options& system) {
  return is(system, "", "ros2") || is(system, "", "cyclonedds") || is(system, "", "fastdds");
}
// The middleware, if it was measured to hand over within a process in the writer's own thread
// (docs/middleware/deliveries.md); "" otherwise. rclcpp over Fast DDS was not measured.
std::string hands_over_within_a_process(const Options& system) {
  if (is(system, "", "ros2")) return is(system, "rmw", "fastrtps") ? "" : "Cyclone DDS";
  if (is(system, "", "cyclonedds")) return "Cyclone DDS";
  if (is(system, "", "fastdds")) return is(system, "transport", "udp") ? "" : "Fast DDS";
  if (is(system, "", "zeromq")) {
    const bool is_inproc = !is(system, "transport", "tcp") && !is(system, "pattern", "req-rep");
    return is_inproc ? "ZeroMQ" : "";
  }
  return is(system, "", "ros1") && is(system, "transport", "intraprocess") ? "roscpp" : "";
}
bool is_of_middleware(const Options& system) {
  return is_dds(system) || is(system, "", "ros1") || is(system, "", "zeromq") ||
         is(system, "", "mqtt") || is(system, "", "yarp");
}

constexpr const char* said = "the file says so";
std::string handed_over_by(const std::string& middleware) {
  return "its ends are in one process, where " + middleware +
         " hands over in the writer's own thread";
}

constexpr std::uint32_t usual_depth = 10;

WireRules wire_of(const Options& system, const ModelOrigin& origin, const DeliveryWish& wish) {
  WireRules wire;
  const bool is_best_effort =
      std::ranges::any_of(std::array{"reliability", "pub-reliability", "sub-reliability"},
                          [&](const char* const end) { return is(system, end, "best_effort"); });
  wire.loses = wish.loses.value_or(wish.is_best_effort || is_best_effort);
  const bool keeps_all =
      wish.keeps_all || is(system, "pub-history", "keep_all") ||
      (is(system, "history", "keep_all") && !is(system, "pub-history", "keep_last"));
  if (keeps_all) return wire;
  if (wish.pub_depth) {
    wire.keep_last = *wish.pub_depth;
  } else if (origin.kind == ModelOrigin::Kind::queue) {
    if (origin.size.drops_oldest) {
      wire.keep_last = wish.has_depth ? wish.depth.value_or(origin.size.size) : usual_depth;
    }
  } else if (is_dds(system)) {
    const auto own = number_of(system, "pub-depth");
    wire.keep_last = own          ? *own
                     : wish.depth ? *wish.depth
                                  : number_of(system, "depth").value_or(usual_depth);
  }
  return wire;
}

}  // namespace

DeliveryRule delivery_of(const ModelInstance& model, const ModelOrigin& origin,
                         const DeliveryWish& wish, const DeliveryPlace& place) {
  const Options system = system_options_of(model);
  DeliveryRule rule{Delivery::late, wire_of(system, origin, wish), "", wish.stream};
  // A client of MQTT has one TCP connection.
  if (rule.stream.empty() && is(system, "", "mqtt")) rule.stream = "mqtt";
  const auto with = [&rule](Delivery delivery, std::string why) {
    rule.delivery = delivery;
    rule.why = std::move(why);
    return rule;
  };
  if (wish.delivery) return with(*wish.delivery, said);
  // A strict port that is written by hand has one: it says itself what it holds.
  const bool is_strict =
      origin.kind == ModelOrigin::Kind::queue && !origin.size.drops_oldest && !wish.pub_depth;
  if (is_strict) return with(Delivery::at_once, "");
  const std::string middleware = hands_over_within_a_process(system);
  if (place.is_in_one_process && !middleware.empty()) {
    return with(Delivery::at_once, handed_over_by(middleware));
  }
  if (is(system, "", "yarp")) {
    const bool is_late = is(system, "kind", "buffered") || is(system, "kind", "strict") ||
                         is(system, "carrier", "udp") || is(system, "carrier", "mcast") ||
                         is(system, "carrier", "fast_tcp");
    return is_late ? with(Delivery::late, "")
                   : with(Delivery::acknowledged, "YARP's writer waits for its readers");
  }
  if (place.is_topic || is_of_middleware(system)) return rule;
  return with(Delivery::at_once, "");
}

DeliveryRule delivery_of(const Service& service, const DeliveryWish& wish,
                         const DeliveryPlace& place) {
  DeliveryRule rule{Delivery::late, {service.depth, wish.loses.value_or(false)}, "", ""};
  const auto with = [&rule](Delivery delivery, std::string why) {
    rule.delivery = delivery;
    rule.why = std::move(why);
    return rule;
  };
  if (wish.delivery) return with(*wish.delivery, said);
  const bool is_cyclone = place.is_of_ros2 && !service.takes_one_by_one;
  if (place.is_in_one_process && is_cyclone) {
    return with(Delivery::at_once, handed_over_by("Cyclone DDS"));
  }
  return rule;
}

// ---- What the file says -------------------------------------------------------------------------

DeliveryWish read_delivery(const Declarations& file, const TreeNode& entry,
                           const std::map<std::string, std::string>& options) {
  DeliveryWish wish;
  if (const TreeNode* const delivery = entry.find("delivery")) {
    wish.delivery = delivery->is("late")      ? Delivery::late
                    : delivery->is("at_once") ? Delivery::at_once
                                              : Delivery::acknowledged;
  }
  const TreeNode* const loses = entry.find("loses");
  if (loses != nullptr) wish.loses = loses->is("true");
  if (const TreeNode* const stream = entry.find("stream")) wish.stream = stream->text();
  wish.pub_depth = number_of(options, "pub-depth");
  if (options.contains("pub-depth") && !wish.pub_depth && options.at("pub-depth") != "both" &&
      entry.find("use") != nullptr) {
    file.tree().fail("'pub-depth' is a number of at least 1", *entry.find("with"));
  }
  wish.depth = number_of(options, "depth");
  wish.has_depth = options.contains("depth");
  wish.keeps_all = is(options, "pub-history", "keep_all");
  wish.is_best_effort =
      std::ranges::any_of(std::array{"reliability", "pub-reliability", "sub-reliability"},
                          [&](const char* const end) { return is(options, end, "best_effort"); });
  return wish;
}

std::string process_of(const TreeNode& entry, const std::string& name) {
  const TreeNode* const process = entry.is_map() ? entry.find("process") : nullptr;
  return process == nullptr ? "one of " + name : "process " + process->text();
}

std::string process_of_end(const Declarations& file, const End& end) {
  if (end.node.empty()) return file.programs[end.program].process;
  for (const ProgramDeclaration& program : file.programs) {
    if (std::ranges::find(program.nodes, end.node) != program.nodes.end()) return program.process;
  }
  return "";
}

std::vector<std::uint32_t> programs_at(const Declarations& file, const End& end) {
  if (end.node.empty()) return {end.program};
  std::vector<std::uint32_t> programs;
  for (std::uint32_t number = 0; number < file.programs.size(); ++number) {
    const auto& nodes = file.programs[number].nodes;
    if (std::ranges::find(nodes, end.node) != nodes.end()) programs.push_back(number);
  }
  return programs;
}

}  // namespace maide
