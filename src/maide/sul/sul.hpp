// The system under learning as the rest of Maide sees it: it answers batches of queries with traces
// of events. Each query starts from a fresh reset. A system refuses an input whose actor is still
// in a call, and does not try one that lies beyond its learning purposes. Both are answers
// ("refused", "unexplored"), not errors, and the word goes on behind them.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"

namespace maide {

// ---- Queries ----
//
// A system is asked a word or a decision tree: an input, then a subtree for each output. With a
// tree, adaptive learners and tests do not pay a reset for each branch. Queries exist on two
// levels. `Query` speaks the learner's symbols (inputs and outputs of a Mealy machine). `SulQuery`
// names the expected outputs by text, as they cross the wire.

// Which Mealy machine stands for an interface automaton (design: "Translations").
enum class Translation : std::uint8_t {
  eager,  // one step is an input and all outputs until quiescence
  av,     // Aarts & Vaandrager (CONCUR 2010): inputs answer "+", the extra input Delta takes one
          // output, or says "delta"; while outputs are due inputs are refused
};
std::string_view to_string(Translation translation);  // "eager", "av"

// A tree of inputs: node 0 is asked first; after an output without a branch of its own the query
// ends. `Output` is Symbol (learner's side) or std::string (on the wire).
template <typename Output>
struct BasicDecisionTree {
  struct Node {
    Symbol input = 0;
    std::vector<std::pair<Output, std::uint32_t>> branches;  // output -> index of the next node
  };
  std::vector<Node> nodes;
};

using DecisionTree = BasicDecisionTree<Symbol>;

// A question in the symbols of a Mealy machine.
using Query = std::variant<Word, DecisionTree>;

// A question to a system. Inputs are indices into SulInfo::inputs; under Translation::av the index
// one past the last stands for Delta. Branches are keyed by mealy_output() of the step.
struct SulQuery {
  std::variant<Word, BasicDecisionTree<std::string>> inputs;
  Translation translation = Translation::eager;
};

class LearningPurpose;

// ---- Answers ----
//
// What became of one input.
enum class StepStatus : std::uint8_t {
  taken,       // the system took the input; `events` are its outputs until quiescence
  refused,     // the actor is busy, or (av) an output is due: nothing was done
  unexplored,  // beyond a bound of a learning purpose: never tried
  absorbed,    // the same, under at-bound=absorb
  delta,       // av only: Delta took the output in `events`, or none was due
};

// An output as it was observed: which actor's call or callback produced it, and its name.
struct Event {
  std::uint32_t actor = 0;  // index into SulInfo::actors
  std::string output;
  bool operator==(const Event&) const = default;
};

struct SulStep {
  StepStatus status = StepStatus::taken;
  // In the canonical order: actors as declared, an actor's own in the order in which they came.
  std::vector<Event> events;
  std::vector<std::uint32_t> busy;        // actors whose call had not returned at quiescence
  std::chrono::microseconds duration{0};  // from the input to quiescence
  // The part of `duration` behind the last thing seen (an event, a call's return): what it took to
  // be sure that nothing more would come.
  std::chrono::microseconds settling{0};
};

// How a word ended. A crash or a hang that is reproducible is an observation: its step is the last
// one, and has the single event `crash` or `hang` (fatal_words.hpp).
enum class WordEnd : std::uint8_t {
  complete,
  crash,    // the system died in the last step
  hang,     // no quiescence within the step limit
  aborted,  // cancelled by the client
};

struct SulAnswer {
  Word inputs;                 // the inputs really asked: the word, or the path taken in the tree
  std::vector<SulStep> steps;  // one for each input, fewer when the word did not complete
  WordEnd end = WordEnd::complete;
  std::string reason;                           // why it ended in a crash or a hang, in words
  std::uint32_t attempts = 1;                   // how often the word was run to get this answer
  std::chrono::microseconds reset_duration{0};  // time of the reset before it
  // The part of `reset_duration` during which this query was there and waited; a reset that was
  // made while nobody asked costs time, but nobody's.
  std::chrono::microseconds reset_wait{0};
};

// The answer of a Mealy machine to a step: the outputs joined by ',' ("quiet" if none), "+" for an
// input under av, the output or "delta" for Delta, "refused", "unexplored" or "absorbed".
std::string mealy_output(const SulStep& step, Translation translation);
// The same without a copy of a single output; several are joined in `joined`.
std::string_view mealy_output(const SulStep& step, Translation translation, std::string& joined);

// Names that a system's own outputs must not have, because answers use them.
bool is_reserved_output(std::string_view name);

struct SulInput {
  std::string name;
  std::uint32_t actor = 0;  // index into SulInfo::actors
  // The outputs by which its call may return, observed or not ("written", "failed"); empty if the
  // call never blocks.
  std::vector<std::string> returns;
};

struct SulOutput {
  std::string name;
  std::uint32_t actor = 0;
};

// What a system says of itself once its options are set.
struct SulInfo {
  std::string name;                 // "port", "cyclonedds", "sim:coffee.dot"
  std::vector<std::string> actors;  // in the canonical order
  std::vector<SulInput> inputs;
  std::vector<SulOutput> outputs;               // those observed; may grow as outputs are seen
  std::map<std::string, std::string> options;   // effective values, defaults included
  std::map<std::string, std::string> versions;  // wrapper, middleware: part of the fingerprint
  std::string bound;            // what its own learning purpose bounds, "" if nothing:
                                // "at most 6 messages in flight"
  bool has_actors = true;       // false: a plain Mealy machine; answers are opaque outputs
  bool names_actors = true;     // false: its one actor is a name for the whole system
  bool speaks_trees = true;     // answers decision trees
  bool speaks_purposes = true;  // can be given a learning purpose
  bool speaks_av = true;        // understands Delta
};

// Failures that were put right: the system's process died, or did not end, and the word in progress
// was asked again, and that did not happen again each time.
struct SulIncidents {
  struct Death {
    std::string reason;  // "the wrapper was killed by signal 11 (Segmentation fault)"
    std::string after;   // the word that was answered last before it; "" if there was none
    std::string word;    // the word that was asked again; "" if none was in progress
  };
  static constexpr std::size_t most_kept = 20;
  std::uint64_t count = 0;
  std::vector<Death> first;  // the first ones, most_kept at most
  void add(Death death);
  void add(const SulIncidents& others);
};

// Called once for each query, with its index in the batch; in any order, from the calling thread.
using SulAnswerSink = std::function<void(std::size_t index, SulAnswer answer)>;

class Sul {
 public:
  virtual ~Sul() = default;

  virtual const SulInfo& info() const = 0;

  // Adds a learning purpose for all later queries. Throws UsageError where not supported.
  virtual void add_purpose(const LearningPurpose& purpose) = 0;

  // Runs every query from a fresh reset and hands its answer to `sink`. Throws WrapperError if the
  // system fails, Interrupted if `control` says stop; answers already given to `sink` stay valid.
  virtual void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
                   const RunControl& control) = 0;

  // Since the start.
  virtual SulIncidents incidents() const { return {}; }
};

}  // namespace maide
