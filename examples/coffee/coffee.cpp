// The smallest program that learns: a class of its own, a learner, a teacher, and a model that
// Graphviz draws. `coffee | dot -Tsvg > coffee.svg`
#include <iostream>
#include <maide/maide.hpp>

#include "coffee_machine.hpp"

int main() {
  CoffeeMachine machine;  // any class with inputs(), reset() and step()

  maide::SulOracle system{machine};  // plays words on the machine
  maide::Cache oracle{system};       // never plays the same word twice
  maide::LmPlus learner{oracle};
  maide::WMethod teacher{oracle, {.extra_states = 2}};

  const maide::Mealy model = learn(learner, teacher);

  std::cerr << model.size() << " states; " << teacher.guarantee() << '\n';
  write_dot(std::cout, model);  // ready for Graphviz
}
