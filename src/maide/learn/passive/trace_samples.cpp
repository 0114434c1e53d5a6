#include "maide/learn/passive/trace_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"

namespace maide {
namespace {

constexpr std::size_t batch_size = 4096;

std::uint32_t needed_count(const SamplingOptions& options) {
  if (!(options.confidence > 0 && options.confidence < 1 && options.rarest > 0 &&
        options.rarest < 1)) {
    throw UsageError(
        fmt::format("a confidence of {} for answers that come with probability {} is "
                    "not between 0 and 1",
                    options.confidence, options.rarest));
  }
  return static_cast<std::uint32_t>(
      std::ceil(std::log1p(-options.confidence) / std::log1p(-options.rarest)));
}

}  // namespace

TraceSamples::TraceSamples(OutputOracle& oracle, const SamplingOptions& options)
    : oracle_(oracle), needed_(needed_count(options)), most_rounds_(options.most_rounds) {}

std::uint32_t TraceSamples::count(Node node, Symbol input) const {
  const auto& cells = records_[node].cells;
  return cells.empty() ? 0 : cells[input].count;
}

std::span<const TraceSamples::Branch> TraceSamples::branches(Node node, Symbol input) const {
  const auto& cells = records_[node].cells;
  if (cells.empty()) return {};
  return cells[input].branches;
}

TraceSamples::Node TraceSamples::child(Node node, Symbol input, Symbol output) const {
  for (const Branch& branch : branches(node, input)) {
    if (branch.output == output) return branch.node;
  }
  return none;
}

Word TraceSamples::inputs_of(Node node) const {
  Word word;
  for (; node != root; node = records_[node].parent) word.push_back(records_[node].input);
  std::ranges::reverse(word);
  return word;
}

void TraceSamples::record(const MealyAnswer& answer) {
  Node node = root;
  for (std::size_t i = 0; i < answer.outputs.size(); ++i) {
    const Symbol input = answer.inputs[i];
    if (records_[node].cells.empty()) records_[node].cells.resize(inputs().size());
    ++records_[node].cells[input].count;
    Node next = child(node, input, answer.outputs[i]);
    if (next == none) {
      next = static_cast<Node>(records_.size());
      records_[node].cells[input].branches.push_back({answer.outputs[i], next});
      records_.push_back({node, input, {}});
    }
    node = next;
  }
}

void TraceSamples::run(std::span<const Word> words, const RunControl& control) {
  for (std::size_t start = 0; start < words.size(); start += batch_size) {
    control.check("learning");
    const auto part = words.subspan(start, std::min(batch_size, words.size() - start));
    const std::vector<Query> batch(part.begin(), part.end());
    const auto answers =
        oracle_.ask(batch, control, [this](std::size_t, const MealyAnswer& answer) {
          record(answer);  // before an exception
        });
    for (const MealyAnswer& answer : answers) record(answer);
  }
}

// The most that any place along `word` lacks, behind the traces seen.
std::uint32_t TraceSamples::missing(Node node, std::span<const Symbol> word) const {
  if (word.empty()) return 0;
  const std::uint32_t seen = count(node, word.front());
  std::uint32_t most = seen < needed_ ? needed_ - seen : 0;
  for (const Branch& branch : branches(node, word.front())) {
    most = std::max(most, missing(branch.node, word.subspan(1)));
  }
  return most;
}

void TraceSamples::sample(std::vector<Word> words, const RunControl& control) {
  words = without_prefixes(std::move(words));
  const std::uint64_t limit = std::uint64_t{needed_} * most_rounds_;
  std::vector<Word> batch;
  do {
    batch.clear();
    for (const Word& word : words) {
      const std::uint32_t lacking = missing(root, word);
      if (lacking == 0) continue;
      std::uint64_t& runs = runs_[word];
      const std::uint64_t copies = std::min<std::uint64_t>(lacking, limit - std::min(limit, runs));
      runs += copies;
      batch.insert(batch.end(), copies, word);
    }
    run(batch, control);
  } while (!batch.empty());
}

}  // namespace maide
