// C++ sources of ROS 2 nodes as a system file. What has no rule is a hole, and said.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/extract/front_end.hpp"
#include "maide/extract/model.hpp"

namespace maide::extract {

struct ExtractOptions {
  FrontEndOptions front_end;
  std::vector<std::string> tables;  // beside Maide's own
  bool is_closed = false;           // nobody else writes, asks or serves
  bool assumes_ok = false, assumes_exceptions = false;
  bool assumes_read = false;   // that the reader lost nothing without a word
  std::size_t most_holes = 0;  // kinds of them that the file names; 0: all
  std::string executor;        // of nodes that nothing runs: `single`, `multi:4`; empty: a constant
};

struct Extracted {
  std::string system, holes_file;  // YAML
  std::vector<Hole> holes;
  std::vector<std::string> assumptions;  // that nobody made, and without which it may be wrong
  std::vector<std::string> notes;        // what it takes for granted as all do
  std::size_t files = 0, nodes = 0;
  std::vector<std::string> constants;  // numbers of threads that nothing tells
  std::map<Place, std::string> lines;  // of the sources, where holes are
  bool is_whole() const { return holes.empty() && assumptions.empty(); }
};

// Throws UsageError and Interrupted as read_sources() does.
Extracted extract_system(const std::vector<std::string>& arguments, const ExtractOptions& options,
                         const RunControl& control);

}  // namespace maide::extract
