// Components of a system: programs that have something to do with one another, because their texts
// name the same model or shared variable, or because an action of nobody joins their models.
// Components do not notice each other. Deadlocks, stuck programs and errors are decided in each,
// and a formula on the runs of those that its atoms name. A search visits the sum of their states,
// and not the product.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "maide/check/system/system.hpp"

namespace maide {

// Models that the program's text names or its steps use.
std::set<std::uint32_t> models_of(const Program& program);

// The programs of each component, ascending; in the order of their first programs. O(edges).
std::vector<std::vector<std::uint32_t>> find_components(const System& system);

// The programs of the components that the property's atoms name: those of the named programs, and
// of the programs that name the same models. For a property without atoms the first component's.
std::vector<std::uint32_t> programs_of(const System& system, const Property& property,
                                       const std::vector<std::vector<std::uint32_t>>& components);

// The programs of the components in which nothing can happen but deaths, while some program of it
// has neither ended nor may rest.
std::vector<std::uint32_t> deadlocked_programs(const System& system, const GlobalState& state);

// All programs of a system belong to it, and so does all that happens by itself: each action of
// nobody uses a model of some program.
bool is_whole(const System& system, const std::vector<std::uint32_t>& programs);

// Some step waits for what anybody may do.
bool awaits_anybody(const System& system);

// Some programs of a system with the models that they name, as a system of its own. What nobody
// does belongs to it if it uses one of its models. Its programs, models and actions of nobody have
// other numbers, in the same order; edges, states and actions of models have the same.
class SystemPart {
 public:
  // The whole system. Keeps a reference.
  explicit SystemPart(const System& whole);
  // Those programs, ascending; no programs: the whole system. With a property, what its atoms name
  // besides, and the texts that reports show; of a formula, or an automaton of runs, what anybody
  // may send does not count as what comes. Keeps a reference.
  SystemPart(const System& whole, std::vector<std::uint32_t> programs,
             const Property* property = nullptr);

  const System& system() const { return own_ ? *own_ : *whole_; }
  bool is_whole() const { return program_numbers_.empty(); }
  // The part's programs, by their numbers in the whole system.
  const std::vector<std::uint32_t>& programs() const { return programs_; }
  // A property of the whole system, whose atoms are all in the part, as one of the part.
  Property property(const Property& of_whole) const;
  // Whether a step of the whole system is one of the part.
  bool has(const Step& step) const;
  // A step of the part, and back.
  Step to_whole(Step step) const;
  Step from_whole(Step step) const;

 private:
  void add_programs();
  void add_ends();
  void add_nobodys_actions();
  CombinedStep renumbered(CombinedStep step) const;
  ModelUse renumbered(ModelUse use) const;

  const System* whole_;
  std::optional<System> own_;
  std::vector<std::uint32_t> programs_;
  std::vector<std::uint32_t> nobodys_actions_;  // their numbers in the whole system
  std::vector<std::uint32_t> program_numbers_,
      model_numbers_;  // in the part, by those in the whole
};

}  // namespace maide
