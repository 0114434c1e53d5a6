#include "maide/join/learned_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <exception>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "maide/automata/compare.hpp"
#include "maide/automata/strength.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/hash.hpp"
#include "maide/base/json.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/random.hpp"
#include "maide/base/text.hpp"
#include "maide/check/rules/built_in_models.hpp"
#include "maide/experiment/known_models.hpp"
#include "maide/experiment/learn_model.hpp"
#include "maide/experiment/nondeterministic_run.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/experiment/pacing.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/join/valued_queue.hpp"
#include "maide/ros2/ros2_graph.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide {
namespace {

constexpr std::string_view start_from_key = "start-from";

// Names what is learned. What that starts from makes no other model of it.
std::string describe(const ModelRequest& request) {
  std::string text = request.learn;
  for (const auto& [key, value] : request.with) text += " " + key + "=" + value;
  std::string learning;
  for (const auto& [key, value] : request.learning) {
    if (key != start_from_key) learning += " " + key + "=" + value;
  }
  if (!learning.empty()) text += " (learning" + learning + ")";
  if (!request.values.empty()) text += " with the values " + join(request.values, " ");
  return text;
}

bool is_of_tests(const std::string& key) {
  return key != "algorithm" && key != "eq" && key != start_from_key;
}

// Throws UsageError for a key that is none, or that neither the algorithm nor the tests look at.
void check_keys(const ModelRequest& request, const ExperimentOptions& options) {
  const std::span<const TestOption> known = test_options();
  for (const auto& [key, value] : request.learning) {
    if (!is_of_tests(key)) continue;
    if (std::ranges::find(known, key, &TestOption::key) == known.end()) {
      std::vector<std::string> keys{"algorithm", "eq", std::string(start_from_key)};
      for (const TestOption& option : known) keys.emplace_back(option.key);
      throw UsageError(fmt::format("'learning' has no key '{}'; it may have: {}", key, join(keys)));
    }
    require_test_option(options.algorithm, options.test_method, key);
  }
}

// What `learning:` says of a system; files are relative to `folder`.
ExperimentOptions read_learning(const ModelRequest& request, const std::filesystem::path& folder,
                                const OpenedSystem& opened) {
  const SulInfo& system = opened.sul->info();
  ExperimentOptions options;
  for (const auto& [name, value] : request.learning) {
    if (name == "algorithm") {
      options.algorithm = value;
    } else if (name == "eq") {
      options.test_method = value;
    } else if (name == start_from_key) {
      options.old_model =
          read_old_machine(folder / value, Translation::eager, input_alphabet(system));
    }
  }
  check_keys(request, options);
  for (const auto& [key, value] : request.learning) {
    if (is_of_tests(key)) set_test_option(options.testing, key, value);
  }
  options.testing.budget = test_budget(opened.reference.has_value());
  return options;
}

// A system and how it was opened.
struct Opened {
  SystemSpec spec;
  SystemAccess access;
  OpenedSystem system;
};

Opened open(const ModelRequest& request, const LearnedModelsOptions& options) {
  std::vector<std::string> key_values;
  for (const auto& [key, value] : request.with) key_values.push_back(key + "=" + value);
  SystemSpec spec = parse_system_spec(request.learn, key_values);
  if (spec.kind == SystemSpec::Kind::simulated) {
    spec.target = (folder_of(options, request) / spec.target)
                      .string();  // like every file that is named there
  }
  SystemAccess access;
  access.translation = Translation::eager;
  access.jobs = options.jobs;
  OpenedSystem system = open_system(spec, access, options.control);
  return {std::move(spec), std::move(access), std::move(system)};
}

// What a system answered, beside its model: another system, or another version, has another file.
std::filesystem::path cache_path(const std::filesystem::path& kept, const SulInfo& system) {
  std::string identity;
  for (const auto& [key, value] : describe_origin(system)) identity += key + "=" + value + "\n";
  return kept.parent_path() /
         fmt::format("{}-{:08x}.cache", kept.stem().string(), hash_text(identity) & 0xffffffff);
}

// Counterexamples that a model was refined with, in its own file: [["write","read"],...].
constexpr const char* counterexamples_key = "counterexamples";
using Words = std::vector<std::vector<std::string>>;

Words read_counterexamples(const InterfaceAutomaton& automaton, const std::string& file) {
  const auto text = automaton.origin.find(counterexamples_key);
  if (text == automaton.origin.end()) return {};
  try {
    return parse_json(text->second, file).get<Words>();
  } catch (const Json::exception&) {
    throw UsageError("its counterexamples are no list of words of inputs (" + file + ")");
  }
}

std::vector<Word> to_symbols(const Words& words, const Alphabet& inputs) {
  std::vector<Word> result;
  for (const std::vector<std::string>& names : words) {
    Word& word = result.emplace_back();
    for (const std::string& name : names) {
      const auto symbol = inputs.find(name);
      if (!symbol) throw UsageError("the system has no input '" + name + "' of a counterexample");
      word.push_back(*symbol);
    }
  }
  return result;
}

// Learns with what is in the cache beside `kept`, and right about `counterexamples`.
InterfaceAutomaton learn(const ModelRequest& request, const Opened& opened,
                         ExperimentOptions experiment, const Words& counterexamples,
                         const std::filesystem::path& kept, const RunControl& control) {
  Sul& sul = *opened.system.sul;
  std::error_code failure;  // the cache that is opened there says it better
  std::filesystem::create_directories(kept.parent_path(), failure);
  experiment.cache_file = cache_path(kept, sul.info());
  experiment.known_words = to_symbols(counterexamples, input_alphabet(sul.info()));
  experiment.reference = opened.system.reference ? &*opened.system.reference : nullptr;
  experiment.confirm = !opened.system.reference;
  if (experiment.confirm) experiment.sample = words_of_a_sample;
  experiment.slower = make_slower_system(opened.spec, opened.access, sul, {}, control);
  LearnedModel learned = learn_model(sul, Translation::eager, experiment, control);
  if (!learned.experiment.is_complete()) std::rethrow_exception(learned.experiment.error);
  auto* automaton = std::get_if<InterfaceAutomaton>(&*learned.model);
  if (automaton == nullptr) {
    throw UsageError("'" + request.learn +
                     "' is a plain Mealy machine, and programs meet interface automata");
  }
  if (!counterexamples.empty()) {
    automaton->origin[counterexamples_key] = to_json_line(Json(counterexamples));
  }
  return std::move(*automaton);
}

// What a kept file says is hashed, and the hash stands in it. White space and comments do not
// count.
constexpr const char* checksum_key = "checksum";

std::string checksum_of(const InterfaceAutomaton& automaton) {
  InterfaceAutomaton plain = automaton;
  plain.origin.erase(checksum_key);
  std::ostringstream text;
  write_dot(text, plain);
  return fmt::format("{:016x}", hash_text(text.str()));
}

struct Kept {
  InterfaceAutomaton automaton;
  bool is_edited = false;  // since it was learned
};

// How strong an edited model is, nobody knows. A file without a checksum is believed.
std::optional<Kept> read_kept(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  Kept kept{read_interface_automaton(file)};
  Origin& origin = kept.automaton.origin;
  const auto checksum = origin.find(checksum_key);
  if (checksum == origin.end()) return kept;
  kept.is_edited = checksum->second != checksum_of(kept.automaton);
  origin.erase(checksum);
  if (!kept.is_edited) return kept;
  for (const char* claim : {"strength", "tests"}) origin.erase(claim);
  return kept;
}

bool is_weak(const InterfaceAutomaton& automaton) {
  const auto stated = find_strength(automaton.origin);
  return stated && stated->is_weak;
}

// Whether a model was learned from this very system: name, options, versions, bound.
bool is_model_of(const InterfaceAutomaton& automaton, const SulInfo& system) {
  const Origin now = describe_origin(system);
  return std::ranges::all_of(now, [&](const auto& entry) {
    const auto kept = automaton.origin.find(entry.first);
    return kept != automaton.origin.end() && kept->second == entry.second;
  });
}

// A kept model to start from: of this system, to be refined, or of another version of it. What it
// cannot be started from is left: nobody asked for it.
std::optional<Mealy> machine_of(const InterfaceAutomaton& kept, const ExperimentOptions& options,
                                const SulInfo& system) {
  if (find_learner(options.algorithm).is_nondeterministic()) return std::nullopt;
  try {
    Mealy machine = to_mealy(kept, Translation::eager);
    if (shares_inputs(machine, input_alphabet(system))) return machine;
  } catch (const UsageError&) {  // no machine stands for it: it was edited
  }
  return std::nullopt;
}

void keep(const std::filesystem::path& file, const InterfaceAutomaton& automaton) {
  std::error_code failure;  // the write that follows says it better
  std::filesystem::create_directories(file.parent_path(), failure);
  InterfaceAutomaton signed_one = automaton;
  signed_one.origin[checksum_key] = checksum_of(automaton);
  std::ostringstream text;
  write_dot(text, signed_one);
  write_file_atomically(file, text.str());
}

std::string with_name(const Error& error, const ModelRequest& request) {
  return fmt::format("model {}: {}", request.instance, error.what());
}

Error with_place(const Error& error, const ModelRequest& request) {
  return {error.status(),
          fmt::format("{} ({})", with_name(error, request), to_string(request.position))};
}

}  // namespace

std::filesystem::path folder_of(const LearnedModelsOptions& options, const ModelRequest& request) {
  if (!options.folder.empty()) return options.folder;
  return std::filesystem::path(request.position.file).parent_path();
}

std::filesystem::path kept_model_path(const std::filesystem::path& folder,
                                      const ModelRequest& request) {
  const std::string text = describe(request);
  std::string name;
  for (const char c : text) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '=' || c == '-';
    name += is_plain ? c : '_';
  }
  name.resize(std::min<std::size_t>(name.size(), 100));
  return folder / learned_models_folder / fmt::format("{}-{:016x}.dot", name, hash_text(text));
}

namespace {

void note(const LearnedModelsOptions& options, const std::string& line) {
  if (options.note) options.note(line);
}

// The kept model of a request, or else a new one, which is kept.
InterfaceAutomaton find_or_learn(const ModelRequest& request, const LearnedModelsOptions& options) {
  const std::filesystem::path kept = kept_model_path(folder_of(options, request), request);
  const Opened opened = open(request, options);
  const SulInfo& system = opened.system.sul->info();
  ExperimentOptions experiment = read_learning(request, folder_of(options, request), opened.system);
  const auto before = read_kept(kept);
  if (before && is_model_of(before->automaton, system)) {
    const std::string& name = request.instance;
    note(options, before->is_edited
                      ? fmt::format("{}: {} was edited since it was learned; it is used, but its "
                                    "strength is unknown (delete it to have the model learned "
                                    "again)",
                                    name, kept.string())
                      : fmt::format("{}: learned before ({})", name, kept.string()));
    return before->automaton;
  }
  if (before && !experiment.old_model) {
    experiment.old_model = machine_of(before->automaton, experiment, system);
  }
  note(options, fmt::format("{}: learning {}{}", request.instance, describe(request),
                            experiment.old_model ? ", starting from an earlier model" : ""));
  InterfaceAutomaton automaton =
      learn(request, opened, std::move(experiment), {}, kept, options.control);
  keep(kept, automaton);
  return automaton;
}

// ---- Values ----

// Two values, and the depths at which a queue is learned with them.
const std::vector<std::string> two_values{"go", "stop"};
constexpr std::int64_t deepest_with_values = 3;
constexpr std::size_t value_words = 300;  // that the model with the file's values is tried on
constexpr std::uint64_t value_seed = 23;

void set_option(ModelRequest& request, const std::string& key, const std::string& value) {
  const auto known = std::ranges::find_if(
      request.with, [&](const auto& entry) { return same_key(entry.first, key); });
  if (known == request.with.end()) {
    request.with.emplace_back(key, value);
  } else {
    known->second = value;
  }
}

ModelRequest with_payload(ModelRequest request, const std::vector<std::string>& values) {
  request.values.clear();
  set_option(request, "payload", payload_of(values));
  return request;
}

// The request for that system with room for at most `depth` messages, as far as its options say how
// many.
ModelRequest with_depth(ModelRequest request, const Opened& opened,
                        const LearnedModelsOptions& options, std::int64_t depth) {
  for (const OptionSpec& row : list_system_options(opened.spec, {}, options.control)) {
    const bool is_room = row.keeps_more == "+" || row.key == "size" || row.key == "max-samples";
    const auto& now = opened.system.sul->info().options;
    const auto value = now.find(row.key);
    if (!is_room || value == now.end()) continue;
    const auto number = parse_number<std::int64_t>(value->second);
    if (number && *number > depth) set_option(request, row.key, std::to_string(depth));
  }
  return request;
}

// The rule that explains what the system does with two values at small depths.
LossRule find_loss_rule(const ModelRequest& plain, const Opened& opened,
                        const LearnedModelsOptions& options) {
  std::vector<LossRule> rules{LossRule::oldest, LossRule::newest};
  std::string before;
  for (std::int64_t depth = 1; depth <= deepest_with_values; ++depth) {
    const ModelRequest small = with_depth(plain, opened, options, depth);
    if (describe(small) == before) continue;  // it has no more room than that
    before = describe(small);
    const InterfaceAutomaton model = find_or_learn(small, options);
    const InterfaceAutomaton valued = find_or_learn(with_payload(small, two_values), options);
    std::erase_if(rules, [&](LossRule rule) {
      const auto made = make_valued_queue(model, two_values, rule, max_queue_states);
      return !made || !compare(valued, *made, options.control).same();
    });
    if (rules.empty()) {
      throw UsageError(fmt::format(
          "{} treats messages with values as no queue does, so each value must be learned: say "
          "payload: 'values:...'",
          describe(small)));
    }
  }
  return rules.front();
}

// Plays random words on the system and throws at the first that it answers as the model does not.
void try_values(const InterfaceAutomaton& model, const ModelRequest& request,
                const LearnedModelsOptions& options) {
  const Opened opened = open(with_payload(request, request.values), options);
  Sul& sul = *opened.system.sul;
  const Mealy machine = to_mealy(model, Translation::eager);
  const Alphabet known = input_alphabet(sul.info());
  std::vector<Symbol> writes, others, to_system;
  for (Symbol input = 0; input < machine.inputs().size(); ++input) {
    const std::string& name = machine.inputs().name(input);
    const auto symbol = known.find(name);
    if (!symbol) throw UsageError("the system has no input '" + name + "'");
    to_system.push_back(*symbol);
    (name.starts_with("write(") ? writes : others).push_back(input);
  }
  Random random(value_seed);
  std::vector<Word> words(value_words);  // in the model's inputs
  std::vector<SulQuery> batch;
  for (Word& word : words) {
    const std::size_t length = 4 + random.below(29);
    Word asked;
    for (std::size_t i = 0; i < length; ++i) {
      const auto& from = others.empty() || random.below(2) == 0 ? writes : others;
      word.push_back(from[random.below(from.size())]);
      asked.push_back(to_system[word.back()]);
    }
    batch.push_back({std::move(asked), Translation::eager});
  }
  sul.run(
      batch,
      [&](std::size_t index, const SulAnswer& answer) {
        const Word& word = words[index];
        const Word expected = machine.output_word(word);
        for (std::size_t i = 0; i < word.size(); ++i) {
          const std::string seen = i < answer.steps.size()
                                       ? mealy_output(answer.steps[i], Translation::eager)
                                       : "nothing";
          const std::string& output = machine.outputs().name(expected[i]);
          if (seen == output) continue;
          throw UsageError(fmt::format(
              "with the values of the file {} is no queue: after {} one answers {}, and it {}",
              describe(request),
              to_string(Word(word.begin(), word.begin() + static_cast<std::ptrdiff_t>(i) + 1),
                        machine.inputs()),
              output, seen));
        }
      },
      options.control);
}

// The model of a queue with the values of the file (join/valued_queue.hpp).
InterfaceAutomaton find_or_make_valued(const ModelRequest& request,
                                       const LearnedModelsOptions& options) {
  for (const std::string& value : request.values) {
    if (value.find(',') == std::string::npos) continue;
    throw UsageError("a message of " + request.learn + " carries one value, not (" + value + ")");
  }
  ModelRequest plain = request;
  plain.values.clear();
  const std::filesystem::path kept = kept_model_path(folder_of(options, request), request);
  const Opened opened = open(plain, options);
  const auto before = read_kept(kept);
  if (before && is_model_of(before->automaton, opened.system.sul->info())) return before->automaton;
  const InterfaceAutomaton model = find_or_learn(plain, options);
  const LossRule rule = find_loss_rule(plain, opened, options);
  auto made = make_valued_queue(model, request.values, rule, max_queue_states);
  if (!made) {
    throw UsageError(describe(plain) +
                     " is no queue, so each value must be learned: say payload: 'values:...'");
  }
  try_values(*made, request, options);
  const std::string how = fmt::format(
      "values by the rule that {}, as with two values at depths up to {}; tried on {} words",
      to_string(rule), deepest_with_values, value_words);
  std::string& tests = made->origin["tests"];
  tests += (tests.empty() ? "" : "; ") + how;
  made->origin[std::string(values_key)] = payload_of(request.values);
  note(options, fmt::format("{}: {}", request.instance, how));
  keep(kept, *made);
  return std::move(*made);
}

}  // namespace

ModelSource make_learning_source(LearnedModelsOptions options) {
  return [options = std::move(options)](const ModelRequest& request) {
    if (request.learn.empty() || request.known) return read_requested_model(request);
    try {
      if (auto topic = ros2_topic_of_unknown_depth(request)) return std::move(*topic);
      return request.values.empty() ? find_or_learn(request, options)
                                    : find_or_make_valued(request, options);
    } catch (const UsageError& error) {
      throw UsageError(with_name(error, request));
    } catch (const Error& error) {
      throw with_place(error, request);
    }
  };
}

Refinement refine_learned_model(const ModelRequest& request, const RefinementGoal& goal,
                                const LearnedModelsOptions& options) {
  const std::filesystem::path kept = kept_model_path(folder_of(options, request), request);
  try {
    const Opened opened = open(request, options);
    const SulInfo& system = opened.system.sul->info();
    const auto file = read_kept(kept);
    if (!file || !is_model_of(file->automaton, system)) {
      throw UsageError("the model to refine is not there any more");
    }
    const InterfaceAutomaton& before = file->automaton;
    ExperimentOptions experiment =
        read_learning(request, folder_of(options, request), opened.system);
    experiment.old_model = machine_of(before, experiment, system);
    if (goal.tests_again) {
      experiment.test_method.clear();
      const TestCost budget = experiment.testing.budget;
      experiment.testing = {};
      experiment.testing.seed = goal.seed;
      experiment.testing.budget = budget;
    }
    Words counterexamples = read_counterexamples(before, kept.string());
    if (!goal.counterexample.empty()) counterexamples.push_back(goal.counterexample);
    const InterfaceAutomaton after =
        learn(request, opened, std::move(experiment), counterexamples, kept, options.control);
    keep(kept, after);
    return {before.size(), after.size(), !compare(before, after, options.control).same(),
            is_weak(before) && !is_weak(after), after.origin.at("tests")};
  } catch (const Error& error) {
    throw with_place(error, request);
  }
}

}  // namespace maide
