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

// Why nothing that is written to a model, learned from a real connection, is ever delivered: "its
// writer offers reliability best_effort, its reader asks for reliable, and such ends never match";
// "" if something is, or it is not known why. By the rules of DDS: a reader takes no less than it
// asks for.
std::string describe_mismatch(const ModelInstance& model);

// Why the built-in model does not take that input in its state: "is held", "is full".
std::string describe_refusal(const ModelInstance& model, Symbol input);

// The input or output of that name as the file has it: "send" for the "send2" of a service's second
// client, "write" for the "write2" of a topic's second writer.
std::string file_word(const System& system, std::uint32_t model, const std::string& name);
// Names of inputs or outputs; where more than `most` differ in their values alone, these as one
// without a value: "write" for "write(0)" and "write(1)".
std::vector<std::string> without_values(const std::vector<std::string>& names,
                                        std::size_t most = 1);

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

// What the program waits for in that control state: steps that are progress, and of these no error,
// unless there is nothing else.
std::vector<ProgramEdge> awaited_at(const Program& program, ControlState control);
// What the program waits for with these steps, of which one is no plain input or output, and by
// these guards, which do not hold: "waits at line 6 in a select for q.read -> message or n == 1".
std::string describe_waiting(const System& system, const Program& program,
                             const std::vector<ProgramEdge>& awaited,
                             const std::vector<Program::Guard>& guards = {});
// The guards of the `select` at which control stands that do not hold there, whatever shared
// variables are.
std::vector<Program::Guard> closed_guards(const Program& program, ControlState control);

}  // namespace maide
