// Table 2 of "Reverse Engineering of Middleware for Verification of Robot Control Architectures"
// (Khalili, Natale, Tacchella, SIMPAR 2014) as data: the systems of its two case studies, and what
// SPIN found there. The models are learned; the programs are those of the paper's Figures 1 and 2.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/engine.hpp"

namespace maide {

// What the paper's table says of a system: SPIN on a 2.26 GHz Core 2 Duo.
struct PaperCheckingRow {
  std::string states;  // in the paper's precision: "19M"
  double seconds = 0;
  std::uint64_t megabytes = 0;
};

// A system of ours, and the paper's row beside it.
struct CheckedRow {
  std::string name;                       // the paper's columns
  std::optional<PaperCheckingRow> paper;  // none: the paper has no such row
  Verdict expected = Verdict::holds;      // on deadlocks; with a row, the paper's conclusion
  std::string system;                     // the text of the system file
};

// Both halves of the table, in its order; then its last row with the other way of meeting a full
// queue.
std::vector<CheckedRow> table2_rows();

// How the models that the rows' systems `learn:` are learned from a system of ours: the options, by
// the model's name. Throws UsageError for a system that is not among table2_systems().
std::map<std::string, std::map<std::string, std::string>> table2_models(const std::string& system);

// The systems of Table 1 from which all of the models can be learned.
std::vector<std::string> table2_systems();

}  // namespace maide
