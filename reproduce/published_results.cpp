#include "published_results.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <published_results_data.hpp>  // made by the build

#include "maide/base/error.hpp"

namespace maide {
namespace {

using Options = std::map<std::string, std::string>;

const YAML::Node& paper() {
  static const YAML::Node data = YAML::Load(std::string(paper_yaml));
  return data;
}

PaperLearningRow read_row(const std::string& configuration) {
  const YAML::Node row = paper()["table1"][configuration];
  return {configuration,
          row[0].as<std::size_t>(),
          row[1].as<std::size_t>(),
          row[2].as<std::uint64_t>(),
          row[3].as<std::uint64_t>(),
          row[4].as<std::uint64_t>(),
          row[5].as<double>()};
}

Options with(Options base, const Options& more) {
  base.insert(more.begin(), more.end());
  return base;
}

Mealy read_machine(const YAML::Node& rows) {
  Mealy machine(Alphabet({"write", "read", "interrupt"}), Alphabet(), rows.size());
  for (StateId state = 0; state < rows.size(); ++state) {
    for (Symbol input = 0; input < rows[state].size(); ++input) {
      const YAML::Node answer = rows[state][input];
      machine.set_transition(state, input, machine.intern_output(answer[0].as<std::string>()),
                             answer[1].as<StateId>());
    }
  }
  machine.actors = {{"writer", {"write"}, {"written", "failed"}},
                    {"reader", {"read"}, {"message"}},
                    {"writer_control", {"interrupt"}, {"done"}}};
  return machine;
}

// The study's text with the row's values in it.
std::string fill_in(std::string text, const Options& values) {
  for (const auto& [name, value] : values) {
    const std::string gap = "<" + name + ">";
    for (std::size_t at = text.find(gap); at != text.npos; at = text.find(gap, at)) {
      text.replace(at, gap.size(), value);
    }
  }
  return text;
}

struct Peers {
  std::vector<PeerRun> runs;
  std::vector<PeerMean> means;
  std::vector<PeerTesting> testing;
  std::vector<std::string> models_of_the_means;
};

Peers read_peers() {
  const YAML::Node data = YAML::Load(std::string(peers_yaml));
  const auto text = [](const YAML::Node& row, const char* key) {
    return row[key].as<std::string>();
  };
  const auto count = [](const YAML::Node& row, const char* key) {
    return row[key].as<std::size_t>();
  };
  Peers peers;
  for (const YAML::Node& row : data["runs"]) {
    peers.runs.push_back({text(row, "model"), count(row, "states"), count(row, "inputs"),
                          text(row, "tool"), text(row, "learner"), count(row, "resets"),
                          count(row, "symbols"), count(row, "equivalence_queries"),
                          row["cpu"] ? std::optional(row["cpu"].as<double>()) : std::nullopt});
  }
  for (const YAML::Node& row : data["means"]) {
    peers.means.push_back(
        {text(row, "tool"), text(row, "learner"), row["symbols_and_resets"].as<double>()});
  }
  for (const YAML::Node& row : data["testing"]) {
    peers.testing.push_back({text(row, "model"), count(row, "states"), count(row, "inputs"),
                             row["test_symbols"].as<double>(), count(row, "learned")});
  }
  peers.models_of_the_means = data["models_of_the_means"].as<std::vector<std::string>>();
  return peers;
}

const Peers& peers() {
  static const Peers data = read_peers();
  return data;
}

}  // namespace

std::vector<ReproducedRow> table1_rows(const std::string& system) {
  const YAML::Node systems = paper()["systems"];
  if (!systems[system]) {
    throw UsageError(fmt::format("table 1 has no rows for '{}'; there are rows for {}", system,
                                 fmt::join(table1_systems(), ", ")));
  }
  const auto kinds = systems[system].as<std::map<std::string, Options>>();
  const auto tryread = paper()["tryread"].as<Options>();
  std::vector<ReproducedRow> rows;
  const auto add = [&](const std::string& configuration, const std::string& kind,
                       const Options& more) {
    const auto options = kinds.find(kind);
    if (options == kinds.end()) return;
    rows.push_back({read_row(configuration), with(options->second, more)});
  };
  add("port", "plain", {});
  add("buffered port (non-strict)", "newest", {});
  add("buffered port (strict)", "all", {{"size", "3"}});
  add("buffered port (non-strict)*", "newest", tryread);
  add("buffered port (strict)*", "all", with({{"size", "3"}}, tryread));
  for (const char* size : {"1", "2", "3", "4", "5", "6"}) {
    add(std::string("strict, size ") + size, "all", {{"size", size}});
  }
  return rows;
}

std::vector<std::string> table1_systems() {
  std::vector<std::string> names;
  for (const auto& system : paper()["systems"]) names.push_back(system.first.as<std::string>());
  return names;
}

Mealy expected_interrupt_model() { return read_machine(paper()["interrupt"]["expected"]); }
Mealy paper_interrupt_model() { return read_machine(paper()["interrupt"]["paper"]); }

std::map<std::string, std::string> interrupt_options() {
  return paper()["interrupt"]["options"].as<Options>();
}

std::vector<std::string> interrupt_systems() {
  return paper()["interrupt"]["systems"].as<std::vector<std::string>>();
}

std::vector<CheckedRow> table2_rows() {
  std::vector<CheckedRow> rows;
  for (const YAML::Node& row : paper()["table2"]) {
    CheckedRow& checked = rows.emplace_back();
    checked.name = row["name"].as<std::string>();
    if (const YAML::Node spin = row["spin"]) {
      checked.paper = {spin[0].as<std::string>(), spin[1].as<double>(),
                       spin[2].as<std::uint64_t>()};
    }
    checked.expected = row["deadlock"].as<bool>() ? Verdict::violated : Verdict::holds;
    checked.system = fill_in(paper()["studies"][row["study"].as<std::string>()].as<std::string>(),
                             row["with"].as<Options>());
  }
  return rows;
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

std::span<const PeerRun> peer_runs() { return peers().runs; }
std::span<const PeerMean> peer_means() { return peers().means; }
std::span<const PeerTesting> peer_testing() { return peers().testing; }

bool are_the_41_models(std::span<const std::string> names) {
  const std::vector<std::string>& known = peers().models_of_the_means;
  return std::equal(names.begin(), names.end(), known.begin(), known.end());
}

}  // namespace maide
