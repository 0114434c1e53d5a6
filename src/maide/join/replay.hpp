// Replays runs of a composed system on the real one. The middleware behind each model is driven
// through its part of the run. What it does is compared with the run, step by step.
//
//   Trace ----> words      One for each model instance, and for each topic with all its ends. It
//   has
//                          the inputs that the programs give there, in order. The loop of a lasso
//                          is in it several times. For a deadlock the calls that the programs are
//                          left with follow.
//   words ----> answers    Of the real systems (Sul), each step until quiescence.
//   answers --> a walk     Along the trace. Every output must be due when a program takes it.
//                          Nothing may be due that the model does not have.
//
// Programs are not run: Maide makes their calls. Callbacks of nodes are, call by call
// (replayed_nodes.hpp). Instances share nothing but the programs. So each
// instance is given its word without the pauses that the steps of others would make. An order
// between steps of different instances is no part of what a model says.
//
// The idea to run a counterexample before it is believed: Groce, Peled & Yannakakis, "Adaptive
// model checking", TACAS 2002.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/system/trace.hpp"
#include "maide/join/real_system.hpp"

namespace maide {

// Where the real system did not do what the run says, and what it did.
struct Deviation {
  enum class Kind : std::uint8_t {
    output,        // the outputs of an input are others, or it was not taken: the model is wrong
    other_answer,  // as above, but another of the answers that a nondeterministic model has
    pending_call,  // a call is still busy whose program goes on in the run: its return is hidden
    deadlock,      // at the end the system takes a call that the model does not take
  };
  Kind kind = Kind::output;
  std::size_t step = 0;   // index of the trace's step; as many as it has steps: at its end
  std::size_t round = 0;  // of the loop, from 0; 0 before it
  std::uint32_t model = 0;
  std::string expected, seen;
  std::vector<std::string> word;  // inputs of the instance up to the one that went another way
  bool is_of_topic = false;       // of one with several ends: put together of its readers' models

  bool is_of_nodes = false;  // of the system that plays nodes

  // Such words are counterexamples to the instance's model.
  bool refutes_model() const {
    return !is_of_topic && !is_of_nodes && (kind == Kind::output || kind == Kind::deadlock);
  }
};

// One run on the real system.
struct ReplayedRun {
  std::optional<Deviation> deviation;  // none: the system followed
  // What was seen at each step of the trace, loops not repeated: the outputs of an input, "quiet",
  // "" for what needs no system. As long as the system followed, and the deviation.
  std::vector<std::string> seen;
  std::size_t steps = 0;  // that were followed, loops repeated
};

struct ReplayOptions {
  std::size_t loops = 3;  // how often the loop of a lasso is played, at least 1
  RunControl control;
};

// Plays the runs and hands each to `sink`, with its index, in order. All are runs of `system`.
// Throws Interrupted, WrapperError and what Sul::run throws; runs that were handed over stay valid.
// Each run costs a reset for each instance that it uses.
void play_on_real_system(const System& system, const std::vector<std::unique_ptr<RealSystem>>& real,
                         std::span<const Trace> traces, const ReplayOptions& options,
                         const std::function<void(std::size_t, ReplayedRun)>& sink);

}  // namespace maide
