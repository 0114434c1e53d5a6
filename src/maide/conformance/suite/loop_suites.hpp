// Tests that look for what hides behind inputs that seem to do nothing: a lock that a few rare
// inputs open, a count that shows when it is full. A complete suite for two more states would find
// some of it, at the price of every word of three inputs anywhere. These suites stay inside the
// states where inputs loop, and put many words into one, so they cost symbols instead of words.
//
//   chains  in every state every word of a few inputs that loop there, packed into circuits of de
//           Bruijn's graph (N. G. de Bruijn, "A combinatorial problem", 1946). The circuits are
//           drawn at random, so that what came before each word differs from draw to draw
//   pumps   in every state every looping input, repeated, and then each other input
//   growth  where an input led through a row of states, as where something is counted: the guess
//           that the row goes on
//   ladders a, aa, aaa, ..., each with another input behind it, in the states around such a row
//   samples random words of the kinds that the others leave out: counts that show at one number
//           only, cycles of two inputs, two counts at once
//
// An input loops in a state if it leads back there, and was neither refused nor left untried. In a
// state that is entered by outputs that end the session alone, none does. After
// the words of a chain or a sample every looping input is given once (the roll call), and then a
// word that identifies the state.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"
#include "maide/conformance/identify/state_identifiers.hpp"
#include "maide/conformance/suite/test_suite.hpp"

namespace maide {

// No suite here makes a word of more inputs: wrappers read lines of some megabytes at most.
inline constexpr std::size_t longest_test = 100'000;

// A hypothesis as the suites here see it.
class LoopingInputs {
 public:
  // A word, and the state of the hypothesis to which it leads.
  struct Start {
    Word access;
    StateId state;
  };

  // Keeps references to both; `hypothesis` must be complete, the identifiers its own. `is_error`:
  // of each output whether it ends the session; empty: none does. O(n k).
  LoopingInputs(const Mealy& hypothesis, const StateIdentifiers& identifiers,
                const std::vector<bool>& is_error = {});

  const Mealy& hypothesis() const { return hypothesis_; }
  // Those that loop in a state, in the order of the alphabet.
  std::span<const Symbol> of(StateId state) const { return loops_[state]; }
  // A shortest word to each state, the nearest first; to a state behind the end of the session one
  // that does not end it, where there is one.
  std::span<const Start> states() const { return states_; }
  // For each state and each output with which a transition leads there, one such transition that
  // does not end a word of `states`; those of outputs that few transitions have, first. What the
  // hypothesis takes for one state may be another one when it is entered in another way.
  std::span<const Start> ways() const { return ways_; }

  // Appends the roll call and a word that identifies the state. For a state with several such words
  // `turn` chooses.
  void append_end(StateId state, std::uint64_t turn, Word& word) const;

 private:
  void avoid_errors(const std::vector<bool>& is_error);
  void find_ways(const std::vector<bool>& is_error);

  const Mealy& hypothesis_;
  const StateIdentifiers& identifiers_;
  std::vector<std::vector<Symbol>> loops_;  // by state
  std::vector<bool> is_over_;               // by state: only error outputs lead there
  std::vector<Start> states_, ways_;
};

// A circuit through all words of `order` of these letters, each once, and then its first order - 1
// letters again: letters^order + order - 1 symbols. Uniform among Hierholzer's circuits for random
// orders of the edges. O(length).
Word draw_chain(std::span<const Symbol> letters, std::size_t order, Random random);

class ChainSuite : public TestSuite {
 public:
  static constexpr std::size_t short_piece = 400, long_piece = 4000;

  // Behind each start all words of `order` inputs that loop there, cut into pieces of so many
  // inputs; of each start at most `max_pieces` words. Long pieces find what takes several steps to
  // show, short ones what does not last. Keeps references.
  ChainSuite(const LoopingInputs& loops, std::span<const LoopingInputs::Start> starts,
             std::size_t order, std::size_t piece_length, Random random,
             std::uint64_t max_pieces = ~std::uint64_t{0});

  bool next(Word& word) override;
  std::optional<std::uint64_t> size() const override { return size_; }
  std::optional<std::uint64_t> symbols() const override { return symbols_; }
  // Nothing was left out for `max_pieces`.
  bool is_whole() const { return is_whole_; }

 private:
  std::uint64_t count_pieces(StateId state) const;

  const LoopingInputs& loops_;
  std::span<const LoopingInputs::Start> starts_;
  std::size_t order_, piece_length_;
  Random random_;
  std::uint64_t max_pieces_;
  std::uint64_t size_ = 0, symbols_ = 0;
  bool is_whole_ = true;
  std::size_t start_ = 0;    // of the chain that is played
  std::uint64_t piece_ = 0;  // that comes next
  Word chain_;
};

class PumpSuite : public TestSuite {
 public:
  // `counts`: how often inputs are repeated; ascending, each at most a quarter of the longest test.
  // Keeps a reference.
  PumpSuite(const LoopingInputs& loops, std::vector<std::size_t> counts);

  bool next(Word& word) override;
  std::optional<std::uint64_t> size() const override { return size_; }
  std::optional<std::uint64_t> symbols() const override { return symbols_; }

 private:
  // The place of the next pump.
  struct Place {
    std::size_t start = 0, loop = 0, count = 0;
    Symbol follower = 0;
  };
  static bool advance(const LoopingInputs& loops, std::size_t counts, Place& place, bool anew);
  bool make(Place& place, Word* word, std::uint64_t& symbols) const;

  const LoopingInputs& loops_;
  std::vector<std::size_t> counts_;
  std::uint64_t size_ = 0, symbols_ = 0;
  Place place_;
};

// Guesses that a row of states that one input leads through goes on, to twice its length, and
// that one input gives and another takes back as often as the sizes say. Few words; a system that
// differs shows by one of them as many states as it has.
class GrowthSuite : public TestSuite {
 public:
  // `sizes`: what the system's options name. At most `max_symbols` inputs in all.
  GrowthSuite(const LoopingInputs& loops, std::span<const std::size_t> sizes,
              std::uint64_t max_symbols);

  bool next(Word& word) override;
  std::optional<std::uint64_t> size() const override { return words_.size(); }

 private:
  void add(const Word& access, Symbol input, std::size_t times, Symbol follower,
           std::size_t follower_times);
  void guess_rows(const LoopingInputs& loops);
  void guess_sizes(const LoopingInputs& loops, std::span<const std::size_t> sizes);

  std::uint64_t symbols_left_;
  std::vector<Word> words_;
  std::size_t next_ = 0;
};

// Where an input led through a row of at least four states something is counted, and something else
// may be: beside it, or behind its last state. So this suite plays ladders in all states that do
// not lie inside of a row. A ladder is a, aa, aaa, ..., each with b behind it and the way back: it
// finds a count that shows at one number only. It is played for every looping a and every b to 24
// repeats, and then for all of them on from there. Empty if there is no row.
class LadderSuite : public TestSuite {
 public:
  // Inputs are repeated as often as is said, but at most 128 times. Keeps a reference.
  LadderSuite(const LoopingInputs& loops, std::size_t most_repeats);

  bool next(Word& word) override;
  std::optional<std::uint64_t> size() const override { return std::nullopt; }

 private:
  const LoopingInputs& loops_;
  std::size_t most_repeats_;
  std::vector<std::size_t> starts_;  // those outside of rows, where inputs loop
  std::uint64_t most_pairs_ = 0;     // of letters, in one of them
  std::size_t turn_ = 0;             // in starts_
  std::uint64_t number_ = 0;         // of the ladder in each
};

class LoopSampler : public TestSuite {
 public:
  // Endless, unless no input loops. Inputs are repeated as often as is said, but at most 128 times:
  // a ladder grows with the square. Keeps a reference.
  LoopSampler(const LoopingInputs& loops, std::size_t most_repeats, Random random);

  bool next(Word& word) override;
  std::optional<std::uint64_t> size() const override { return std::nullopt; }
  // Symbols of every ladder in every state: more samples than these say little new. O(1).
  std::uint64_t enough() const { return enough_; }

 private:
  // A looping input, a second one where there is one, and any input.
  struct Letters {
    Symbol first, second, follower;
  };
  Letters draw_letters(std::span<const Symbol> loops);
  const LoopingInputs& loops_;
  std::size_t most_repeats_;
  Random random_;
  std::vector<std::size_t> starts_;             // those where inputs loop
  std::vector<std::uint64_t> ladders_, steps_;  // of each start, those made
  std::size_t turn_ = 0;
  std::uint64_t enough_ = 0;
};

}  // namespace maide
