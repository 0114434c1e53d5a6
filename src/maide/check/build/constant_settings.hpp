// Other values for constants of a system file, `maide check --set n=5`: the file's text is changed
// before it is read. So all that is made of it has these values: models, programs, suggestions,
// exports, what a report shows. Places are those of the file, but for what stands behind a constant
// in its line.
#pragma once

#include <string>
#include <vector>

#include "maide/check/system/system.hpp"

namespace maide {

// Of "n=5". Throws UsageError for another text, and for a constant that comes twice.
std::vector<ConstantSetting> parse_settings(const std::vector<std::string>& texts);

// The text of the system file with these values of its constants. Throws UsageError for a name that
// is no constant's, and a value that is no number of 64 bits, nor `true` or `false`; ParseError for
// what is no system file.
std::string with_settings(const std::string& text, const std::string& file,
                          const std::vector<ConstantSetting>& settings);

}  // namespace maide
