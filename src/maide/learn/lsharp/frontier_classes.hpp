// What is known of the frontier nodes of L#'s observation tree. It is kept once for all nodes of
// which the same is known: from large machines the same is asked in very many places, and answered
// alike.
//
// A *class* stands for words that were asked from a node, one after the other, and their outputs.
// Classes form a trie with an edge for each input: a child goes on with the last word, or begins
// another one. The *members* of a class are frontier nodes, named by the transitions that lead to
// them. Its *candidates* are the states of the basis that nothing of this tells from the members.
//
// Invariant: the candidates of a class are among those of its parent. So a new state is compared
// only with the children of those classes that it fits, and a word that becomes known from a state
// only with the classes that have the state as a candidate. Classes without members below are given
// up.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/lsharp/observation_tree.hpp"

namespace maide {

class FrontierClasses {
 public:
  using Class = std::uint32_t;
  using Member = std::uint32_t;
  static constexpr Class root = 0;  // nothing is known of its members
  static constexpr Class none = ~Class{0};
  static constexpr Member no_member = ~Member{0};

  FrontierClasses() : records_(1) {}

  // The class of a member, or none.
  Class class_of(Member member) const { return member < class_.size() ? class_[member] : none; }
  // Ascending.
  const std::vector<StateId>& candidates(Class at) const { return records_[at].candidates; }
  bool has_members(Class at) const { return records_[at].first_member != no_member; }
  // Calls `visit(member)` for the members of a class, those that came last first.
  template <typename Visit>
  void for_each_member(Class at, Visit&& visit) const {
    for (Member member = records_[at].first_member; member != no_member; member = next_[member]) {
      visit(member);
    }
  }
  // The words asked and what was answered to each. O(length).
  struct Observation {
    Word inputs, outputs;
  };
  std::vector<Observation> observations(Class at) const;
  // Classes there are, those given up included: an upper bound of their numbers.
  std::size_t size() const { return records_.size(); }

  // A word was asked from a member, or from a new one: moves it to the class of which this is
  // known, too. `tree` has the word already.
  void move(Member member, std::span<const Symbol> inputs, std::span<const Symbol> outputs,
            const ObservationTree& tree);
  // It is no frontier node any more.
  void remove(Member member);

  // Compares a state that is not there yet with the classes.
  void add_state(StateId state, ObservationTree::Node node, const ObservationTree& tree);
  // A word has become known from a state that was added, up to `known` it was before.
  void refute(StateId state, std::span<const Symbol> inputs, std::span<const Symbol> outputs,
              std::size_t known);

  // Members whose class has lost its last candidate since this was called last; some may have left
  // it, or it may have got another one.
  std::vector<Member> take_isolated();
  // Classes with several candidates, and members.
  const std::vector<Class>& update_open();
  // Since this was called last: classes that got or lost candidates, or their first member (some
  // may have none any more); and members that came to a class.
  struct Changes {
    std::vector<Class> classes;
    std::vector<Member> members;
  };
  Changes take_changes();

  // Throws std::logic_error unless every class has the members, the place in the trie and exactly
  // the candidates that it should have by this tree. O(classes x candidates x length).
  void check_invariants(const ObservationTree& tree) const;

 private:
  struct Record {
    Class parent = none;
    std::uint32_t place = 0;       // of the edge that leads here, in its word
    Symbol input = 0, output = 0;  // of this edge
    Class first_child = none, next = none, before = none;  // siblings
    std::uint32_t children = 0;
    Member first_member = no_member;
    bool is_changed = false, is_open = false;  // is in changes_, open_
    std::vector<StateId> candidates;
  };
  struct Edge {
    Class parent;
    Symbol input, output;
    bool begins;
    bool operator==(const Edge&) const = default;
  };
  struct EdgeHash {
    std::size_t operator()(const Edge& edge) const;
  };

  // A class that a state is a candidate of, or was, and the edge that leads there.
  struct Watcher {
    Class at;
    Symbol input, output;
    auto operator<=>(const Watcher&) const = default;
  };
  // Those of one state and place. A word that becomes known passes very many places, and at most of
  // them every class has the word's own output: a summary tells so without a look at the classes.
  struct Watchers {
    static constexpr Symbol no_output = ~Symbol{0}, several = no_output - 1;

    void add(const Watcher& watcher);
    void note_output(const Watcher& watcher);
    void summarise();  // after some were removed
    // False only if none has this input and another output.
    bool may_differ(Symbol input, Symbol output) const;

    std::vector<Watcher> all;
    // Of those whose input has this remainder: the one output they have.
    std::array<Symbol, 8> outputs = {no_output, no_output, no_output, no_output,
                                     no_output, no_output, no_output, no_output};
  };

  Class find_or_add(Class parent, std::uint32_t place, Symbol input, Symbol output,
                    const ObservationTree& tree);
  void find_candidates(Class at, const ObservationTree& tree);
  void watch(StateId state, Class at);
  bool is_present(const Watcher& watcher, StateId state, std::size_t place) const;
  void add_candidate(StateId state, const ObservationTree& tree);
  void remove_candidate(Class from, StateId state);
  void give_up_unused(Class at);
  void note_change(Class at);
  bool has_candidate(Class at, StateId state) const;
  bool is_last_word(Class at, std::span<const Symbol> inputs) const;
  bool lies_along(Class at, std::span<const Symbol> inputs, std::span<const Symbol> outputs) const;
  Word last_word(Class at) const;
  void check_class(Class at, const ObservationTree& tree) const;

  std::vector<Record> records_;
  std::vector<Class> unused_;  // records to use again
  std::unordered_map<Edge, Class, EdgeHash> children_;
  std::vector<ObservationTree::Node> states_;    // by state
  std::vector<std::vector<Watchers>> watchers_;  // by state and place
  std::vector<Class> class_;                     // by member
  std::vector<Member> next_, before_;            // by member: lists of each class
  std::vector<Member> isolated_;
  std::vector<Class> open_;
  // While a member moves: where the last word of a new class leads from its candidates, in order.
  std::vector<ObservationTree::Node> last_nodes_;
  Class last_nodes_of_ = none;
  Changes changes_;
};

}  // namespace maide
