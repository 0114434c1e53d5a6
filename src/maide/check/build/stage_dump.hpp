// Dumps: what each stage of reading a system file hands on, written out, and read again.
//
//   tree    The file, in one style.
//   names   The file, and what each of its names is.
//   models  Names, and the automata that were read or learned. Whoever has them needs no wrapper.
//   system  Programs, models and properties as the search sees them.
//
// The dump of the tree is a system file. The others are JSON, which read_system() and
// parse_system() take where a system file may stand. They have the text of the file, so places in
// messages are those of the file. Built-in models and services are their names and options, for
// they are made anew. What is found anew when a dump is read must be what the dump has. The order
// of members counts nowhere. A dump may have hundreds of megabytes: whatever writes or reads one
// hears of its control.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/build/model_source.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

enum class Stage : std::uint8_t { tree, names, models, system };
// By its name; none is called so.
std::optional<Stage> find_stage(std::string_view name);

// The dump of a stage of that file, or of the file that a dump was made from. Only `models` and
// `system` ask `source`, and not for models that the dump has. Throws what parse_system() throws.
// O(what is dumped).
std::string dump_stage(Stage stage, std::string_view text, const std::string& file,
                       const ModelSource& source, const RunControl& control = {},
                       const std::vector<ConstantSetting>& settings = {});

// The text is a dump of names, models or a system: an object of JSON that says its stage, wherever
// among its members.
bool is_stage_dump(std::string_view text);
// The system that the dump leads to. Throws ParseError for a dump that was changed, or that another
// version wrote; UsageError for settings that are not the dump's own; and what parse_system()
// throws.
System parse_stage_dump(std::string_view text, const std::string& file, const ModelSource& source,
                        const RunControl& control = {},
                        const std::vector<ConstantSetting>& settings = {});

}  // namespace maide
