#include "maide/learn/cache/cache.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <variant>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/learn/cache/cache_file.hpp"

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
      outputs_(system.outputs()),
      has_refusals_(refusals == Refusals::change_nothing) {}

Cache::Cache(OutputOracle& system, CacheFile& file, Refusals refusals) : Cache(system, refusals) {
  stored_outputs_ = file.outputs();
  learn_refusals();
  try {
    file.for_each([this](const Word& inputs, const Word& outputs) { insert(inputs, outputs); });
  } catch (const NondeterminismError&) {
    throw UsageError("the cache contradicts itself (" + file.path().string() + ")");
  }
  file_ = &file;
  kept_ = tree_.edge_count();
}

Symbol Cache::intern_output(std::string_view name) { return outputs_.intern(name); }

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
  std::vector<Lookup> known = look_up_all(batch);
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
      Lookup lookup = look_up(batch[i]);
      if (!lookup.is_whole) continue;
      hand_up(lookup.answer);
      on_early_end(i, lookup.answer);
    }
    throw;
  }
  std::vector<MealyAnswer> answers;
  answers.reserve(batch.size());
  for (Lookup& lookup : known) {
    hand_up(lookup.answer);
    answers.push_back(std::move(lookup.answer));
  }
  return answers;
}

// Some of the words that would be asked without what is refused, to be asked as they are: a wrapper
// that says by itself that an input was refused may be wrong. At first many, then few.
std::vector<Query> Cache::select_whole(std::span<const Query> batch,
                                       const std::vector<Lookup>& known) {
  constexpr std::uint64_t one_in = 64;
  std::vector<Query> whole;
  if (!has_refusals_ || misses_ == 0) return whole;  // a file that has all is not doubted
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const auto* word = std::get_if<Word>(&batch[i]);
    const Word& outputs = known[i].answer.outputs;
    const auto refused =
        std::ranges::find_if(outputs, [this](Symbol output) { return is_refusal(output); });
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
                                               const std::vector<Lookup>& known) {
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
                       std::vector<Lookup>& known, const RunControl& control) {
  while (!unknown.empty()) {
    const std::vector<std::size_t> selected = select_queries(batch, unknown, known);
    const std::size_t chunk = file_ != nullptr ? words_at_risk : selected.size();
    const std::uint64_t corrections = votes_ ? votes_->corrections : 0;
    const TraceTree::Node first_fresh = tree_.next_node();
    for (std::size_t start = 0; start < selected.size(); start += chunk) {
      const auto part =
          std::span(selected).subspan(start, std::min(chunk, selected.size() - start));
      std::vector<const Lookup*> lookups;
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
    const bool was_corrected = votes_ && votes_->corrections != corrections;
    // What is new in the tree are answers to this batch. Behind what is refused an answer may come
    // to what is not new: then it is looked up.
    const bool is_all_new = !was_corrected && !has_refusals_;
    for (TraceTree::Node node = first_fresh; is_all_new && node < tree_.next_node(); ++node) {
      tree_.mark(node);
    }
    std::vector<std::size_t> still_unknown;
    for (const std::size_t index : unknown) {
      const bool was_sent = std::ranges::binary_search(selected, index);
      Lookup& lookup = known[index];
      const bool is_over = was_sent && lookup.answer.end != WordEnd::complete;  // there is no more
      if (is_over && !has_refusals_) continue;
      const Word* const word = std::get_if<Word>(&batch[index]);
      if (was_sent && is_all_new && word != nullptr && lookup.answer.inputs == *word) continue;
      Lookup now = look_up(batch[index]);
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
                                     std::span<const Lookup* const> known) {
  std::vector<MealyAnswer> answers(queries.size());
  std::vector<std::size_t> places(queries.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  std::vector<Query> again;
  const std::uint64_t corrections = votes_ ? votes_->corrections : 0;
  try {
    for (std::uint32_t attempt = 1; !queries.empty(); ++attempt) {
      std::vector<MealyAnswer> fresh = ask_below(queries, control);
      MAIDE_CHECK(fresh.size() == queries.size() && places.size() == queries.size());
      std::vector<Query> spoilt;
      std::vector<std::size_t> spoilt_places;
      for (std::size_t i = 0; i < fresh.size(); ++i) {
        const bool is_known = !known.empty() && (!votes_ || votes_->corrections == corrections);
        if (!(is_known && extend(queries[i], *known[places[i]], fresh[i])) &&
            !accept(fresh[i], control)) {
          if (attempt >= votes_->options.most_attempts) {
            throw contradiction(fresh[i].inputs, fresh[i].outputs,
                                find_conflict(fresh[i].inputs, fresh[i].outputs).value_or(0));
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
bool Cache::extend(const Query& query, const Lookup& known, const MealyAnswer& answer) {
  if (has_refusals_ || (votes_ && !votes_->watched.empty())) return false;
  const Word* const word = std::get_if<Word>(&query);
  const Word& path = word != nullptr ? *word : known.answer.inputs;
  const std::size_t start = known.answer.outputs.size();
  const std::size_t end = std::min(answer.inputs.size(), answer.outputs.size());
  if (end <= start || (word != nullptr && end > word->size()) ||
      !std::equal(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(start),
                  answer.inputs.begin()) ||
      !std::equal(known.answer.outputs.begin(), known.answer.outputs.end(),
                  answer.outputs.begin())) {
    return false;
  }
  TraceTree::Node node = known.node;
  MAIDE_CHECK(start == 0 ? node == TraceTree::root
                         : tree_.output(node) == known.answer.outputs.back());
  std::size_t i = start;
  for (; i < end; ++i) {  // what other words of the batch have brought
    const TraceTree::Node child = tree_.child(node, answer.inputs[i]);
    if (child == TraceTree::none) break;
    if (tree_.output(child) != answer.outputs[i]) return false;
    node = child;
  }
  if (i == end) return true;
  for (; i < end; ++i) node = tree_.add_child(node, answer.inputs[i], answer.outputs[i]);
  if (file_ != nullptr) file_->add(answer.inputs, answer.outputs, stored_outputs_);
  return true;
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
        if (!find_conflict(answer.inputs, answer.outputs)) insert(answer.inputs, answer.outputs);
      });
  learn_system_outputs();
  for (MealyAnswer& answer : fresh) {
    renumber(answer);
    check_refusals(answer);
  }
  return fresh;
}

std::optional<std::size_t> Cache::find_conflict(const Word& inputs, const Word& outputs) const {
  TraceTree::Node node = TraceTree::root;
  const std::size_t length = std::min(inputs.size(), outputs.size());
  for (std::size_t i = 0; i < length; ++i) {
    const TraceTree::Node edge = tree_.child(node, inputs[i]);
    if (edge == TraceTree::none && !is_refusal(outputs[i])) break;
    if (edge == TraceTree::none) continue;
    if (tree_.output(edge) != outputs[i]) return i;
    node = behind(node, edge);
  }
  return std::nullopt;
}

// An input that was refused is not taken next, for nothing has changed. By no fault of a run: who
// says what is refused knows no better.
void Cache::check_refusals(const MealyAnswer& answer) const {
  Word refused;  // since an input was taken
  for (std::size_t i = 0; has_refusals_ && i < answer.outputs.size(); ++i) {
    const Symbol input = answer.inputs[i];
    if (is_refusal(answer.outputs[i])) {
      refused.push_back(input);
    } else if (std::ranges::find(refused, input) == refused.end()) {
      refused.clear();
    } else {
      throw Error(
          ExitStatus::system_failed,
          fmt::format("input '{}' is refused and yet changes the state: \"{}\" was answered "
                      "\"{}\"",
                      inputs().name(input), to_string(head(answer.inputs, i + 1), inputs()),
                      to_string(head(answer.outputs, i + 1), stored_outputs_)));
    }
  }
}

NondeterminismError Cache::contradiction(const Word& inputs, const Word& outputs,
                                         std::size_t agreeing) const {
  MAIDE_CHECK(agreeing < inputs.size() && agreeing < outputs.size());
  const auto word = std::span(inputs).first(agreeing + 1);
  return {to_string(word, system_.inputs()), to_string(known_outputs(word), stored_outputs_),
          to_string(std::span(outputs).first(agreeing + 1), stored_outputs_)};
}

// Adds a trace, to the file, too; nothing of one that contradicts the tree.
void Cache::insert(const Word& inputs, const Word& outputs) {
  if (const auto agreeing = find_conflict(inputs, outputs)) {
    throw contradiction(inputs, outputs, *agreeing);
  }
  TraceTree::Node node = TraceTree::root;
  bool is_new = false;
  for (std::size_t i = 0; i < std::min(inputs.size(), outputs.size()); ++i) {
    TraceTree::Node edge = tree_.child(node, inputs[i]);
    if (edge == TraceTree::none) {
      edge = tree_.add_child(node, inputs[i], outputs[i]);
      is_new = true;
    }
    node = behind(node, edge);
  }
  if (is_new && file_ != nullptr) file_->add(inputs, outputs, stored_outputs_);
}

// Makes the outputs known that the system has named since.
void Cache::learn_system_outputs() {
  const Alphabet& names = system_.outputs();
  while (from_system_.size() < names.size()) {
    const auto next = static_cast<Symbol>(from_system_.size());
    from_system_.push_back(stored_outputs_.intern(names.name(next)));
  }
  learn_refusals();
}

void Cache::learn_refusals() {
  while (has_refusals_ && is_refusal_.size() < stored_outputs_.size()) {
    const std::string& name = stored_outputs_.name(static_cast<Symbol>(is_refusal_.size()));
    is_refusal_.push_back(name == "refused" || name == "unexplored" || name == "absorbed");
  }
}

void Cache::hand_up(MealyAnswer& answer) {
  if (handed_up_.size() < stored_outputs_.size()) {
    handed_up_.resize(stored_outputs_.size(), no_symbol);
  }
  for (Symbol& output : answer.outputs) {
    MAIDE_CHECK(output < handed_up_.size());
    Symbol& handed_up = handed_up_[output];
    if (handed_up == no_symbol) handed_up = outputs_.intern(stored_outputs_.name(output));
    output = handed_up;
  }
}

void Cache::check_invariants() const {
  tree_.check_invariants();
  for (Symbol output = 0; output < from_system_.size(); ++output) {
    MAIDE_CHECK_ALWAYS(stored_outputs_.name(from_system_[output]) ==
                       system_.outputs().name(output));
  }
  for (Symbol output = 0; output < handed_up_.size(); ++output) {
    MAIDE_CHECK_ALWAYS(handed_up_[output] == no_symbol ||
                       outputs_.name(handed_up_[output]) == stored_outputs_.name(output));
  }
  std::vector<TraceTree::Node> below;
  for (std::vector<TraceTree::Node> open{TraceTree::root}; !open.empty();) {
    const TraceTree::Node node = open.back();
    open.pop_back();
    tree_.children(node, below);
    for (const TraceTree::Node child : below) {
      MAIDE_CHECK_ALWAYS(tree_.input(child) < inputs().size());
      MAIDE_CHECK_ALWAYS(tree_.output(child) < stored_outputs_.size());
      // What was asked for in this run, the consistency test comes to.
      MAIDE_CHECK_ALWAYS(!tree_.is_marked(child) || node == TraceTree::root ||
                         tree_.is_marked(node));
    }
    open.insert(open.end(), below.begin(), below.end());
  }
  if (!votes_) return;
  MAIDE_CHECK_ALWAYS(votes_->depth == 0);
  for (const auto& [word, watched] : votes_->watched) {
    MAIDE_CHECK_ALWAYS(!word.empty() && watched.before.size() == 2);
    const Symbol output = known_outputs(word).back();
    MAIDE_CHECK_ALWAYS(watched.ballot.winner().value_or(output) == output);
  }
}

Query Cache::to_stored(const DecisionTree& tree) {
  DecisionTree result = tree;
  for (auto& node : result.nodes) {
    for (auto& [output, child] : node.branches) {
      output = stored_outputs_.intern(outputs_.name(output));
    }
  }
  return result;
}

Query Cache::to_system(const Query& query) {
  if (const Word* word = std::get_if<Word>(&query)) return *word;
  DecisionTree result = std::get<DecisionTree>(query);
  for (auto& node : result.nodes) {
    for (auto& [output, child] : node.branches) {
      output = system_.intern_output(stored_outputs_.name(output));
    }
  }
  return result;
}

bool Cache::has_refused(const Lookup& known) const {
  const Word& outputs = known.answer.outputs;
  return has_refusals_ &&
         std::ranges::any_of(outputs, [this](Symbol output) { return is_refusal(output); });
}

Word Cache::without_refused(std::span<const Symbol> inputs, std::span<const Symbol> outputs) const {
  Word word;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (i + 1 == inputs.size() || !is_refusal(outputs[i])) word.push_back(inputs[i]);
  }
  return word;
}

// The given inputs of what is known, and what follows.
Query Cache::without_refused(const Query& query, const Lookup& known) const {
  const Word& outputs = known.answer.outputs;
  if (const Word* word = std::get_if<Word>(&query)) {
    Word shorter;
    for (std::size_t i = 0; i < word->size(); ++i) {
      if (i >= outputs.size() || !is_refusal(outputs[i])) shorter.push_back((*word)[i]);
    }
    return shorter;
  }
  const auto& nodes = std::get<DecisionTree>(query).nodes;
  DecisionTree shorter;
  std::size_t place = 0;
  for (const Symbol output : outputs) {
    const DecisionTree::Node& node = nodes[place];
    if (!is_refusal(output)) {
      const auto next = static_cast<std::uint32_t>(shorter.nodes.size() + 1);
      shorter.nodes.push_back({node.input, {{output, next}}});
    }
    for (const auto& [branch, child] : node.branches) {
      if (branch == output) place = child;
    }
  }
  std::vector<std::size_t> sources{place};
  const std::size_t first = shorter.nodes.size();
  for (std::size_t i = 0; i < sources.size(); ++i) {
    DecisionTree::Node node = nodes[sources[i]];
    for (auto& [output, child] : node.branches) {
      sources.push_back(child);
      child = static_cast<std::uint32_t>(first + sources.size() - 1);
    }
    shorter.nodes.push_back(std::move(node));
  }
  return shorter;
}

// These queries of the batch, ascending: the part of the batch itself where nothing lies between
// them and all are words as they are, as learners mostly ask; else in `copies`.
std::span<const Query> Cache::to_system(std::span<const Query> batch,
                                        std::span<const std::size_t> selected,
                                        const std::vector<Lookup>& known,
                                        std::vector<Query>& copies) {
  const auto is_as_it_is = [&](std::size_t index) {
    return std::holds_alternative<Word>(batch[index]) && !has_refused(known[index]);
  };
  if (selected.back() - selected.front() + 1 == selected.size() &&
      std::ranges::all_of(selected, is_as_it_is)) {
    return batch.subspan(selected.front(), selected.size());
  }
  copies.reserve(selected.size());
  for (const std::size_t index : selected) {
    copies.push_back(to_system(
        has_refused(known[index]) ? without_refused(batch[index], known[index]) : batch[index]));
  }
  return copies;
}

}  // namespace maide
