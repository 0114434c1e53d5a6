// Learning purposes (Aarts & Vaandrager, CONCUR 2010): interface automata that say which inputs may
// be offered when. A purpose constrains only the inputs of its own alphabet. An input that it does
// not enable in its present state is beyond its bound and never reaches the system. Outputs that it
// does not know, or does not enable, leave it where it is.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "maide/automata/interface_automaton.hpp"

namespace maide {

// What the model says of an input beyond the bound.
enum class AtBound : std::uint8_t {
  refuse,  // the state is marked unexplored
  absorb,  // a self-loop marked absorbed is drawn (the paper's 16th transition)
};

class LearningPurpose {
 public:
  // `automaton` must be deterministic; throws UsageError otherwise.
  explicit LearningPurpose(InterfaceAutomaton automaton, AtBound at_bound = AtBound::refuse);

  // At most `bound` messages in flight: each of `sends` puts one there, each of `receives` takes
  // one away. A system that itself keeps at most `capacity` messages (0: no limit) never has more
  // in flight: with capacity <= bound the purpose allows everything. O(bound) states.
  static LearningPurpose in_flight(std::size_t bound, std::size_t capacity,
                                   std::span<const std::string> sends,
                                   std::span<const std::string> receives, AtBound at_bound);

  const InterfaceAutomaton& automaton() const { return automaton_; }
  AtBound at_bound() const { return at_bound_; }

  // A run of the purpose along one word.
  class Monitor {
   public:
    explicit Monitor(const LearningPurpose& purpose)
        : purpose_(&purpose), state_(purpose.automaton().initial()) {}
    bool allows(std::string_view input) const;
    void on_input(std::string_view input);    // an input that was taken
    void on_output(std::string_view output);  // an output that was observed
   private:
    const LearningPurpose* purpose_;
    StateId state_;
  };

 private:
  InterfaceAutomaton automaton_;
  AtBound at_bound_;
};

}  // namespace maide
