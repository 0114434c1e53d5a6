#include "maide/conformance/suite/loop_suites.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"
#include "maide/conformance/identify/separating_words.hpp"

namespace maide {
namespace {

constexpr std::size_t sample_length = 400;  // of a walk or a tour of pumps, at least

constexpr std::size_t highest_ladder = 128;

std::uint64_t power(std::uint64_t base, std::size_t exponent) {
  std::uint64_t result = 1;
  for (std::size_t i = 0; i < exponent; ++i) result = saturating_product(result, base);
  return result;
}

void append(Word& word, Symbol input, std::size_t times) { word.insert(word.end(), times, input); }

}  // namespace

LoopingInputs::LoopingInputs(const Mealy& hypothesis, const StateIdentifiers& identifiers,
                             const std::vector<bool>& is_error)
    : hypothesis_(hypothesis),
      identifiers_(identifiers),
      loops_(hypothesis.size()),
      is_over_(hypothesis.size()) {
  const auto refused = hypothesis.outputs().find("refused");
  const auto untried = hypothesis.outputs().find("unexplored");
  for (Word& access : compute_state_cover(hypothesis)) {
    const StateId state = hypothesis.run(access);
    states_.push_back({std::move(access), state});
  }
  if (!is_error.empty()) avoid_errors(is_error);
  for (const auto& [access, state] : states_) {
    if (is_over_[state]) continue;
    for (Symbol input = 0; input < hypothesis.inputs().size(); ++input) {
      const auto [target, output] = hypothesis.row(state)[input];
      if (target == state && output != refused && output != untried) {
        loops_[state].push_back(input);
      }
    }
  }
  find_ways(is_error);
}

// Behind the end of a session is a state that no input leaves, so only words to such states pass an
// error output, by their last input.
void LoopingInputs::avoid_errors(const std::vector<bool>& is_error) {
  const auto ends = [&](const Word& word) {
    const StateId before = hypothesis_.run(head(word, word.size() - 1));
    return is_error[hypothesis_.output(before, word.back())];
  };
  for (const Start& start : states_)
    is_over_[start.state] = !start.access.empty() && ends(start.access);
  for (Start& start : states_) {
    if (!is_over_[start.state]) continue;
    for (const auto& [access, source] : states_) {
      for (Symbol input = 0; input < hypothesis_.inputs().size(); ++input) {
        const auto [target, output] = hypothesis_.row(source)[input];
        if (target != start.state || source == target || is_over_[source] || is_error[output])
          continue;
        start.access = access;
        start.access.push_back(input);
        is_over_[start.state] = false;
        break;
      }
      if (!is_over_[start.state]) break;
    }
  }
}

void LoopingInputs::find_ways(const std::vector<bool>& is_error) {
  std::vector<const Word*> access_of(hypothesis_.size());
  for (const auto& [access, state] : states_) access_of[state] = &access;
  std::vector<std::uint64_t> uses(hypothesis_.outputs().size());
  for (const Start& start : states_) {
    for (const auto& [target, output] : hypothesis_.row(start.state)) ++uses[output];
  }
  // The last transition of each kind: the farthest, and the one that the least is known of.
  std::map<std::pair<StateId, Symbol>, Start> last;
  for (const auto& [access, state] : states_) {
    for (Symbol input = 0; input < hypothesis_.inputs().size(); ++input) {
      const auto [target, output] = hypothesis_.row(state)[input];
      Word word = access;
      word.push_back(input);
      const bool is_end = is_over_[state] || (!is_error.empty() && is_error[output]);
      if (target != state && !is_end && *access_of[target] != word) {
        last[{target, output}] = {std::move(word), target};
      }
    }
  }
  std::vector<std::pair<std::uint64_t, Start>> by_rarity;
  for (auto& [kind, start] : last) by_rarity.emplace_back(uses[kind.second], std::move(start));
  std::ranges::stable_sort(
      by_rarity, [](const auto& left, const auto& right) { return left.first < right.first; });
  for (auto& [rarity, start] : by_rarity) ways_.push_back(std::move(start));
}

void LoopingInputs::append_end(StateId state, std::uint64_t turn, Word& word) const {
  word.insert(word.end(), loops_[state].begin(), loops_[state].end());
  const std::span<const Word> words = identifiers_.of(state);
  const Word& last = words[turn % words.size()];
  word.insert(word.end(), last.begin(), last.end());
}

namespace {

// An input leads through new states one after the other, as where something is counted.
struct Row {
  Symbol input;
  std::size_t start;  // of its first state
  std::vector<StateId> states;
};

std::vector<Row> find_rows(const LoopingInputs& loops) {
  constexpr std::size_t shortest_row = 4;
  const Mealy& hypothesis = loops.hypothesis();
  std::vector<Row> rows;
  for (Symbol input = 0; input < hypothesis.inputs().size(); ++input) {
    std::vector<bool> is_inside(hypothesis.size());  // of a row that began before
    for (std::size_t start = 0; start < loops.states().size(); ++start) {
      const StateId first = loops.states()[start].state;
      if (is_inside[first]) continue;
      std::vector<StateId> row{first};
      is_inside[first] = true;
      for (StateId next = hypothesis.target(first, input); !is_inside[next];
           next = hypothesis.target(next, input)) {
        is_inside[next] = true;
        row.push_back(next);
      }
      if (row.size() >= shortest_row) rows.push_back({input, start, std::move(row)});
    }
  }
  return rows;
}

// a, aa, aaa, ..., each with b behind it.
struct Ladder {
  Symbol rung, follower;
  std::size_t shortest, longest;
};

constexpr std::size_t short_ladder = 24;
constexpr std::uint64_t ladder_stride = 7919;  // a prime, so that all pairs are passed

std::uint64_t count_ladder_pairs(const LoopingInputs& loops, StateId state) {
  return loops.of(state).size() * loops.hypothesis().inputs().size();
}

Ladder make_ladder(const LoopingInputs& loops, StateId state, std::uint64_t pair, bool is_long,
                   std::size_t most_repeats) {
  const std::span<const Symbol> letters = loops.of(state);
  pair %= count_ladder_pairs(loops, state);
  const std::size_t middle = std::min(short_ladder, most_repeats);
  return {letters[pair % letters.size()], static_cast<Symbol>(pair / letters.size()),
          is_long ? std::min(middle + 1, most_repeats) : 1, is_long ? most_repeats : middle};
}

// A shortest word from one state to another; nothing if there is none. O(n k).
std::optional<Word> find_path(const Mealy& machine, StateId from, StateId to) {
  struct Step {
    StateId before;
    Symbol input;
  };
  std::vector<std::optional<Step>> entered(machine.size());
  std::vector<StateId> queue{from};
  for (std::size_t next = 0; next < queue.size() && queue[next] != to; ++next) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      const StateId target = machine.target(queue[next], input);
      if (target == from || entered[target]) continue;
      entered[target] = Step{queue[next], input};
      queue.push_back(target);
    }
  }
  Word path;
  for (StateId at = to; at != from; at = entered[at]->before) {
    if (!entered[at]) return std::nullopt;
    path.push_back(entered[at]->input);
  }
  std::ranges::reverse(path);
  return path;
}

// Behind each follower comes `back`, the way to the same state again; false if there is none, or
// the word gets too long.
bool append_ladder(const Ladder& ladder, const std::optional<Word>& back, Word& word) {
  for (std::size_t times = ladder.shortest; times <= ladder.longest; ++times) {
    append(word, ladder.rung, times);
    word.push_back(ladder.follower);
    if (!back || word.size() + back->size() > longest_test / 2) return false;
    word.insert(word.end(), back->begin(), back->end());
  }
  return true;
}

}  // namespace

// Hierholzer's algorithm on the graph whose nodes are the words of order - 1 letters, whose edges
// are those of `order`: a node's edges are taken in an order that is drawn for it.
Word draw_chain(std::span<const Symbol> letters, std::size_t order, Random random) {
  const std::size_t count = letters.size();
  if (count == 0 || order == 0) return {};
  const std::size_t nodes = power(count, order - 1);
  std::vector<std::uint32_t> edges(nodes * count);  // of each node, its next letters
  for (std::size_t node = 0; node < nodes; ++node) {
    const auto own = std::span(edges).subspan(node * count, count);
    std::iota(own.begin(), own.end(), 0);
    random.shuffle(own);
  }
  std::vector<std::uint32_t> taken(nodes);
  // Nodes on the way, each with the letter that led there.
  std::vector<std::pair<std::size_t, std::uint32_t>> path{{0, 0}};
  Word circuit;
  circuit.reserve(nodes * count + order - 1);
  while (!path.empty()) {
    const auto [node, letter] = path.back();
    if (taken[node] < count) {
      const std::uint32_t next = edges[node * count + taken[node]++];
      path.emplace_back((node * count + next) % nodes, next);
    } else {
      path.pop_back();
      if (!path.empty()) circuit.push_back(letters[letter]);
    }
  }
  MAIDE_CHECK(circuit.size() == nodes * count);  // every edge once
  std::ranges::reverse(circuit);
  // It begins in node 0, whose letters are all the first: the words across the seam are closed by
  // its own beginning.
  for (std::size_t i = 0; i + 1 < order; ++i) circuit.push_back(circuit[i]);
  return circuit;
}

ChainSuite::ChainSuite(const LoopingInputs& loops, std::span<const LoopingInputs::Start> starts,
                       std::size_t order, std::size_t piece_length, Random random,
                       std::uint64_t max_pieces)
    : loops_(loops),
      starts_(starts),
      order_(order),
      piece_length_(piece_length),
      random_(random),
      max_pieces_(max_pieces) {
  for (const auto& [access, state] : starts_) {
    const std::uint64_t all = count_pieces(state);
    const std::uint64_t pieces = std::min(all, max_pieces_);
    is_whole_ = is_whole_ && pieces == all;
    const std::size_t letters = loops_.of(state).size();
    size_ = saturating_sum(size_, pieces);
    const std::uint64_t inside =
        std::min(saturating_sum(power(letters, order_), (order_ - 1) * pieces),
                 saturating_product(pieces, piece_length_ + order_ - 1));
    symbols_ =
        saturating_sum(symbols_, saturating_sum(saturating_product(pieces, access.size() + letters),
                                                letters == 0 ? 0 : inside));
  }
}

std::uint64_t ChainSuite::count_pieces(StateId state) const {
  const std::size_t letters = loops_.of(state).size();
  if (letters == 0) return 0;
  const std::uint64_t words = power(letters, order_);
  return words / piece_length_ + (words % piece_length_ != 0 ? 1 : 0);
}

bool ChainSuite::next(Word& word) {
  while (start_ < starts_.size() &&
         piece_ >= std::min(max_pieces_, count_pieces(starts_[start_].state))) {
    ++start_;
    piece_ = 0;
  }
  if (start_ == starts_.size()) return false;
  const auto& [access, state] = starts_[start_];
  const std::span<const Symbol> letters = loops_.of(state);
  if (piece_ == 0) chain_ = draw_chain(letters, order_, random_.split());
  const std::size_t begin = piece_ * piece_length_;
  MAIDE_CHECK(begin + order_ - 1 < chain_.size());
  const std::size_t end = std::min(begin + piece_length_ + order_ - 1, chain_.size());
  word = access;
  word.insert(word.end(), chain_.begin() + static_cast<std::ptrdiff_t>(begin),
              chain_.begin() + static_cast<std::ptrdiff_t>(end));
  loops_.append_end(state, piece_, word);
  ++piece_;
  return true;
}

PumpSuite::PumpSuite(const LoopingInputs& loops, std::vector<std::size_t> counts)
    : loops_(loops), counts_(std::move(counts)) {
  Place place;
  while (make(place, nullptr, symbols_)) ++size_;
}

// To the next follower, which is another input; to the next count, loop and start behind the last.
// With `anew` the place may already be right.
bool PumpSuite::advance(const LoopingInputs& loops, std::size_t counts, Place& place, bool anew) {
  const std::size_t inputs = loops.hypothesis().inputs().size();
  if (!anew) ++place.follower;
  while (place.start < loops.states().size()) {
    const auto looping = loops.of(loops.states()[place.start].state);
    if (place.loop < looping.size()) {
      if (place.count < counts) {
        if (place.follower < inputs && place.follower == looping[place.loop]) ++place.follower;
        if (place.follower < inputs) return true;
        place.follower = 0;
        ++place.count;
        continue;
      }
      place.count = 0;
      ++place.loop;
      continue;
    }
    place.loop = 0;
    ++place.start;
  }
  return false;
}

// One word: pumps of one loop and count as long as their followers loop, too, and the word is not
// long enough. Only counts, without a word.
bool PumpSuite::make(Place& place, Word* word, std::uint64_t& symbols) const {
  if (counts_.empty() || !advance(loops_, counts_.size(), place, true)) return false;
  const auto& [access, state] = loops_.states()[place.start];
  const Mealy& hypothesis = loops_.hypothesis();
  const Place begin = place;
  MAIDE_CHECK(place.count < counts_.size() && place.loop < loops_.of(state).size());
  const Symbol loop = loops_.of(state)[place.loop];
  const std::size_t times = counts_[place.count];
  const std::size_t longest = std::min(std::max(8 * times, sample_length), longest_test / 2);
  std::size_t length = access.size();
  if (word != nullptr) *word = access;
  while (true) {
    const Symbol follower = place.follower;
    length += times + 1;
    if (word != nullptr) {
      append(*word, loop, times);
      word->push_back(follower);
    }
    const bool has_next = advance(loops_, counts_.size(), place, false);
    const bool goes_on = has_next && place.start == begin.start && place.loop == begin.loop &&
                         place.count == begin.count && hypothesis.target(state, follower) == state;
    if (goes_on && length < longest) continue;
    const StateId last = hypothesis.target(state, follower);
    if (word != nullptr) loops_.append_end(last, follower, *word);
    symbols = saturating_sum(symbols, length + loops_.of(last).size());
    return true;
  }
}

bool PumpSuite::next(Word& word) {
  std::uint64_t ignored = 0;
  return make(place_, &word, ignored);
}

GrowthSuite::GrowthSuite(const LoopingInputs& loops, std::span<const std::size_t> sizes,
                         std::uint64_t max_symbols)
    : symbols_left_(max_symbols) {
  guess_sizes(loops, sizes);
  guess_rows(loops);
}

bool GrowthSuite::next(Word& word) {
  if (next_ == words_.size()) return false;
  word = words_[next_++];
  return true;
}

void GrowthSuite::add(const Word& access, Symbol input, std::size_t times, Symbol follower,
                      std::size_t follower_times) {
  MAIDE_CHECK(input != follower && times > 0 && follower_times > 0);
  const std::size_t length = access.size() + times + follower_times;
  if (length > symbols_left_ || length > longest_test) return;
  symbols_left_ -= length;
  Word& word = words_.emplace_back(access);
  append(word, input, times);
  append(word, follower, follower_times);
}

// What one input puts in and another takes out, once more than there is room for.
void GrowthSuite::guess_sizes(const LoopingInputs& loops, std::span<const std::size_t> sizes) {
  const Symbol inputs = static_cast<Symbol>(loops.hypothesis().inputs().size());
  for (const std::size_t size : sizes) {
    if (loops.hypothesis().size() > size) continue;
    for (const auto& [access, state] : loops.states()) {
      for (const Symbol loop : loops.of(state)) {
        for (Symbol follower = 0; follower < inputs; ++follower) {
          if (follower != loop) add(access, loop, size + 1, follower, size + 2);
        }
      }
    }
  }
}

void GrowthSuite::guess_rows(const LoopingInputs& loops) {
  const Mealy& hypothesis = loops.hypothesis();
  const Symbol inputs = static_cast<Symbol>(hypothesis.inputs().size());
  for (const auto& [input, start, row] : find_rows(loops)) {
    const Word& access = loops.states()[start].access;
    for (Symbol follower = 0; follower < inputs; ++follower) {
      if (follower == input) continue;
      std::size_t taken_back = 0;
      for (std::size_t i = 1; i < row.size(); ++i) {
        if (hypothesis.target(row[i], follower) == row[i - 1]) ++taken_back;
      }
      const bool takes_back = 2 * taken_back > row.size();
      add(access, input, 2 * row.size(), follower, takes_back ? 2 * row.size() + 1 : 1);
    }
  }
}

LadderSuite::LadderSuite(const LoopingInputs& loops, std::size_t most_repeats)
    : loops_(loops), most_repeats_(std::clamp<std::size_t>(most_repeats, 2, highest_ladder)) {
  const std::vector<Row> rows = find_rows(loops);
  if (rows.empty()) return;
  std::vector<bool> is_inside(loops.hypothesis().size());
  for (const Row& row : rows) {
    for (std::size_t i = 1; i + 1 < row.states.size(); ++i) is_inside[row.states[i]] = true;
  }
  for (std::size_t start = 0; start < loops.states().size(); ++start) {
    const StateId state = loops.states()[start].state;
    if (is_inside[state] || loops.of(state).empty()) continue;
    starts_.push_back(start);
    most_pairs_ = std::max(most_pairs_, count_ladder_pairs(loops, state));
  }
}

// The starts take turns, so that each comes as far as the others.
bool LadderSuite::next(Word& word) {
  while (number_ < 2 * most_pairs_ && !starts_.empty()) {
    const std::size_t start = turn_;
    const std::uint64_t number = number_;
    if (++turn_ == starts_.size()) {
      turn_ = 0;
      ++number_;
    }
    const auto& [access, state] = loops_.states()[starts_[start]];
    const std::uint64_t pairs = count_ladder_pairs(loops_, state);
    const bool is_long = number >= most_pairs_;
    const std::uint64_t own = is_long ? number - most_pairs_ : number;
    if (own >= pairs) continue;
    word = access;
    const Ladder ladder =
        make_ladder(loops_, state, start + ladder_stride * own, is_long, most_repeats_);
    const Mealy& hypothesis = loops_.hypothesis();
    const auto back = find_path(hypothesis, hypothesis.target(state, ladder.follower), state);
    if (append_ladder(ladder, back, word)) loops_.append_end(state, number, word);
    return true;
  }
  return false;
}

LoopSampler::LoopSampler(const LoopingInputs& loops, std::size_t most_repeats, Random random)
    : loops_(loops),
      most_repeats_(std::clamp<std::size_t>(most_repeats, 2, highest_ladder)),
      random_(random) {
  const std::size_t inputs = loops.hypothesis().inputs().size();
  for (std::size_t i = 0; i < loops.states().size(); ++i) {
    const std::size_t letters = loops.of(loops.states()[i].state).size();
    if (letters == 0) continue;
    starts_.push_back(i);
    const std::uint64_t ladder = most_repeats_ * (most_repeats_ + 3) / 2;
    enough_ = saturating_sum(enough_, saturating_product(letters * inputs, ladder));
  }
  random_.shuffle(starts_);
  ladders_.resize(starts_.size());
  steps_.resize(starts_.size());
}

LoopSampler::Letters LoopSampler::draw_letters(std::span<const Symbol> loops) {
  const auto draw = [&] { return loops[random_.below(loops.size())]; };
  Letters letters{draw(), draw(), 0};
  letters.follower = static_cast<Symbol>(random_.below(loops_.hypothesis().inputs().size()));
  return letters;
}

// Kinds take turns; so do states, by rounds.
bool LoopSampler::next(Word& word) {
  if (starts_.empty()) return false;
  enum class Kind : std::uint8_t { ladder, steps, pump, small_triangle, triangle, cycle, walk };
  constexpr std::array kinds{Kind::ladder,   Kind::steps,  Kind::ladder, Kind::small_triangle,
                             Kind::ladder,   Kind::pump,   Kind::ladder, Kind::cycle,
                             Kind::triangle, Kind::ladder, Kind::walk};
  const std::size_t start = turn_ % starts_.size();
  const auto& [access, state] = loops_.states()[starts_[start]];
  const Kind kind = kinds[(turn_ / starts_.size() + turn_) % kinds.size()];
  const std::span<const Symbol> loops = loops_.of(state);
  const Letters letters = draw_letters(loops);
  ++turn_;
  word = access;
  switch (kind) {
    case Kind::steps:  // a, then every looping input, so often; for each a once
      if (steps_[start] < loops.size()) {
        const Symbol step = loops[steps_[start]++];
        for (std::size_t times = 1; times <= most_repeats_; ++times) {
          word.push_back(step);
          for (const Symbol other : loops) {
            if (other != step) word.push_back(other);
          }
        }
        break;
      }
      [[fallthrough]];
    case Kind::ladder: {
      // Every pair of letters once with short ladders, which cost least for what they may find,
      // before one comes again with a long one.
      const std::uint64_t number = ladders_[start]++;
      const bool is_long = number / count_ladder_pairs(loops_, state) % 2 == 1;
      const Ladder ladder =
          make_ladder(loops_, state, start + ladder_stride * number, is_long, most_repeats_);
      const bool stays = loops_.hypothesis().target(state, ladder.follower) == state;
      if (!append_ladder(ladder, stays ? std::optional(Word()) : std::nullopt, word)) return true;
      break;
    }
    case Kind::pump:
      append(word, letters.first, 1 + random_.below(most_repeats_));
      word.push_back(letters.follower);
      return true;
    case Kind::small_triangle:
    case Kind::triangle: {  // each count of a, then each up to it of b
      const std::size_t most =
          kind == Kind::triangle ? most_repeats_ : std::min<std::size_t>(16, most_repeats_);
      const std::size_t step = kind == Kind::triangle ? 1 + random_.below(8) : 1;
      for (std::size_t times = step; times <= most; times += step) {
        append(word, letters.first, times);
        append(word, letters.second, times);
        word.push_back(loops[random_.below(loops.size())]);
      }
      break;
    }
    case Kind::cycle:
      for (std::size_t i = random_.below(most_repeats_) + 1; i > 0; --i) {
        word.push_back(letters.first);
        word.push_back(letters.second);
      }
      break;
    case Kind::walk:
      for (std::size_t i = 0; i < sample_length; ++i)
        word.push_back(loops[random_.below(loops.size())]);
      break;
  }
  loops_.append_end(state, turn_, word);
  return true;
}

}  // namespace maide
