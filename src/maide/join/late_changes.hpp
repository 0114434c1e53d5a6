// Changes of a system file that help where a message comes too late: waiting until it has arrived,
// asking for it again, waiting for it in place of one look, asking the server again, a writer that
// keeps more messages. Each is the file's text with the change in it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/system/system.hpp"

namespace maide {

struct LateChange {
  std::string connection;      // that is helped
  std::string text;            // of the whole file
  std::string description;     // "`wait map -> arrived;` behind `map.write;` in line 7"
  bool is_of_several = false;  // places at once: only where none of them alone is enough
};

// Those at connections whose messages arrive late, in the order of the file; those at a writer come
// before those at a reader. Last two connections between the same programs as one that keeps the
// order, as when data and notice are one message: at most ten pairs. None of a file whose text is
// not known.
std::vector<LateChange> list_late_changes(const System& system);

// How many messages a writer keeps (`pub-depth`) that are on their way: of a topic or model with
// late messages whose queue is written by hand or read from a file.
struct WriterDepth {
  std::string section, name;  // "topics", "map"
  std::int64_t value = 0;
};
// Those whose value is known at once, in the order of the file.
std::vector<WriterDepth> find_writer_depths(const System& system);
struct ChangedText {
  std::string text;   // of the whole file
  std::string lines;  // what is new in it: "topics: {map: {with: {pub-depth: 4}}}"
};
ChangedText with_writer_depth(const System& system, const WriterDepth& place, std::int64_t value);

}  // namespace maide
