#include "maide/learn/cache/known_answers.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "maide/base/invariant.hpp"

namespace maide {

Symbol KnownAnswers::intern_output(const std::string& name) {
  const Symbol output = outputs_.intern(name);
  if (output == is_refusal_.size()) {
    is_refusal_.push_back(name == "refused" || name == "unexplored" || name == "absorbed");
  }
  return output;
}

bool KnownAnswers::has_refused(const CacheLookup& known) const {
  const Word& outputs = known.answer.outputs;
  return has_refusals_ &&
         std::ranges::any_of(outputs, [this](Symbol output) { return is_refusal(output); });
}

Word KnownAnswers::without_refused(std::span<const Symbol> inputs,
                                   std::span<const Symbol> outputs) const {
  Word word;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (i + 1 == inputs.size() || !is_refusal(outputs[i])) word.push_back(inputs[i]);
  }
  return word;
}

Query KnownAnswers::without_refused(const Query& query, const CacheLookup& known) const {
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

CacheLookup KnownAnswers::look_up(const Query& query) {
  CacheLookup result;
  result.is_whole = play_query(query, result.answer, [&](Symbol input) -> std::optional<Symbol> {
    const TraceTree::Node edge = tree_.child(result.node, input);
    if (edge == TraceTree::none) return std::nullopt;
    result.node = behind(result.node, edge);
    tree_.mark(edge);
    return tree_.output(edge);
  });
  return result;
}

std::vector<CacheLookup> KnownAnswers::look_up_all(std::span<const Query> batch) {
  std::vector<CacheLookup> results(batch.size());
  std::vector<std::span<const Symbol>> words(batch.size());  // empty for trees
  std::size_t symbols = 0, as_before = 0;  // of all words; those that begin as the word before them
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Word* const word = std::get_if<Word>(&batch[i]);
    if (word == nullptr) continue;
    words[i] = *word;
    results[i].answer.outputs.reserve(word->size());
    symbols += word->size();
    if (i > 0) as_before += count_common(words[i - 1], words[i]);
  }
  if (has_refusals_ || 2 * as_before >= symbols) {
    follow_in_turn(words, results);
  } else {
    tree_.walk_together(words, [&](std::size_t i, TraceTree::Node node) {
      results[i].node = node;
      results[i].answer.outputs.push_back(tree_.output(node));
      tree_.mark(node);
    });
  }
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (std::holds_alternative<DecisionTree>(batch[i])) {
      results[i] = look_up(batch[i]);
      continue;
    }
    MAIDE_CHECK(results[i].answer.outputs.size() <= words[i].size());
    results[i].is_whole = results[i].answer.outputs.size() == words[i].size();
    if (results[i].is_whole) results[i].answer.inputs = std::get<Word>(batch[i]);
  }
  return results;
}

// One word after the other, each from where it parts from the one before: what a learner asks of a
// state begins with that state's access word.
void KnownAnswers::follow_in_turn(std::span<const std::span<const Symbol>> words,
                                  std::vector<CacheLookup>& results) {
  std::vector<TraceTree::Node> path;  // of the word before, as far as the tree knows it
  for (std::size_t i = 0; i < words.size(); ++i) {
    Word& outputs = results[i].answer.outputs;
    const std::size_t common =
        i > 0 ? std::min(count_common(words[i - 1], words[i]), path.size()) : 0;
    path.resize(common);
    if (common > 0) {
      const Word& before = results[i - 1].answer.outputs;
      outputs.assign(before.begin(), before.begin() + static_cast<std::ptrdiff_t>(common));
    }
    TraceTree::Node node = common > 0 ? path.back() : TraceTree::root;
    for (const Symbol input : words[i].subspan(common)) {
      const TraceTree::Node edge = tree_.child(node, input);
      if (edge == TraceTree::none) break;
      node = behind(node, edge);
      tree_.mark(edge);
      path.push_back(node);
      outputs.push_back(tree_.output(edge));
    }
    MAIDE_CHECK(path.size() == outputs.size() && outputs.size() <= words[i].size());
    results[i].node = node;
  }
}

TraceTree::Node KnownAnswers::node_of(std::span<const Symbol> word) const {
  TraceTree::Node node = TraceTree::root;
  for (const Symbol input : word) node = tree_.child(node, input);
  return node;
}

Word KnownAnswers::outputs_to(std::span<const Symbol> word) const {
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

bool KnownAnswers::is_among_first(std::uint64_t count, const Word& word) const {
  TraceTree::Node node = TraceTree::root;
  for (const Symbol input : word) {
    const TraceTree::Node edge = tree_.child(node, input);
    if (edge == TraceTree::none || edge > count) return false;  // nodes count up from the root, 0
    node = behind(node, edge);
  }
  return true;
}

bool KnownAnswers::passes(TraceTree::Node edge, const Word& word, std::size_t input) const {
  TraceTree::Node node = TraceTree::root;
  for (std::size_t i = 0; i < input; ++i) node = behind(node, tree_.child(node, word[i]));
  return tree_.child(node, word[input]) == edge;
}

std::optional<std::size_t> KnownAnswers::find_conflict(const Word& inputs,
                                                       const Word& outputs) const {
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

NondeterminismError KnownAnswers::contradiction(const Word& inputs, const Word& outputs,
                                                std::size_t agreeing) const {
  MAIDE_CHECK(agreeing < inputs.size() && agreeing < outputs.size());
  const auto word = std::span(inputs).first(agreeing + 1);
  return {to_string(word, inputs_), to_string(outputs_to(word), outputs_),
          to_string(std::span(outputs).first(agreeing + 1), outputs_)};
}

bool KnownAnswers::add(const Word& inputs, const Word& outputs) {
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
  return is_new;
}

std::optional<bool> KnownAnswers::extend(const Query& query, const CacheLookup& known,
                                         const MealyAnswer& answer) {
  MAIDE_CHECK(!has_refusals_);
  const Word* const word = std::get_if<Word>(&query);
  const Word& path = word != nullptr ? *word : known.answer.inputs;
  const std::size_t start = known.answer.outputs.size();
  const std::size_t end = std::min(answer.inputs.size(), answer.outputs.size());
  if (end <= start || (word != nullptr && end > word->size()) ||
      !std::equal(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(start),
                  answer.inputs.begin()) ||
      !std::equal(known.answer.outputs.begin(), known.answer.outputs.end(),
                  answer.outputs.begin())) {
    return std::nullopt;
  }
  TraceTree::Node node = known.node;
  MAIDE_CHECK(start == 0 ? node == TraceTree::root
                         : tree_.output(node) == known.answer.outputs.back());
  std::size_t i = start;
  for (; i < end; ++i) {  // what other words of the batch have brought
    const TraceTree::Node child = tree_.child(node, answer.inputs[i]);
    if (child == TraceTree::none) break;
    if (tree_.output(child) != answer.outputs[i]) return std::nullopt;
    node = child;
  }
  if (i == end) return false;
  for (; i < end; ++i) node = tree_.add_child(node, answer.inputs[i], answer.outputs[i]);
  return true;
}

void KnownAnswers::check_invariants() const {
  tree_.check_invariants();
  std::vector<TraceTree::Node> below;
  for (std::vector<TraceTree::Node> open{TraceTree::root}; !open.empty();) {
    const TraceTree::Node node = open.back();
    open.pop_back();
    tree_.children(node, below);
    for (const TraceTree::Node child : below) {
      MAIDE_CHECK_ALWAYS(tree_.input(child) < inputs_.size());
      MAIDE_CHECK_ALWAYS(tree_.output(child) < outputs_.size());
      // What was asked for in this run, the consistency test comes to.
      MAIDE_CHECK_ALWAYS(!tree_.is_marked(child) || node == TraceTree::root ||
                         tree_.is_marked(node));
    }
    open.insert(open.end(), below.begin(), below.end());
  }
}

}  // namespace maide
