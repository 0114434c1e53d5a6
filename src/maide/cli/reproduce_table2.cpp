// `maide reproduce table2`: the paper's two case studies, decided by our own engine and by SPIN on
// models learned anew, beside what the paper reports. Equal conclusions are expected; equal numbers
// of states are not: here a step is a rendezvous, and the bookkeeping of loops costs none.
#include <fmt/format.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "maide/check/check_system.hpp"
#include "maide/check/system_file.hpp"
#include "maide/cli/reproduce.hpp"
#include "maide/workflow/paper_checks.hpp"
#include "maide/workflow/wrapper_search.hpp"

namespace maide::cli {
namespace {

using Models = std::map<std::string, InterfaceAutomaton>;

constexpr const char* line_format = "{:<28} | {:>8} {:>6} {:>6} {:<8} | {:>8} {:>6} {:>6} {:<8}";

std::string conclusion(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds: return "OK";
    case Verdict::violated: return "deadlock";
    case Verdict::inconclusive: return "?";
  }
  return "";
}

std::string table_head(bool has_spin) {
  std::string text = fmt::format(line_format, "", "native", "", "", "", "paper", "", "", "");
  if (has_spin) text += " | SPIN here";
  text +=
      "\n" + fmt::format(line_format, "system", "states", "MB", "s", "", "states", "MB", "s", "");
  if (has_spin) text += fmt::format(" | {:>8} {:>6} {:>6}", "states", "MB", "s");
  return text + "\n";
}

std::string megabytes(const PropertyResult& result) {
  return fmt::format("{:.1f}", static_cast<double>(result.peak_bytes) / 1e6);
}

std::string table_line(const CheckedRow& row, const PropertyResult& native,
                       const std::optional<PropertyResult>& spin, bool agrees) {
  const auto paper = [&](auto value) { return row.paper ? value(*row.paper) : std::string("-"); };
  std::string text = fmt::format(
      line_format, row.name + (agrees ? "" : "  (!)"), native.states, megabytes(native),
      fmt::format("{:.2f}", native.seconds), conclusion(native.verdict),
      paper([](const PaperCheckingRow& of) { return of.states; }),
      paper([](const PaperCheckingRow& of) { return std::to_string(of.megabytes); }),
      paper([](const PaperCheckingRow& of) { return fmt::format("{:.2f}", of.seconds); }),
      row.paper ? conclusion(row.expected) : "-");
  if (spin) {
    text += fmt::format(" | {:>8} {:>6} {:>6.2f} {}", spin->states, megabytes(*spin), spin->seconds,
                        conclusion(spin->verdict));
  }
  return text + "\n";
}

Json describe(const PropertyResult& result) {
  return {{"verdict", to_string(result.verdict)},
          {"states", result.states},
          {"transitions", result.transitions},
          {"seconds", result.seconds},
          {"peak_bytes", result.peak_bytes}};
}

Json row_json(const CheckedRow& row, const PropertyResult& native,
              const std::optional<PropertyResult>& spin, bool agrees) {
  Json json{{"system", row.name},
            {"agrees", agrees},
            {"native", describe(native)},
            {"spin", spin ? describe(*spin) : Json()},
            {"paper", nullptr}};
  if (row.paper) {
    json["paper"] = {{"verdict", to_string(row.expected)},
                     {"states", row.paper->states},
                     {"seconds", row.paper->seconds},
                     {"megabytes", row.paper->megabytes}};
  }
  return json;
}

PropertyResult check_deadlock(const System& system, const std::string& engine, Context& context) {
  CheckRequest request;
  request.properties = {"deadlock"};
  request.options.control = context.control();
  PropertyResult result = check_system(system, *make_engine(engine), request).properties.front();
  if (context.control().should_stop()) throw Interrupted("interrupted");
  return result;
}

Models learn_models(const std::string& system, const ReproduceArguments& arguments,
                    Context& context) {
  Models models;
  for (const auto& [name, options] : table2_models(system)) {
    const LearnedModel learned =
        learn_for_reproduction(system, options, arguments, context.control());
    models.emplace(name, std::get<InterfaceAutomaton>(learned.model.value()));
    context.print(fmt::format("learned {} from {}: {} states, {} transitions, {:.1f} s\n", name,
                              system, learned.states(), learned.transitions(),
                              learned.experiment.seconds));
  }
  return models;
}

}  // namespace

ExitStatus reproduce_table2(const ReproduceArguments& arguments, Context& context) {
  const bool has_spin = find_on_path("spin").has_value();
  if (!has_spin) context.complain("spin is not installed: its columns are left out");
  Json rows = Json::array();
  bool all_agree = true;
  ReproduceArguments chosen = arguments;
  if (chosen.systems.empty()) chosen.systems = {"port"};  // what is checked is the same on each
  for (const std::string& system : chosen_systems(table2_systems(), chosen, context)) {
    const Models models = learn_models(system, arguments, context);
    const ModelSource source = [&](const ModelRequest& request) {
      return models.at(request.learn);
    };
    context.print("\nTable 2, on models learned from " + system + "\n" + table_head(has_spin));
    for (const CheckedRow& row : table2_rows()) {
      const System checked = parse_system(row.system, row.name, source);
      const PropertyResult native = check_deadlock(checked, "native", context);
      std::optional<PropertyResult> spin;
      if (has_spin) spin = check_deadlock(checked, "spin", context);
      const bool agrees =
          native.verdict == row.expected && (!spin || spin->verdict == row.expected);
      all_agree = all_agree && agrees;
      context.print(table_line(row, native, spin, agrees));
      rows.push_back(row_json(row, native, spin, agrees));
      rows.back()["learned_from"] = system;
    }
  }
  context.print(
      "\n* with a non-blocking read of the first queue. A write to that queue when it is full is "
      "accepted and\n  dropped, as in the paper's model; where it waits instead there is a "
      "deadlock, in the row that the paper\n  has not: the first producer waits for ever once "
      "the consumer has ended.\nstates: visited until a deadlock was found, else all that are "
      "reachable. (!): another conclusion.\n");
  context.set_result({{"table", "table2"}, {"agree", all_agree}, {"rows", rows}});
  return all_agree ? ExitStatus::ok : ExitStatus::violated;
}

}  // namespace maide::cli
