#include "maide/workflow/paper_checks.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "maide/base/error.hpp"
#include "maide/workflow/paper_tables.hpp"

namespace maide {
namespace {

// A planner sends a burst of via points and waits for one acknowledgement (Figure 1).
std::string case_study_1(const std::string& via, int burst) {
  return fmt::format(R"(models:
  via:  {{learn: {0}}}
  sync: {{learn: buffered}}
programs:
  planner: |
    loop {{
      repeat {1} {{ via.write; }}
      sync.read -> message;
    }}
  controller: |
    loop {{
      repeat {1} {{ via.read -> message; }}
      sync.write;
    }}
)",
                     via, burst);
}

// Two producers, and a consumer that needs a message of each (Figure 2).
std::string case_study_2(const std::string& q1, const std::string& q2, int n1, int n2, int n3,
                         const std::string& read) {
  return fmt::format(R"(models:
  q1: {{learn: {}}}
  q2: {{learn: {}, when_unexplored: wait}}
programs:
  p1: "repeat {} {{ q1.write; }}"
  p2: "repeat {} {{ q2.write; }}"
  p3: "repeat {} {{ {} q2.read -> message; }}"
)",
                     q1, q2, n1, n2, n3, read);
}

CheckedRow blocking(int n1, int n2, int n3, int size, PaperCheckingRow paper) {
  const std::string queue = fmt::format("strict-{}", size);
  return {
      fmt::format("N {}/{}/{}, size {}", n1, n2, n3, size), paper,
      n1 < n3 ? Verdict::violated : Verdict::holds,
      case_study_2(queue + ", when_unexplored: wait", queue, n1, n2, n3, "q1.read -> message;")};
}

CheckedRow nonblocking(const std::string& at_full, std::optional<PaperCheckingRow> paper,
                       Verdict expected) {
  return {fmt::format("N 90*/100/100, size 6{}", paper ? "" : ", waits"), std::move(paper),
          expected,
          case_study_2("strict-6-tryread, when_unexplored: " + at_full, "strict-6", 90, 100, 100,
                       "switch q1.tryread { message {} quiet {} }")};
}

}  // namespace

std::vector<CheckedRow> table2_rows() {
  return {
      {"non-strict", {{"38", 0.01, 128}}, Verdict::violated, case_study_1("buffered", 6)},
      {"strict, N=1", {{"15K", 0.04, 129}}, Verdict::holds, case_study_1("strict-1", 1)},
      {"strict, N=6", {{"42K", 0.09, 132}}, Verdict::holds, case_study_1("strict-6", 6)},
      blocking(100, 100, 100, 1, {"8K", 0.02, 129}),
      blocking(90, 100, 100, 1, {"790", 0.01, 128}),
      blocking(100, 100, 100, 6, {"128K", 0.33, 140}),
      blocking(90, 100, 100, 6, {"1930", 0.02, 128}),
      blocking(200, 200, 200, 6, {"519K", 3.29, 176}),
      blocking(180, 200, 200, 6, {"3820", 0.04, 129}),
      nonblocking("drop", PaperCheckingRow{"19M", 91.00, 1300}, Verdict::holds),
      nonblocking("wait", std::nullopt, Verdict::violated),
  };
}

std::map<std::string, std::map<std::string, std::string>> table2_models(const std::string& system) {
  const std::vector<ReproducedRow> learned = table1_rows(system);
  const auto options_of = [&](const std::string& configuration) {
    for (const ReproducedRow& row : learned) {
      if (row.paper.configuration == configuration) return row.options;
    }
    throw UsageError(fmt::format("'{}' cannot be a {}; table 2 is there on {}", system,
                                 configuration, fmt::join(table2_systems(), ", ")));
  };
  std::map<std::string, std::map<std::string, std::string>> models{
      {"buffered", options_of("buffered port (non-strict)")},
      {"strict-1", options_of("strict, size 1")},
      {"strict-6", options_of("strict, size 6")}};
  models["strict-6-tryread"] = models["strict-6"];
  models["strict-6-tryread"]["inputs"] = "write,read,tryread";
  return models;
}

std::vector<std::string> table2_systems() {
  std::vector<std::string> systems = table1_systems();
  std::erase(systems, "mqtt");  // its queues drop what is newest
  return systems;
}

}  // namespace maide
