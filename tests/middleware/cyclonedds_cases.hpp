// Configurations of Cyclone DDS, and the model that each must have over write and tryread.
#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "connection_models.hpp"
#include "wrapper_checks.hpp"

namespace maide::test {

struct CycloneDdsCase {
  std::string name;
  SystemOptions options;
  ConnectionModel model;
  std::size_t states;  // of the minimal machine
};

inline void PrintTo(const CycloneDdsCase& tested, std::ostream* out) { *out << tested.name; }

inline SystemOptions with_tryread(SystemOptions options, bool gap) {
  options["inputs"] = "write,tryread";
  options["payload"] = gap ? "gap" : "none";
  options.try_emplace("observe", "message,null");
  return options;
}

// A reader that is deleted and made anew, with what the writer keeps for it.
inline CycloneDdsCase reconnecting(const std::string& durability, bool gap, std::size_t states) {
  CycloneDdsCase made{durability + (gap ? "_gap" : ""),
                      {{"depth", "2"},
                       {"reliability", "reliable"},
                       {"durability", durability},
                       {"inputs", "write,tryread,disconnect,connect"},
                       {"payload", gap ? "gap" : "none"},
                       {"observe", "message,null,unconnected"}},
                      {2, WhenFull::drop_oldest, gap, true},
                      states};
  if (durability == "transient_local") made.model.replayed = 2;
  made.model.read_alone = "unconnected";
  return made;
}

inline std::vector<CycloneDdsCase> cyclonedds_cases() {
  std::vector<CycloneDdsCase> all{
      {"defaults", with_tryread({}, false), {1, WhenFull::drop_oldest, false}, 2}};
  // What keep_last drops does not depend on the reliability.
  for (const std::string reliability : {"default", "best_effort"}) {
    all.push_back({"keep_last_2_" + reliability,
                   with_tryread({{"depth", "2"}, {"reliability", reliability}}, true),
                   {2, WhenFull::drop_oldest, true},
                   4});
  }
  for (std::size_t n = 1; n <= 4; ++n) {
    const std::string depth = std::to_string(n);
    all.push_back({"keep_last_" + depth,
                   with_tryread({{"depth", depth}, {"reliability", "reliable"}}, true),
                   {n, WhenFull::drop_oldest, true},
                   n + 2});
    if (n == 4) break;
    all.push_back({"best_effort_max_samples_" + depth,
                   with_tryread({{"history", "keep_all"}, {"max-samples", depth}}, true),
                   {n, WhenFull::drop_newest, true},
                   (std::size_t{1} << (n + 2)) - 2});
    SystemOptions reliable{
        {"history", "keep_all"}, {"max-samples", depth}, {"reliability", "reliable"}};
    all.push_back({"blocking_max_samples_" + depth,
                   with_tryread(reliable, true),
                   {n, WhenFull::block, true},
                   n + 2});
    reliable["max_blocking_time"] = "0";
    reliable["observe"] = "message,null,failed";
    all.push_back({"failing_max_samples_" + depth,
                   with_tryread(reliable, true),
                   {n, WhenFull::fail, true},
                   n + 1});
  }
  all.push_back(reconnecting("volatile", false, 4));
  all.push_back(reconnecting("volatile", true, 8));
  all.push_back(reconnecting("transient_local", false, 9));
  all.push_back(reconnecting("transient_local", true, 18));
  // A best-effort reader, which is the default, gets nothing of what the writer keeps.
  CycloneDdsCase best_effort = reconnecting("transient_local", true, 8);
  best_effort.name = "transient_local_gap_best_effort";
  best_effort.options.erase("reliability");
  best_effort.model.replayed = 0;
  all.push_back(std::move(best_effort));
  return all;
}

// The same over the network, where models are the same once both ends know each other: all but a
// full reliable reader, for which the protocol's buffers wait.
inline std::vector<CycloneDdsCase> cyclonedds_udp_cases() {
  std::vector<CycloneDdsCase> chosen;
  for (CycloneDdsCase& each : cyclonedds_cases()) {
    for (const char* name :
         {"keep_last_2_default", "keep_last_2", "best_effort_max_samples_2", "volatile_gap",
          "transient_local_gap", "transient_local_gap_best_effort"}) {
      if (each.name != name) continue;
      each.name += "_udp";
      each.options["transport"] = "udp";
      chosen.push_back(std::move(each));
      break;
    }
  }
  return chosen;
}

}  // namespace maide::test
