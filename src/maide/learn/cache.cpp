#include "maide/learn/cache.hpp"

#include <algorithm>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/learn/cache_file.hpp"

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

bool is_prefix(const Word& prefix, const Word& word) {
  return prefix.size() <= word.size() && std::equal(prefix.begin(), prefix.end(), word.begin());
}

// Those of the unknown queries whose answers answer all of them: no word that is a prefix of
// another, nothing twice. Ascending. O(words log words) comparisons.
std::vector<std::size_t> select_queries(std::span<const Query> batch,
                                        std::span<const std::size_t> unknown) {
  std::vector<std::size_t> selected, words;
  std::unordered_set<Word, WordHash> trees;
  for (const std::size_t index : unknown) {
    if (const auto* tree = std::get_if<DecisionTree>(&batch[index])) {
      if (trees.insert(encode(*tree)).second) selected.push_back(index);
    } else {
      words.push_back(index);
    }
  }
  const auto word = [&](std::size_t index) -> const Word& { return std::get<Word>(batch[index]); };
  // A word's extensions follow it; of equal words the first in the batch comes last, and stays.
  std::sort(words.begin(), words.end(), [&](std::size_t left, std::size_t right) {
    const auto order = word(left) <=> word(right);
    return order != 0 ? order < 0 : left > right;
  });
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i + 1 < words.size() && is_prefix(word(words[i]), word(words[i + 1]))) continue;
    selected.push_back(words[i]);
  }
  std::sort(selected.begin(), selected.end());
  return selected;
}

}  // namespace

Cache::Cache(OutputOracle& system) : system_(system), outputs_(system.outputs()) {}

Cache::Cache(OutputOracle& system, CacheFile& file) : Cache(system) {
  stored_outputs_ = file.outputs();
  try {
    file.for_each([this](const Word& inputs, const Word& outputs) { insert(inputs, outputs); });
  } catch (const NondeterminismError&) {
    throw UsageError("the cache contradicts itself (" + file.path().string() + ")");
  }
  file_ = &file;
  kept_ = tree_.edge_count();
}

Symbol Cache::intern_output(std::string_view name) { return outputs_.intern(name); }

bool Cache::answer_from_tree(const Query& query, MealyAnswer& answer) {
  TraceTree::Node node = TraceTree::root;
  return play_query(query, answer, [&](Symbol input) -> std::optional<Symbol> {
    node = tree_.child(node, input);
    if (node == TraceTree::none) return std::nullopt;
    tree_.mark(node);
    return tree_.output(node);
  });
}

std::vector<MealyAnswer> Cache::ask(std::span<const Query> batch, const RunControl& control,
                                    const PartialSink& on_early_end) {
  // Branches of trees in the tree's numbering; words are the same in all.
  std::vector<Query> converted;
  if (std::any_of(batch.begin(), batch.end(),
                  [](const Query& query) { return std::holds_alternative<DecisionTree>(query); })) {
    learn_system_outputs();
    converted.reserve(batch.size());
    for (const Query& query : batch) {
      const auto* tree = std::get_if<DecisionTree>(&query);
      converted.push_back(tree != nullptr ? to_stored(*tree) : query);
    }
    batch = converted;
  }
  std::vector<MealyAnswer> answers(batch.size());
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (!answer_from_tree(batch[i], answers[i])) unknown.push_back(i);
  }
  hits_ += batch.size() - unknown.size();
  try {
    if (!unknown.empty()) ask_system(batch, std::move(unknown), answers, control);
  } catch (...) {
    for (std::size_t i = 0; on_early_end && i < batch.size(); ++i) {
      MealyAnswer answer;
      if (!answer_from_tree(batch[i], answer)) continue;
      hand_up(answer);
      on_early_end(i, answer);
    }
    throw;
  }
  for (MealyAnswer& answer : answers) hand_up(answer);
  return answers;
}

// Asks until nothing is unknown: a word that ended early does not answer its prefixes' extensions,
// and a correction may forget what was just recorded.
void Cache::ask_system(std::span<const Query> batch, std::vector<std::size_t> unknown,
                       std::vector<MealyAnswer>& answers, const RunControl& control) {
  while (!unknown.empty()) {
    const std::vector<std::size_t> selected = select_queries(batch, unknown);
    const std::size_t chunk = file_ != nullptr ? words_at_risk : selected.size();
    const std::uint64_t corrections = votes_ ? votes_->corrections : 0;
    for (std::size_t start = 0; start < selected.size(); start += chunk) {
      const auto part =
          std::span(selected).subspan(start, std::min(chunk, selected.size() - start));
      std::vector<Query> queries;
      queries.reserve(part.size());
      for (const std::size_t index : part) queries.push_back(to_system(batch[index]));
      std::vector<MealyAnswer> fresh = send(std::move(queries), control);
      for (std::size_t i = 0; i < part.size(); ++i) answers[part[i]] = std::move(fresh[i]);
    }
    misses_ += selected.size();
    const bool was_corrected = votes_ && votes_->corrections != corrections;
    std::vector<std::size_t> still_unknown;
    for (const std::size_t index : unknown) {
      MealyAnswer& answer = answers[index];
      const bool was_sent = std::binary_search(selected.begin(), selected.end(), index);
      if (was_sent && answer.end != WordEnd::complete) continue;  // there is no more of it
      answer.inputs.clear();
      answer.outputs.clear();
      if (answer_from_tree(batch[index], answer)) {
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
// has spoilt.
std::vector<MealyAnswer> Cache::send(std::vector<Query> queries, const RunControl& control) {
  std::vector<MealyAnswer> answers(queries.size());
  std::vector<std::size_t> places(queries.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  try {
    for (std::uint32_t attempt = 1; !queries.empty(); ++attempt) {
      std::vector<MealyAnswer> fresh = ask_below(queries, control);
      std::vector<Query> spoilt;
      std::vector<std::size_t> spoilt_places;
      for (std::size_t i = 0; i < fresh.size(); ++i) {
        if (!accept(fresh[i], control)) {
          if (attempt >= votes_->options.most_attempts) {
            throw contradiction(fresh[i].inputs, fresh[i].outputs,
                                find_conflict(fresh[i].inputs, fresh[i].outputs).value_or(0));
          }
          spoilt.push_back(std::move(queries[i]));
          spoilt_places.push_back(places[i]);
        }
        answers[places[i]] = std::move(fresh[i]);
      }
      queries = std::move(spoilt);
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

// The system's answers in the tree's numbering. Those before an exception are recorded unless they
// contradict the tree: the call ends with another error already.
std::vector<MealyAnswer> Cache::ask_below(std::span<const Query> queries,
                                          const RunControl& control) {
  const auto renumber = [this](MealyAnswer& answer) {
    for (Symbol& output : answer.outputs) output = from_system_[output];
  };
  std::vector<MealyAnswer> fresh =
      system_.ask(queries, control, [&](std::size_t, MealyAnswer answer) {
        learn_system_outputs();
        renumber(answer);
        if (!find_conflict(answer.inputs, answer.outputs)) record(answer);
      });
  learn_system_outputs();
  for (MealyAnswer& answer : fresh) renumber(answer);
  return fresh;
}

void Cache::record(const MealyAnswer& answer) {
  if (insert(answer.inputs, answer.outputs) && file_ != nullptr) {
    file_->add(answer.inputs, answer.outputs, stored_outputs_);
  }
}

std::optional<std::size_t> Cache::find_conflict(const Word& inputs, const Word& outputs) const {
  TraceTree::Node node = TraceTree::root;
  const std::size_t length = std::min(inputs.size(), outputs.size());
  for (std::size_t i = 0; i < length; ++i) {
    node = tree_.child(node, inputs[i]);
    if (node == TraceTree::none) break;
    if (tree_.output(node) != outputs[i]) return i;
  }
  return std::nullopt;
}

NondeterminismError Cache::contradiction(const Word& inputs, const Word& outputs,
                                         std::size_t agreeing) const {
  const auto word = std::span(inputs).first(agreeing + 1);
  return {to_string(word, system_.inputs()), to_string(known_outputs(word), stored_outputs_),
          to_string(std::span(outputs).first(agreeing + 1), stored_outputs_)};
}

// Adds a trace; false if all of it was known. Adds nothing of a trace that contradicts the tree.
bool Cache::insert(const Word& inputs, const Word& outputs) {
  if (const auto agreeing = find_conflict(inputs, outputs)) {
    throw contradiction(inputs, outputs, *agreeing);
  }
  TraceTree::Node node = TraceTree::root;
  bool is_new = false;
  for (std::size_t i = 0; i < std::min(inputs.size(), outputs.size()); ++i) {
    const TraceTree::Node child = is_new ? TraceTree::none : tree_.child(node, inputs[i]);
    is_new = child == TraceTree::none;
    node = is_new ? tree_.add_child(node, inputs[i], outputs[i]) : child;
  }
  return is_new;
}

// Makes the outputs known that the system has named since.
void Cache::learn_system_outputs() {
  const Alphabet& names = system_.outputs();
  while (from_system_.size() < names.size()) {
    const auto next = static_cast<Symbol>(from_system_.size());
    from_system_.push_back(stored_outputs_.intern(names.name(next)));
  }
}

void Cache::hand_up(MealyAnswer& answer) {
  for (Symbol& output : answer.outputs) {
    if (output >= handed_up_.size()) handed_up_.resize(stored_outputs_.size(), no_symbol);
    Symbol& handed_up = handed_up_[output];
    if (handed_up == no_symbol) handed_up = outputs_.intern(stored_outputs_.name(output));
    output = handed_up;
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

}  // namespace maide
