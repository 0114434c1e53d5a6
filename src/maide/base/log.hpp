// What a program says while it works, on standard error, one line a message: "maide: warning: ...".
// Results never go here, nor do the errors that end a program.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace maide {

enum class LogLevel : std::uint8_t {
  quiet,    // warnings only (-q)
  normal,   // and notes
  verbose,  // and details (-v)
};

// Names the program in every line and sets what is said. Without a call: "maide", normal.
void set_up_log(const std::string& program, LogLevel level);

void log_warning(std::string_view message);  // something may be wrong
void log_note(std::string_view message);     // worth knowing
void log_detail(std::string_view message);   // for those who asked with -v

}  // namespace maide
