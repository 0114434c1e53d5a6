#include "maide/check/search/shrunk_run.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/check/system/atom_view.hpp"

namespace maide {
namespace {

bool does_the_same(const Step& one, const Step& other) {
  return one.actor == other.actor && one.action == other.action && one.is_beyond == other.is_beyond;
}

enum class Arrivals : std::uint8_t {
  as_they_were,  // steps like others
  early,         // what is on its way arrives as soon as it can
};

class Shrinking {
 public:
  Shrinking(const System& system, const Property& property, Trace trace, Arrivals arrivals,
            const RunControl& control, std::uint64_t most_steps)
      : system_(system),
        property_(property),
        atoms_(atoms_of(property)),
        best_(std::move(trace)),
        arrivals_(arrivals),
        control_(control),
        most_steps_(most_steps) {}

  // Lets what is on its way arrive early in the run. False if it is no counterexample any more.
  bool begin() {
    if (arrivals_ == Arrivals::as_they_were) return true;
    best_ = made_of(best_);
    return (!best_.loop_start || *best_.loop_start < best_.steps.size()) &&
           find_flaw(system_, property_, best_).empty();
  }

  Trace run() {
    for (std::size_t before = best_.steps.size() + 1; best_.steps.size() < before && may_go_on();) {
      before = best_.steps.size();
      leave_out_ways_round();
      turn_loop_back();
      begin_loop_early();
      leave_out_actors();
      leave_out_pieces();
    }
    return std::move(best_);
  }

 private:
  static std::size_t first_of_loop(const Trace& trace) {
    return trace.loop_start.value_or(trace.steps.size());
  }
  std::size_t stem() const { return first_of_loop(best_); }

  bool may_go_on() const { return tried_ < most_steps_ && !control_.should_stop(); }

  // Takes what is shorter, and a counterexample.
  bool consider(Trace trace) {
    if (trace.steps.size() >= best_.steps.size()) return false;
    if (trace.loop_start && *trace.loop_start >= trace.steps.size()) return false;
    std::vector<GlobalState> states{initial_state(system_)};
    for (const Step& step : trace.steps) states.push_back(apply(system_, states.back(), step));
    tried_ += trace.steps.size();
    std::uint64_t further = 0;  // in rounds until the loop closes, which find_flaw() goes again
    const bool is_closed = closed(system_, trace, states, atoms_, &further).has_value();
    tried_ += 3 * further * system_.programs.size();
    if (is_closed) tried_ += (trace.steps.size() - first_of_loop(trace)) * system_.programs.size();
    if (!is_closed || !find_flaw(system_, property_, trace).empty()) return false;
    best_ = std::move(trace);
    return true;
  }

  // Before the loop each state once.
  void leave_out_ways_round() {
    std::map<std::pair<std::vector<StateId>, std::vector<ControlState>>, std::size_t> places;
    Trace shorter;
    GlobalState at = initial_state(system_);
    places.emplace(std::pair(at.models, at.programs), 0);
    for (std::size_t i = 0; i < stem(); ++i) {
      at = apply(system_, at, best_.steps[i]);
      shorter.steps.push_back(best_.steps[i]);
      const auto [place, is_new] =
          places.try_emplace({at.models, at.programs}, shorter.steps.size());
      if (is_new) continue;
      shorter.steps.resize(place->second);
      std::erase_if(places, [&](const auto& one) { return one.second > shorter.steps.size(); });
    }
    append_loop_to(shorter);
    consider(std::move(shorter));
  }

  void append_loop_to(Trace& trace) const {
    if (!best_.loop_start) return;
    trace.loop_start = trace.steps.size();
    trace.steps.insert(trace.steps.end(),
                       best_.steps.begin() + static_cast<std::ptrdiff_t>(*best_.loop_start),
                       best_.steps.end());
  }

  // What comes before the loop and is its end belongs to it; and of a loop that is the same several
  // times, one is enough.
  void turn_loop_back() {
    if (!best_.loop_start) return;
    std::vector<Step> loop(best_.steps.begin() + static_cast<std::ptrdiff_t>(stem()),
                           best_.steps.end());
    std::size_t length = 1;
    for (; length < loop.size(); ++length) {
      if (loop.size() % length != 0) continue;
      const auto repeats = [&](std::size_t i) { return does_the_same(loop[i], loop[i - length]); };
      std::size_t at = length;
      while (at < loop.size() && repeats(at)) ++at;
      if (at == loop.size()) break;
    }
    for (const std::size_t size : {length, loop.size()}) {
      std::vector<Step> round(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(size));
      std::size_t first = stem();
      for (; first > 0 && does_the_same(best_.steps[first - 1], round.back()); --first) {
        std::rotate(round.begin(), round.end() - 1, round.end());
      }
      std::vector<bool> keeps(best_.steps.size(), false);
      std::fill_n(keeps.begin(), first + size, true);
      if (try_kept(keeps, first)) return;
    }
  }

  // The last steps of an actor before the loop may be its last ones of the loop. Then the loop can
  // begin with them; it is tried with all actors, then with each alone.
  void begin_loop_early() {
    if (!best_.loop_start) return;
    if (begin_loop_early(std::nullopt)) return;
    for (std::uint32_t actor = 0; actor < system_.programs.size() && may_go_on(); ++actor) {
      begin_loop_early(actor);
    }
  }

  bool begin_loop_early(std::optional<std::uint32_t> only) {
    std::vector<bool> moves(best_.steps.size(), false);  // into the loop, or to its begin
    for (std::uint32_t actor = 0; actor < system_.programs.size(); ++actor) {
      if (only && actor != *only) continue;
      std::size_t in_loop = best_.steps.size();
      for (std::size_t i = stem(); i > 0; --i) {
        if (best_.steps[i - 1].actor != actor) continue;
        while (in_loop > stem() && best_.steps[in_loop - 1].actor != actor) --in_loop;
        if (in_loop == stem()) break;
        if (!does_the_same(best_.steps[i - 1], best_.steps[in_loop - 1])) break;
        moves[i - 1] = moves[--in_loop] = true;
      }
    }
    Trace trace;
    const auto add = [&](std::size_t from, std::size_t to, bool moving) {
      for (std::size_t i = from; i < to; ++i) {
        if (moves[i] == moving) trace.steps.push_back(best_.steps[i]);
      }
    };
    add(0, stem(), false);
    trace.loop_start = trace.steps.size();
    add(0, stem(), true);
    add(stem(), best_.steps.size(), false);
    return consider(made_of(trace));
  }

  void leave_out_actors() {
    for (std::uint32_t actor = 0; actor < system_.programs.size() && may_go_on(); ++actor) {
      std::vector<bool> keeps;
      for (const Step& step : best_.steps) keeps.push_back(step.actor != actor);
      try_kept(keeps, stem());
    }
  }

  void leave_out_pieces() {
    for (std::size_t size = best_.steps.size(); size > 0; size /= 2) {
      for (std::size_t first = 0; first < best_.steps.size() && may_go_on();) {
        std::vector<bool> keeps(best_.steps.size(), true);
        for (std::size_t i = first; i < std::min(first + size, keeps.size()); ++i) keeps[i] = false;
        if (!try_kept(keeps, stem())) first += size;
      }
    }
  }

  // Takes those steps of the best run that are kept, and possible; the loop begins with the first
  // from `loop` on.
  bool try_kept(const std::vector<bool>& keeps, std::size_t loop) {
    return consider(made_of(kept_of_best(keeps, loop)));
  }
  Trace kept_of_best(const std::vector<bool>& keeps, std::size_t loop) const {
    MAIDE_CHECK(keeps.size() == best_.steps.size());
    Trace kept;
    for (std::size_t i = 0; i < keeps.size(); ++i) {
      if (best_.loop_start && i == loop) kept.loop_start = kept.steps.size();
      if (keeps[i]) kept.steps.push_back(best_.steps[i]);
    }
    return kept;
  }

  // A run of those steps, without those that are not possible.
  Trace made_of(const Trace& wanted) {
    Trace trace;
    GlobalState at = initial_state(system_);
    const auto take = [&](const Step& step) {
      ++tried_;
      at = apply(system_, at, step);
      trace.steps.push_back(step);
    };
    for (std::size_t i = 0; i < wanted.steps.size(); ++i) {
      if (wanted.loop_start == i) trace.loop_start = trace.steps.size();
      if (comes_by_itself(wanted.steps[i])) continue;
      ++tried_;
      if (is_error(system_, at)) break;
      if (const auto step = step_like(system_, at, wanted.steps[i])) take(*step);
      // A clock of nobody's would tick for ever.
      const std::size_t most = most_arrivals_a_step * (i + 1);
      while (arrivals_ == Arrivals::early && trace.steps.size() < most && !is_error(system_, at)) {
        const auto arrival = next_arrival(at);
        if (!arrival) break;
        take(*arrival);
      }
    }
    return trace;
  }

  static constexpr std::size_t most_arrivals_a_step = 4;  // on average

  bool comes_by_itself(const Step& step) const {
    return arrivals_ == Arrivals::early && is_arrival(step);
  }
  // It is asked for again and again on fair runs; what is lost is not.
  bool is_arrival(const Step& step) const {
    return step.actor == nobody && system_.nobodys_actions[step.action].what.fair != 0;
  }
  std::optional<Step> next_arrival(const GlobalState& at) const {
    const std::vector<Step> steps = enabled_steps(system_, at, nobody);
    const auto place =
        std::ranges::find_if(steps, [&](const auto& step) { return is_arrival(step); });
    return place == steps.end() ? std::nullopt : std::optional(*place);
  }

  const System& system_;
  const Property& property_;
  std::vector<Atom> atoms_;
  Trace best_;
  Arrivals arrivals_;
  const RunControl& control_;
  std::uint64_t most_steps_;
  std::uint64_t tried_ = 0;
};

}  // namespace

Trace shrink(const System& system, const Property& property, Trace trace, const RunControl& control,
             std::uint64_t most_steps) {
  if (system.nobodys_actions.empty()) {
    return Shrinking(system, property, std::move(trace), Arrivals::as_they_were, control,
                     most_steps)
        .run();
  }
  Trace shrunk =
      Shrinking(system, property, trace, Arrivals::as_they_were, control, most_steps).run();
  Shrinking early(system, property, std::move(trace), Arrivals::early, control, most_steps);
  if (!early.begin()) return shrunk;
  Trace other = early.run();
  return other.steps.size() <= shrunk.steps.size() ? other : shrunk;
}

}  // namespace maide
