// The types of the values that programs write into queues, and which programs use which variables.
// Both depend on each other - a value is read into a variable and written elsewhere - so programs
// are resolved again and again until nothing new comes, or the types grow and grow. Then the queues
// are made, with those of these values that occur.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "maide/check/build/models.hpp"
#include "maide/check/build/value_flow.hpp"

namespace maide {
namespace {

constexpr int max_rounds = 20;

class ValueFinder {
 public:
  ValueFinder(const Declarations& file, Models& models) : file_(file), models_(models) {}

  void find() {
    for (int round = 0;; ++round) {
      has_new_values_ = false;
      for (std::uint32_t program = 0; program < file_.programs.size(); ++program) {
        resolve(program);
      }
      if (!has_new_values_) break;
      if (round == max_rounds) fail_growing();
    }
    for (const auto& [name, programs] : users_) {
      const bool is_shared = programs.size() > 1 || models_.names.variables.at(name).service;
      if (!is_shared) models_.own[*programs.begin()].insert(name);
    }
    for (const auto& [name, variable] : models_.names.variables) {
      if (!users_.contains(name)) models_.unused.push_back(variable);
    }
  }

 private:
  void resolve(std::uint32_t number) {
    const ProgramDeclaration& program = file_.programs[number];
    program_syntax::Context known = models_.context(file_, number);
    known.stage = program_syntax::Context::Stage::models;
    known.on_value = [&](std::uint32_t model, const program_syntax::Event& input, std::size_t place,
                         const ValueType& type) { note(model, input, place, type); };
    try {
      const program_syntax::Tree tree = maide::resolve(program, known);
      models_.first_errors.erase(number);
      for (const std::string& name : tree.file_variables) users_[name].insert(number);
    } catch (const ParseError& error) {
      models_.first_errors.insert_or_assign(number, error);
    }
  }

  // What is written has a value of that type, too.
  void note(std::uint32_t model, const program_syntax::Event& input, std::size_t place,
            const ValueType& type) {
    if (!models_.queues.contains(model) || input.name != "write") return;
    auto& types = models_.names.carried[model];
    if (types.size() <= place) {
      types.resize(place + 1, type);
      has_new_values_ = true;
    }
    ValueType& known = types[place];
    const ValueType before = known;
    if (known.kind != type.kind) return;  // found again: the queue has no such input
    known.low = std::min(known.low, type.low);
    known.high = std::max(known.high, type.high);
    for (const Value word : type.words) {
      if (!known.contains(word)) known.words.push_back(word);
    }
    has_new_values_ = has_new_values_ || known != before;
  }

  [[noreturn]] void fail_growing() const {
    for (const auto& [model, types] : models_.names.carried) {
      const ModelInstance& instance = models_.instances[model];
      throw ParseError("the values of queue '" + instance.name +
                           "' grow and grow: read them into a variable that is declared with its "
                           "range",
                       instance.position);
    }
    throw ParseError("the values of queues grow and grow", {file_.tree().file(), 0, 0});
  }

  const Declarations& file_;
  Models& models_;
  std::map<std::string, std::set<std::uint32_t>> users_;  // of variables: programs
  bool has_new_values_ = false;
};

// Those that several programs use become models of their own.
void make_shared_variables(Models& models) {
  for (auto& [name, variable] : models.names.variables) {
    const bool is_own = std::ranges::any_of(
        models.own, [&own_name = name](const auto& own) { return own.contains(own_name); });
    if (is_own) continue;
    constexpr std::uint64_t most = 4096;
    if (variable.type.count() > most) {
      throw ParseError("a shared variable has at most " + std::to_string(most) + " values",
                       variable.position);
    }
    variable.leaf.index = static_cast<std::uint32_t>(models.instances.size());
    for (std::uint32_t member = 0; member < member_count(variable.leaf.dimensions); ++member) {
      if (variable.service) {
        models.names.services.at(*variable.service + member).presence =
            variable.leaf.index + member;
      }
      ModelInstance model;
      model.name = name + member_suffix(variable.leaf.dimensions, member);
      model.automaton = InterfaceAutomaton({}, {}, variable.type.count());
      model.automaton.set_initial(static_cast<StateId>(variable.type.place_of(variable.initial)));
      model.source = ModelInstance::Source::variable;
      model.type = variable.type;
      model.position = variable.position;
      models.instances.push_back(std::move(model));
    }
  }
}

// The queues with the values that occur.
class QueueMaker {
 public:
  QueueMaker(const Declarations& file, Models& models, const ModelSource& source,
             const QueueLimits& limits)
      : file_(file), models_(models), source_(source), limits_(limits) {}

  void make(OccurringValues values) {
    for (const auto& [model, types] : models_.names.carried) {
      // Where nothing ever occurs, there is one value nevertheless: the names say that it has some.
      if (values[model].empty()) values[model].insert(std::vector<std::uint64_t>(types.size()));
    }
    share_learned(values);
    for (const auto& [model, occurring] : values) make(model, names_of(model, occurring));
  }

 private:
  // Those that are learned alike are learned once.
  void share_learned(OccurringValues& values) const {
    using Learned = std::tuple<std::filesystem::path, std::string,
                               std::vector<std::pair<std::string, std::string>>>;
    std::map<Learned, std::set<std::vector<std::uint64_t>>> shared;
    const auto learned_as = [&](std::uint32_t model) -> std::optional<Learned> {
      const auto& request = models_.queues.at(model).learned;
      if (!request) return std::nullopt;
      return Learned{request->file, request->learn, request->with};
    };
    for (const auto& [model, occurring] : values) {
      if (const auto key = learned_as(model))
        shared[*key].insert(occurring.begin(), occurring.end());
    }
    for (auto& [model, occurring] : values) {
      if (const auto key = learned_as(model)) occurring = shared[*key];
    }
  }

  // "3", "3,go".
  std::vector<std::string> names_of(std::uint32_t model,
                                    const std::set<std::vector<std::uint64_t>>& occurring) const {
    const std::vector<ValueType>& types = models_.names.carried.at(model);
    std::vector<std::string> names;
    for (const std::vector<std::uint64_t>& places : occurring) {
      std::string& name = names.emplace_back();
      for (std::size_t i = 0; i < places.size(); ++i) {
        name +=
            (i == 0 ? "" : ",") + to_string(types[i].at(places[i]), types[i].kind, models_.words);
      }
    }
    return names;
  }

  void make(std::uint32_t model, std::vector<std::string> values) {
    QueueModel& queue = models_.queues.at(model);
    ModelInstance& instance = models_.instances[model];
    if (queue.learned) {
      queue.learned->values = std::move(values);
      instance.read(ask_source(file_, source_, {}, *queue.learned));
    } else {
      for (std::string& value : values) value = "(" + std::move(value) + ")";
      queue.size.values = std::move(values);
      instance.as_read.reset();
      make_queue_of(models_, model, queue.size, limits_);
    }
    add_ends(file_, models_, model, limits_);
  }

  const Declarations& file_;
  Models& models_;
  const ModelSource& source_;
  const QueueLimits& limits_;
};

}  // namespace

void find_values(const Declarations& file, Models& models, const ModelSource& source,
                 const QueueLimits& limits, const RunControl& control) {
  models.own.resize(file.programs.size());
  if (models.queues.empty() && models.names.variables.empty()) return;
  ValueFinder(file, models).find();
  if (!models.first_errors.empty()) throw models.first_errors.begin()->second;
  make_shared_variables(models);
  if (models.names.carried.empty()) return;
  QueueMaker(file, models, source, limits).make(find_occurring_values(file, models, control));
}

}  // namespace maide
