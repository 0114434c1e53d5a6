#include "dds/wrapper_table.hpp"

#include <utility>

namespace maide::dds {
namespace {

// keep_last and max-samples bound themselves; only keep_all alone needs a bound to be learned.
OptionSpec size_row() {
  OptionSpec row = common_options::size(0, 1000);
  row.least = 0;
  row.help += "; 0: no bound but the QoS";
  return row;
}

}  // namespace

std::vector<OptionSpec> option_table() {
  std::vector<OptionSpec> table = Policies::options();
  for (OptionSpec& row : std::vector<OptionSpec>{
           common_options::inputs({"write", "read", "tryread", "disconnect", "connect"}),
           common_options::observe({"message", "null", "written", "failed", "unconnected"}),
           common_options::payload(),
           size_row(),
           common_options::at_bound(),
       }) {
    table.push_back(std::move(row));
  }
  for (OptionSpec& row : common_options::ends()) table.push_back(std::move(row));
  return table;
}

EndCounts end_counts(const OptionValues& options) {
  return {static_cast<std::size_t>(options.number("writers")),
          static_cast<std::size_t>(options.number("readers"))};
}

SystemSetup make_setup(const Policies& policies, const OptionValues& options) {
  SystemSetup setup;
  setup.actors = {"writer", "reader"};
  setup.inputs = {{"write", "writer", {}},
                  {"read", "reader", {"message"}},
                  {"tryread", "reader", {}},
                  {"disconnect", "reader", {}},
                  {"connect", "reader", {}}};
  if (disconnects(options)) setup.inputs[1].returns.push_back("unconnected");
  if (policies.write_may_block()) setup.inputs[0].returns = {"written"};
  setup.events = {{"message", "reader"},
                  {"null", "reader"},
                  {"unconnected", "reader"},
                  {"written", "writer"},
                  {"failed", "writer"}};
  setup.messages_come_again = policies.keeps_for_late_readers();
  if (options.number("size") > 0) setup.in_flight.emplace().capacity = policies.capacity();
  return setup;
}

}  // namespace maide::dds
