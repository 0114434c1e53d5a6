// What a DDS wrapper says of itself and of its system, whatever the vendor: the same options,
// actors, inputs and events, so that models of two vendors can be compared.
#pragma once

#include <vector>

#include "dds/dds_connection.hpp"
#include "dds/policies.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"

namespace maide::dds {

// The QoS policies and the options of common_options that mean something here.
std::vector<OptionSpec> option_table();

EndCounts end_counts(const OptionValues& options);

SystemSetup make_setup(const Policies& policies, const OptionValues& options);

}  // namespace maide::dds
