// Why a program cannot go on where a run ends, or while a loop goes round: what it waits for, in
// which state its model is, since when, what became of the messages, and which programs could still
// change that. Here are facts alone; report/explanation.hpp puts them into words.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "maide/check/system/system.hpp"
#include "maide/check/system/trace.hpp"
#include "maide/check/verdict/message_account.hpp"
#include "maide/check/verdict/service_account.hpp"
#include "maide/check/verdict/ways_out.hpp"

namespace maide {

// What became of the request whose answer a client waits for.
struct ServiceWait {
  std::uint32_t model = 0;          // of the service
  std::uint32_t client = 0;         // its number there
  bool has_asked = false;           // along the run
  bool is_requested = false;        // a request of the client is not served
  bool is_served = false;           // one is served, and not answered
  bool is_coming = false;           // an answer to it is on its way
  bool is_answered = false;         // an answer to it is not taken
  std::optional<ServiceLoss> loss;  // its last, where nothing of it is on its way
  std::optional<Helper> taker;      // the client's callback that takes the answer, if it has one
  std::optional<Helper> server;     // who would serve the request, or answer it
};

// Why one program waits, at one position of a run.
struct Waiting {
  enum class Reason : std::uint8_t {
    nothing_due,  // it awaits outputs, and the model has none to give
    output_due,   // the model has another output due, and until that is taken it does nothing else
    busy,         // the model refuses the input: an earlier call has not returned
    bound,        // the input was never tried there, and is assumed to wait
    several,      // it awaits a step that is more than one input or output of one model
  };
  Reason reason = Reason::nothing_due;
  std::uint32_t program = 0;
  std::vector<ProgramEdge> awaited;       // all that it could go on with
  std::uint32_t model = 0;                // whose inputs or outputs these are; not of `several`
  std::optional<std::size_t> cause;       // the step that made the output due, or the call busy
  std::vector<Symbol> due;                // outputs of the model that are due
  std::optional<MessageAccount> account;  // of nothing_due: what became of the messages
  std::vector<WayOut> ways;               // of `several`
  std::vector<ServiceWait> services;      // of `several`: where an answer is awaited
  std::vector<Symbol> wanted;             // inputs that would help; of output_due: outputs to take
  // Programs, other than this one, that do what would help: that have it in their text, and of
  // those the ones that can still come to it from where they are.
  std::vector<std::uint32_t> helpers, reachable_helpers;
  // In a `repeat`, the program is in round `round` of `rounds`, and the awaited thing is the one
  // with that number there; of `rounds` if each round does it once, whatever happens (0: no
  // `repeat`).
  std::uint32_t round = 0, rounds = 0, number = 0;
  bool is_once_a_round = false;
};

// What keeps the program from stepping at position `at` of the run (`states` are replay()'s, of
// which the first at + 1 count). The program must have a step to take, and none possible there.
Waiting find_waiting(const System& system, const Trace& trace,
                     const std::vector<GlobalState>& states, std::size_t at, std::uint32_t program);

// The programs that cannot step, but for dying, although they have not ended, may not rest and are
// at no error; in order.
std::vector<std::uint32_t> blocked_programs(const System& system, const GlobalState& state);

// A circle of programs each of which waits for the next and nobody else, the first of them the
// first of `waitings`; empty if there is none. Only the last waits for the first again.
std::vector<std::uint32_t> find_circle(const std::vector<Waiting>& waitings);

}  // namespace maide
