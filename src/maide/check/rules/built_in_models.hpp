// Models that a system file uses without a file: a mutex, a semaphore, a queue. They are written by
// hand, and verdicts say so.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

// `lock`, possible when nobody holds it; `unlock`, by anybody, possible when somebody does; perhaps
// `trylock`, which brings `yes` and locks, or `no`. 2 states, and 2 before the answers.
InterfaceAutomaton make_mutex(bool has_trylock = false);

// `acquire` while something is there, at first `count`; `release` up to `count`. count + 1 states.
InterfaceAutomaton make_semaphore(std::uint32_t count);

// What a system file may write behind `use:`, one row each; queues, whose contents programs decide,
// are apart, and so is what knows who uses it (locks.hpp).
struct BuiltInModel {
  std::string_view name;
  std::string_view option;  // under `with`, from 1; empty: it has none
  InterfaceAutomaton (*make)(std::uint32_t option);
};
std::span<const BuiltInModel> built_in_models();
const BuiltInModel* find_built_in(std::string_view name);  // null: there is none

struct QueueSize {
  std::uint32_t size = 1;     // at least 1
  bool drops_oldest = false;  // a write into a full queue; else it is not possible
  // What is written, each "(3)" or "(3,go)"; empty: messages without a value.
  std::vector<std::string> values{};
  bool is_unknown = false;  // nobody knows how many it keeps
  // It has an input that brings `null` where a read would wait.
  bool has_tryread = false;
  bool keeps_nothing = false;  // it takes every message, and no more is seen of it
};
inline constexpr std::uint64_t max_queue_states = 200'000;
// States that make_queue() makes: 2 size + 2 without values, else the words over them up to that
// length, twice and one more.
double queue_states(const QueueSize& queue);
// A strict port: `write`; a `read` of an empty queue is taken and waits; `message` comes. A
// `tryread` of an empty queue brings `null`.
// O(states).
//
// A queue of unknown size has what holds for every size. A second message may push out the
// first, so from there on one `read` gets a message, and what another one gets is unexplored. With
// values, the first is unexplored, too.
InterfaceAutomaton make_queue(const QueueSize& queue);

// A `depth:` or an option in system files, and of a model's origin.
inline constexpr const char* unknown_depth = "unknown";
bool has_unknown_depth(const InterfaceAutomaton& automaton);

// What a callback does whose code is not known: `begin` goes beyond what is known.
InterfaceAutomaton make_unknown_code(const std::string& callback);
// That callback; nothing of other models.
std::optional<std::string> find_unknown_code(const InterfaceAutomaton& automaton);

// A model whose states get their numbers as they are met, for one that has too many to make them
// all, or whose number is not known. A state is what the model holds; what follows it is worked out
// when it is asked for.
class GrowingModel {
 public:
  using Contents = std::vector<std::uint32_t>;
  virtual ~GrowingModel() = default;

  // The names and the initial state, which nothing follows yet.
  virtual InterfaceAutomaton start() const = 0;
  // It has more than max_queue_states states, which one need not count.
  virtual bool is_large() const = 0;
  // What the model holds there, in words; empty where its name says it.
  virtual std::string describe(StateId) const { return ""; }
  // How many messages it holds there, if it is a wire.
  virtual std::optional<std::uint32_t> held(StateId) const { return std::nullopt; }
  // What it holds there, if it is a service.
  virtual std::optional<ServiceContents> service_contents(StateId) const { return std::nullopt; }
  // Adds to the automaton, which start() made, what follows `state`. Nothing the second time.
  void expand(InterfaceAutomaton& automaton, StateId state);
  // And what follows the messages that are due then.
  void expand_with_messages(InterfaceAutomaton& automaton, StateId state);
  // The automaton with those of its states that are marked, each expanded, and the messages due
  // behind them. All else is one state, in which no input was ever tried. `numbers` becomes by
  // state its number there.
  InterfaceAutomaton cut_down(const InterfaceAutomaton& automaton, const std::vector<bool>& reached,
                              std::vector<StateId>& numbers);

  const Contents& contents(StateId state) const { return met_[state]; }
  // The state with these contents: a new one, or behind cut_down() the one for all else.
  StateId state_of(InterfaceAutomaton& automaton, Contents contents);
  // It is the state for all else, in the automaton that cut_down() made.
  bool is_elsewhere(StateId state) const { return is_cut_down_ && state + 1 == met_.size(); }

 protected:
  struct Follower {
    Action action;
    Contents contents;
  };
  explicit GrowingModel(Contents initial);
  virtual std::vector<Follower> followers(const Contents& contents) const = 0;
  // An output follows, and nothing else.
  virtual bool is_due(const Contents& contents) const = 0;

 private:
  std::map<Contents, StateId> states_;
  std::vector<Contents> met_;  // by state
  std::vector<bool> is_expanded_;
  bool is_cut_down_ = false;
};

// Contents: what the reader has (nothing, a read that waits, a message, or null), and what is kept,
// oldest first. Messages without values are counted instead: a list of each length would be as long
// as all of them squared.
class GrowingQueue : public GrowingModel {
 public:
  explicit GrowingQueue(QueueSize queue);

  InterfaceAutomaton start() const override;
  bool is_large() const override { return true; }

 private:
  static constexpr std::uint32_t idle = 0, waiting = 1, first_message = 2;

  std::vector<Follower> followers(const Contents& contents) const override;
  bool is_due(const Contents& contents) const override { return contents[0] >= first_message; }
  std::uint32_t null() const { return first_message + letters_; }

  bool is_counted() const { return queue_.values.empty(); }
  // How many are kept.
  std::size_t kept(const Contents& contents) const {
    return is_counted() ? contents[1] : contents.size() - 1;
  }
  void add(Contents& contents, Symbol letter) const;
  Symbol take_oldest(Contents& contents) const;

  QueueSize queue_;
  Symbol letters_ = 1;
};

}  // namespace maide
