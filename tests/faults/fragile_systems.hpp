// What the tests of crashing systems share: the fragile lamp and its model.
#pragma once

#include <exception>
#include <map>
#include <string>

#include "maide/automata/interface_automaton.hpp"
#include "maide/experiment/learn_model.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"

namespace maide::test {

using Options = std::map<std::string, std::string>;

// `end` is what a hit does to the lamp that is on.
inline InterfaceAutomaton make_lamp(const std::string& end) {
  InterfaceAutomaton lamp(Alphabet({"press", "hit"}), Alphabet({"on", "off", "dull", end}), 7);
  const auto input = [](Symbol symbol) { return Action{Action::Kind::input, symbol}; };
  const auto output = [](Symbol symbol) { return Action{Action::Kind::output, symbol}; };
  lamp.add_transition(0, input(0), 2);   // off, press
  lamp.add_transition(2, output(0), 1);  // on
  lamp.add_transition(1, input(0), 3);   // on, press
  lamp.add_transition(3, output(1), 0);
  lamp.add_transition(0, input(1), 4);  // off, hit
  lamp.add_transition(4, output(2), 0);
  lamp.add_transition(1, input(1), 5);  // on, hit
  lamp.add_transition(5, output(3), 6);
  return lamp;
}

inline LearnedModel learn_lamp(const Options& options, Translation translation,
                               const ExperimentOptions& experiment = {}) {
  const auto sul = spawn_wrapper({MAIDE_BINARY_DIR "/bin/fragile_wrapper"}, options);
  LearnedModel learned = learn_model(*sul, translation, experiment);
  if (learned.experiment.error) std::rethrow_exception(learned.experiment.error);
  return learned;
}

}  // namespace maide::test
