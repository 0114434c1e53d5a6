// The cache's votes on contradictions. Invariant: a vote on a word counts the output to its last
// input in runs that agree with the tree before it, so a word's prefixes are settled before it is;
// and tree and file say the same at any time.
#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/base/invariant.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/cache/cache_file.hpp"

namespace maide {
namespace {

// Runs of one vote that are spoilt before the input that is voted on, for each attempt allowed.
constexpr std::uint32_t spoilt_limit = 10;

bool is_proper_prefix(const Word& prefix, const Word& word) {
  return prefix.size() < word.size() && is_prefix(prefix, word);
}

}  // namespace

// While one lives, words are being asked again; on_vote is told of the outermost.
class Cache::VoteScope {
 public:
  explicit VoteScope(std::optional<Votes>& votes) : votes_(votes) {
    if (votes_ && votes_->depth++ == 0 && votes_->on_vote) votes_->on_vote(true);
  }
  ~VoteScope() {
    if (votes_ && --votes_->depth == 0 && votes_->on_vote) votes_->on_vote(false);
  }
  VoteScope(const VoteScope&) = delete;
  VoteScope& operator=(const VoteScope&) = delete;

 private:
  std::optional<Votes>& votes_;
};

void Cache::hold_votes(const VoteOptions& options, std::function<void(bool)> on_vote) {
  Ballot check(options);  // throws if they cannot be
  votes_ = Votes();
  votes_->options = options;
  votes_->on_vote = std::move(on_vote);
}

void Cache::ask_afresh(const Word& word, const RunControl& control) {
  const VoteScope scope(votes_);
  const Query query = word;
  send(std::span(&query, 1), control);
}

bool Cache::is_kept(const Word& word) const {
  TraceTree::Node node = TraceTree::root;
  for (const Symbol input : word) {
    const TraceTree::Node edge = tree_.child(node, input);
    if (edge == TraceTree::none || edge > kept_) return false;  // nodes count up from the root, 0
    node = behind(node, edge);
  }
  return true;
}

// Records a fresh answer; false if the tree, which it contradicts, is right.
bool Cache::accept(const MealyAnswer& answer, const RunControl& control) {
  count_votes(answer);
  // Each correction makes them agree on one more input, or is undone by none.
  for (std::size_t corrections = 0; corrections <= answer.outputs.size(); ++corrections) {
    const auto agreeing = find_conflict(answer.inputs, answer.outputs);
    if (!agreeing) {
      insert(answer.inputs, answer.outputs);
      return true;
    }
    if (!votes_) throw contradiction(answer.inputs, answer.outputs, *agreeing);
    const Word word =
        without_refused(std::span(answer.inputs).first(*agreeing + 1), answer.outputs);
    if (!decide(word, answer.outputs[*agreeing], control)) {
      return false;
    }
  }
  return false;
}

// Counts a fresh answer for every word that is watched.
void Cache::count_votes(const MealyAnswer& answer) {
  if (!votes_ || votes_->watched.empty()) return;
  TraceTree::Node node = TraceTree::root;
  Word word;
  for (std::size_t i = 0; i < answer.outputs.size(); ++i) {
    word.push_back(answer.inputs[i]);
    if (const auto found = votes_->watched.find(word); found != votes_->watched.end()) {
      found->second.ballot.add(answer.outputs[i]);
    }
    const TraceTree::Node edge = tree_.child(node, answer.inputs[i]);
    if (edge == TraceTree::none || tree_.output(edge) != answer.outputs[i]) return;
    node = behind(node, edge);
    if (node != edge) word.pop_back();
  }
}

// Asks a word that is in the tree until its last output is decided, which was the `other` one just
// now; true if the tree was changed, there or before.
bool Cache::decide(const Word& word, Symbol other, const RunControl& control) {
  MAIDE_CHECK(!word.empty() && tree_.output(node_of(word)) != other);
  Votes::Watched& watched =
      votes_->watched
          .try_emplace(word, Votes::Watched{Ballot(votes_->options),
                                            Word{tree_.output(node_of(word)), other}})
          .first->second;
  const Ballot& ballot = watched.ballot;
  const VoteScope scope(votes_);
  std::uint32_t asked = 0;
  while (ballot.missing() > 0) {
    const std::uint32_t most = votes_->options.most_attempts;
    if (ballot.is_nondeterministic()) {
      const Contradiction all = describe(word);
      throw NondeterminismError(all.word, all.answers);
    }
    MAIDE_CHECK(ballot.total() < most);
    const std::uint32_t copies = std::min(ballot.missing(), most - ballot.total());
    const std::vector<Query> queries(copies, Query(word));
    for (const MealyAnswer& answer : ask_below(queries, control)) {
      count_votes(answer);
      const auto agreeing = find_conflict(answer.inputs, answer.outputs);
      if (!agreeing || *agreeing + 1 >= word.size()) continue;
      if (++asked > spoilt_limit * most) {
        throw contradiction(answer.inputs, answer.outputs, *agreeing);
      }
      // Spoilt earlier, or the tree is wrong there; then this ballot is closed.
      if (decide(head(word, *agreeing + 1), answer.outputs[*agreeing], control)) return true;
    }
  }
  return impose(word, *ballot.winner());
}

// Makes `output` the answer to the last input of a word that is in the tree; false if it was.
bool Cache::impose(const Word& word, Symbol output) {
  const TraceTree::Node node = node_of(word);
  MAIDE_CHECK(node != TraceTree::root && node != TraceTree::none);
  if (tree_.output(node) == output) return false;
  if (tree_.is_marked(node)) votes_->corrected = word;
  ++votes_->corrections;
  // What was counted behind the wrong answer counts no more. Words are ordered, so the extensions
  // of one follow it.
  auto& watched = votes_->watched;
  for (auto next = watched.upper_bound(word);
       next != watched.end() && is_proper_prefix(word, next->first);) {
    votes_->closed.push_back(describe(next->first));
    next = watched.erase(next);
  }
  tree_.correct(node, output);
  if (file_ != nullptr) {
    const Word outputs = known_outputs(word);
    std::vector<std::pair<Word, Word>> beginnings;  // of what is removed
    file_->remove_if([&](const Word& inputs, const Word& answer) {
      const auto agreeing = find_conflict(inputs, answer);
      if (!agreeing || !passes(node, inputs, *agreeing)) return false;
      beginnings.emplace_back(head(inputs, *agreeing), head(answer, *agreeing));
      return true;
    });
    for (const auto& [inputs, answer] : beginnings) {
      // What was refused there may be in no other word.
      if (has_refusals_ && !inputs.empty()) file_->add(inputs, answer, stored_outputs_);
    }
    file_->add(word, outputs, stored_outputs_);
  }
  return true;
}

// Whether the word, in agreement with the tree before, comes by that edge with this input.
bool Cache::passes(TraceTree::Node edge, const Word& word, std::size_t input) const {
  TraceTree::Node node = TraceTree::root;
  for (std::size_t i = 0; i < input; ++i) node = behind(node, tree_.child(node, word[i]));
  return tree_.child(node, word[input]) == edge;
}

void Cache::throw_if_corrected() {
  if (!votes_ || !votes_->corrected) return;
  const Word word = *std::exchange(votes_->corrected, std::nullopt);
  tree_.unmark_all();  // what is asked from here on is a run of its own
  throw CacheCorrected(to_string(word, system_.inputs()));
}

// The last edge of a word that goes on behind no refused input.
TraceTree::Node Cache::node_of(std::span<const Symbol> word) const {
  TraceTree::Node node = TraceTree::root;
  for (const Symbol input : word) node = tree_.child(node, input);
  return node;
}

// As far as the tree knows the word: a correction may have forgotten the rest.
Word Cache::known_outputs(std::span<const Symbol> word) const {
  TraceTree::Node node = TraceTree::root;
  Word outputs;
  for (const Symbol input : word) {
    const TraceTree::Node edge = tree_.child(node, input);
    if (edge == TraceTree::none) break;
    outputs.push_back(tree_.output(edge));
    node = behind(node, edge);
  }
  return outputs;
}

Contradiction Cache::describe(const Word& word) const {
  const Votes::Watched& watched = votes_->watched.at(word);
  MAIDE_CHECK(watched.before.size() == 2 && watched.before[0] != watched.before[1]);
  std::map<Symbol, std::uint64_t> counts;
  for (const auto& [output, count] : watched.ballot.counts()) counts[output] = count;
  for (const Symbol output : watched.before) ++counts[output];
  std::vector<std::pair<Symbol, std::uint64_t>> sorted(counts.begin(), counts.end());
  std::ranges::stable_sort(
      sorted, [](const auto& left, const auto& right) { return left.second > right.second; });
  Contradiction result;
  result.word = to_string(word, system_.inputs());
  Word outputs = known_outputs(word);
  for (const auto& [output, count] : sorted) {
    outputs.back() = output;
    result.answers.emplace_back(to_string(outputs, stored_outputs_), count);
  }
  return result;
}

std::vector<Contradiction> Cache::contradictions() const {
  if (!votes_) return {};
  std::vector<Contradiction> result = votes_->closed;
  for (const auto& entry : votes_->watched) result.push_back(describe(entry.first));
  return result;
}

}  // namespace maide
