// Small helpers over nlohmann::json: parsing with a position in the error, and writing that cannot
// fail. Headers include this file (it only declares the type); a source that reads or builds values
// includes <nlohmann/json.hpp> itself.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "maide/base/run_control.hpp"

namespace maide {

// Objects keep the order in which their members were added, so that output reads as it was meant.
using Json = nlohmann::ordered_json;

// Parses one JSON value. `file` names the text in errors. Throws ParseError (file:line:column), and
// Interrupted when `control` says stop.
Json parse_json(std::string_view text, const std::string& file, const RunControl& control = {});
// The same for what does not keep the order of members.
nlohmann::json parse_sorted_json(std::string_view text, const std::string& file,
                                 const RunControl& control = {});

// The value on one line, without a newline. Bytes that are not UTF-8 become U+FFFD.
std::string to_json_line(const Json& value);

}  // namespace maide
