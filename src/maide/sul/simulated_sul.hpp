// A model, simulated: the system under learning that needs no middleware. An interface automaton is
// played with its actors, refusals and marks; a plain Mealy machine answers each input with its
// output, whole (no translation behind it).
#pragma once

#include <memory>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/sul/learning_purpose.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

class SteppedSystem;

class SimulatedSul : public Sul {
 public:
  // `name` is what the system is called in models and messages ("sim:port.dot"). An automaton must
  // be deterministic, quiescent at the start and without endless outputs; throws UsageError
  // otherwise.
  SimulatedSul(InterfaceAutomaton automaton, std::string name);
  SimulatedSul(Mealy machine, std::string name);
  ~SimulatedSul() override;

  const SulInfo& info() const override { return info_; }
  void add_purpose(const LearningPurpose& purpose) override;
  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override;

  // Adds to info().versions: what identifies the model ("model", a hash of its text).
  void add_version(const std::string& what, const std::string& version);

  // The machine behind it, in the given translation (a plain machine: as it is): what a perfect
  // equivalence oracle compares with. The purposes added are not part of it.
  Mealy reference(Translation translation) const;

 private:
  InterfaceAutomaton automaton_;
  Mealy machine_;
  bool is_plain_;
  SulInfo info_;
  std::vector<LearningPurpose> purposes_;
};

}  // namespace maide
