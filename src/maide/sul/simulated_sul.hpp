// A simulated model: the system under learning that needs no middleware. An interface automaton is
// played with its actors, refusals and marks. A plain Mealy machine answers each input with its
// output, whole (no translation behind it). Where a model is nondeterministic, chance decides, all
// ways alike: the same words in the same order are answered alike, but not the same word twice.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/automata/nondeterministic_mealy.hpp"
#include "maide/base/random.hpp"
#include "maide/sul/learning_purpose.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

class SteppedSystem;

class SimulatedSul : public Sul {
 public:
  // `name` is what the system is called in models and messages ("sim:port.dot"). An automaton must
  // be quiescent at the start and without endless outputs; throws UsageError otherwise (for endless
  // outputs of a nondeterministic one, when they are met).
  SimulatedSul(InterfaceAutomaton automaton, std::string name);
  SimulatedSul(const Mealy& machine, std::string name);
  SimulatedSul(NondeterministicMealy machine, std::string name);
  ~SimulatedSul() override;

  const SulInfo& info() const override { return info_; }
  void add_purpose(const LearningPurpose& purpose) override;
  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override;

  // Adds to info().versions: what identifies the model ("model", a hash of its text).
  void add_version(const std::string& what, const std::string& version);

  // The machine behind it, in the given translation (a plain machine: as it is): what a perfect
  // equivalence oracle compares with. The purposes added are not part of it. Throws UsageError if
  // the model is nondeterministic.
  bool is_deterministic() const { return is_deterministic_; }
  Mealy reference(Translation translation) const;

 private:
  void describe_plain(const Alphabet& inputs, const Alphabet& outputs);

  InterfaceAutomaton automaton_;
  NondeterministicMealy machine_;
  bool is_plain_;
  bool is_deterministic_ = true;
  Random random_{1};
  SulInfo info_;
  std::vector<LearningPurpose> purposes_;
};

}  // namespace maide
