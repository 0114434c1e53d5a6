#include "maide/check/build/value_flow.hpp"

#include <cstddef>
#include <deque>
#include <string>
#include <utility>

#include "maide/check/unroll/walker.hpp"

namespace maide {

namespace program_syntax {
namespace {

class FlowWalker;

// What one model offers, and who waits for it.
struct Offers {
  struct Waiting {
    FlowWalker* walker = nullptr;
    ControlState place = 0;
    std::size_t next = 0;  // of `outputs`: the first that was not offered there
  };
  std::vector<std::string> outputs;
  std::vector<Waiting> waiting;
  std::size_t offered = 0;  // of `outputs`: to all who waited
  bool has_newcomers = false;
};

// What flows between the programs.
class Flow {
 public:
  explicit Flow(const Names& names) : names_(names) {}

  bool carries(std::uint32_t model) const { return names_.carried.contains(model); }
  void note(std::uint32_t model, const std::vector<Value>& values, const std::string& arguments) {
    const auto types = names_.carried.find(model);
    if (types == names_.carried.end() || types->second.size() != values.size()) return;
    std::vector<std::uint64_t> places;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!types->second[i].contains(values[i])) return;  // an error of the run that comes there
      places.push_back(types->second[i].place_of(values[i]));
    }
    if (values_[model].insert(std::move(places)).second) {
      offers_[model].outputs.push_back("message" + arguments);
    }
  }
  void add_output(std::uint32_t model, const std::string& name) {
    offers_[model].outputs.push_back(name);
  }
  void wait(std::uint32_t model, FlowWalker& walker, ControlState place) {
    Offers& offers = offers_[model];
    offers.waiting.push_back({&walker, place});
    offers.has_newcomers = true;
  }

  std::map<std::uint32_t, Offers>& offers() { return offers_; }
  OccurringValues take_values() { return std::move(values_); }

 private:
  const Names& names_;
  std::map<std::uint32_t, Offers> offers_;  // by model
  OccurringValues values_;
};

// Walks through one program.
class FlowWalker final : public Walker {
 public:
  // Keeps references.
  FlowWalker(const Tree& tree, const Unrolled& program, ModelActions& actions, const Names& names,
             const RunControl& control, Flow& flow)
      : Walker(tree, program, actions, names, control), flow_(flow) {
    begin();
  }

  // Goes on from all places that were come to. Returns false if there was none.
  bool advance() {
    const std::size_t first = next_;
    for (; next_ < places_.size(); ++next_) {
      look_sometimes();
      const Place place = places_[next_];
      if (place.frame != no_frame) expand(static_cast<ControlState>(next_), place);
    }
    return next_ > first;
  }

  // The model offers the output to the place, which waits at it.
  void offer(ControlState number, std::uint32_t model, const std::string& output) {
    look_sometimes();
    const Place place = places_[number];
    const Statement& statement = statement_at(place.frame);
    const Values values = program_.valuations[place.valuation];
    const FrameId next = behind(place.frame);
    for (const SelectArm& arm : statement.select_arms) {
      if (!may_start(statement, arm, values) || !takes_from(arm, model, values)) continue;
      const Values after = behind_start(statement, arm, values);
      for (const FrameId behind_arm : ways_behind(place, statement)) {
        const FrameId end = arm.end ? enter(*arm.end, behind_arm) : behind_arm;
        if (arm.kind == SelectArm::Kind::output) {
          if (matches(arm.event, split_name(output), output, after)) {
            take(arm.event, *arm.body, end, output, after);
          }
        } else if (const Arm* of = arm_for(output, arm.arms, after)) {
          take(of->output, *of->body, end, output, after);
        }
      }
    }
    if (const Arm* of = arm_for(output, statement.arms, values)) {
      take(of->output, *of->body, next, output, values);
    }
  }

 private:
  // A queue takes what is written into it, whatever it is.
  Symbol input_of(std::uint32_t model, const Event& event, const Values& values) const override {
    if (event.has_arguments && event.name == "write" && flow_.carries(model)) return 0;
    return Walker::input_of(model, event, values);
  }

  void expand(ControlState number, const Place& place) {
    const Statement& statement = statement_at(place.frame);
    const Values values = program_.valuations[place.valuation];
    const SourcePosition where = at(statement.line, statement.column);
    const FrameId next = behind(place.frame);
    using Kind = Statement::Kind;
    if (place.phase == Phase::writes) {
      settle(next, values);
      return;
    }
    switch (statement.kind) {
      case Kind::choice:
        for (const Value way : {1, 0}) settle(enter(branch(statement, way), next), values);
        break;
      case Kind::choose:
        if (const auto choices = choices_of(statement, values)) {  // too many are told later
          for (const Value value : *choices) with_value(place, statement, value, values);
        }
        break;
      case Kind::assign:
        for (const auto& way : outcomes(*statement.expression, values, where)) {
          if (way.result.value) with_value(place, statement, *way.result.value, values);
        }
        break;
      case Kind::when:
      case Kind::repeat_while:
        for (const auto& way : outcomes(*statement.expression, values, where)) {
          if (way.result.value) behind_condition(place, statement, *way.result.value, values);
        }
        break;
      case Kind::atomic:
        for (const auto& way : outcomes_of_atomic(statement, values, where)) {
          if (!way.result.is_blocked && way.result.error.empty()) settle(next, way.result.values);
        }
        break;
      case Kind::select: expand_arms(number, place, statement, values); break;
      case Kind::rounds:
        expand_arms(number, place, statement, values);
        expand_looks(place, statement, values);
        break;
      case Kind::spin:
        expand_arms(number, place, statement, values);
        settle(next, values);
        break;
      case Kind::refused_spin: break;
      case Kind::end_callback:
      case Kind::withdraw:
      case Kind::run:
      case Kind::join:
      case Kind::relock:
      case Kind::kill:
      case Kind::restart:
      case Kind::end_process:
      case Kind::arrival: settle(next, values); break;
      default: expand_rendezvous(number, place, statement, values); break;
    }
  }

  void expand_rendezvous(ControlState number, const Place& place, const Statement& statement,
                         const Values& values) {
    const FrameId next = behind(place.frame);
    const std::uint32_t model = model_of(statement.model, values);
    if (place.phase == Phase::before) {
      note(statement.model, statement.input, values);
      behind_input(place, statement, values);
      return;
    }
    const bool is_service = names_.services.contains(model);
    bool waits = false;
    for (const Arm& arm : statement.arms) {
      if (arm.is_quiet) {
        settle(enter(*arm.body, next), values);
      } else if (is_service) {
        take(arm.output, *arm.body, next, arm.output.name, values);
      } else {
        waits = true;
      }
    }
    if (waits) flow_.wait(model, *this, number);
  }

  void expand_arms(ControlState number, const Place& place, const Statement& statement,
                   const Values& values) {
    std::set<std::uint32_t> models;
    for (const SelectArm& arm : statement.select_arms) {
      if (!may_start(statement, arm, values)) continue;
      try {
        expand_arm(place, statement, arm, values, models);
      } catch (const EvaluationError&) {  // an error of the run that takes the arm
      }
    }
    for (const std::uint32_t model : models) flow_.wait(model, *this, number);
  }

  void expand_arm(const Place& place, const Statement& statement, const SelectArm& arm,
                  const Values& values, std::set<std::uint32_t>& models) {
    const Values after = behind_start(statement, arm, values);
    using Kind = SelectArm::Kind;
    const bool names_model = arm.kind == Kind::input || arm.kind == Kind::output;
    if (names_model || arm.kind == Kind::arrival) check_arm(arm, after);
    const bool is_service = names_model && names_.services.contains(model_of(arm.model, after));
    if (names_model && !is_service && (arm.kind == Kind::output || !arm.body)) {
      models.insert(model_of(arm.model, after));
    } else {
      for (const FrameId behind_arm : ways_behind(place, statement)) {
        const FrameId next = arm.end ? enter(*arm.end, behind_arm) : behind_arm;
        settle(enter(arm.body ? *arm.body : *arm.arms.front().body, next), after);
      }
    }
    if (arm.kind == Kind::input) note(arm.model, arm.event, after);
  }

  // Where control goes on behind an arm. Code that spins may go on spinning.
  std::vector<FrameId> ways_behind(const Place& place, const Statement& statement) {
    std::vector<FrameId> ways{behind(place.frame)};
    if (statement.kind == Statement::Kind::spin) ways.push_back(place.frame);
    return ways;
  }

  // Of an executor that goes by rounds: by what it may have found. What it found before is passed
  // over.
  void expand_looks(const Place& place, const Statement& statement, const Values& values) {
    const bool has_passed = *values[statement.target.index] == 0;
    const Value looks = has_passed ? Value{1} << statement.select_arms.size() : 1;
    for (Value found = 0; found < looks; ++found) {
      Values after = values;
      after[statement.target.index] = found;
      settle(place.frame, std::move(after));
    }
  }

  bool may_start(const Statement& statement, const SelectArm& arm, const Values& values) const {
    if (statement.kind == Statement::Kind::rounds) {
      return (*values[statement.target.index] >> number_of(statement, arm) & 1) != 0;
    }
    try {
      return !arm.guard || reads_shared(*arm.guard) || evaluate(*arm.guard, values) != 0;
    } catch (const EvaluationError&) {
      return false;
    }
  }
  static std::size_t number_of(const Statement& statement, const SelectArm& arm) {
    return static_cast<std::size_t>(&arm - statement.select_arms.data());
  }
  // The values behind the arm's beginning. Of an executor that goes by rounds: those that come
  // later in its round are left.
  static Values behind_start(const Statement& statement, const SelectArm& arm, Values values) {
    if (statement.kind != Statement::Kind::rounds) return values;
    const auto passed = (Value{2} << number_of(statement, arm)) - 1;
    Value& left = *values[statement.target.index];
    left &= ~passed;
    return values;
  }
  bool takes_from(const SelectArm& arm, std::uint32_t model, const Values& values) const {
    using Kind = SelectArm::Kind;
    const bool takes = arm.kind == Kind::output || (arm.kind == Kind::input && !arm.body);
    if (!takes) return false;
    try {
      return model_of(arm.model, values) == model;
    } catch (const EvaluationError&) {
      return false;
    }
  }

  // The program writes that.
  void note(const ModelReference& model, const Event& event, const Values& values) {
    if (event.name != "write" || !event.has_arguments) return;
    std::vector<Value> written;
    for (const Event::Argument& argument : event.arguments) {
      written.push_back(evaluate(argument.expression, values));
    }
    const std::string arguments = name_of(event, values).substr(event.name.size());
    const std::uint32_t number = element(model.leaf, values);
    if (!model.is_topic) return flow_.note(number, written, arguments);
    for (const Topic::Reader& reader : names_.topics[number].readers) {
      flow_.note(reader.model, written, arguments);
    }
  }

  Flow& flow_;
  std::size_t next_ = 0;  // place that is expanded next
};

}  // namespace
}  // namespace program_syntax

namespace {

using program_syntax::Flow;
using program_syntax::FlowWalker;
using program_syntax::Offers;

class ValueSearch {
 public:
  ValueSearch(const Declarations& file, Models& models, const RunControl& control)
      : file_(file), models_(models), control_(control), flow_(models.names) {}

  OccurringValues run() {
    // The walkers see a system of these models.
    System system;
    system.models = std::move(models_.instances);
    system.words = std::move(models_.words);
    ModelActions actions(system);
    const auto put_back = [&] {
      models_.instances = std::move(system.models);
      models_.words = std::move(system.words);
    };
    try {
      add_outputs(system);
      add_walkers(system, actions);
      search();
    } catch (...) {
      put_back();
      throw;
    }
    walkers_.clear();
    put_back();
    return flow_.take_values();
  }

 private:
  // The names that are known before queues have values.
  void add_outputs(const System& system) {
    for (std::uint32_t model = 0; model < system.models.size(); ++model) {
      for (const std::string& name : system.models[model].automaton.outputs().names()) {
        if (name != "message" || !flow_.carries(model)) flow_.add_output(model, name);
      }
    }
  }

  void add_walkers(System& system, ModelActions& actions) {
    for (std::uint32_t number = 0; number < file_.programs.size(); ++number) {
      const ProgramDeclaration& program = file_.programs[number];
      program_syntax::Context known{
          system.models,   models_.names, system.words, number, models_.own[number],
          program.indices, nullptr,       nullptr,      {}};
      known.stage = program_syntax::Context::Stage::owners;
      try {
        trees_.push_back(resolve(program, known));
      } catch (const ParseError&) {
        continue;  // which is told when the program is made
      }
      walkers_.emplace_back(trees_.back(),
                            program_syntax::Unrolled{program.name, number, program.position,
                                                     program.may_die, program.nodes},
                            actions, models_.names, control_, flow_);
    }
  }

  void search() {
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      for (FlowWalker& walker : walkers_) goes_on = walker.advance() || goes_on;
      for (auto& [model, offers] : flow_.offers()) goes_on = offer(model, offers) || goes_on;
    }
  }

  // Returns false if nobody was offered anything.
  bool offer(std::uint32_t model, Offers& offers) {
    if (!offers.has_newcomers && offers.offered == offers.outputs.size()) return false;
    bool was_offered = false;
    for (Offers::Waiting& waiting : offers.waiting) {
      for (; waiting.next < offers.outputs.size(); ++waiting.next) {
        waiting.walker->offer(waiting.place, model, offers.outputs[waiting.next]);
        was_offered = true;
      }
    }
    offers.offered = offers.outputs.size();
    offers.has_newcomers = false;
    return was_offered;
  }

  const Declarations& file_;
  Models& models_;
  const RunControl& control_;
  Flow flow_;
  std::deque<program_syntax::Tree> trees_;
  std::deque<FlowWalker> walkers_;  // in their places: those who wait point to them
};

}  // namespace

OccurringValues find_occurring_values(const Declarations& file, Models& models,
                                      const RunControl& control) {
  return ValueSearch(file, models, control).run();
}

}  // namespace maide
