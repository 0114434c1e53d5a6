// Which values programs write into queues, and which of them use which variables. Both depend on
// each other - a value is read into a variable and written elsewhere - so programs are resolved
// again and again until nothing new comes. Values only become more, and a queue with too many is
// refused, so this ends.
#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/build/code_resolver.hpp"
#include "maide/check/build/models.hpp"

namespace maide {
namespace {

constexpr int max_rounds = 20;

class ValueFinder {
 public:
  ValueFinder(const Declarations& file, Models& models, const QueueLimits& limits)
      : file_(file), models_(models), limits_(limits) {}

  void find() {
    for (int round = 0;; ++round) {
      has_new_values_ = false;
      for (std::uint32_t program = 0; program < file_.programs.size(); ++program) {
        resolve(program);
      }
      if (!has_new_values_) break;
      for (const auto& [model, queue] : models_.queues) {
        if (!queue.types.empty()) make_valued(model);
      }
      if (round == max_rounds) fail_growing();
    }
    for (const auto& [name, programs] : users_) {
      if (programs.size() == 1) models_.own[*programs.begin()].insert(name);
    }
    for (const auto& [name, variable] : models_.names.variables) {
      if (!users_.contains(name)) models_.unused.push_back(variable);
    }
  }

 private:
  void resolve(std::uint32_t number) {
    const ProgramDeclaration& program = file_.programs[number];
    program_syntax::Context known = models_.context(file_, number);
    known.on_value = [&](std::uint32_t model, const program_syntax::Event& input, std::size_t place,
                         const ValueType& type) { note(model, input, place, type); };
    try {
      const program_syntax::Tree tree =
          program.thread ? program_syntax::resolve_thread(*program.thread, program.position, known)
                         : program_syntax::resolve_program(*program.code, known);
      models_.first_errors.erase(number);
      for (const std::string& name : tree.file_variables) users_[name].insert(number);
    } catch (const ParseError& error) {
      models_.first_errors.insert_or_assign(number, error);
    }
  }

  // What is written has a value of that type, too.
  void note(std::uint32_t model, const program_syntax::Event& input, std::size_t place,
            const ValueType& type) {
    const auto queue = models_.queues.find(model);
    if (queue == models_.queues.end() || input.name != "write") return;
    auto& types = queue->second.types;
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

  // "(3)", "(3,go)": all values that may be written into the queue.
  std::vector<std::string> values_of(std::uint32_t model) const {
    std::vector<std::string> values = {""};
    for (const ValueType& type : models_.queues.at(model).types) {
      std::vector<std::string> longer;
      if (type.count() > max_queue_states) fail_large_queue(models_, model, limits_);
      for (const std::string& value : values) {
        for (std::uint64_t place = 0; place < type.count(); ++place) {
          longer.push_back((value.empty() ? "(" : value + ",") +
                           to_string(type.at(place), type.kind, models_.words));
          if (longer.size() > max_queue_states) fail_large_queue(models_, model, limits_);
        }
      }
      values = std::move(longer);
    }
    for (std::string& value : values) value += ")";
    return values;
  }

  // The queue's automaton with all values that are written into it; of a learned one as yet only
  // the names of its inputs and outputs.
  void make_valued(std::uint32_t model) {
    QueueModel& queue = models_.queues.at(model);
    queue.size.values = values_of(model);
    ModelInstance& instance = models_.instances[model];
    if (queue.learned) {
      queue.learned->values.clear();
      for (const std::string& value : queue.size.values) {
        queue.learned->values.push_back(value.substr(1, value.size() - 2));
      }
      instance.read(names_alone(instance.automaton, queue.size.values));
      return;
    }
    instance.as_read.reset();
    make_queue_of(models_, model, queue.size, limits_);
    add_ends(file_, models_, model, limits_);
  }

  static InterfaceAutomaton names_alone(const InterfaceAutomaton& known,
                                        const std::vector<std::string>& values) {
    const InterfaceAutomaton valued = make_queue({1, false, values});
    std::vector<std::string> inputs = valued.inputs().names(), outputs = valued.outputs().names();
    const auto add = [](std::vector<std::string>& names, const Alphabet& more) {
      for (const std::string& name : more.names()) {
        const std::string base = name.substr(0, name.find('('));
        if (base == "write" || base == "message") continue;
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
      }
    };
    add(inputs, known.inputs());
    add(outputs, known.outputs());
    InterfaceAutomaton alone(Alphabet(std::span<const std::string>(inputs)),
                             Alphabet(std::span<const std::string>(outputs)), 1);
    alone.actors = known.actors;
    return alone;
  }

  [[noreturn]] void fail_growing() const {
    for (const auto& [model, queue] : models_.queues) {
      if (queue.types.empty()) continue;
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
  const QueueLimits& limits_;
  std::map<std::string, std::set<std::uint32_t>> users_;  // of variables: programs
  bool has_new_values_ = false;
};

}  // namespace

void find_values(const Declarations& file, Models& models, const ModelSource& source,
                 const QueueLimits& limits) {
  models.own.resize(file.programs.size());
  if (models.queues.empty() && models.names.variables.empty()) return;
  ValueFinder(file, models, limits).find();
  for (const auto& [model, queue] : models.queues) {
    if (!queue.learned || queue.types.empty()) continue;
    models.instances[model].read(ask_source(file, source, {}, *queue.learned));
    add_ends(file, models, model, limits);
  }
}

}  // namespace maide
