#include "maide/learn/cache/cache.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <variant>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/learn/cache/cache_consistency.hpp"
#include "maide/learn/cache/cache_file.hpp"
#include "maide/learn/cache/cache_votes.hpp"

namespace maide {
namespace {

// With a file, batches are cut so that a kill loses no more words than this.
constexpr std::size_t words_at_risk = 64;

// A decision tree as a word, to find equal ones.
Word encode(const DecisionTree& tree) {
  Word code;
  for (const auto& node : tree.nodes) {
    code.push_back(node.input);
    code.push_back(static_cast<Symbol>(node.branches.size()));
    for (const auto& [output, child] : node.branches) {
      code.push_back(output);
      code.push_back(child);
    }
  }
  return code;
}

}  // namespace

Cache::Cache(OutputOracle& system, Refusals refusals)
    : system_(system),
      known_(std::make_unique<KnownAnswers>(system.inputs(), refusals == Refusals::change_nothing)),
      outputs_(system.outputs()) {}

Cache::Cache(OutputOracle& system, CacheFile& file, Refusals refusals) : Cache(system, refusals) {
  for (const std::string& name : file.outputs().names()) known_->intern_output(name);
  try {
    file.for_each([this](const Word& inputs, const Word& outputs) { insert(inputs, outputs); });
  } catch (const NondeterminismError&) {
    throw UsageError("the cache contradicts itself (" + file.path().string() + ")");
  }
  file_ = &file;
  kept_ = known_->tree().edge_count();
}

Cache::Cache(Cache&& other) noexcept = default;
Cache::~Cache() = default;

Symbol Cache::intern_output(std::string_view name) { return outputs_.intern(name); }

void Cache::hold_votes(const VoteOptions& options, std::function<void(bool)> on_vote) {
  votes_ = std::make_unique<CacheVotes>(options, std::move(on_vote), *known_, file_);
}

void Cache::ask_afresh(const Word& word, const RunControl& control) {
  const CacheVotes::Scope scope(votes_.get());
  const Query query = word;
  send(std::span(&query, 1), control);
}

bool Cache::is_kept(const Word& word) const { return known_->is_among_first(kept_, word); }

std::vector<Contradiction> Cache::contradictions() const {
  return votes_ ? votes_->contradictions() : std::vector<Contradiction>{};
}

std::unique_ptr<EquivalenceOracle> Cache::make_consistency_test() {
  return std::make_unique<CacheConsistencyTest>(*known_);
}

std::uint64_t Cache::observation_count() const { return known_->tree().edge_count(); }
std::uint64_t Cache::bytes() const { return known_->tree().bytes(); }

std::vector<MealyAnswer> Cache::ask(std::span<const Query> batch, const RunControl& control,
                                    const PartialSink& on_early_end) {
  // Branches of trees in the tree's numbering; words are the same in all.
  std::vector<Query> converted;
  if (std::ranges::any_of(
          batch, [](const Query& query) { return std::holds_alternative<DecisionTree>(query); })) {
    learn_system_outputs();
    converted.reserve(batch.size());
    for (const Query& query : batch) {
      const auto* tree = std::get_if<DecisionTree>(&query);
      converted.push_back(tree != nullptr ? to_stored(*tree) : query);
    }
    batch = converted;
  }
  std::vector<CacheLookup> known = known_->look_up_all(batch);
  MAIDE_CHECK(known.size() == batch.size());
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (!known[i].is_whole) unknown.push_back(i);
  }
  hits_ += batch.size() - unknown.size();
  const std::vector<Query> whole = select_whole(batch, known);
  try {
    if (!unknown.empty()) ask_system(batch, std::move(unknown), known, control);
    if (!whole.empty()) send(whole, control);
  } catch (...) {
    for (std::size_t i = 0; on_early_end && i < batch.size(); ++i) {
      CacheLookup lookup = known_->look_up(batch[i]);
      if (!lookup.is_whole) continue;
      hand_up(lookup.answer);
      on_early_end(i, lookup.answer);
    }
    throw;
  }
  std::vector<MealyAnswer> answers;
  answers.reserve(batch.size());
  for (CacheLookup& lookup : known) {
    hand_up(lookup.answer);
    answers.push_back(std::move(lookup.answer));
  }
  return answers;
}

// Some of the words that would be asked without what is refused, to be asked as they are: a wrapper
// that says by itself that an input was refused may be wrong. At first many, then few.
std::vector<Query> Cache::select_whole(std::span<const Query> batch,
                                       const std::vector<CacheLookup>& known) {
  constexpr std::uint64_t one_in = 64;
  std::vector<Query> whole;
  if (!known_->has_refusals() || misses_ == 0) return whole;  // a file that has all is not doubted
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const auto* word = std::get_if<Word>(&batch[i]);
    const Word& outputs = known[i].answer.outputs;
    const auto refused =
        std::ranges::find_if(outputs, [this](Symbol output) { return known_->is_refusal(output); });
    if (word == nullptr || refused == outputs.end()) continue;
    if (static_cast<std::size_t>(refused - outputs.begin()) + 1 == word->size()) continue;
    ++shortened_;
    if (std::has_single_bit(shortened_) || shortened_ % one_in == 0) whole.push_back(*word);
  }
  misses_ += whole.size();
  return whole;
}

// Those of the unknown queries whose answers answer all of them: no word that is a prefix of
// another, nothing twice. Ascending. Words of which one is a prefix of the other leave the tree at
// the same place by the same input, so only such are compared. O(words log words).
std::vector<std::size_t> Cache::select_queries(std::span<const Query> batch,
                                               std::span<const std::size_t> unknown,
                                               const std::vector<CacheLookup>& known) {
  std::vector<std::size_t> selected;
  std::unordered_set<Word, WordHash> trees;
  struct Leaving {
    std::uint64_t place;  // the node and the input
    std::size_t index;
  };
  std::vector<Leaving> words;
  // What is not known of a word.
  const auto rest = [&](std::size_t index) {
    return std::span(std::get<Word>(batch[index])).subspan(known[index].answer.outputs.size());
  };
  for (const std::size_t index : unknown) {
    if (const auto* tree = std::get_if<DecisionTree>(&batch[index])) {
      if (trees.insert(encode(*tree)).second) selected.push_back(index);
    } else {
      MAIDE_CHECK(!rest(index).empty());  // or it is known
      words.push_back({std::uint64_t{known[index].node} << 32 | rest(index).front(), index});
    }
  }
  // A word's extensions follow it; of equal words the first in the batch comes last, and stays.
  std::ranges::sort(words, [&](const Leaving& left, const Leaving& right) {
    if (left.place != right.place) return left.place < right.place;
    const auto one = rest(left.index), other = rest(right.index);
    const auto order =
        std::lexicographical_compare_three_way(one.begin(), one.end(), other.begin(), other.end());
    return order != 0 ? order < 0 : left.index > right.index;
  });
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i + 1 < words.size() && words[i].place == words[i + 1].place &&
        is_prefix(rest(words[i].index), rest(words[i + 1].index))) {
      continue;
    }
    selected.push_back(words[i].index);
  }
  std::ranges::sort(selected);
  MAIDE_CHECK(!selected.empty() && selected.size() <= unknown.size());
  return selected;
}

// Asks until nothing is unknown: a word that ended early does not answer its prefixes' extensions,
// and a correction may forget what was just recorded.
void Cache::ask_system(std::span<const Query> batch, std::vector<std::size_t> unknown,
                       std::vector<CacheLookup>& known, const RunControl& control) {
  while (!unknown.empty()) {
    const std::vector<std::size_t> selected = select_queries(batch, unknown, known);
    const std::size_t chunk = file_ != nullptr ? words_at_risk : selected.size();
    const std::uint64_t corrections = votes_ ? votes_->corrections() : 0;
    const TraceTree::Node first_fresh = known_->tree().next_node();
    for (std::size_t start = 0; start < selected.size(); start += chunk) {
      const auto part =
          std::span(selected).subspan(start, std::min(chunk, selected.size() - start));
      std::vector<const CacheLookup*> lookups;
      lookups.reserve(part.size());
      for (const std::size_t index : part) lookups.push_back(&known[index]);
      std::vector<Query> copies;
      std::vector<MealyAnswer> fresh =
          send(to_system(batch, part, known, copies), control, lookups);
      MAIDE_CHECK(fresh.size() == part.size());
      for (std::size_t i = 0; i < part.size(); ++i) {
        known[part[i]].answer = std::move(fresh[i]);
      }
    }
    misses_ += selected.size();
    const bool was_corrected = votes_ && votes_->corrections() != corrections;
    // What is new in the tree are answers to this batch. Behind what is refused an answer may come
    // to what is not new: then it is looked up.
    const bool is_all_new = !was_corrected && !known_->has_refusals();
    for (TraceTree::Node node = first_fresh; is_all_new && node < known_->tree().next_node();
         ++node) {
      known_->tree().mark(node);
    }
    std::vector<std::size_t> still_unknown;
    for (const std::size_t index : unknown) {
      const bool was_sent = std::ranges::binary_search(selected, index);
      CacheLookup& lookup = known[index];
      const bool is_over = was_sent && lookup.answer.end != WordEnd::complete;  // there is no more
      if (is_over && !known_->has_refusals()) continue;
      const Word* const word = std::get_if<Word>(&batch[index]);
      if (was_sent && is_all_new && word != nullptr && lookup.answer.inputs == *word) continue;
      CacheLookup now = known_->look_up(batch[index]);
      lookup.answer.inputs = std::move(now.answer.inputs);  // but times and attempts as sent
      lookup.answer.outputs = std::move(now.answer.outputs);
      lookup.node = now.node;
      if (is_over) continue;
      if (now.is_whole) {
        if (!was_sent) ++hits_;
      } else if (was_sent && !was_corrected) {
        throw Error(ExitStatus::system_failed, "the system answered another query than was asked");
      } else {
        still_unknown.push_back(index);
      }
    }
    unknown = std::move(still_unknown);
  }
}

// Answers in the tree's numbering, recorded; also those before an exception. Asks again what noise
// has spoilt. `known`: what was looked up of each query just now, or nothing.
std::vector<MealyAnswer> Cache::send(std::span<const Query> queries, const RunControl& control,
                                     std::span<const CacheLookup* const> known) {
  std::vector<MealyAnswer> answers(queries.size());
  std::vector<std::size_t> places(queries.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  std::vector<Query> again;
  const std::uint64_t corrections = votes_ ? votes_->corrections() : 0;
  try {
    for (std::uint32_t attempt = 1; !queries.empty(); ++attempt) {
      std::vector<MealyAnswer> fresh = ask_below(queries, control);
      MAIDE_CHECK(fresh.size() == queries.size() && places.size() == queries.size());
      std::vector<Query> spoilt;
      std::vector<std::size_t> spoilt_places;
      for (std::size_t i = 0; i < fresh.size(); ++i) {
        const bool is_known = !known.empty() && (!votes_ || votes_->corrections() == corrections);
        if (!(is_known && extend(queries[i], *known[places[i]], fresh[i])) &&
            !accept(fresh[i], control)) {
          if (attempt >= votes_->most_attempts()) {
            throw known_->contradiction(
                fresh[i].inputs, fresh[i].outputs,
                known_->find_conflict(fresh[i].inputs, fresh[i].outputs).value_or(0));
          }
          spoilt.push_back(queries[i]);
          spoilt_places.push_back(places[i]);
        }
        answers[places[i]] = std::move(fresh[i]);
      }
      again = std::move(spoilt);
      queries = again;
      places = std::move(spoilt_places);
    }
    if (file_ != nullptr) file_->commit();
  } catch (...) {
    if (file_ != nullptr) file_->commit();
    throw;
  }
  throw_if_corrected();
  return answers;
}

// Records an answer whose beginning was looked up before, without walking there again; false, and
// nothing is recorded, if there is more to do: it contradicts the tree, or votes wait for it.
bool Cache::extend(const Query& query, const CacheLookup& known, const MealyAnswer& answer) {
  if (known_->has_refusals() || (votes_ && votes_->is_watching())) return false;
  const std::optional<bool> is_new = known_->extend(query, known, answer);
  if (is_new.value_or(false) && file_ != nullptr) {
    file_->add(answer.inputs, answer.outputs, known_->outputs());
  }
  return is_new.has_value();
}

// The system's answers in the tree's numbering. Those before an exception are recorded unless they
// contradict the tree: the call ends with another error already.
std::vector<MealyAnswer> Cache::ask_below(std::span<const Query> queries,
                                          const RunControl& control) {
  const auto renumber = [this](MealyAnswer& answer) {
    for (Symbol& output : answer.outputs) {
      MAIDE_CHECK(output < from_system_.size());
      output = from_system_[output];
    }
  };
  std::vector<MealyAnswer> fresh =
      system_.ask(queries, control, [&](std::size_t, MealyAnswer answer) {
        learn_system_outputs();
        renumber(answer);
        check_refusals(answer);
        if (!known_->find_conflict(answer.inputs, answer.outputs))
          insert(answer.inputs, answer.outputs);
      });
  learn_system_outputs();
  for (MealyAnswer& answer : fresh) {
    renumber(answer);
    check_refusals(answer);
  }
  return fresh;
}

// An input that was refused is not taken next, for nothing has changed. By no fault of a run: who
// says what is refused knows no better.
void Cache::check_refusals(const MealyAnswer& answer) const {
  Word refused;  // since an input was taken
  for (std::size_t i = 0; known_->has_refusals() && i < answer.outputs.size(); ++i) {
    const Symbol input = answer.inputs[i];
    if (known_->is_refusal(answer.outputs[i])) {
      refused.push_back(input);
    } else if (std::ranges::find(refused, input) == refused.end()) {
      refused.clear();
    } else {
      throw Error(
          ExitStatus::system_failed,
          fmt::format("input '{}' is refused and yet changes the state: \"{}\" was answered "
                      "\"{}\"",
                      inputs().name(input), to_string(head(answer.inputs, i + 1), inputs()),
                      to_string(head(answer.outputs, i + 1), known_->outputs())));
    }
  }
}

// Adds a trace, to the file, too; nothing of one that contradicts the tree.
void Cache::insert(const Word& inputs, const Word& outputs) {
  if (known_->add(inputs, outputs) && file_ != nullptr) {
    file_->add(inputs, outputs, known_->outputs());
  }
}

// Records a fresh answer; false if the tree, which it contradicts, is right.
bool Cache::accept(const MealyAnswer& answer, const RunControl& control) {
  if (votes_) votes_->count_answer(answer);
  const auto ask = [&](std::span<const Query> queries) { return ask_below(queries, control); };
  // Each correction makes them agree on one more input, or is undone by none.
  for (std::size_t corrections = 0; corrections <= answer.outputs.size(); ++corrections) {
    const auto agreeing = known_->find_conflict(answer.inputs, answer.outputs);
    if (!agreeing) {
      insert(answer.inputs, answer.outputs);
      return true;
    }
    if (!votes_) throw known_->contradiction(answer.inputs, answer.outputs, *agreeing);
    const Word word =
        known_->without_refused(std::span(answer.inputs).first(*agreeing + 1), answer.outputs);
    if (!votes_->decide(word, answer.outputs[*agreeing], ask)) return false;
  }
  return false;
}

void Cache::throw_if_corrected() {
  const std::optional<Word> word = votes_ ? votes_->take_corrected() : std::nullopt;
  if (!word) return;
  known_->tree().unmark_all();  // what is asked from here on is a run of its own
  throw CacheCorrected(to_string(*word, system_.inputs()));
}

// Makes the outputs known that the system has named since.
void Cache::learn_system_outputs() {
  const Alphabet& names = system_.outputs();
  while (from_system_.size() < names.size()) {
    const auto next = static_cast<Symbol>(from_system_.size());
    from_system_.push_back(known_->intern_output(names.name(next)));
  }
}

void Cache::hand_up(MealyAnswer& answer) {
  if (handed_up_.size() < known_->outputs().size()) {
    handed_up_.resize(known_->outputs().size(), no_symbol);
  }
  for (Symbol& output : answer.outputs) {
    MAIDE_CHECK(output < handed_up_.size());
    Symbol& handed_up = handed_up_[output];
    if (handed_up == no_symbol) handed_up = outputs_.intern(known_->outputs().name(output));
    output = handed_up;
  }
}

void Cache::check_invariants() const {
  known_->check_invariants();
  for (Symbol output = 0; output < from_system_.size(); ++output) {
    MAIDE_CHECK_ALWAYS(known_->outputs().name(from_system_[output]) ==
                       system_.outputs().name(output));
  }
  for (Symbol output = 0; output < handed_up_.size(); ++output) {
    MAIDE_CHECK_ALWAYS(handed_up_[output] == no_symbol ||
                       outputs_.name(handed_up_[output]) == known_->outputs().name(output));
  }
  if (votes_) votes_->check_invariants();
}

Query Cache::to_stored(const DecisionTree& tree) {
  DecisionTree result = tree;
  for (auto& node : result.nodes) {
    for (auto& [output, child] : node.branches) {
      output = known_->intern_output(outputs_.name(output));
    }
  }
  return result;
}

Query Cache::to_system(const Query& query) {
  if (const Word* word = std::get_if<Word>(&query)) return *word;
  DecisionTree result = std::get<DecisionTree>(query);
  for (auto& node : result.nodes) {
    for (auto& [output, child] : node.branches) {
      output = system_.intern_output(known_->outputs().name(output));
    }
  }
  return result;
}

// These queries of the batch, ascending: the part of the batch itself where nothing lies between
// them and all are words as they are, as learners mostly ask; else in `copies`.
std::span<const Query> Cache::to_system(std::span<const Query> batch,
                                        std::span<const std::size_t> selected,
                                        const std::vector<CacheLookup>& known,
                                        std::vector<Query>& copies) {
  const auto is_as_it_is = [&](std::size_t index) {
    return std::holds_alternative<Word>(batch[index]) && !known_->has_refused(known[index]);
  };
  if (selected.back() - selected.front() + 1 == selected.size() &&
      std::ranges::all_of(selected, is_as_it_is)) {
    return batch.subspan(selected.front(), selected.size());
  }
  copies.reserve(selected.size());
  for (const std::size_t index : selected) {
    copies.push_back(to_system(known_->has_refused(known[index])
                                   ? known_->without_refused(batch[index], known[index])
                                   : batch[index]));
  }
  return copies;
}

}  // namespace maide
