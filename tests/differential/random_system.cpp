#include "random_system.hpp"

#include "maide/automata/random_automata.hpp"

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

}  // namespace

System random_system(Random& random) {
  System system;
  system.file = "random.yaml";
  system.models.push_back(random_model("m", random));
  if (random.chance(0.6)) system.models.push_back(random_model("n", random));
  const std::vector<ProgramInterface> interfaces = system.interfaces();
  const std::uint64_t count = random.between(1, 3);
  for (std::uint64_t index = 0; index < count; ++index) {
    std::string text = ProgramText(system, random).block(2);
    if (random.chance(0.5)) text = "loop { m.i0; " + text + "}";
    const std::string name(1, static_cast<char>('p' + index));
    system.programs.push_back(
        parse_program(name, ScalarText(text, text, {"random.yaml", 1, 1}), interfaces));
  }
  return system;
}

}  // namespace maide::test
