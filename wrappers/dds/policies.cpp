#include "dds/policies.hpp"

#include <algorithm>
#include <string>

#include "maide/base/error.hpp"

namespace maide::dds {

namespace {

std::vector<OptionSpec> rows_of_both() {
  return {
      OptionSpec::choice("history", "keep_last", {"keep_last", "keep_all"},
                         "QoS of both ends: what is kept for the reader; DDS's default")
          .keeping_more_with("keep_all"),
      OptionSpec::integer("depth", 1, 1, 1000, "samples that keep_last keeps; DDS's default")
          .keeping_more_with("+"),
      OptionSpec::choice("reliability", "default", {"default", "reliable", "best_effort"},
                         "QoS of both ends; by DDS's default the writer is reliable, the reader "
                         "best_effort")
          .keeping_more_with("reliable"),
      OptionSpec::choice("durability", "default", {"default", "volatile", "transient_local"},
                         "QoS of both ends; transient_local: a reader that connects gets what the "
                         "writer keeps")
          .keeping_more_with("transient_local"),
  };
}

EndPolicies end_from(const OptionValues& options, const std::string& prefix,
                     const EndPolicies& defaults) {
  EndPolicies end = defaults;
  end.keep_all = options.of_end(prefix, "history") == "keep_all";
  end.depth = static_cast<std::int32_t>(std::stoi(options.of_end(prefix, "depth")));
  const std::string& reliability = options.of_end(prefix, "reliability");
  if (reliability != "default") end.reliable = reliability == "reliable";
  const std::string& durability = options.of_end(prefix, "durability");
  if (durability != "default") end.transient_local = durability == "transient_local";
  if (end.keep_all && end.depth != 1) {
    throw UsageError("option depth: it means nothing with history=keep_all");
  }
  return end;
}

}  // namespace

std::vector<OptionSpec> Policies::options() {
  std::vector<OptionSpec> rows = common_options::with_each_end(rows_of_both());
  rows.push_back(OptionSpec::integer("max-samples", 0, 0, 1000,
                                     "resource limit of keep_all, 0 for none; DDS's default"));
  rows.push_back(
      OptionSpec::choice("max-blocking-time", "infinite", {"infinite", "0"},
                         "how long a reliable write waits for room before it fails (DDS's default "
                         "is 100 ms, but time is not modelled)"));
  return rows;
}

Policies Policies::from(const OptionValues& options, const VendorDefaults& defaults) {
  Policies policies;
  policies.writer =
      end_from(options, "pub-", {.transient_local = defaults.writer_is_transient_local});
  policies.reader = end_from(options, "sub-", {.reliable = false});
  policies.max_samples = static_cast<std::int32_t>(options.number("max-samples"));
  policies.write_waits = options.is("max-blocking-time", "infinite");

  const bool limited = policies.max_samples > 0;
  if (!policies.reader.keep_all && limited) {
    throw UsageError("option max-samples: it needs history=keep_all");
  }
  if (policies.reader.keep_all && !limited && options.number("size") == 0) {
    throw UsageError(
        "option history: keep_all grows without limit, so say size=N (messages in flight to try) "
        "or max-samples=N");
  }
  if (disconnects(options) && options.number("size") > 0) {
    throw UsageError(
        "option size: it counts messages in flight, and disconnect loses some; say max-samples=N "
        "or keep_last");
  }
  return policies;
}

bool disconnects(const OptionValues& options) {
  const std::vector<std::string> inputs = options.list("inputs");
  return std::find(inputs.begin(), inputs.end(), "disconnect") != inputs.end();
}

std::size_t Policies::capacity() const {
  if (!reader.keep_all) return static_cast<std::size_t>(reader.depth);
  if (max_samples == 0) return 0;
  return static_cast<std::size_t>(max_samples) + (write_may_block() ? 1 : 0);
}

}  // namespace maide::dds
