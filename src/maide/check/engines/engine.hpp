// Engines decide properties of systems. There are three: Maide's own, SPIN (spin_engine.hpp) and
// LTSmin (ltsmin_engine.hpp). An engine answers for one property at a time. It knows nothing of
// what a verdict rests on; that is check_system's part.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/engines/verdict.hpp"
#include "maide/check/reduce/reduction_kind.hpp"
#include "maide/check/search/ranks.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

struct PropertyResult {
  std::string name;
  Verdict verdict = Verdict::inconclusive;
  std::string reason;  // one line: of an inconclusive verdict, or why one that holds says nothing
  std::uint64_t states = 0;               // stored; with a formula, of its product with the system
  std::uint64_t transitions = 0;          // seen, or taken in a search for cycles
  double seconds = 0;                     // of the search, wall clock
  std::uint64_t peak_bytes = 0;           // memory of the search
  std::uint64_t sent_bytes = 0;           // between ranks
  Reduction reduction = Reduction::none;  // what was used
  std::optional<Trace> trace;             // of a violation, or of what is possible
  std::optional<Trace> remarkable;        // of `stuck`, if it holds: a run that is not fair enough
  bool stays_within_learned = false;      // all runs were seen, and none goes beyond
  bool is_possibility = false;            // it holds if there is a run, which is the trace
  // Programs on whose runs it was decided, or of whose runs the trace is one; none: all.
  std::vector<std::uint32_t> programs;
  bool is_internal_error = false;  // an error of Maide's own, which `reason` names

  // The peak of the memory, shared out among the states; 0 without states.
  double bytes_per_state() const {
    return states == 0 ? 0 : static_cast<double>(peak_bytes) / static_cast<double>(states);
  }
};

// Whether some run leaves what was learned.
struct CutResult {
  Verdict verdict = Verdict::inconclusive;  // holds: no run does
  std::string reason;                       // of an inconclusive verdict
  std::optional<Trace> trace;               // its last step leaves what was learned
};

struct EngineOptions {
  std::optional<std::uint64_t> memory_mib;  // limit of a search; none: most of the machine's
  // What the native engine may leave out, as far as the property allows.
  Reduction reduction = Reduction::none;
  // Threads of a search that can use several; 0: one a processor. Verdicts do not depend on it, nor
  // what is found and counted breadth-first, or counted where nothing is put off and no cycle is
  // found.
  unsigned threads = 0;
  std::size_t states_a_thread = 256;  // at least, for it to be worth a thread
  // Not owned; those of rank 0, while the others serve_searches(). Null: this process is alone.
  // Memory and threads are those of each. Which counterexample is shown, and the counts of a
  // search that does not come to its end, depend on their number.
  Ranks* ranks = nullptr;
  // Stored by a search of the native engine, which is inconclusive beyond.
  std::uint64_t most_states = ~std::uint64_t{0};
  bool shortens = true;  // the native engine looks for a shorter run than the one it found first
  // A folder; not empty: the breadth-first searches of the native engine begin where one that was
  // stopped there had come to, and write how far they have come, every so many seconds.
  std::string checkpoints;
  double checkpoint_seconds = 60;
  RunControl control;
};

// The limit of a search in MiB: what the options say, or three quarters of the machine's memory, at
// least 256; a rank's share of it.
std::uint64_t memory_limit_mib(const EngineOptions& options);

// What the options say, or as many as this process may use processors; a rank's share of them.
unsigned thread_count(const EngineOptions& options);

// "interrupted" or "out of time": why a search that was told to stop was.
std::string why_stopped(const EngineOptions& options);

// Throws std::logic_error, an error of Maide's own, if the run that the engine shows does not
// violate the property.
void require_sound(const std::string& engine, const System& system, const Property& property,
                   const Trace& trace);

class Engine {
 public:
  virtual ~Engine() = default;
  virtual std::string name() const = 0;
  // What keeps this engine from checking the property of that whole system, one line; "" if
  // nothing does.
  virtual std::string obstacle(const System& system, const Property& property) const = 0;
  // Decides the property, which must have no obstacle. Limits and interruptions make the verdict
  // inconclusive. Throws UsageError if the engine cannot work at all (a missing tool, a full disk).
  virtual PropertyResult check(const System& system, const Property& property,
                               const EngineOptions& options) = 0;
  virtual CutResult find_cut(const System& system, const EngineOptions& options) = 0;
};

// The engine of that name: `native`, `spin`, `ltsmin`. Throws UsageError for others.
std::unique_ptr<Engine> make_engine(const std::string& name);

// Throws UsageError for options that say something to other engines alone.
void require_fitting(const Engine& engine, const EngineOptions& options);

// Maide's own engine: explicit states, packed (packed_system.hpp, state_table.hpp). Deadlocks, cuts
// and invariants by breadth-first search, so that what it shows is a shortest run; `stuck` and all
// other formulas by an on-the-fly search for a fair cycle (fair_cycle.hpp), in parts by several
// threads.
class NativeEngine : public Engine {
 public:
  std::string name() const override { return "native"; }
  std::string obstacle(const System& system, const Property& property) const override;
  PropertyResult check(const System& system, const Property& property,
                       const EngineOptions& options) override;
  CutResult find_cut(const System& system, const EngineOptions& options) override;
};

}  // namespace maide
