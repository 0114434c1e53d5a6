#include "maide/automata/differences.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "maide/automata/mealy.hpp"
#include "maide/base/hash.hpp"
#include "maide/base/invariant.hpp"

namespace maide {
namespace {

// ---- Pairs of states that meet ----

struct Step {
  std::optional<Symbol> left, right;  // labels; nothing: this machine rests
  StateId left_state, right_state;
  std::size_t question;
  bool agrees;
};

// The ways that both answers have, and then the ways on which each machine goes on with its own
// answer, where that is one way each.
template <typename Visit>
void for_each_step(const BehaviourPair& pair, StateId left, StateId right, Visit&& visit) {
  for (std::size_t question = 0; question < pair.questions.size(); ++question) {
    const auto& left_ways = pair.left_answer(left, question).ways;
    const auto& right_ways = pair.right_answer(right, question).ways;
    const auto find = [](const auto& ways, Symbol label) -> const Answer::Way* {
      for (const Answer::Way& way : ways) {
        if (way.label == label) return &way;
      }
      return nullptr;
    };
    const Answer::Way* left_alone = nullptr;
    const Answer::Way* right_alone = nullptr;
    std::size_t left_count = 0, right_count = 0;
    for (const Answer::Way& way : left_ways) {
      if (const Answer::Way* other = find(right_ways, way.label)) {
        if (pair.is_rest(way.label)) continue;
        visit(Step{way.label, way.label, way.target, other->target, question, true});
      } else {
        left_alone = &way;
        ++left_count;
      }
    }
    for (const Answer::Way& way : right_ways) {
      if (find(left_ways, way.label) != nullptr) continue;
      right_alone = &way;
      ++right_count;
    }
    if (left_count != 1 || right_count != 1) continue;
    const auto label = [&](const Answer::Way& way) {
      return pair.is_rest(way.label) ? std::nullopt : std::optional(way.label);
    };
    visit(Step{label(*left_alone), label(*right_alone), left_alone->target, right_alone->target,
               question, false});
  }
}

// Whether two states that meet answer a question differently, by a cause of its own: a state in
// which something is about to come out refuses inputs for that reason.
bool differs(const BehaviourPair& pair, StateId left, StateId right, std::size_t question) {
  const Answer& left_answer = pair.left_answer(left, question);
  const Answer& right_answer = pair.right_answer(right, question);
  if (left_answer.text == right_answer.text) return false;
  const std::size_t last = pair.questions.size() - 1;
  if (!pair.has_outputs || question == last) return true;
  if (pair.left_answer(left, last).text == pair.right_answer(right, last).text) return true;
  const auto is_waited_for = [&](const Answer& answer, const Answer& outputs) {
    return answer.ways.empty() && answer.is_known &&
           std::ranges::any_of(outputs.ways,
                               [&](const Answer::Way& way) { return !pair.is_rest(way.label); });
  };
  return !is_waited_for(left_answer, pair.left_answer(left, last)) &&
         !is_waited_for(right_answer, pair.right_answer(right, last));
}

// The numbers of pairs of states. A table with linear probing, half full at most: it is asked for
// each step of each pair.
class PairNumbers {
 public:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  std::uint32_t find(std::uint64_t pair) const { return places_[place_of(pair)].number; }
  // False if the pair has a number already.
  bool insert(std::uint64_t pair, std::uint32_t number) {
    Place& place = places_[place_of(pair)];
    if (place.number != none) return false;
    place = {pair, number};
    if (2 * ++size_ > places_.size()) grow();
    return true;
  }

 private:
  struct Place {
    std::uint64_t pair = 0;
    std::uint32_t number = none;
  };

  // The pair's own, or the free one where it belongs.
  std::size_t place_of(std::uint64_t pair) const {
    const std::size_t last = places_.size() - 1;
    std::size_t at = hash_mix(0, pair) & last;
    while (places_[at].number != none && places_[at].pair != pair) at = (at + 1) & last;
    return at;
  }
  void grow() {
    std::vector<Place> old(2 * places_.size());
    old.swap(places_);
    for (const Place& place : old) {
      if (place.number != none) places_[place_of(place.pair)] = place;
    }
  }

  std::vector<Place> places_{1024};
  std::size_t size_ = 0;
};

class DifferenceSearch {
 public:
  DifferenceSearch(const BehaviourPair& pair, const RunControl& control)
      : pair_(pair), control_(control) {}

  Differences run() {
    explore();
    result_.pairs = meetings_.size();
    find_partners();
    list();
    return std::move(result_);
  }

 private:
  static constexpr std::uint32_t none = PairNumbers::none;

  // Two states that a word leads to; the first such word by (steps that differ, length, order).
  struct Meeting {
    StateId left, right;
    std::uint32_t parent;  // place in meetings_
    Step step;             // that led here from there
    std::uint32_t passed, length;
  };

  static std::uint64_t key(StateId left, StateId right) {
    return (std::uint64_t{left} << 32) | right;
  }
  std::uint32_t find(StateId left, StateId right) const { return places_.find(key(left, right)); }

  // Dijkstra's algorithm. What is open lies in lists, by the steps that differ and the length, and
  // is taken in the order in which it was found.
  void explore() {
    std::vector<std::vector<std::vector<Meeting>>> open;
    std::size_t left_open = 0;
    const auto push = [&](const Meeting& meeting) {
      if (open.size() <= meeting.passed) open.resize(meeting.passed + std::size_t{1});
      auto& lists = open[meeting.passed];
      if (lists.size() <= meeting.length) lists.resize(meeting.length + std::size_t{1});
      lists[meeting.length].push_back(meeting);
      ++left_open;
    };
    const std::size_t most = most_pairs(pair_);
    push({pair_.left.initial, pair_.right.initial, none, {}, 0, 0});
    for (std::size_t passed = 0; passed < open.size(); ++passed) {
      for (std::size_t length = 0; length < open[passed].size(); ++length) {
        const std::vector<Meeting> list = std::move(open[passed][length]);
        for (const Meeting& meeting : list) {
          --left_open;
          visit(meeting, push);
          if (meetings_.size() < most) continue;
          result_.is_complete = left_open == 0;
          return;
        }
      }
    }
  }

  template <typename Push>
  void visit(const Meeting& meeting, Push&& push) {
    const auto place = static_cast<std::uint32_t>(meetings_.size());
    if (!places_.insert(key(meeting.left, meeting.right), place)) return;
    MAIDE_CHECK(meetings_.empty() || std::tie(meetings_.back().passed, meetings_.back().length) <=
                                         std::tie(meeting.passed, meeting.length));
    meetings_.push_back(meeting);
    if (place % comparison_check == 0) control_.check("the comparison");
    for_each_step(pair_, meeting.left, meeting.right, [&](const Step& step) {
      if (find(step.left_state, step.right_state) != none) return;
      push(Meeting{step.left_state, step.right_state, place, step,
                   meeting.passed + (step.agrees ? 0 : 1), meeting.length + 1});
    });
  }

  // ---- Partners ----

  // The score of every meeting, in [0, 1]: the mean over the questions of which at least one side
  // has something to tell. `keep` is what the states behind an answer in common count.
  std::vector<float> compute_scores() const {
    constexpr float keep = 0.6F;  // Walkinshaw & Bogdanov's
    constexpr int most_rounds = 20;
    constexpr float small = 1e-4F;
    struct Term {
      std::uint32_t question, target;
    };
    std::vector<Term> terms;
    std::vector<std::size_t> begin;
    for (const Meeting& meeting : meetings_) {
      begin.push_back(terms.size());
      for_each_step(pair_, meeting.left, meeting.right, [&](const Step& step) {
        if (!step.agrees) return;
        const std::uint32_t target = find(step.left_state, step.right_state);
        if (target == none) return;  // too many pairs
        terms.push_back({static_cast<std::uint32_t>(step.question), target});
      });
    }
    begin.push_back(terms.size());
    std::vector<std::uint16_t> asked(meetings_.size());
    std::vector<std::uint16_t> agreed(meetings_.size());
    for (std::size_t i = 0; i < meetings_.size(); ++i)
      count_answers(meetings_[i], asked[i], agreed[i]);
    std::vector<float> scores(meetings_.size(), 1), next(meetings_.size());
    for (int round = 0; round < most_rounds; ++round) {
      control_.check("the comparison");
      float most = 0;
      for (std::size_t i = 0; i < meetings_.size(); ++i) {
        float sum = (1 - keep) * static_cast<float>(agreed[i]);
        for (std::size_t at = begin[i]; at < begin[i + 1];) {
          float part = 0;
          std::size_t end = at;
          for (; end < begin[i + 1] && terms[end].question == terms[at].question; ++end) {
            part += scores[terms[end].target];
          }
          sum += keep * part / static_cast<float>(end - at);
          at = end;
        }
        next[i] = asked[i] == 0 ? 1 : sum / static_cast<float>(asked[i]);
        most = std::max(most, std::abs(next[i] - scores[i]));
      }
      scores.swap(next);
      if (most < small) break;
    }
    return scores;
  }

  // Of the questions that at least one state has a way for, and both models tried: how many there
  // are, and how many have a way in common.
  void count_answers(const Meeting& meeting, std::uint16_t& asked, std::uint16_t& agreed) const {
    asked = agreed = 0;
    for (std::size_t question = 0; question < pair_.questions.size(); ++question) {
      const Answer& left = pair_.left_answer(meeting.left, question);
      const Answer& right = pair_.right_answer(meeting.right, question);
      if (!pair_.is_common[question] || !left.is_known || !right.is_known) continue;
      const bool rests = left.text == right.text && left.ways.size() == 1 &&
                         pair_.is_rest(left.ways.front().label);
      if (rests || (left.ways.empty() && right.ways.empty())) continue;
      ++asked;
      agreed += std::ranges::any_of(left.ways, [&](const Answer::Way& way) {
        return std::ranges::any_of(
            right.ways, [&](const Answer::Way& other) { return way.label == other.label; });
      });
    }
  }

  bool are_partners(StateId left, StateId right) const {
    return result_.left_partners[left] == right;
  }

  void join(StateId left, StateId right) {
    if (result_.left_partners[left] != Mealy::no_state ||
        result_.right_partners[right] != Mealy::no_state) {
      return;
    }
    result_.left_partners[left] = right;
    result_.right_partners[right] = left;
  }

  void find_partners() {
    result_.left_partners.assign(pair_.left.size, Mealy::no_state);
    result_.right_partners.assign(pair_.right.size, Mealy::no_state);
    for (StateId left = 0; left < pair_.left.size; ++left) {
      if (pair_.equivalent[left] != Mealy::no_state) join(left, pair_.equivalent[left]);
    }
    join(pair_.left.initial, pair_.right.initial);
    const std::vector<float> scores = compute_scores();
    std::vector<std::uint32_t> order(meetings_.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    // Scores that hardly differ are the same, so that rounding decides nothing.
    const auto rank = [&](std::uint32_t place) { return std::lround(scores[place] * 1000); };
    std::ranges::stable_sort(
        order, [&](std::uint32_t one, std::uint32_t other) { return rank(one) > rank(other); });
    for (const std::uint32_t place : order) {
      if (scores[place] > 0) join(meetings_[place].left, meetings_[place].right);
    }
  }

  // ---- The list ----

  bool is_bound(StateId left, StateId right, std::size_t question) const {
    return !pair_.left_answer(left, question).is_known ||
           !pair_.right_answer(right, question).is_known;
  }

  // Each difference is a place in meetings_ and a question.
  void list() {
    std::set<std::pair<std::uint32_t, std::size_t>> places;
    std::set<std::uint32_t> exits;
    if (!are_partners(pair_.left.initial, pair_.right.initial)) exits.insert(0);
    for (std::uint32_t place = 0; place < meetings_.size(); ++place) {
      const StateId left = meetings_[place].left, right = meetings_[place].right;
      if (!are_partners(left, right)) continue;
      for (std::size_t question = 0; question < pair_.questions.size(); ++question) {
        if (!differs(pair_, left, right, question)) continue;
        if (pair_.is_common[question]) places.emplace(place, question);
      }
      for_each_step(pair_, left, right, [&](const Step& step) {
        if (!step.agrees || are_partners(step.left_state, step.right_state)) return;
        const std::uint32_t exit = find(step.left_state, step.right_state);
        if (exit != none) exits.insert(exit);
      });
    }
    for (const std::uint32_t exit : exits) {
      if (const auto nearest = find_nearest(exit)) places.insert(*nearest);
    }
    tell_lonely_questions(places);
    for (const auto& [place, question] : places) add(place, question);
    std::stable_partition(result_.list.begin(), result_.list.end(),
                          [](const Difference& difference) { return !difference.is_bound; });
  }

  // A question that only one model knows is told where it can first be asked.
  void tell_lonely_questions(std::set<std::pair<std::uint32_t, std::size_t>>& places) const {
    for (std::size_t question = 0; question < pair_.questions.size(); ++question) {
      if (pair_.is_common[question]) continue;
      for (std::uint32_t place = 0; place < meetings_.size(); ++place) {
        const Meeting& meeting = meetings_[place];
        if (pair_.left_answer(meeting.left, question).ways.empty() &&
            pair_.right_answer(meeting.right, question).ways.empty()) {
          continue;
        }
        places.emplace(place, question);
        break;
      }
    }
  }

  // From two states that are no partners, by steps that agree and meet no partners: the nearest
  // contradiction, or else the nearest bound.
  std::optional<std::pair<std::uint32_t, std::size_t>> find_nearest(std::uint32_t exit) const {
    std::optional<std::pair<std::uint32_t, std::size_t>> bound;
    std::vector<std::uint32_t> queue{exit};
    std::set<std::uint32_t> seen{exit};
    for (std::size_t next = 0; next < queue.size(); ++next) {
      if (next % comparison_check == 0) control_.check("the comparison");
      const Meeting& meeting = meetings_[queue[next]];
      for (std::size_t question = 0; question < pair_.questions.size(); ++question) {
        if (!pair_.is_common[question]) continue;
        if (!differs(pair_, meeting.left, meeting.right, question)) continue;
        const std::pair found{queue[next], question};
        if (!is_bound(meeting.left, meeting.right, question)) return found;
        if (!bound) bound = found;
      }
      for_each_step(pair_, meeting.left, meeting.right, [&](const Step& step) {
        if (!step.agrees || are_partners(step.left_state, step.right_state)) return;
        const std::uint32_t target = find(step.left_state, step.right_state);
        if (target != none && seen.insert(target).second) queue.push_back(target);
      });
    }
    return bound;
  }

  void add(std::uint32_t place, std::size_t question) {
    const Meeting& meeting = meetings_[place];
    Difference difference;
    difference.left_state = meeting.left;
    difference.right_state = meeting.right;
    difference.question = question;
    difference.left = pair_.texts.name(pair_.left_answer(meeting.left, question).text);
    difference.right = pair_.texts.name(pair_.right_answer(meeting.right, question).text);
    difference.is_bound = is_bound(meeting.left, meeting.right, question);
    for (std::uint32_t at = place; meetings_[at].parent != none; at = meetings_[at].parent) {
      const Step& step = meetings_[at].step;
      const auto name = [&](std::optional<Symbol> label) {
        return label ? pair_.labels.name(*label) : std::string();
      };
      difference.way.push_back({step.question, name(step.left), name(step.right), step.left_state,
                                step.right_state, step.agrees});
    }
    std::ranges::reverse(difference.way);
    MAIDE_CHECK(difference.way.size() == meeting.length && difference.passed() == meeting.passed);
    result_.list.push_back(std::move(difference));
  }

  const BehaviourPair& pair_;
  const RunControl& control_;
  std::vector<Meeting> meetings_;
  PairNumbers places_;
  Differences result_;
};

}  // namespace

std::size_t most_pairs(const BehaviourPair& pair) {
  constexpr std::size_t least = std::size_t{1} << 17, most = 1'000'000;
  return std::clamp(4 * (pair.left.size + pair.right.size), least, most);
}

std::size_t Difference::passed() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(way, [](const JointStep& step) { return !step.agrees; }));
}

std::size_t Differences::count_bounds() const {
  return static_cast<std::size_t>(std::ranges::count_if(list, &Difference::is_bound));
}

std::vector<std::string> describe_way(const BehaviourPair& pair, const Difference& difference) {
  std::vector<std::string> word;
  const auto side = [](const std::string& label) {
    return label.empty() ? std::string(rest_label) : label;
  };
  for (const JointStep& step : difference.way) {
    word.push_back(!pair.has_outputs ? pair.questions[step.question]
                   : step.agrees     ? step.left
                                     : "(" + side(step.left) + " / " + side(step.right) + ")");
  }
  return word;
}

Differences find_differences(const BehaviourPair& pair, const RunControl& control) {
  return DifferenceSearch(pair, control).run();
}

}  // namespace maide
