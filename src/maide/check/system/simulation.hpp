// A run of a system that is made step by step, forward and back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "maide/base/random.hpp"
#include "maide/check/system/system.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

class Simulation {
 public:
  // Why nothing follows, but for deaths.
  enum class End : std::uint8_t {
    none,      // something does
    ended,     // all programs have ended
    at_rest,   // those that have not ended may rest
    deadlock,  // some program neither has ended nor may rest
    error,     // a program has come to an error
    cut,       // the run has left what was learned
  };

  // Keeps a reference.
  explicit Simulation(const System& system);

  const System& system() const { return system_; }
  const Trace& trace() const { return trace_; }
  // One more than steps were taken.
  const std::vector<GlobalState>& states() const { return states_; }
  // What can come next.
  const std::vector<Step>& next() const { return next_; }
  End end() const;

  // One of next().
  void take(std::size_t index);
  // Takes the last step back. There is one.
  void go_back();

 private:
  const System& system_;
  Trace trace_;
  std::vector<GlobalState> states_;
  std::vector<Step> next_;
};

// One of the steps, which are some and those of an actor side by side: first the actor is drawn,
// then his step, all alike. So whoever can go on goes on, with probability one.
std::size_t draw_step(const std::vector<Step>& steps, Random& random);

}  // namespace maide
