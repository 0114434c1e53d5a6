// Where the programs `maide-wrap-<middleware>` are found: beside the running program, then in
// ../libexec/maide from there, then on PATH.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace maide {

// The program of the wrapper called `name` ("cyclonedds"), or nothing if it is nowhere. A name that
// is not made of letters, digits, '_' and '-' is nowhere.
std::optional<std::filesystem::path> find_wrapper(std::string_view name);

// The program called `name`, as a shell would find it on PATH (`name` has no '/').
std::optional<std::filesystem::path> find_on_path(std::string_view name);

// The names of all wrappers that can be found, in alphabetical order.
std::vector<std::string> list_wrappers();

// For error messages: the wrappers that could be found, and where they were looked for.
std::string describe_wrapper_search();

}  // namespace maide
