#include "maide/sul/ia_translator.hpp"

#include <exception>
#include <optional>
#include <utility>
#include <variant>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/text.hpp"

namespace maide {
namespace {

void check_names(const SulInfo& info) {
  for (const SulOutput& output : info.outputs) {
    if (is_reserved_output(output.name) || output.name.find(',') != std::string::npos) {
      throw UsageError("output '" + output.name + "' of " + info.name +
                       " has a name with a meaning of its own in answers");
    }
  }
  for (const SulInput& input : info.inputs) {
    if (input.name == delta_input) {
      throw UsageError("input 'Delta' of " + info.name +
                       " has the name of the av translation's own");
    }
  }
}

SulQuery to_sul_query(const Query& query, Translation translation, const Alphabet& outputs) {
  if (const Word* word = std::get_if<Word>(&query)) return {*word, translation};
  BasicDecisionTree<std::string> tree;
  for (const auto& node : std::get<DecisionTree>(query).nodes) {
    auto& copy = tree.nodes.emplace_back();
    copy.input = node.input;
    for (const auto& [output, next] : node.branches) {
      copy.branches.emplace_back(outputs.name(output), next);
    }
  }
  return {std::move(tree), translation};
}

}  // namespace

IaTranslator::IaTranslator(Sul& sul, Translation translation)
    : sul_(sul), translation_(translation) {
  const SulInfo& info = sul.info();
  if (translation == Translation::av && (!info.speaks_av || !info.has_actors)) {
    throw UsageError(info.name + " cannot be learned with --translation av");
  }
  if (info.has_actors) check_names(info);
  for (const SulInput& input : info.inputs) {
    if (inputs_.find(input.name))
      throw UsageError(info.name + " names input '" + input.name + "' twice");
    inputs_.intern(input.name);
  }
  if (inputs_.empty()) throw UsageError(info.name + " has no inputs to learn");
  if (translation == Translation::av) inputs_.intern(delta_input);
}

std::vector<MealyAnswer> IaTranslator::run(std::span<const Query> batch,
                                           const RunControl& control) {
  return run(batch, control, {});
}

std::vector<MealyAnswer> IaTranslator::run(std::span<const Query> batch, const RunControl& control,
                                           const PartialSink& on_early_end) {
  std::vector<SulQuery> queries;
  queries.reserve(batch.size());
  for (const Query& query : batch) queries.push_back(to_sul_query(query, translation_, outputs_));

  std::vector<std::optional<SulAnswer>> raw(batch.size());
  std::exception_ptr failure;
  try {
    run_unknown(queries, raw, control);
  } catch (...) {
    failure = std::current_exception();
  }

  // In query order, so that outputs get the same numbers whatever the order of arrival.
  std::vector<MealyAnswer> answers(batch.size());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    if (!raw[i]) continue;
    fatal_words_.add(*raw[i], translation_);
    if (is_fatal(raw[i]->end)) fatal_words_.mark_asked(queries[i]);
    answers[i] = to_mealy_answer(std::move(*raw[i]), queries[i]);
    if (answers[i].end != WordEnd::aborted) continue;
    raw[i].reset();
    if (failure) continue;
    failure = std::make_exception_ptr(WrapperError(
        "the run was aborted in the word \"" + to_string(answers[i].inputs, inputs_) + "\"",
        info().name));
  }
  if (!failure) return answers;
  for (std::size_t i = 0; i < raw.size() && on_early_end; ++i) {
    if (raw[i]) on_early_end(i, answers[i]);
  }
  std::rethrow_exception(failure);
}

// Runs what is not known to run into a crash or a hang.
void IaTranslator::run_unknown(std::span<const SulQuery> queries,
                               std::vector<std::optional<SulAnswer>>& answers,
                               const RunControl& control) {
  std::vector<SulQuery> unknown;
  std::vector<std::size_t> places;
  if (!fatal_words().empty()) {
    for (std::size_t i = 0; i < queries.size(); ++i) {
      answers[i] = fatal_words_.find(queries[i]);
      if (answers[i]) continue;
      unknown.push_back(queries[i]);
      places.push_back(i);
    }
    if (unknown.empty()) return;
    queries = unknown;
  }
  sul_.run(
      queries,
      [&](std::size_t index, SulAnswer answer) {
        MAIDE_CHECK(index < queries.size());
        std::optional<SulAnswer>& place = answers[places.empty() ? index : places[index]];
        MAIDE_CHECK(!place);  // each query is answered once
        place = std::move(answer);
      },
      control);
}

MealyAnswer IaTranslator::to_mealy_answer(SulAnswer raw, const SulQuery& query) {
  answer_rest(raw, query, info());
  MAIDE_CHECK(raw.inputs.size() == raw.steps.size());
  MealyAnswer answer;
  answer.inputs = std::move(raw.inputs);
  answer.end = raw.end;
  answer.attempts = raw.attempts;
  answer.reset_duration = raw.reset_duration;
  answer.reset_wait = raw.reset_wait;
  answer.outputs.reserve(raw.steps.size());
  std::string joined;
  for (const SulStep& step : raw.steps) {
    answer.outputs.push_back(outputs_.intern(mealy_output(step, translation_, joined)));
    answer.system_duration += step.duration;
    answer.settling += step.settling;
  }
  return answer;
}

void IaTranslator::remember(const Word& inputs, const std::vector<std::string>& outputs) {
  // An output of a plain Mealy machine means what that machine says.
  if (info().has_actors) fatal_words_.add(inputs, outputs, info(), translation_);
}

std::map<std::string, std::string> identifying_options(const SulInfo& info) {
  std::map<std::string, std::string> options = info.options;
  for (const char* ends : {"readers", "writers"}) {
    const auto found = options.find(ends);
    if (found != options.end() && found->second == "1") options.erase(found);
  }
  return options;
}

Origin describe_origin(const SulInfo& info) {
  Origin origin;
  origin["sul"] = quote_shell_word(info.name);
  for (const auto& [key, value] : identifying_options(info)) {
    origin["sul"] += " " + quote_shell_word(key + "=" + value);
  }
  if (!info.bound.empty()) origin["bound"] = info.bound;
  std::string versions;
  for (const auto& [what, version] : info.versions) {
    versions += (versions.empty() ? "" : ", ") + what + " " + version;
  }
  if (!versions.empty()) origin["versions"] = versions;
  return origin;
}

// The system's, with the inputs and outputs that are its own.
std::vector<Actor> IaTranslator::actors() const {
  const SulInfo& its = info();
  std::vector<Actor> actors;
  for (std::size_t i = 0; i < its.actors.size(); ++i) {
    Actor& actor = actors.emplace_back(Actor{its.actors[i], {}, {}});
    for (const SulInput& input : its.inputs) {
      if (input.actor == i) actor.inputs.push_back(input.name);
    }
    for (const SulOutput& output : its.outputs) {
      if (output.actor == i) actor.outputs.push_back(output.name);
    }
  }
  return actors;
}

InterfaceAutomaton IaTranslator::to_interface_automaton(const Mealy& machine) const {
  InterfaceAutomaton automaton = maide::to_interface_automaton(machine, translation_, actors());
  automaton.hidden_returns = find_hidden_returns(machine, translation_, info());
  for (const auto& [key, value] : describe_origin(info())) automaton.origin[key] = value;
  return automaton;
}

InterfaceAutomaton IaTranslator::to_interface_automaton(
    const NondeterministicMealy& machine) const {
  InterfaceAutomaton automaton = maide::to_interface_automaton(machine, actors());
  automaton.hidden_returns = find_hidden_returns(machine, info());
  for (const auto& [key, value] : describe_origin(info())) automaton.origin[key] = value;
  return automaton;
}

}  // namespace maide
