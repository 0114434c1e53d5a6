#include "maide/learn/lsharp/frontier_classes.hpp"

#include <algorithm>
#include <utility>

#include "maide/base/hash.hpp"
#include "maide/base/invariant.hpp"

namespace maide {

std::size_t FrontierClasses::EdgeHash::operator()(const Edge& edge) const {
  const std::uint64_t from = std::uint64_t{edge.parent} << 1U | (edge.begins ? 1U : 0U);
  return hash_mix(hash_mix(0, from), std::uint64_t{edge.input} << 32U | edge.output);
}

Word FrontierClasses::last_word(Class at) const {
  Word word;
  for (; at != root; at = records_[at].parent) {
    word.push_back(records_[at].input);
    if (records_[at].place == 0) break;
  }
  return {word.rbegin(), word.rend()};
}

std::vector<FrontierClasses::Observation> FrontierClasses::observations(Class at) const {
  std::vector<Observation> result;
  Observation reversed;
  for (; at != root; at = records_[at].parent) {
    reversed.inputs.push_back(records_[at].input);
    reversed.outputs.push_back(records_[at].output);
    if (records_[at].place > 0) continue;
    result.push_back({{reversed.inputs.rbegin(), reversed.inputs.rend()},
                      {reversed.outputs.rbegin(), reversed.outputs.rend()}});
    reversed = {};
  }
  MAIDE_CHECK(reversed.inputs.empty());  // every word begins at place 0
  return result;
}

bool FrontierClasses::has_candidate(Class at, StateId state) const {
  return std::ranges::binary_search(records_[at].candidates, state);
}

void FrontierClasses::note_change(Class at) {
  Record& record = records_[at];
  if (!std::exchange(record.is_changed, true)) changes_.classes.push_back(at);
  if (record.candidates.size() > 1 && has_members(at) && !std::exchange(record.is_open, true)) {
    open_.push_back(at);
  }
}

// The last word of the class is the beginning of this one.
bool FrontierClasses::is_last_word(Class at, std::span<const Symbol> inputs) const {
  if (at == root || records_[at].place >= inputs.size()) return false;
  for (;; at = records_[at].parent) {
    const Record& record = records_[at];
    if (record.input != inputs[record.place]) return false;
    if (record.place == 0) return true;
  }
}

void FrontierClasses::move(Member member, std::span<const Symbol> inputs,
                           std::span<const Symbol> outputs, const ObservationTree& tree) {
  MAIDE_CHECK(inputs.size() == outputs.size());
  if (class_.size() <= member) {
    class_.resize(member + std::size_t{1}, none);
    next_.resize(class_.size(), no_member);
    before_.resize(class_.size(), no_member);
  }
  const Class from = class_[member];
  Class at = from == none ? root : from;
  last_nodes_of_ = none;
  for (std::size_t i = is_last_word(at, inputs) ? records_[at].place + 1 : 0; i < inputs.size();
       ++i) {
    at = find_or_add(at, static_cast<std::uint32_t>(i), inputs[i], outputs[i], tree);
  }
  MAIDE_CHECK(inputs.empty() ||
              (records_[at].place + 1 == inputs.size() && is_last_word(at, inputs)));
  if (at == from) return;
  Record& record = records_[at];
  MAIDE_CHECK(from == none || record.candidates.size() <= records_[from].candidates.size());
  const Member first = std::exchange(record.first_member, member);
  if (from != none) remove(member);
  MAIDE_CHECK(class_[member] == none && (first == no_member || before_[first] == no_member));
  class_[member] = at;
  next_[member] = first;
  before_[member] = no_member;
  if (first == no_member) {
    note_change(at);
  } else {
    before_[first] = member;
  }
  changes_.members.push_back(member);
  if (record.candidates.empty()) isolated_.push_back(member);
}

void FrontierClasses::remove(Member member) {
  MAIDE_CHECK(class_of(member) != none);
  const Class from = std::exchange(class_[member], none);
  if (next_[member] != no_member) {
    MAIDE_CHECK(before_[next_[member]] == member && class_[next_[member]] == from);
    before_[next_[member]] = before_[member];
  }
  if (before_[member] != no_member) {
    MAIDE_CHECK(next_[before_[member]] == member && class_[before_[member]] == from);
    next_[before_[member]] = next_[member];
  } else {
    MAIDE_CHECK(records_[from].first_member == member);
    records_[from].first_member = next_[member];
  }
  give_up_unused(from);
}

void FrontierClasses::give_up_unused(Class at) {
  while (at != root && records_[at].children == 0 && !has_members(at)) {
    Record& record = records_[at];
    const Class parent = record.parent;
    MAIDE_CHECK(record.first_child == none && records_[parent].children > 0);
    MAIDE_CHECK(children_.at({parent, record.input, record.output, record.place == 0}) == at);
    children_.erase({parent, record.input, record.output, record.place == 0});
    if (record.next != none) records_[record.next].before = record.before;
    (record.before != none ? records_[record.before].next : records_[parent].first_child) =
        record.next;
    --records_[parent].children;
    record.candidates = {};
    unused_.push_back(at);
    at = parent;
  }
}

FrontierClasses::Class FrontierClasses::find_or_add(Class parent, std::uint32_t place, Symbol input,
                                                    Symbol output, const ObservationTree& tree) {
  // The edge goes on with the last word, or begins another one.
  MAIDE_CHECK(place == 0 || (parent != root && records_[parent].place + 1 == place));
  const auto [found, is_new] = children_.try_emplace({parent, input, output, place == 0}, none);
  if (!is_new) return found->second;
  Class at = static_cast<Class>(records_.size());
  if (unused_.empty()) {
    records_.emplace_back();
  } else {
    at = unused_.back();
    unused_.pop_back();
  }
  found->second = at;
  Record& record = records_[at];
  MAIDE_CHECK(record.children == 0 && !has_members(at) && record.candidates.empty());
  record.parent = parent;
  record.place = place;
  record.input = input;
  record.output = output;
  record.before = none;
  record.next = std::exchange(records_[parent].first_child, at);
  if (record.next != none) records_[record.next].before = at;
  ++records_[parent].children;
  find_candidates(at, tree);
  return at;
}

// Of a chain of new classes the nodes are found step by step.
void FrontierClasses::find_candidates(Class at, const ObservationTree& tree) {
  const Record& record = records_[at];
  const std::vector<StateId>& above = records_[record.parent].candidates;
  if (record.place == 0 || last_nodes_of_ != record.parent) {
    Word before = last_word(at);
    before.pop_back();
    last_nodes_.clear();
    for (const StateId state : above) last_nodes_.push_back(tree.find(states_[state], before));
  }
  MAIDE_CHECK(last_nodes_.size() >= above.size());
  std::vector<StateId> candidates;
  for (std::size_t i = 0; i < above.size(); ++i) {
    ObservationTree::Node node = last_nodes_[i];
    if (node != ObservationTree::none) node = tree.child(node, record.input);
    if (node != ObservationTree::none && tree.output(node) != record.output) continue;
    last_nodes_[candidates.size()] = node;
    candidates.push_back(above[i]);
    watch(above[i], at);
  }
  records_[at].candidates = std::move(candidates);
  last_nodes_of_ = at;
}

// Forgets the classes that were given up before the list has to grow.
void FrontierClasses::watch(StateId state, Class at) {
  MAIDE_CHECK(at != root && states_[state] != ObservationTree::none);
  const std::size_t place = records_[at].place;
  if (watchers_[state].size() <= place) watchers_[state].resize(place + 1);
  Watchers& watchers = watchers_[state][place];
  std::vector<Watcher>& all = watchers.all;
  if (all.size() == all.capacity()) {
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    std::erase_if(all, [&](const Watcher& old) { return !is_present(old, state, place); });
    all.reserve(std::max<std::size_t>(4, 2 * all.size()));
    MAIDE_CHECK(all.size() < all.capacity());
    watchers.summarise();
  }
  watchers.add({at, records_[at].input, records_[at].output});
}

void FrontierClasses::Watchers::add(const Watcher& watcher) {
  all.push_back(watcher);
  note_output(watcher);
}

void FrontierClasses::Watchers::note_output(const Watcher& watcher) {
  Symbol& output = outputs[watcher.input % outputs.size()];
  output = output == no_output || output == watcher.output ? watcher.output : several;
}

void FrontierClasses::Watchers::summarise() {
  outputs.fill(no_output);
  for (const Watcher& watcher : all) note_output(watcher);
}

bool FrontierClasses::Watchers::may_differ(Symbol input, Symbol output) const {
  const Symbol known = outputs[input % outputs.size()];
  return known != no_output && known != output;
}

// The record of a class that was given up may be used again, for another one.
bool FrontierClasses::is_present(const Watcher& watcher, StateId state, std::size_t place) const {
  const Record& record = records_[watcher.at];
  return record.place == place && record.input == watcher.input &&
         record.output == watcher.output && has_candidate(watcher.at, state);
}

void FrontierClasses::add_state(StateId state, ObservationTree::Node node,
                                const ObservationTree& tree) {
  if (states_.size() <= state) {
    states_.resize(state + std::size_t{1}, ObservationTree::none);
    watchers_.resize(states_.size());
  }
  MAIDE_CHECK(node < tree.size() && states_[state] == ObservationTree::none);  // added once
  states_[state] = node;
  add_candidate(state, tree);
}

// To the root, and to those classes below that it fits. No recursion: classes are as deep as words
// are long.
void FrontierClasses::add_candidate(StateId state, const ObservationTree& tree) {
  struct Place {
    Class at;
    ObservationTree::Node node;  // where its last word leads from the state, or none
  };
  std::vector<Place> open{{root, states_[state]}};
  while (!open.empty()) {
    const auto [at, node] = open.back();
    open.pop_back();
    std::vector<StateId>& candidates = records_[at].candidates;
    MAIDE_CHECK(!has_candidate(at, state));
    MAIDE_CHECK(at == root || has_candidate(records_[at].parent, state));
    candidates.insert(std::ranges::lower_bound(candidates, state), state);
    if (at != root) watch(state, at);
    if (has_members(at)) note_change(at);
    const std::size_t first = open.size();
    for (Class child = records_[at].first_child; child != none; child = records_[child].next) {
      const Record& record = records_[child];
      ObservationTree::Node below = record.place == 0 ? states_[state] : node;
      if (below != ObservationTree::none) below = tree.child(below, record.input);
      if (below != ObservationTree::none && tree.output(below) != record.output) continue;
      open.push_back({child, below});
    }
    std::reverse(open.begin() + static_cast<std::ptrdiff_t>(first), open.end());
  }
}

// The last word of the class is this one as far as it goes, but for its last output.
bool FrontierClasses::lies_along(Class at, std::span<const Symbol> inputs,
                                 std::span<const Symbol> outputs) const {
  for (; records_[at].place > 0; at = records_[at].parent) {
    const Record& above = records_[records_[at].parent];
    if (above.input != inputs[above.place] || above.output != outputs[above.place]) return false;
  }
  return true;
}

void FrontierClasses::refute(StateId state, std::span<const Symbol> inputs,
                             std::span<const Symbol> outputs, std::size_t known) {
  MAIDE_CHECK(inputs.size() == outputs.size());
  MAIDE_CHECK(state < states_.size() && states_[state] != ObservationTree::none);
  std::vector<Class> refuted;
  const std::size_t end = std::min(inputs.size(), watchers_[state].size());
  for (std::size_t place = known; place < end; ++place) {
    Watchers& watchers = watchers_[state][place];
    if (!watchers.may_differ(inputs[place], outputs[place])) continue;
    refuted.clear();
    for (const Watcher& watcher : watchers.all) {
      if (watcher.input != inputs[place] || watcher.output == outputs[place]) continue;
      if (is_present(watcher, state, place) && lies_along(watcher.at, inputs, outputs)) {
        refuted.push_back(watcher.at);
      }
    }
    if (refuted.empty()) continue;
    for (const Class at : refuted) remove_candidate(at, state);
    std::erase_if(watchers.all, [&](const Watcher& old) { return !is_present(old, state, place); });
    watchers.summarise();
  }
}

// From a class and all below it.
void FrontierClasses::remove_candidate(Class from, StateId state) {
  std::vector<Class> open{from};
  while (!open.empty()) {
    const Class at = open.back();
    open.pop_back();
    std::vector<StateId>& candidates = records_[at].candidates;
    const auto found = std::ranges::lower_bound(candidates, state);
    if (found == candidates.end() || *found != state) continue;
    MAIDE_CHECK(at != root && (at == from || !has_candidate(records_[at].parent, state)));
    candidates.erase(found);
    if (has_members(at)) note_change(at);
    if (candidates.empty()) {
      for_each_member(at, [&](Member member) { isolated_.push_back(member); });
    }
    const std::size_t first = open.size();
    for (Class child = records_[at].first_child; child != none; child = records_[child].next) {
      open.push_back(child);
    }
    std::reverse(open.begin() + static_cast<std::ptrdiff_t>(first), open.end());
  }
}

std::vector<FrontierClasses::Member> FrontierClasses::take_isolated() {
  return std::exchange(isolated_, {});
}

const std::vector<FrontierClasses::Class>& FrontierClasses::update_open() {
  std::erase_if(open_, [&](Class at) {
    Record& record = records_[at];
    MAIDE_CHECK(record.is_open);
    record.is_open = record.candidates.size() > 1 && has_members(at);
    return !record.is_open;
  });
  return open_;
}

FrontierClasses::Changes FrontierClasses::take_changes() {
  for (const Class at : changes_.classes) {
    MAIDE_CHECK(records_[at].is_changed);  // none is there twice
    records_[at].is_changed = false;
  }
  return std::exchange(changes_, {});
}

void FrontierClasses::check_invariants(const ObservationTree& tree) const {
  std::vector<bool> is_unused(records_.size(), false);
  for (const Class at : unused_) {
    MAIDE_CHECK_ALWAYS(at != root && !is_unused[at]);
    MAIDE_CHECK_ALWAYS(records_[at].candidates.empty() && !has_members(at));
    is_unused[at] = true;
  }
  MAIDE_CHECK_ALWAYS(children_.size() + unused_.size() + 1 == records_.size());
  std::vector<bool> is_listed(class_.size(), false);
  for (Class at = 0; at < records_.size(); ++at) {
    if (is_unused[at]) continue;
    check_class(at, tree);
    Member before = no_member;
    for_each_member(at, [&](Member member) {
      MAIDE_CHECK_ALWAYS(class_.at(member) == at && before_.at(member) == before);
      MAIDE_CHECK_ALWAYS(!is_listed[member]);
      is_listed[member] = true;
      before = member;
    });
    std::uint32_t children = 0;
    Class last = none;
    for (Class child = records_[at].first_child; child != none; child = records_[child].next) {
      MAIDE_CHECK_ALWAYS(!is_unused[child] && records_[child].parent == at);
      MAIDE_CHECK_ALWAYS(records_[child].before == last);
      last = child;
      ++children;
    }
    MAIDE_CHECK_ALWAYS(children == records_[at].children);
  }
  for (Member member = 0; member < class_.size(); ++member) {
    MAIDE_CHECK_ALWAYS(is_listed[member] == (class_[member] != none));
  }
  for (StateId state = 0; state < states_.size(); ++state) {
    MAIDE_CHECK_ALWAYS(has_candidate(root, state) == (states_[state] != ObservationTree::none));
  }
}

// Of one class that is in use: what it is known by, and its candidates.
void FrontierClasses::check_class(Class at, const ObservationTree& tree) const {
  const Record& record = records_[at];
  MAIDE_CHECK_ALWAYS(std::ranges::adjacent_find(record.candidates, std::ranges::greater_equal{}) ==
                     record.candidates.end());  // ascending, none twice
  MAIDE_CHECK_ALWAYS(record.is_changed == (std::ranges::count(changes_.classes, at) == 1));
  MAIDE_CHECK_ALWAYS(record.is_open == (std::ranges::count(open_, at) == 1));
  MAIDE_CHECK_ALWAYS(record.is_open || record.candidates.size() < 2 || !has_members(at));
  if (at == root) return;
  MAIDE_CHECK_ALWAYS(record.children > 0 || has_members(at));  // else it is given up
  const bool begins = record.place == 0;
  MAIDE_CHECK_ALWAYS(begins ||
                     (record.parent != root && records_[record.parent].place + 1 == record.place));
  MAIDE_CHECK_ALWAYS(children_.at({record.parent, record.input, record.output, begins}) == at);
  // Of the parent's candidates those from which the last word is not known to end otherwise.
  const Word word = last_word(at);
  for (const StateId state : record.candidates) {
    MAIDE_CHECK_ALWAYS(has_candidate(record.parent, state));
    const Watchers& watchers = watchers_.at(state).at(record.place);
    const Watcher watcher{at, record.input, record.output};
    MAIDE_CHECK_ALWAYS(std::ranges::find(watchers.all, watcher) != watchers.all.end());
    MAIDE_CHECK_ALWAYS(watchers.may_differ(record.input, record.output + 1));
  }
  for (const StateId state : records_[record.parent].candidates) {
    const ObservationTree::Node node = tree.find(states_[state], word);
    const bool fits = node == ObservationTree::none || tree.output(node) == record.output;
    MAIDE_CHECK_ALWAYS(fits == has_candidate(at, state));
  }
}

}  // namespace maide
