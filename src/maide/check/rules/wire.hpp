// A wire: what a writer has sent and a model has not got, in order. Nothing holds between wires.
// What lies on a wire comes to the model by itself, one after the other, at any time.
//
// A writer that keeps its last p messages may lose an older one that is still on its way: when its
// turn comes, it arrives or it is lost. A wire holds at most 10 messages, or p where that is more.
// What is put on it then pushes out the oldest, or waits where the writer keeps all.
//
// Where the two ends meet some time after the start, what is put before is lost, but for the newest
// that the writer keeps for who comes later: these are on the wire once they meet.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/rules/built_in_models.hpp"
#include "maide/check/system/model_actions.hpp"

namespace maide {

struct WireRules {
  std::uint32_t keep_last = 0;  // messages that the writer keeps; 0: all, so that none is lost
  bool loses = false;           // any message may be lost
  bool meets = false;           // its ends meet some time after the start
  std::uint32_t kept = 0;       // messages for who comes later; of a wire whose ends meet

  static constexpr std::uint32_t least_room = 10;  // messages
  std::size_t room() const { return keep_last > least_room ? keep_last : least_room; }
  bool may_put(std::size_t held) const { return keep_last != 0 || held < room(); }
  // What is put is the newest of `items`. Where there is no room the oldest is lost.
  void put(std::vector<std::uint32_t>& items, std::uint32_t item) const;
  // The oldest of that many may be lost when its turn comes.
  bool may_lose(std::size_t held) const {
    return loses ? held > 0 : keep_last != 0 && held > keep_last;
  }
};

// The wire as a model. Its states are what it holds; programs and nobody use it by actions alone.
class WireModel : public GrowingModel {
 public:
  struct Operation {
    enum class Kind : std::uint8_t {
      put,       // the letter
      add,       // the letter, where there is room
      push_out,  // the letter pushes out the oldest
      arrive,    // the oldest, which is the letter
      lose,      // the oldest
      // The same, of the letter, by whether its writer has died; where calls are waited for.
      arrive_of_living,
      arrive_of_dead,
      lose_of_living,
      lose_of_dead,
      clear,       // its reader has died
      abandon,     // the writer has died: each message still arrives, or is lost
      is_full,     // a condition: nothing may be put
      is_empty,    // a condition
      is_used,     // a condition: something is on its way
      holds,       // a condition: a message of the caller that is the letter
      holds_none,  // a condition: none of its
      meet,        // its ends, which had not met
      has_met,     // a condition
    };
    Kind kind = Kind::put;
    std::uint32_t letter = 0;
  };

  // `inputs`: what may be sent, as texts show it: "write(3)". `callers`: how many there are whose
  // calls return with the arrival, each of which has one message at most on the wire; 0: calls
  // return at once. The first caller's letters are the inputs; the next one's follow.
  WireModel(WireRules rules, std::vector<std::string> inputs, std::uint32_t callers = 0);

  std::uint32_t letter_of(std::uint32_t input, std::uint32_t caller) const {
    return caller * static_cast<std::uint32_t>(inputs_.size()) + input;
  }

  // Its outputs name its steps: `lost`, and `arrives` or, of a message
  // with values, `arrives(3)`.
  InterfaceAutomaton start() const override;
  bool is_large() const override { return false; }
  // "2 messages: 3, 4"; "" of an empty wire.
  std::string describe(StateId state) const override;
  std::optional<std::uint32_t> held(StateId state) const override;

  // Adds all states to the automaton, which start() made. False if they are more than `most`.
  bool make_all(InterfaceAutomaton& automaton, bool writer_may_die, std::size_t most);
  ModelUse use(ModelActions& actions, std::uint32_t model, const Operation& operation);

  bool meets() const { return rules_.meets; }

  static constexpr Symbol lost = 0;
  Symbol arrives(std::uint32_t letter) const;

 private:
  std::vector<Follower> followers(const Contents&) const override { return {}; }
  bool is_due(const Contents&) const override { return false; }
  // Behind the operation; none where it is not possible. Contents: how many of the letters are of a
  // writer that has died, or `not_met`; and the letters, oldest first, or those kept.
  std::optional<Contents> after(Contents contents, const Operation& operation) const;
  std::optional<Contents> before_meeting(Contents contents, const Operation& operation) const;
  std::string text_of(const Operation& operation) const;
  const std::string& input_of(std::uint32_t letter) const {
    return inputs_[letter % inputs_.size()];
  }
  std::uint32_t caller_of(std::uint32_t letter) const {
    return letter / static_cast<std::uint32_t>(inputs_.size());
  }
  bool holds(const std::vector<std::uint32_t>& items, std::uint32_t caller) const;

  WireRules rules_;
  std::vector<std::string> inputs_;
  std::uint32_t callers_;
};

}  // namespace maide
