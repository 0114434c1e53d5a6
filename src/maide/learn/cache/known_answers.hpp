// What the cache knows: a tree of execution traces (trace_tree.hpp) and the names of its outputs.
// In a large tree each step waits for memory, so steps of a batch are saved or made to wait
// together: whichever the batch allows.
//
// Inputs that were refused change nothing: the tree has them as leaves, and a word goes on where it
// was. What is looked up is marked: another one asked for it in this run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/learn/cache/trace_tree.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {

// What is known of a query.
struct CacheLookup {
  // Outputs as far as the tree goes; inputs of words only to the end.
  MealyAnswer answer;
  TraceTree::Node node = TraceTree::root;  // where it leads, behind refused inputs
  bool is_whole = false;                   // the answer goes to the end of the query
};

class KnownAnswers {
 public:
  // `has_refusals`: the outputs "refused", "unexplored" and "absorbed" say that an input was not
  // taken. Keeps a reference to `inputs`.
  KnownAnswers(const Alphabet& inputs, bool has_refusals)
      : inputs_(inputs), has_refusals_(has_refusals) {}

  TraceTree& tree() { return tree_; }
  const TraceTree& tree() const { return tree_; }
  const Alphabet& inputs() const { return inputs_; }
  // In the order of recording. All outputs here are numbers of these.
  const Alphabet& outputs() const { return outputs_; }
  Symbol intern_output(const std::string& name);

  // ---- What was refused ----

  bool has_refusals() const { return has_refusals_; }
  bool is_refusal(Symbol output) const { return has_refusals_ && is_refusal_[output]; }
  // Where one is behind an edge from `node`.
  TraceTree::Node behind(TraceTree::Node node, TraceTree::Node edge) const {
    return is_refusal(tree_.output(edge)) ? node : edge;
  }
  bool has_refused(const CacheLookup& known) const;
  // The given inputs of what is known, and what follows.
  Query without_refused(const Query& query, const CacheLookup& known) const;
  // The word without the inputs that were refused, but for its last.
  Word without_refused(std::span<const Symbol> inputs, std::span<const Symbol> outputs) const;

  // ---- Looking up ----

  CacheLookup look_up(const Query& query);
  std::vector<CacheLookup> look_up_all(std::span<const Query> batch);
  // The last edge of a word that goes on behind no refused input.
  TraceTree::Node node_of(std::span<const Symbol> word) const;
  // As far as the tree knows the word: a correction may have forgotten the rest.
  Word outputs_to(std::span<const Symbol> word) const;
  // The first that many edges that were added have the whole answer to the word.
  bool is_among_first(std::uint64_t count, const Word& word) const;
  // Whether the word, in agreement with the tree before, comes by that edge with this input.
  bool passes(TraceTree::Node edge, const Word& word, std::size_t input) const;

  // ---- Adding ----

  // How many inputs agree before the outputs contradict the tree; nothing if they do not.
  std::optional<std::size_t> find_conflict(const Word& inputs, const Word& outputs) const;
  NondeterminismError contradiction(const Word& inputs, const Word& outputs,
                                    std::size_t agreeing) const;
  // Adds a trace, and says whether something of it was new. Throws contradiction().
  bool add(const Word& inputs, const Word& outputs);
  // Adds an answer whose beginning was looked up before, without walking there again, and says
  // whether something of it was new. Nothing, and nothing is added: it contradicts the tree.
  std::optional<bool> extend(const Query& query, const CacheLookup& known,
                             const MealyAnswer& answer);

  // Throws std::logic_error unless the tree and the alphabets fit together. O(observations).
  void check_invariants() const;

 private:
  void follow_in_turn(std::span<const std::span<const Symbol>> words,
                      std::vector<CacheLookup>& results);

  const Alphabet& inputs_;
  bool has_refusals_;
  Alphabet outputs_;
  std::vector<bool> is_refusal_;  // by output
  TraceTree tree_;                // a refused input is a leaf
};

}  // namespace maide
