#include "maide/check/pan_output.hpp"

#include <cstdlib>
#include <sstream>

namespace maide {
namespace {

bool contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

// The number at the start of the line, if `rest` follows it.
bool read_count(const std::string& line, const char* rest, std::uint64_t& count) {
  if (!contains(line, rest)) return false;
  char* end = nullptr;
  const double value = std::strtod(line.c_str(), &end);  // large counts come as 1.9867e+06
  if (end == line.c_str() || value < 0) return false;
  count = static_cast<std::uint64_t>(value);
  return true;
}

}  // namespace

std::optional<PanOutput> parse_pan_output(const std::string& text) {
  PanOutput output;
  bool has_errors = false, has_states = false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t errors = line.find("errors: ");
    if (errors != std::string::npos && line.starts_with("State-vector")) {
      output.errors = std::strtoull(line.c_str() + errors + 8, nullptr, 10);
      has_errors = true;
    } else if (read_count(line, "states, stored", output.states)) {
      has_states = true;
    } else if (read_count(line, "transitions (=", output.transitions)) {
    } else if (contains(line, "total actual memory usage")) {
      output.peak_bytes =
          static_cast<std::uint64_t>(std::strtod(line.c_str(), nullptr) * 1024 * 1024);
    } else if (line.starts_with("pan:") && contains(line, "(at depth")) {
      if (output.first_error.empty()) output.first_error = line.substr(line.find(' ') + 1);
    }
  }
  output.is_depth_truncated = contains(text, "max search depth too small");
  output.is_memory_exhausted = contains(text, "reached -DMEMLIM bound") ||
                               contains(text, "out of memory") || contains(text, "cannot allocate");
  output.is_complete = has_errors && has_states && !output.is_depth_truncated &&
                       !output.is_memory_exhausted && !contains(text, "Search not completed") &&
                       !contains(text, "hash-compact") && !contains(text, "Bit statespace search");
  if (!has_errors && !output.is_memory_exhausted) return std::nullopt;
  return output;
}

}  // namespace maide
