// The cache between the learner and the system: a tree of execution traces (Margaria, Raffelt &
// Steffen, "Knowledge-based relevance filtering for efficient system-level test-based model
// generation", ISSE 2005). A transparent filter: answers are those of the system below, but what is
// known never reaches it: words and prefixes of words asked before, words that are prefixes of
// others of the same batch, decision trees as far as the tree knows their path. A fresh answer that
// contradicts the tree is a NondeterminismError with both answers.
//
// Invariants: outputs are numbered in the order in which answers are handed up, and the consistency
// test knows only what was handed up, whatever a file held before or a system below answered first:
// a resumed run goes the way of an uninterrupted one, word for word.
#pragma once

#include <cstdint>
#include <memory>

#include "maide/learn/equivalence_oracle.hpp"
#include "maide/learn/output_oracle.hpp"
#include "maide/learn/trace_tree.hpp"

namespace maide {

class CacheFile;

class Cache : public OutputOracle {
 public:
  // Keeps a reference to `system`.
  explicit Cache(OutputOracle& system);
  // Starts with what `file` holds and keeps every fresh answer there; keeps both references. Throws
  // UsageError if the file contradicts itself.
  Cache(OutputOracle& system, CacheFile& file);

  using OutputOracle::ask;
  const Alphabet& inputs() const override { return system_.inputs(); }
  const Alphabet& outputs() const override { return outputs_; }
  Symbol intern_output(std::string_view name) override;
  // Answers from the tree have no durations. What was answered before an exception is kept.
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                               const PartialSink& on_early_end = {}) override;

  // Equivalence oracle that sends nothing: finds a shortest (then alphabet-least) known word that
  // the hypothesis gets wrong. Knows only what was asked in this run, not what a file holds beyond
  // that: so a resumed run goes the way of an uninterrupted one. Lives no longer than the cache.
  std::unique_ptr<EquivalenceOracle> make_consistency_test();

  std::uint64_t hits() const { return hits_; }      // queries that needed no system
  std::uint64_t misses() const { return misses_; }  // queries sent to the system
  // Inputs observed, each once for each word that leads to it.
  std::uint64_t observation_count() const { return tree_.edge_count(); }
  std::uint64_t bytes() const { return tree_.bytes(); }

 private:
  class ConsistencyTest;

  static constexpr Symbol no_symbol = ~Symbol{0};

  // Answers, outputs in the tree's numbering, as far as the tree goes; true if to the end of the
  // query. Marks what it reads as asked in this run.
  bool answer_from_tree(const Query& query, MealyAnswer& answer);
  void ask_system(std::span<const Query> batch, std::vector<std::size_t> unknown,
                  std::vector<MealyAnswer>& answers, const RunControl& control);
  std::vector<MealyAnswer> send(std::span<const Query> batch, std::span<const std::size_t> selected,
                                const RunControl& control);
  void record(const MealyAnswer& answer);
  bool insert(const Word& inputs, const Word& outputs);
  void learn_system_outputs();
  void hand_up(MealyAnswer& answer);
  Query to_stored(const DecisionTree& tree);
  Query to_system(const Query& query);

  OutputOracle& system_;
  CacheFile* file_ = nullptr;
  // Three numberings of outputs: the system's; the tree's ("stored", the file's: in the order of
  // recording); and that of `outputs_`, in which answers are handed up.
  Alphabet stored_outputs_;
  Alphabet outputs_;
  std::vector<Symbol> handed_up_;    // stored -> outputs_, or no symbol while never handed up
  std::vector<Symbol> from_system_;  // the system's -> stored
  TraceTree tree_;
  std::uint64_t hits_ = 0, misses_ = 0;
};

}  // namespace maide
