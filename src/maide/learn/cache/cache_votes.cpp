#include "maide/learn/cache/cache_votes.hpp"

#include <algorithm>
#include <utility>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/learn/cache/cache_file.hpp"

namespace maide {
namespace {

// Runs of one vote that are spoilt before the input that is voted on, for each attempt allowed.
constexpr std::uint32_t spoilt_limit = 10;

bool is_proper_prefix(const Word& prefix, const Word& word) {
  return prefix.size() < word.size() && is_prefix(prefix, word);
}

}  // namespace

CacheVotes::Scope::Scope(CacheVotes* votes) : votes_(votes) {
  if (votes_ != nullptr && votes_->depth_++ == 0 && votes_->on_vote_) votes_->on_vote_(true);
}

CacheVotes::Scope::~Scope() {
  if (votes_ != nullptr && --votes_->depth_ == 0 && votes_->on_vote_) votes_->on_vote_(false);
}

CacheVotes::CacheVotes(const VoteOptions& options, std::function<void(bool)> on_vote,
                       KnownAnswers& known, CacheFile* file)
    : options_(options), on_vote_(std::move(on_vote)), known_(known), file_(file) {
  Ballot check(options);  // throws if they cannot be
}

void CacheVotes::count_answer(const MealyAnswer& answer) {
  if (watched_.empty()) return;
  TraceTree::Node node = TraceTree::root;
  Word word;
  for (std::size_t i = 0; i < answer.outputs.size(); ++i) {
    word.push_back(answer.inputs[i]);
    if (const auto found = watched_.find(word); found != watched_.end()) {
      found->second.ballot.add(answer.outputs[i]);
    }
    const TraceTree::Node edge = known_.tree().child(node, answer.inputs[i]);
    if (edge == TraceTree::none || known_.tree().output(edge) != answer.outputs[i]) return;
    node = known_.behind(node, edge);
    if (node != edge) word.pop_back();
  }
}

bool CacheVotes::decide(const Word& word, Symbol other, const Asker& ask) {
  MAIDE_CHECK(!word.empty() && known_.tree().output(known_.node_of(word)) != other);
  Watched& watched =
      watched_
          .try_emplace(word, Watched{Ballot(options_),
                                     Word{known_.tree().output(known_.node_of(word)), other}})
          .first->second;
  const Ballot& ballot = watched.ballot;
  const Scope scope(this);
  std::uint32_t asked = 0;
  while (ballot.missing() > 0) {
    const std::uint32_t most = options_.most_attempts;
    if (ballot.is_nondeterministic()) {
      const Contradiction all = describe(word);
      throw NondeterminismError(all.word, all.answers);
    }
    MAIDE_CHECK(ballot.total() < most);
    const std::uint32_t copies = std::min(ballot.missing(), most - ballot.total());
    const std::vector<Query> queries(copies, Query(word));
    for (const MealyAnswer& answer : ask(queries)) {
      count_answer(answer);
      const auto agreeing = known_.find_conflict(answer.inputs, answer.outputs);
      if (!agreeing || *agreeing + 1 >= word.size()) continue;
      if (++asked > spoilt_limit * most) {
        throw known_.contradiction(answer.inputs, answer.outputs, *agreeing);
      }
      // Spoilt earlier, or the tree is wrong there; then this ballot is closed.
      if (decide(head(word, *agreeing + 1), answer.outputs[*agreeing], ask)) return true;
    }
  }
  return impose(word, *ballot.winner());
}

// Makes `output` the answer to the last input of a word that is in the tree; false if it was.
bool CacheVotes::impose(const Word& word, Symbol output) {
  const TraceTree::Node node = known_.node_of(word);
  MAIDE_CHECK(node != TraceTree::root && node != TraceTree::none);
  if (known_.tree().output(node) == output) return false;
  if (known_.tree().is_marked(node)) corrected_ = word;
  ++corrections_;
  // What was counted behind the wrong answer counts no more. Words are ordered, so the extensions
  // of one follow it.
  for (auto next = watched_.upper_bound(word);
       next != watched_.end() && is_proper_prefix(word, next->first);) {
    closed_.push_back(describe(next->first));
    next = watched_.erase(next);
  }
  known_.tree().correct(node, output);
  if (file_ != nullptr) {
    const Word outputs = known_.outputs_to(word);
    std::vector<std::pair<Word, Word>> beginnings;  // of what is removed
    file_->remove_if([&](const Word& inputs, const Word& answer) {
      const auto agreeing = known_.find_conflict(inputs, answer);
      if (!agreeing || !known_.passes(node, inputs, *agreeing)) return false;
      beginnings.emplace_back(head(inputs, *agreeing), head(answer, *agreeing));
      return true;
    });
    for (const auto& [inputs, answer] : beginnings) {
      // What was refused there may be in no other word.
      if (known_.has_refusals() && !inputs.empty()) file_->add(inputs, answer, known_.outputs());
    }
    file_->add(word, outputs, known_.outputs());
  }
  return true;
}

std::optional<Word> CacheVotes::take_corrected() { return std::exchange(corrected_, std::nullopt); }

Contradiction CacheVotes::describe(const Word& word) const {
  const Watched& watched = watched_.at(word);
  MAIDE_CHECK(watched.before.size() == 2 && watched.before[0] != watched.before[1]);
  std::map<Symbol, std::uint64_t> counts;
  for (const auto& [output, count] : watched.ballot.counts()) counts[output] = count;
  for (const Symbol output : watched.before) ++counts[output];
  std::vector<std::pair<Symbol, std::uint64_t>> sorted(counts.begin(), counts.end());
  std::ranges::stable_sort(
      sorted, [](const auto& left, const auto& right) { return left.second > right.second; });
  Contradiction result;
  result.word = to_string(word, known_.inputs());
  Word outputs = known_.outputs_to(word);
  for (const auto& [output, count] : sorted) {
    outputs.back() = output;
    result.answers.emplace_back(to_string(outputs, known_.outputs()), count);
  }
  return result;
}

std::vector<Contradiction> CacheVotes::contradictions() const {
  std::vector<Contradiction> result = closed_;
  for (const auto& entry : watched_) result.push_back(describe(entry.first));
  return result;
}

void CacheVotes::check_invariants() const {
  MAIDE_CHECK_ALWAYS(depth_ == 0);
  for (const auto& [word, watched] : watched_) {
    MAIDE_CHECK_ALWAYS(!word.empty() && watched.before.size() == 2);
    const Symbol output = known_.outputs_to(word).back();
    MAIDE_CHECK_ALWAYS(watched.ballot.winner().value_or(output) == output);
  }
}

}  // namespace maide
