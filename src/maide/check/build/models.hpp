// The automata of a system's models: read, learned, made by hand or by rules. This is the only
// stage that asks anybody for a model, and so the only one from which a wrapper may be started.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "maide/check/build/declarations.hpp"
#include "maide/check/build/queue_growth.hpp"

namespace maide {

// A queue, of which programs decide which values it carries (Names::carried).
struct QueueModel {
  QueueSize size;
  std::optional<ModelRequest> learned;  // the queue is a model that was learned without values
};

struct Models {
  std::vector<ModelInstance> instances;
  Names names;  // with what the automata bring: who waits for a return, what a death does
  WordTable words;
  GrowingModels growing;                       // large queues, and services
  std::map<std::uint32_t, QueueModel> queues;  // by model
  // Which of the file's variables are one program's alone, by program.
  std::vector<std::set<std::string>> own;
  std::vector<VariableName> unused;                // variables that no program uses
  std::map<std::size_t, ParseError> first_errors;  // by program: what was met last

  program_syntax::Context context(const Declarations& file, std::uint32_t program);
};

// Asks for each model once, in the order of the file, and for queues that carry values once more.
// Throws ParseError, what `source` throws, and Interrupted when the control says stop.
Models find_models(const Declarations& file, const ModelSource& source,
                   const QueueLimits& limits = {}, const RunControl& control = {});

// ---- Its parts ----

// The automaton that the request stands for. A UsageError has its place: the option that it names,
// or else the system.
InterfaceAutomaton ask_source(const Declarations& file, const ModelSource& source,
                              const ModelOrigin& origin, const ModelRequest& request);
// What becomes of the model because programs stand at its ends: it is a topic's reader's, or some
// of them may die.
void add_ends(const Declarations& file, Models& models, std::uint32_t model,
              const QueueLimits& limits);
// A queue of the file: the automaton with all its states, or one that grows.
void make_queue_of(Models& models, std::uint32_t number, const QueueSize& size,
                   const QueueLimits& limits);
[[noreturn]] void fail_large_queue(const Models& models, std::uint32_t model,
                                   const QueueLimits& limits);
// Which programs use which variables of the file, and of what types are the values that are written
// into queues: found by resolving the programs until nothing new comes. The variables that several
// programs use become models. The queues get their automata, with the values that occur
// (value_flow.hpp).
void find_values(const Declarations& file, Models& models, const ModelSource& source,
                 const QueueLimits& limits, const RunControl& control);

}  // namespace maide
