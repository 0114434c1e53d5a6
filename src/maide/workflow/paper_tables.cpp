#include "maide/workflow/paper_tables.hpp"

#include <fmt/format.h>

#include "maide/base/error.hpp"

namespace maide {
namespace {

using Options = std::map<std::string, std::string>;

const PaperLearningRow plain_port{"port", 4, 5, 18, 1, 33, 0.6};
const PaperLearningRow buffered{"buffered port (non-strict)", 4, 6, 35, 2, 50, 1.0};
const PaperLearningRow strict{"buffered port (strict)", 8, 11, 132, 4, 180, 2.0};
const PaperLearningRow buffered_tryread{"buffered port (non-strict)*", 4, 8, 63, 2, 114, 2.5};
const PaperLearningRow strict_tryread{"buffered port (strict)*", 8, 16, 224, 4, 323, 12.0};

const std::vector<PaperLearningRow>& rows_by_size() {
  static const std::vector<PaperLearningRow> rows{
      {"strict, size 1", 4, 5, 18, 1, 32, 1.0},      {"strict, size 2", 6, 8, 54, 3, 86, 2.1},
      {"strict, size 3", 8, 11, 132, 4, 180, 2.0},   {"strict, size 4", 10, 14, 225, 6, 260, 10.0},
      {"strict, size 5", 12, 17, 504, 7, 396, 17.0}, {"strict, size 6", 14, 20, 987, 8, 531, 31.0}};
  return rows;
}

Options with(Options base, const Options& more) {
  base.insert(more.begin(), more.end());
  return base;
}

// The paper drew a non-blocking read's refused writes as self-loops: at-bound=absorb.
const Options tryread{{"inputs", "write,read,tryread"}, {"at-bound", "absorb"}};

std::vector<ReproducedRow> port_rows() {
  const Options newest{{"kind", "buffered"}};
  const Options all{{"kind", "strict"}, {"size", "3"}};
  std::vector<ReproducedRow> rows{{plain_port, {{"kind", "port"}}},
                                  {buffered, newest},
                                  {strict, all},
                                  {buffered_tryread, with(newest, tryread)},
                                  {strict_tryread, with(all, tryread)}};
  std::size_t size = 0;
  for (const PaperLearningRow& row : rows_by_size()) {
    rows.push_back({row, {{"kind", "strict"}, {"size", std::to_string(++size)}}});
  }
  return rows;
}

// The two buffered ports: `newest` keeps the newest message, `all` and a `size` every one.
std::vector<ReproducedRow> buffered_rows(const Options& newest, const Options& all) {
  const Options three = with(all, {{"size", "3"}});
  std::vector<ReproducedRow> rows;
  if (!newest.empty()) rows.push_back({buffered, newest});
  rows.push_back({strict, three});
  if (!newest.empty()) rows.push_back({buffered_tryread, with(newest, tryread)});
  rows.push_back({strict_tryread, with(three, tryread)});
  std::size_t size = 0;
  for (const PaperLearningRow& row : rows_by_size()) {
    rows.push_back({row, with(all, {{"size", std::to_string(++size)}})});
  }
  return rows;
}

struct BufferedSystem {
  std::string name;
  Options newest;  // empty: there is no such configuration
  Options all;
};

const std::vector<BufferedSystem>& buffered_systems() {
  static const std::vector<BufferedSystem> systems{
      {"cyclonedds", {{"history", "keep_last"}, {"depth", "1"}}, {{"history", "keep_all"}}},
      {"fastdds", {{"history", "keep_last"}, {"depth", "1"}}, {{"history", "keep_all"}}},
      {"zeromq", {{"conflate", "yes"}}, {{"conflate", "no"}}},
      {"ros1", {{"queue_size", "1"}}, {{"queue_size", "0"}}},
      {"mqtt", {}, {{"qos", "0"}}},
  };
  return systems;
}

}  // namespace

std::vector<ReproducedRow> table1_rows(const std::string& system) {
  if (system == "yarp" || system == "port") return port_rows();
  for (const BufferedSystem& known : buffered_systems()) {
    if (system == known.name) return buffered_rows(known.newest, known.all);
  }
  throw UsageError(fmt::format("table 1 has no rows for '{}'; there are rows for {}", system,
                               fmt::join(table1_systems(), ", ")));
}

std::vector<std::string> table1_systems() {
  std::vector<std::string> names{"yarp", "port"};
  for (const BufferedSystem& known : buffered_systems()) names.push_back(known.name);
  return names;
}

}  // namespace maide
