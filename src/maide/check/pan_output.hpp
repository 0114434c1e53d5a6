// What SPIN's verifier `pan` prints, as far as verdicts need it. Nothing that it does not plainly
// say counts as a complete search.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace maide {

struct PanOutput {
  std::uint64_t errors = 0;
  std::uint64_t states = 0;  // stored
  std::uint64_t transitions = 0;
  std::uint64_t peak_bytes = 0;
  std::string first_error;          // "invalid end state (at depth 18)"
  bool is_depth_truncated = false;  // "max search depth too small"
  bool is_memory_exhausted = false;
  // The search ran to its end, and no limit cut a part of it off.
  bool is_complete = false;
};

// Nothing if the text is not the output of a verifier that came to its end.
std::optional<PanOutput> parse_pan_output(const std::string& text);

}  // namespace maide
