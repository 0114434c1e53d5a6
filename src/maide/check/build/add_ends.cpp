// What becomes of models because programs stand at their ends: the writer's outputs of a topic are
// collected from its readers' models, and a program that may die leaves its end.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/build/models.hpp"
#include "maide/check/rules/model_ends.hpp"

namespace maide {
namespace {

using Death = std::vector<std::vector<ModelStep>>;  // by state

// What a death does to each state, and then another one.
Death compose(const Death& one, const Death& other) {
  Death both(one.size());
  for (std::size_t state = 0; state < one.size(); ++state) {
    for (const ModelStep& first : one[state]) {
      for (const ModelStep& second : other[first.target]) {
        const ModelStep step{second.target, first.is_beyond || second.is_beyond};
        if (std::find(both[state].begin(), both[state].end(), step) == both[state].end()) {
          both[state].push_back(step);
        }
      }
    }
  }
  return both;
}

void replace_automaton(ModelInstance& instance, InterfaceAutomaton by) {
  if (!instance.as_read) {
    instance.as_read = std::make_shared<const InterfaceAutomaton>(std::move(instance.automaton));
  }
  instance.automaton = std::move(by);
}

bool changes_nothing(const Death& death) {
  for (StateId state = 0; state < death.size(); ++state) {
    if (death[state] != std::vector<ModelStep>{{state, false}}) return false;
  }
  return true;
}

void add_topic_ends(const Declarations& file, const Topic& topic, Topic::Reader& reader,
                    ModelInstance& instance) {
  EndOptions options;
  options.collects = true;
  options.may_leave = file.programs[reader.program].may_die;
  options.when_unexplored = instance.when_unexplored;
  if (!topic.mortal.empty()) {
    options.ends.push_back(find_end(instance.automaton, "writer", 0, 1, {"reader"}));
    if (topic.writers.size() > 1) options.ends.front().disconnect.reset();
  }
  EndedModel ended = with_ends(instance.automaton, options);
  replace_automaton(instance, std::move(ended.automaton));
  reader.collected = std::move(ended.collected);
  reader.cleared = std::move(ended.cleared);
  reader.gone = ended.gone;
  reader.writer_death.clear();
  if (!ended.deaths.empty() && !changes_nothing(ended.deaths.front())) {
    reader.writer_death = std::move(ended.deaths.front());
  }
}

void add_model_ends(const Declarations& file, Models& models, std::uint32_t model,
                    const QueueLimits& limits) {
  ModelInstance& instance = models.instances[model];
  const Ends& ends = models.names.models.at(file.ends_of.at(model)).ends;
  EndOptions options;
  options.when_unexplored = instance.when_unexplored;
  std::vector<std::uint32_t> dying;  // by end
  for (const auto& [actor, at_it] : ends) {
    std::set<std::string> others;
    for (const auto& [other, at_other] : ends) {
      if (other != actor) others.insert(other);
    }
    for (std::size_t place = 0; place < at_it.size(); ++place) {
      if (!at_it[place].node.empty() || !file.programs[at_it[place].program].may_die) continue;
      options.ends.push_back(find_end(instance.automaton, actor, place, at_it.size(), others));
      dying.push_back(at_it[place].program);
    }
  }
  if (dying.empty()) return;
  if (instance.is_grown) fail_large_queue(models, model, limits);
  EndedModel ended = with_ends(instance.automaton, options);
  replace_automaton(instance, std::move(ended.automaton));
  auto& deaths = models.names.deaths;
  for (const std::uint32_t program : dying) deaths[program].erase(model);
  for (std::size_t end = 0; end < dying.size(); ++end) {
    auto& of_program = deaths[dying[end]];
    const auto [place, is_new] = of_program.try_emplace(model, ended.deaths[end]);
    if (!is_new) place->second = compose(place->second, ended.deaths[end]);
  }
  for (const std::uint32_t program : dying) {
    auto& of_program = deaths[program];
    const auto place = of_program.find(model);
    if (place != of_program.end() && changes_nothing(place->second)) of_program.erase(place);
  }
}

}  // namespace

void add_ends(const Declarations& file, Models& models, std::uint32_t model,
              const QueueLimits& limits) {
  ModelInstance& instance = models.instances[model];
  try {
    if (const auto place = file.topic_of.find(model); place != file.topic_of.end()) {
      if (instance.is_grown) fail_large_queue(models, model, limits);
      Topic& topic = models.names.topics[place->second.first];
      add_topic_ends(file, topic, topic.readers[place->second.second], instance);
    } else if (file.ends_of.contains(model)) {
      add_model_ends(file, models, model, limits);
    }
  } catch (const UsageError& error) {
    throw ParseError(error.what(), instance.position);
  }
}

}  // namespace maide
