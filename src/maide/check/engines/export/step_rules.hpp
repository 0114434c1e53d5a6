// The steps of a system as rules, for its exports: each language writes the same rules in its own
// words. A rule is one edge of one program, or one action of nobody, with a relation for each model
// that the edge uses: from which of its states the model goes to which. So a step is possible where
// the program stands at the rule's control state and each model in a state of its relation. The
// meaning is that of check/system/system.hpp: a step of the system belongs to exactly one rule, and
// is exactly one choice of moves of its relations.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/engines/export/step_action.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

// The system has what is no single input, output, `quiet` or choice: steps that use several models
// or a shared variable, deaths, errors, statements at which a program may rest or wait for ever,
// what nobody does.
bool uses_second_edition(const System& system);

// What a model does when it is used in one way.
struct ModelRelation {
  enum class Bound : std::uint8_t {
    within,   // of what was learned
    dropped,  // an input where it was never tried: nothing changes
    cut,      // an input where it was never tried: the run is cut
  };
  ModelUse use;
  Bound bound = Bound::within;
  std::vector<std::pair<StateId, StateId>> moves;  // from, to; by the state that they are from

  std::uint32_t model() const { return use.model; }
  bool changes_nothing() const;  // each move stays where it is
};

struct StepRule {
  std::uint32_t actor = 0;               // a program, or nobody
  ControlState source = 0;               // of nobody: 0
  std::uint32_t action = 0;              // an edge of the program, or an action of nobody
  std::vector<std::uint32_t> relations;  // one for each use, in order
  bool is_beyond = false;                // a relation is not within what was learned
  bool is_cut = false;                   // the run is cut: an export stays where it is
};

// What a rule does, wherever its program stands: the letter of an export that has letters.
struct RuleAction {
  StepAction action;
  std::vector<std::uint32_t> relations;
  auto operator<=>(const RuleAction&) const = default;
};

class StepRules {
 public:
  // Keeps a reference. O(edges + uses x states of their models).
  explicit StepRules(const System& system);

  // Those that have a move.
  const std::vector<ModelRelation>& relations() const { return relations_; }
  // The rules of one control state, in the order of its edges; of nobody all. O(its edges x
  // relations).
  std::vector<StepRule> rules_of(std::uint32_t actor, ControlState state) const;
  // As far as the relations alone tell, some run is cut.
  bool may_cut() const;

  // The step of the rule, but for its targets.
  static Step begun_step(const StepRule& rule);
  RuleAction action_of(const StepRule& rule) const;
  // Its name in another language, which no other action of the program has.
  const std::string& name_of(const RuleAction& action, ExportNames& names, bool of_program) const;
  // "via.write", "via!message", "via quiet", "n == 3", and behind it " beyond" or " dropped".
  std::string describe(const ModelRelation& relation) const;

  // The step that the rule is in that state, with move number `ranks[i]` of those that relation i
  // has from the state of its model. Nothing if it is not possible.
  std::optional<Step> step_of(const StepRule& rule, const std::vector<std::uint32_t>& ranks,
                              const GlobalState& state) const;

 private:
  const std::vector<std::uint32_t>& relations_of(const ModelUse& use);
  void add_rules(const StepRule& begun, std::vector<StepRule>& rules) const;

  const System& system_;
  std::vector<ModelRelation> relations_;
  std::map<ModelUse, std::vector<std::uint32_t>> by_use_;
};

}  // namespace maide
