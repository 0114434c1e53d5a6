// A program against the whole library: every public header at once, and a machine learned.
#include <iostream>
#include <maide/maide.hpp>
#include <string>

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
  maide::SulOracle system{machine};
  maide::Cache oracle{system};
  maide::LmPlus learner{oracle};
  maide::WMethod teacher{oracle, {.extra_states = 1}};
  const maide::Mealy model = learn(learner, teacher);
  std::cout << maide::version() << ": " << model.size() << " states\n";
  return model.size() == 2 ? 0 : 1;
}
