// A program against the public face: a machine learned, and a system of it checked.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <maide/maide.hpp>
#include <string>

static_assert(MAIDE_VERSION_NUMBER >= 200);

// Switches a light; what it answers is the light's new state.
class Switch {
 public:
  maide::Alphabet inputs() const { return {"press"}; }
  void reset() { is_on_ = false; }
  std::string step(const std::string&) {
    is_on_ = !is_on_;
    return is_on_ ? "on" : "off";
  }

 private:
  bool is_on_ = false;
};

int main() {
  Switch machine;
  const maide::Learned learned = maide::learn_machine(machine);
  const auto& model = std::get<maide::Mealy>(learned.model.value());
  std::cout << maide::version() << ": " << model.size() << " states, " << learned.strength << '\n';

  // The long way, by hand.
  maide::SulOracle system{machine};
  maide::Cache oracle{system};
  maide::LmPlus learner{oracle};
  maide::WMethod teacher{oracle, {.extra_states = 1}};
  if (learn(learner, teacher).size() != model.size()) return 1;

  // A port that is never read: the program waits for ever.
  std::ofstream("port.dot") << "digraph port { __start0 -> idle; idle -> full [label=\"?write\"];\n"
                               "full -> idle [label=\"!message\"]; }\n";
  std::ofstream("system.yaml") << "models:\n  via: {file: port.dot}\n"
                                  "programs:\n  planner: \"repeat 2 { via.write; }\"\n";
  const maide::Checked checked = maide::check("system.yaml");
  for (const maide::CheckedProperty& property : checked.properties) {
    std::cout << property.name << ": " << to_string(property.verdict) << ' ' << property.explanation
              << '\n';
  }
  return model.size() == 2 && checked.verdict == maide::Verdict::violated ? 0 : 1;
}
