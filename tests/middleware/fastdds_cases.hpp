// Configurations of Fast DDS, and the model that each must have: those of Cyclone DDS, but for a
// full reliable reader.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "cyclonedds_cases.hpp"

namespace maide::test {

// keep_all with a limit of `n` at both ends, reliable. Over UDP the writer's n and the reader's n
// add up. Within the process what the reader has refused once stays with the writer for good.
inline CycloneDdsCase full_reliable(std::size_t n, bool waits, bool udp) {
  SystemOptions options{
      {"history", "keep_all"}, {"max-samples", std::to_string(n)}, {"reliability", "reliable"}};
  if (!waits) {
    options["max-blocking-time"] = "0";
    options["observe"] = "message,null,failed";
  }
  if (udp) options["transport"] = "udp";
  CycloneDdsCase made{std::string(waits ? "blocking" : "failing") + "_max_samples_" +
                          std::to_string(n) + (udp ? "_udp" : ""),
                      with_tryread(options, true),
                      {udp ? 2 * n : n, waits ? WhenFull::block : WhenFull::fail, true},
                      udp ? 2 * n + (waits ? 2 : 1) : (n + 1) * (n + (waits ? 2 : 1))};
  if (!udp) made.model.stranded = n;
  return made;
}

inline std::vector<CycloneDdsCase> fastdds_cases() {
  std::vector<CycloneDdsCase> all = cyclonedds_cases();
  std::erase_if(all, [](const CycloneDdsCase& each) {
    return each.name.starts_with("blocking") || each.name.starts_with("failing");
  });
  for (std::size_t n = 1; n <= 3; ++n) {
    for (const bool waits : {true, false}) all.push_back(full_reliable(n, waits, false));
  }
  return all;
}

inline std::vector<CycloneDdsCase> fastdds_udp_cases() {
  std::vector<CycloneDdsCase> all = cyclonedds_udp_cases();
  for (const bool waits : {true, false}) all.push_back(full_reliable(1, waits, true));
  return all;
}

}  // namespace maide::test
