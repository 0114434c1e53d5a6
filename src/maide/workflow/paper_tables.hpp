// The tables of "Reverse Engineering of Middleware for Verification of Robot Control Architectures"
// (Khalili, Natale, Tacchella, SIMPAR 2014) as data: what was learned there, what it cost there,
// and which system of ours it corresponds to.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace maide {

// A row of Table 1: a configuration of a YARP port, learned with L*M+ on a 2.26 GHz Core 2 Duo.
struct PaperLearningRow {
  std::string configuration;  // the paper's words; "*" marks rows with a non-blocking read
  std::size_t states = 0, transitions = 0;
  std::uint64_t output_queries = 0, equivalence_queries = 0, experiments = 0;
  double thousand_seconds = 0;
};

// A row of ours beside it.
struct ReproducedRow {
  PaperLearningRow paper;
  std::map<std::string, std::string> options;  // of the system that is learned here
};

// Table 1 (top and bottom) on a system of ours: "yarp", the paper's, and "port" have a counterpart
// of every row, other middlewares of the buffered ones. Throws UsageError for other systems.
std::vector<ReproducedRow> table1_rows(const std::string& system);

// The systems that have rows.
std::vector<std::string> table1_systems();

}  // namespace maide
