// Models and what programs do with them, in the words of verdicts, traces and reports.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "maide/check/system/system.hpp"

namespace maide {

// "via was learned for at most 6 messages in flight".
std::string describe_bound(const ModelInstance& model);

// "a mutex", "a queue of size 2": of a model that is built in.
std::string describe_built_in(const ModelInstance& model);
// What models without a real system are, those of a kind in one line: "fork[0], fork[1] are written
// by hand (a mutex)", "n is a shared variable". Others are left out.
std::vector<std::string> describe_unreal(const System& system,
                                         const std::vector<std::uint32_t>& models);

// Why the built-in model does not take that input in its state: "is held", "is full".
std::string describe_refusal(const ModelInstance& model, Symbol input);

// "via.write", "via!message", "via quiet": what a step does with one model.
std::string describe_use(const System& system, const ModelUse& use);
// What the step does, in the system file's words.
std::string describe_action(const System& system, const Step& step);
// Who took the step: the program, or of nobody what happened by itself.
std::string describe_actor(const System& system, const Step& step);
// What the program's edge does, in the system file's words.
std::string describe_edge(const System& system, const Program& program, const ProgramEdge& edge);

// The error that the state is at, with its program: "p: x = 4 is outside of 0..3
// (system.yaml:7:3)"; "" if it is at none.
std::string describe_error(const System& system, const GlobalState& state);

// What the program waits for with these steps, of which one is no plain input or output: "waits at
// line 6 in a select for q.read -> message or n == 1".
std::string describe_waiting(const System& system, const Program& program,
                             const std::vector<ProgramEdge>& awaited);

// A callback that the program runs waits for an answer: why the callback does not start that
// takes the answer, or the request: ". detector.lookup takes it, and main runs that, too". Empty if
// no node has it. O(edges). The service's states have texts.
std::string describe_taker(const System& system, const GlobalState& state, std::uint32_t program,
                           std::uint32_t service);

}  // namespace maide
