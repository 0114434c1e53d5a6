// The system that a model was learned from, with its options, as the model names it.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "maide/check/system/system.hpp"

namespace maide {

// Of "ros2 depth=10 rmw=cyclonedds": "ros2" under "", and the values of depth and rmw. Empty: the
// model does not say what it is of.
using SystemOptions = std::map<std::string, std::string>;
SystemOptions system_options_of(const ModelInstance& model);
bool is(const SystemOptions& options, const std::string& name, std::string_view value);
// It is of ROS 2 over Fast DDS.
bool is_over_fast_dds(const ModelInstance& model);

}  // namespace maide
