#include "published_results.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <published_results_data.hpp>  // made by the build

#include "maide/base/error.hpp"
#include "maide/check/text/yaml_node.hpp"

namespace maide {
namespace {

using Options = std::map<std::string, std::string>;

// The files are part of the build, so what they should have is there.
const YamlNode& paper() {
  static const YamlDocument data =
      read_yaml(paper_yaml, "the paper's results", "a table");
  return data.root;
}
const YamlNode& get(const YamlNode& map, std::string_view key) { return *map.find(key); }
const YamlNode& get(const YamlNode& list, std::size_t place) { return list.entries[place].value; }

std::size_t count_of(const YamlNode& node) { return std::stoull(node.value); }
double number_of(const YamlNode& node) { return std::stod(node.value); }

Options options_of(const YamlNode& map) {
  Options options;
  for (const YamlEntry& entry : map.entries) options[entry.key.value] = entry.value.value;
  return options;
}
std::vector<std::string> texts_of(const YamlNode& list) {
  std::vector<std::string> texts;
  for (const YamlEntry& entry : list.entries) texts.push_back(entry.value.value);
  return texts;
}

PaperLearningRow read_row(const std::string& configuration) {
  const YamlNode& row = get(get(paper(), "table1"), configuration);
  const auto count = [&](std::size_t place) { return count_of(get(row, place)); };
  return {configuration, count(0), count(1), count(2), count(3), count(4), number_of(get(row, 5))};
}

Options with(Options base, const Options& more) {
  base.insert(more.begin(), more.end());
  return base;
}

Mealy read_machine(const YamlNode& rows) {
  Mealy machine(Alphabet({"write", "read", "interrupt"}), Alphabet(), rows.entries.size());
  for (StateId state = 0; state < rows.entries.size(); ++state) {
    const YamlNode& row = get(rows, state);
    for (Symbol input = 0; input < row.entries.size(); ++input) {
      const YamlNode& answer = get(row, input);
      machine.set_transition(state, input, machine.intern_output(get(answer, 0).value),
                             static_cast<StateId>(count_of(get(answer, 1))));
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
  const YamlDocument document =
      read_yaml(peers_yaml, "results of other tools", "a table");
  const YamlNode& data = document.root;
  const auto text = [](const YamlNode& row, const char* key) { return get(row, key).value; };
  const auto count = [](const YamlNode& row, const char* key) { return count_of(get(row, key)); };
  Peers peers;
  for (const YamlEntry& entry : get(data, "runs").entries) {
    const YamlNode& row = entry.value;
    const YamlNode* const cpu = row.find("cpu");
    peers.runs.push_back({text(row, "model"), count(row, "states"), count(row, "inputs"),
                          text(row, "tool"), text(row, "learner"), count(row, "resets"),
                          count(row, "symbols"), count(row, "equivalence_queries"),
                          cpu != nullptr ? std::optional(number_of(*cpu)) : std::nullopt});
  }
  for (const YamlEntry& entry : get(data, "means").entries) {
    const YamlNode& row = entry.value;
    peers.means.push_back(
        {text(row, "tool"), text(row, "learner"), number_of(get(row, "symbols_and_resets"))});
  }
  for (const YamlEntry& entry : get(data, "testing").entries) {
    const YamlNode& row = entry.value;
    peers.testing.push_back({text(row, "model"), count(row, "states"), count(row, "inputs"),
                             number_of(get(row, "test_symbols")), count(row, "learned")});
  }
  peers.models_of_the_means = texts_of(get(data, "models_of_the_means"));
  return peers;
}

const Peers& peers() {
  static const Peers data = read_peers();
  return data;
}

}  // namespace

std::vector<ReproducedRow> table1_rows(const std::string& system) {
  const YamlNode* const kinds = get(paper(), "systems").find(system);
  if (kinds == nullptr) {
    throw UsageError(fmt::format("table 1 has no rows for '{}'; there are rows for {}", system,
                                 fmt::join(table1_systems(), ", ")));
  }
  const Options tryread = options_of(get(paper(), "tryread"));
  std::vector<ReproducedRow> rows;
  const auto add = [&](const std::string& configuration, const std::string& kind,
                       const Options& more) {
    const YamlNode* const options = kinds->find(kind);
    if (options == nullptr) return;
    rows.push_back({read_row(configuration), with(options_of(*options), more)});
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
  for (const YamlEntry& system : get(paper(), "systems").entries) names.push_back(system.key.value);
  return names;
}

Mealy expected_interrupt_model() {
  return read_machine(get(get(paper(), "interrupt"), "expected"));
}
Mealy paper_interrupt_model() { return read_machine(get(get(paper(), "interrupt"), "paper")); }

std::map<std::string, std::string> interrupt_options() {
  return options_of(get(get(paper(), "interrupt"), "options"));
}

std::vector<std::string> interrupt_systems() {
  return texts_of(get(get(paper(), "interrupt"), "systems"));
}

std::vector<CheckedRow> table2_rows() {
  std::vector<CheckedRow> rows;
  for (const YamlEntry& entry : get(paper(), "table2").entries) {
    const YamlNode& row = entry.value;
    CheckedRow& checked = rows.emplace_back();
    checked.name = get(row, "name").value;
    if (const YamlNode* const spin = row.find("spin")) {
      checked.paper = {get(*spin, 0).value, number_of(get(*spin, 1)), count_of(get(*spin, 2))};
    }
    const bool has_deadlock = get(row, "deadlock").value == "true";
    checked.expected = has_deadlock ? Verdict::violated : Verdict::holds;
    checked.system = fill_in(get(get(paper(), "studies"), get(row, "study").value).value,
                             options_of(get(row, "with")));
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
