// The cache between the learner and the system: a tree of execution traces (Margaria, Raffelt &
// Steffen, "Knowledge-based relevance filtering for efficient system-level test-based model
// generation", ISSE 2005). It is a transparent filter: answers are those of the system below, but
// what is known never reaches the system. Three kinds of queries are known: prefixes of words asked
// before, prefixes of other words of the same batch, and decision trees as far as the tree knows
// their path.
//
// A fresh answer that contradicts the tree is a NondeterminismError with both answers. After
// hold_votes() the shortest prefix on which they differ is asked again instead, until a majority
// decides (learn/oracle/vote.hpp). If the fresh answer was wrong, the query is asked again. If the
// tree was wrong, it is corrected, with the file. The answers behind a wrong answer are forgotten,
// because they belong to another run of the system.
//
// Inputs that a system does not take change nothing: the actor is busy, an output is due, or the
// input lies beyond the bound of a learning purpose. They are not even given to the system
// (sul/query_player.hpp). Where it is told that there are such, the cache needs one answer for
// a word and for the word without them. It asks the shorter one. Where actors are busy, most words
// of learners and tests have some (compare error-aware L#: Kruger, Junges & Rot, arXiv 2602.21674,
// 2026). A wrapper that says by itself that an input was refused may be wrong: some words are asked
// as they are.
//
// Invariants: outputs are numbered in the order in which answers are handed up. The consistency
// test knows only answers that were handed up. Neither depends on what a file held before, or on
// what a system below answered first. So a resumed run goes the way of an uninterrupted one, word
// for word.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/learn/oracle/equivalence_oracle.hpp"
#include "maide/learn/oracle/output_oracle.hpp"
#include "maide/learn/oracle/vote.hpp"

namespace maide {

class CacheFile;
class CacheVotes;
class KnownAnswers;
struct CacheLookup;

// An answer that was handed up in this run was wrong, and is corrected. Whoever asked must begin
// again. That costs little, because the cache answers.
class CacheCorrected : public Error {
 public:
  explicit CacheCorrected(const std::string& word)
      : Error(ExitStatus::inconclusive, "the answer to \"" + word + "\" was corrected") {}
};

class Cache : public OutputOracle {
 public:
  // Whether the outputs "refused", "unexplored" and "absorbed" say that an input was not taken, or
  // are outputs like others.
  enum class Refusals : std::uint8_t { are_outputs, change_nothing };
  static constexpr Refusals refusals_of(bool has_actors) {
    return has_actors ? Refusals::change_nothing : Refusals::are_outputs;
  }

  // Keeps a reference to `system`.
  explicit Cache(OutputOracle& system, Refusals refusals = Refusals::are_outputs);
  // Starts with what `file` holds and keeps every fresh answer there; keeps both references. Throws
  // UsageError if the file contradicts itself.
  Cache(OutputOracle& system, CacheFile& file, Refusals refusals = Refusals::are_outputs);
  Cache(Cache&& other) noexcept;
  ~Cache() override;

  using OutputOracle::ask;
  const Alphabet& inputs() const override { return system_.inputs(); }
  const Alphabet& outputs() const override { return outputs_; }
  Symbol intern_output(std::string_view name) override;
  // Answers from the tree have no durations. What was answered before an exception is kept. Throws
  // CacheCorrected where votes are held.
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                               const PartialSink& on_early_end = {}) override;

  // From now on contradictions are decided by vote. `on_vote` is called with true before a word is
  // asked again and with false afterwards. Throws UsageError for options that cannot be. An input
  // that stays undecided throws NondeterminismError with all answers.
  void hold_votes(const VoteOptions& options, std::function<void(bool begins)> on_vote = {});

  // Asks the system for the word though it may be known: a contradiction is handled like any other.
  // One query, and votes.
  void ask_afresh(const Word& word, const RunControl& control = {});

  // The whole answer to the word was in the file when it was opened: another run asked for it.
  bool is_kept(const Word& word) const;

  // All words that were voted on.
  std::vector<Contradiction> contradictions() const;

  // Equivalence oracle that sends nothing: finds a shortest (then alphabet-least) known word that
  // the hypothesis gets wrong. Knows only what was asked in this run, not what a file holds beyond
  // that: so a resumed run goes the way of an uninterrupted one. Lives no longer than the cache.
  std::unique_ptr<EquivalenceOracle> make_consistency_test();

  std::uint64_t hits() const { return hits_; }      // queries that needed no system
  std::uint64_t misses() const { return misses_; }  // queries sent to the system
  // Inputs observed, each once for each word that leads to it.
  std::uint64_t observation_count() const;
  std::uint64_t bytes() const;

  // Throws std::logic_error unless the tree, the numberings and the votes fit together. Between two
  // calls. O(observations).
  void check_invariants() const;

 private:
  static constexpr Symbol no_symbol = ~Symbol{0};

  std::vector<Query> select_whole(std::span<const Query> batch,
                                  const std::vector<CacheLookup>& known);
  void ask_system(std::span<const Query> batch, std::vector<std::size_t> unknown,
                  std::vector<CacheLookup>& known, const RunControl& control);
  static std::vector<std::size_t> select_queries(std::span<const Query> batch,
                                                 std::span<const std::size_t> unknown,
                                                 const std::vector<CacheLookup>& known);
  std::vector<MealyAnswer> send(std::span<const Query> queries, const RunControl& control,
                                std::span<const CacheLookup* const> known = {});
  bool extend(const Query& query, const CacheLookup& known, const MealyAnswer& answer);
  std::vector<MealyAnswer> ask_below(std::span<const Query> queries, const RunControl& control);
  void insert(const Word& inputs, const Word& outputs);
  bool accept(const MealyAnswer& answer, const RunControl& control);
  void throw_if_corrected();
  void check_refusals(const MealyAnswer& answer) const;
  void learn_system_outputs();
  void hand_up(MealyAnswer& answer);
  Query to_stored(const DecisionTree& tree);
  Query to_system(const Query& query);
  std::span<const Query> to_system(std::span<const Query> batch,
                                   std::span<const std::size_t> selected,
                                   const std::vector<CacheLookup>& known,
                                   std::vector<Query>& copies);

  OutputOracle& system_;
  CacheFile* file_ = nullptr;
  // Three numberings of outputs: the system's; that of what is known ("stored", the file's: in the
  // order of recording); and that of `outputs_`, in which answers are handed up.
  std::unique_ptr<KnownAnswers> known_;
  Alphabet outputs_;
  std::vector<Symbol> handed_up_;      // stored -> outputs_, or no symbol while never handed up
  std::vector<Symbol> from_system_;    // the system's -> stored
  std::unique_ptr<CacheVotes> votes_;  // null: none are held
  std::uint64_t shortened_ = 0;        // words that were, or could have been, asked shorter
  std::uint64_t kept_ = 0;             // edges of the tree that the file held
  std::uint64_t hits_ = 0, misses_ = 0;
};

}  // namespace maide
