#include "random_system.hpp"

#include "maide/automata/random_automata.hpp"
#include "maide/check/build/parse_program.hpp"

namespace maide::test {
namespace {

class ProgramText {
 public:
  ProgramText(const System& system, Random& random) : system_(system), random_(random) {}

  std::string block(int depth) {
    std::string text;
    for (std::uint64_t count = random_.between(1, 3); count > 0; --count) text += statement(depth);
    return text;
  }

  std::string step() { return input(model()) + ";"; }

 private:
  const ModelInstance& model() { return system_.models[random_.below(system_.models.size())]; }
  std::string name(const Alphabet& alphabet) {
    return alphabet.name(static_cast<Symbol>(random_.below(alphabet.size())));
  }
  std::string input(const ModelInstance& model) {
    return model.name + "." + name(model.automaton.inputs());
  }
  std::string output(const ModelInstance& model) { return name(model.automaton.outputs()); }

  std::string statement(int depth) {
    const std::string label = random_.chance(0.4) ? "@l" + std::to_string(labels_++) + " " : "";
    return label + unlabelled(depth) + "\n";
  }

  std::string unlabelled(int depth) {
    const ModelInstance& model = this->model();
    switch (random_.below(depth > 0 ? 9 : 5)) {
      case 0: return "wait " + model.name + " -> " + output(model) + ";";
      case 1: return random_.chance(0.3) ? "skip;" : input(model) + ";";
      case 2: return input(model) + ";";
      case 3:
      case 4: return input(model) + " -> " + output(model) + ";";
      case 5: return "if * { " + block(depth - 1) + "} else { " + block(depth - 1) + "}";
      case 6: return "repeat " + std::to_string(random_.below(4)) + " { " + block(depth - 1) + "}";
      case 7: return "loop { " + input(model) + "; " + block(depth - 1) + "}";
      default: return arms(model, depth);
    }
  }

  std::string arms(const ModelInstance& model, int depth) {
    std::string text = "switch " + input(model) + " { ";
    for (const std::string& output : model.automaton.outputs().names()) {
      if (random_.chance(0.7)) text += output + " { " + block(depth - 1) + "} ";
    }
    return text + "quiet { } }";
  }

  const System& system_;
  Random& random_;
  int labels_ = 0;
};

ModelInstance random_model(const std::string& name, Random& random) {
  RandomInterfaceAutomatonOptions options;
  options.states = random.between(2, 5);
  options.inputs = random.between(1, 2);
  options.outputs = random.between(1, 2);
  options.density = 0.5;
  options.unexplored = 0.5;
  options.absorbed = 0.2;
  options.deterministic = random.chance(0.5);
  ModelInstance model;
  model.name = name;
  model.automaton = random_interface_automaton(options, random);
  model.when_unexplored = static_cast<WhenUnexplored>(random.below(3));
  return model;
}

// Counts to 1, 2 or 3 by i0 and back by i1, which says o0 or nothing.
ModelInstance random_counter(const std::string& name, Random& random) {
  const auto most = static_cast<StateId>(random.between(1, 3));
  const bool says = random.chance(0.5);
  ModelInstance model;
  model.name = name;
  model.automaton =
      InterfaceAutomaton(Alphabet({"i0", "i1"}), Alphabet({"o0"}), says ? 2 * most + 1 : most + 1);
  const Action up{Action::Kind::input, 0}, down{Action::Kind::input, 1};
  for (StateId count = 0; count < most; ++count) {
    model.automaton.add_transition(count, up, count + 1);
    const StateId between = most + 1 + count;
    model.automaton.add_transition(count + 1, down, says ? between : count);
    if (says) model.automaton.add_transition(between, {Action::Kind::output, 0}, count);
  }
  model.automaton.set_initial(static_cast<StateId>(random.below(most + 1)));
  if (random.chance(0.3)) model.automaton.mark_unexplored(most, 0);
  model.when_unexplored = static_cast<WhenUnexplored>(random.below(3));
  return model;
}

// Of one or two messages. One too many is refused, or lost, or was never tried.
ModelInstance random_mailbox(const std::string& name, Random& random) {
  const auto most = static_cast<StateId>(random.between(1, 2));
  const StateId waiting = most + 1, due = waiting + 1;
  ModelInstance model;
  model.name = name;
  model.automaton = InterfaceAutomaton(Alphabet({"i0", "i1"}), Alphabet({"o0"}), due + most);
  const Action put{Action::Kind::input, 0}, take{Action::Kind::input, 1};
  model.automaton.add_transition(0, take, waiting);
  model.automaton.add_transition(waiting, put, due);
  for (StateId held = 0; held < most; ++held) {
    model.automaton.add_transition(held, put, held + 1);
    model.automaton.add_transition(held + 1, take, due + held);
    model.automaton.add_transition(due + held, {Action::Kind::output, 0}, held);
  }
  const std::uint64_t at_full = random.below(3);
  if (at_full == 0) model.automaton.add_transition(most, put, most);
  if (at_full == 1) model.automaton.mark_unexplored(most, 0);
  model.when_unexplored = static_cast<WhenUnexplored>(random.below(3));
  return model;
}

ModelInstance next_model(const std::string& name, const RandomSystemSize& size, Random& random) {
  if (size.mailboxes > 0 && random.chance(size.mailboxes)) return random_mailbox(name, random);
  const bool counts = size.counters > 0 && random.chance(size.counters);
  return counts ? random_counter(name, random) : random_model(name, random);
}

}  // namespace

System random_system(Random& random, const RandomSystemSize& size) {
  System system;
  system.file = "random.yaml";
  system.models.push_back(next_model("m", size, random));
  for (std::size_t index = 1; index < size.most_models; ++index) {
    if (!random.chance(0.6)) continue;
    const std::string name(1, static_cast<char>('m' + index));
    system.models.push_back(next_model(name, size, random));
  }
  const std::uint64_t count = random.between(size.least_programs, size.most_programs);
  for (std::uint64_t index = 0; index < count; ++index) {
    ProgramText program(system, random);
    std::string text = program.block(2);
    if (size.loops > 0) {
      if (random.chance(size.loops)) text = "loop { " + text + program.step() + "}";
    } else if (random.chance(0.5)) {
      text = "loop { m.i0; " + text + "}";
    }
    const std::string name(1, static_cast<char>('p' + index));
    system.programs.push_back(
        parse_program(name, ScalarText(text, text, {"random.yaml", 1, 1}), system));
  }
  return system;
}

}  // namespace maide::test
