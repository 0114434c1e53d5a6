#include "maide/check/verdict/races.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "maide/base/hash.hpp"
#include "maide/check/packed/packed_steps.hpp"
#include "maide/check/rules/wire.hpp"
#include "maide/check/system/components.hpp"
#include "maide/check/verdict/message_account.hpp"
#include "maide/check/verdict/message_lanes.hpp"

namespace maide {
namespace {

using UseKind = ModelUse::Kind;
using LaneKind = MessageLane::Kind;

constexpr std::uint32_t none = ~std::uint32_t{0};

// Rows of words of one length, each once, numbered in the order in which they came.
class RowTable {
 public:
  explicit RowTable(std::size_t width) : width_(width), places_(1024, none) {}

  std::size_t size() const { return words_.size() / width_; }
  std::span<const std::uint64_t> row(std::size_t number) const {
    return {words_.data() + number * width_, width_};
  }
  void insert(std::span<const std::uint64_t> row) {
    if (2 * size() >= places_.size()) grow();
    const std::size_t place = place_of(row);
    if (places_[place] != none) return;
    places_[place] = static_cast<std::uint32_t>(size());
    words_.insert(words_.end(), row.begin(), row.end());
  }

 private:
  std::size_t place_of(std::span<const std::uint64_t> row) const {
    std::uint64_t hash = hash_start;
    for (const std::uint64_t word : row) hash = hash_mix(hash, word);
    std::size_t place = hash_mix(hash, 0) & (places_.size() - 1);
    while (places_[place] != none && !std::ranges::equal(this->row(places_[place]), row)) {
      place = (place + 1) & (places_.size() - 1);
    }
    return place;
  }
  void grow() {
    std::vector<std::uint32_t> old =
        std::exchange(places_, std::vector<std::uint32_t>(4 * places_.size(), none));
    for (const std::uint32_t number : old) {
      if (number != none) places_[place_of(row(number))] = number;
    }
  }

  std::size_t width_;
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> places_;  // numbers of rows, by hash
};

// What is watched besides the system's state: one message on its way, who has heard of it, and
// which messages tell of it. Without a message all words are 0.
class Watch {
 public:
  // The words: which message it is; a bit for each program, shared model and lane; a word a lane.
  Watch(const System& system, const MessageLanes& lanes)
      : programs_(system.programs.size()),
        models_(system.models.size()),
        first_lane_(1 + (programs_ + models_ + lanes.all().size() + 63) / 64),
        words_(first_lane_ + lanes.all().size()) {}

  std::span<std::uint64_t> words() { return words_; }
  void set(std::span<const std::uint64_t> words) { std::ranges::copy(words, words_.begin()); }
  void clear() { std::ranges::fill(words_, 0); }

  bool is_on() const { return words_[0] != 0; }
  // The message lies in lane `on`, behind so many others, and goes to lane `to`.
  void start(std::uint32_t on, std::uint32_t to, std::uint32_t ahead) {
    words_[0] = std::uint64_t{1} << 63 | std::uint64_t{to} << 40 | std::uint64_t{on} << 16 | ahead;
  }
  std::uint32_t on() const { return static_cast<std::uint32_t>(words_[0] >> 16 & 0xffffff); }
  std::uint32_t to() const { return static_cast<std::uint32_t>(words_[0] >> 40 & 0x7fffff); }
  std::uint32_t ahead() const { return static_cast<std::uint32_t>(words_[0] & 0xffff); }
  // One of those before it has left the lane; false: it has itself.
  bool come_nearer() {
    if (ahead() == 0) return false;
    --words_[0];
    return true;
  }

  bool has_heard(std::uint32_t program) const { return bit(program); }
  void hear(std::uint32_t program) { set_bit(program); }
  bool is_told(std::uint32_t model) const { return bit(programs_ + model); }
  void tell(std::uint32_t model) { set_bit(programs_ + model); }
  // The process of the reader has taken from that lane what tells of the message.
  bool is_overtaken_by(std::uint32_t lane) const { return bit(programs_ + models_ + lane); }
  void overtake(std::uint32_t lane) { set_bit(programs_ + models_ + lane); }

  // Which messages of a lane tell of it, the oldest in bit 0.
  std::uint64_t& telling(std::uint32_t lane) { return words_[first_lane_ + lane]; }

 private:
  bool bit(std::size_t at) const { return (words_[1 + at / 64] >> at % 64 & 1) != 0; }
  void set_bit(std::size_t at) { words_[1 + at / 64] |= std::uint64_t{1} << at % 64; }

  std::size_t programs_, models_, first_lane_;
  std::vector<std::uint64_t> words_;
};

std::uint64_t take_bit(std::uint64_t& bits, std::uint32_t at) {
  const std::uint64_t low = bits & ((std::uint64_t{1} << at) - 1);
  const std::uint64_t bit = bits >> at & 1;
  bits = low | (at == 63 ? 0 : bits >> (at + 1) << at);
  return bit;
}

// How many messages there were and are.
struct Change {
  std::uint32_t before = 0, after = 0;
  std::uint32_t fewer() const { return before > after ? before - after : 0; }
  std::uint32_t more() const { return after > before ? after - before : 0; }
};

template <std::size_t words>
class RaceSearch {
 public:
  using State = PackedState<words>;

  RaceSearch(const PackedSystem& packed, const MessageLanes& lanes, const SearchLimits& limits)
      : packed_(packed),
        steps_(packed),
        system_(packed.system()),
        lanes_(lanes),
        limits_(limits),
        users_(system_.models.size()),
        watch_(system_, lanes),
        table_(words + watch_.words().size()) {
    for (std::uint32_t program = 0; program < system_.programs.size(); ++program) {
      for (const std::uint32_t model : models_of(system_.programs[program])) {
        users_[model].insert(program);
      }
    }
    find_candidates();
  }

  Races run() {
    Races races;
    races.has_unknown = lanes_.has_unknown();
    if (candidates_.empty()) return races;
    enter(steps_.initial());
    for (std::size_t next = 0; next < table_.size() && !candidates_.empty(); ++next) {
      const bool is_time_to_look = next % interval == 0;
      if (table_.size() > limits_.states || (is_time_to_look && limits_.control.should_stop())) {
        races.is_complete = false;
        break;
      }
      expand(next);
    }
    races.states = table_.size();
    races.all = std::move(found_);
    return races;
  }

 private:
  static constexpr std::size_t interval = 256;  // states between two looks at the limits

  using Ends = std::pair<std::uint32_t, std::uint32_t>;  // two lanes

  // Messages of these lanes go to these: a wire's to queues, others' to their own.
  void find_candidates() {
    const auto& all = lanes_.all();
    for (std::uint32_t to = 0; to < all.size(); ++to) {
      if (all[to].is_wire() || all[to].takers.empty()) continue;
      const bool is_queue = all[to].kind == LaneKind::queue;
      const std::vector<std::uint32_t> from =
          is_queue ? all[to].wires : std::vector<std::uint32_t>{to};
      for (const std::uint32_t on : from) {
        std::vector<std::uint32_t> candidates;
        for (const std::uint32_t later : find_told(on)) {
          if (may_overtake(later, to)) candidates.push_back(later);
        }
        if (!candidates.empty()) candidates_.emplace(Ends(on, to), std::move(candidates));
      }
    }
  }

  // The lanes from which programs may take what tells of a message on its way there: by what
  // programs may do, in whatever state. What is sent the same way comes behind it.
  std::set<std::uint32_t> find_told(std::uint32_t on) const {
    std::set<std::uint32_t> told;
    std::set<std::uint32_t> heard = lanes_.all()[on].writers;
    std::vector<std::uint32_t> open(heard.begin(), heard.end());
    const auto add = [&](std::uint32_t program) {
      if (heard.insert(program).second) open.push_back(program);
    };
    while (!open.empty()) {
      const std::uint32_t program = open.back();
      open.pop_back();
      for (const auto& [from, to] : lanes_.ways_of(program)) {
        if (from == on) continue;
        told.insert(to);
        std::ranges::for_each(lanes_.all()[to].takers, add);
      }
      for (const std::uint32_t model : models_of(system_.programs[program])) {
        if (!lanes_.is_shared(model)) continue;
        std::ranges::for_each(users_[model], add);
      }
    }
    return told;
  }

  bool may_overtake(std::uint32_t later, std::uint32_t to) const {
    const MessageLane& one = lanes_.all()[later];
    const MessageLane& other = lanes_.all()[to];
    if (one.is_wire() || one.takers.empty()) return false;
    // Another writer's message may come before.
    if (later == to) return other.kind == LaneKind::queue && other.wires.size() > 1;
    // A write puts a message on its way to each reader of a topic.
    if (!one.topic.empty() && one.topic == other.topic) return false;
    return std::ranges::any_of(
        one.processes, [&](const std::string& name) { return other.processes.contains(name); });
  }

  void enter(const State& state) {
    row_.assign(state.begin(), state.begin() + words);
    row_.insert(row_.end(), watch_.words().begin(), watch_.words().end());
    table_.insert(row_);
  }

  void expand(std::size_t number) {
    State state{};
    const auto row = table_.row(number);
    std::ranges::copy(row.first(words), state.begin());
    const std::vector<std::uint64_t> watched(row.begin() + words, row.end());
    watch_.set(watched);
    steps_.for_each(state, [&](const State& next, std::size_t actor, std::uint32_t action,
                               bool is_cut, std::uint64_t) {
      if (is_cut) return;
      watch_.set(watched);
      Step step;
      step.actor = actor < packed_.program_count() ? static_cast<std::uint32_t>(actor) : nobody;
      step.action = action;
      if (!watch_.is_on()) {
        enter(next);
        if (doer_of(system_, step) != nobody) watch_new(state, next, step);
        return;
      }
      if (!candidates_.contains({watch_.on(), watch_.to()})) return;
      if (doer_of(system_, step) != nobody) note_look(state, step);
      if (follow(state, next, step)) enter(next);
    });
  }

  // ---- A message that is watched from here on ---------------------------------------------------

  // The newest message that the program has on its way, where it passes on that it sent it: what is
  // older arrives before that one, so it tells no more. Before, nobody else has heard of it.
  void watch_new(const State& state, const State& next, const Step& step) {
    for (const auto& [ends, later] : candidates_) {
      const auto [on, to] = ends;
      const MessageLane& lane = lanes_.all()[on];
      if (!lane.writers.contains(step.actor)) continue;
      const Change on_way = change_of(lane.on_way, on, state, next);
      const bool begins =
          is_known_newest(on)
              ? on_way.after > 0 && passes_on(on, state, next, step)
              : on_way.more() > 0 && (on == to || gives_to(step, lanes_.all()[to].model));
      if (!begins) continue;
      watch_.clear();
      watch_.start(on, to, on_way.after - 1);
      watch_.hear(step.actor);
      if (follow(state, next, step)) enter(next);
    }
  }

  // One program alone puts messages there, and all of them go to one queue.
  bool is_known_newest(std::uint32_t on) const {
    const MessageLane& lane = lanes_.all()[on];
    const auto leads_here = [&](const auto& entry) { return entry.first.first == on; };
    return lane.writers.size() == 1 && std::ranges::count_if(candidates_, leads_here) == 1;
  }

  // The step puts something elsewhere, or does something that others may notice.
  bool passes_on(std::uint32_t on, const State& state, const State& next, const Step& step) const {
    return std::ranges::any_of(uses_of(system_, step), [&](const ModelUse& use) {
      const auto& lanes = lanes_.of_model(use.model);
      return lanes_.is_shared(use.model) || std::ranges::any_of(lanes, [&](std::uint32_t lane) {
               if (lane == on) return false;
               const Change change = held(lane, state, next);
               return change.more() > 0 || (change.fewer() == 0 && use.kind == UseKind::give) ||
                      (lanes_.all()[lane].is_wire() && is_sent_on(lane, step));
             });
    });
  }

  bool gives_to(const Step& step, std::uint32_t model) const {
    return std::ranges::any_of(events_of(system_, step), [&](const ModelUse& event) {
      return event.kind == UseKind::give && event.model == model;
    });
  }

  // ---- What a step tells of the message ---------------------------------------------------------

  // False if the message that is watched is no longer on its way.
  bool follow(const State& state, const State& next, const Step& step) {
    return doer_of(system_, step) == nobody ? follow_nobody(state, next, step)
                                            : follow_program(state, next, step);
  }

  bool follow_program(const State& state, const State& next, const Step& step) {
    const auto uses = uses_of(system_, step);
    for (const ModelUse& use : uses) {
      if (lanes_.is_shared(use.model) && watch_.is_told(use.model)) watch_.hear(step.actor);
      for (const std::uint32_t lane : lanes_.of_model(use.model)) take(lane, state, next, step);
    }
    const bool has_heard = watch_.has_heard(step.actor);
    for (const ModelUse& use : uses) {
      // What leaves a variable as it was tells nobody anything.
      const bool is_changed =
          system_.models[use.model].source != ModelInstance::Source::variable ||
          packed_.model_state(state, use.model) != packed_.model_state(next, use.model);
      if (has_heard && lanes_.is_shared(use.model) && is_changed) watch_.tell(use.model);
      for (const std::uint32_t lane : lanes_.of_model(use.model)) {
        if (!put(lane, state, next, step, use)) return false;
      }
    }
    return true;
  }

  Change change_of(const std::vector<std::uint32_t>& by_state, std::uint32_t lane,
                   const State& state, const State& next) const {
    const std::uint32_t model = lanes_.all()[lane].model;
    return {by_state[packed_.model_state(state, model)],
            by_state[packed_.model_state(next, model)]};
  }
  Change held(std::uint32_t lane, const State& state, const State& next) const {
    return change_of(lanes_.all()[lane].held, lane, state, next);
  }

  // What the program takes from the lane, or makes it lose.
  void take(std::uint32_t number, const State& state, const State& next, const Step& step) {
    const MessageLane& lane = lanes_.all()[number];
    if (lane.is_wire()) return;
    const std::uint32_t fewer = held(number, state, next).fewer();
    std::uint32_t taken = fewer;
    if (lane.kind == LaneKind::requests) {
      taken = std::min(fewer, change_of(lane.served, number, state, next).more());
    } else if (lane.kind == LaneKind::answers && !lane.takers.contains(step.actor)) {
      taken = 0;
    }
    for (std::uint32_t count = 0; count < fewer; ++count) {
      const bool tells = take_bit(watch_.telling(number), 0) != 0;
      if (!tells || count >= taken) continue;
      watch_.hear(step.actor);
      const MessageLane& to = lanes_.all()[watch_.to()];
      if (to.processes.contains(system_.programs[step.actor].process)) note_overtaking(number);
    }
  }

  // What the program adds to the lane. False if that pushes out the message that is watched.
  bool put(std::uint32_t number, const State& state, const State& next, const Step& step,
           const ModelUse& use) {
    const MessageLane& lane = lanes_.all()[number];
    const Change change = held(number, state, next);
    const std::uint64_t tells = watch_.has_heard(step.actor) ? 1 : 0;
    for (std::uint32_t at = change.before; at < change.after; ++at) {
      watch_.telling(number) |= tells << at;
    }
    if (change.before != change.after) return true;
    if (lane.kind == LaneKind::requests || lane.kind == LaneKind::answers) {
      // What a service pushes out on its way does not show, so such a run is not followed.
      const Change on_way = change_of(lane.on_way, number, state, next);
      return watch_.on() != number || on_way.before < WireRules::least_room;
    }
    const bool is_sent = lane.is_wire()
                             ? is_sent_on(number, step)
                             : use.kind == UseKind::give && lanes_.is_message(use.model, use.index);
    if (!is_sent || change.after == 0) return true;
    // It pushes out the oldest.
    take_bit(watch_.telling(number), 0);
    watch_.telling(number) |= tells << (change.after - 1);
    return watch_.on() != number || watch_.come_nearer();
  }

  bool is_sent_on(std::uint32_t wire, const Step& step) const {
    return std::ranges::any_of(events_of(system_, step), [&](const ModelUse& event) {
      if (event.kind != UseKind::give) return false;
      const auto queue = lanes_.queue_of(event.model);
      if (!queue) return false;
      const auto& wires = lanes_.all()[*queue].wires;
      return std::ranges::find(wires, wire) != wires.end();
    });
  }

  // An arrival, or a loss.
  bool follow_nobody(const State& state, const State& next, const Step& step) {
    std::uint64_t tells = 0;
    for (const ModelUse& use : uses_of(system_, step)) {
      for (const std::uint32_t lane : lanes_.of_model(use.model)) {
        const MessageLane& from = lanes_.all()[lane];
        if (change_of(from.on_way, lane, state, next).fewer() == 0) continue;
        if (watch_.on() == lane && !watch_.come_nearer()) return false;
        if (from.is_wire()) tells = take_bit(watch_.telling(lane), 0);
      }
    }
    for (const ModelUse& use : uses_of(system_, step)) {
      for (const std::uint32_t lane : lanes_.of_model(use.model)) {
        const MessageLane& to = lanes_.all()[lane];
        if (to.kind == LaneKind::queue && use.kind == UseKind::give) {
          arrive(lane, tells, state, next);
        } else if (!to.is_wire() && to.kind != LaneKind::queue) {
          lose_of_service(lane, state, next, step);
        }
      }
    }
    return true;
  }

  void arrive(std::uint32_t lane, std::uint64_t tells, const State& state, const State& next) {
    const Change change = held(lane, state, next);
    for (std::uint32_t gone = change.after; gone < change.before + 1; ++gone) {
      take_bit(watch_.telling(lane), 0);
    }
    if (change.after > 0) watch_.telling(lane) |= tells << (change.after - 1);
  }

  // What is lost on its way, or pushed out by what arrives.
  void lose_of_service(std::uint32_t number, const State& state, const State& next,
                       const Step& step) {
    const MessageLane& lane = lanes_.all()[number];
    const Change change = held(number, state, next);
    const Change on_way = change_of(lane.on_way, number, state, next);
    const bool is_lost = on_way.fewer() > 0 && !lost_by(system_, step).empty();
    for (std::uint32_t gone = change.after; gone < change.before; ++gone) {
      take_bit(watch_.telling(number), is_lost ? on_way_from(change, on_way) : 0);
    }
  }
  static std::uint32_t on_way_from(const Change& held, const Change& on_way) {
    return held.before - on_way.before;
  }

  // ---- What is found ----------------------------------------------------------------------------

  void note_overtaking(std::uint32_t later) {
    watch_.overtake(later);
    if (may_overtake(later, watch_.to())) race_of(later);
  }

  Race& race_of(std::uint32_t later) {
    const auto [place, is_new] = numbers_.try_emplace({later, watch_.to()}, found_.size());
    if (is_new) {
      const MessageLane& to = lanes_.all()[watch_.to()];
      found_.push_back({lanes_.all()[later].name, to.name, to.reader, std::nullopt});
    }
    return found_[place->second];
  }

  // A step that finds nothing where the message would be had it arrived.
  void note_look(const State& state, const Step& step) {
    const MessageLane& to = lanes_.all()[watch_.to()];
    if (!watch_.has_heard(step.actor)) return;
    if (!to.processes.contains(system_.programs[step.actor].process)) return;
    std::vector<std::uint32_t> overtaking = candidates_.at({watch_.on(), watch_.to()});
    std::erase_if(overtaking, [&](std::uint32_t later) {
      return !watch_.is_overtaken_by(later) || race_of(later).missed;
    });
    if (overtaking.empty() || !finds_nothing(state, step, to)) return;
    for (const std::uint32_t later : overtaking) race_of(later).missed = place_of(system_, step);
    leave_out_known();
  }

  // Of a connection of which all is known no message is watched.
  void leave_out_known() {
    std::erase_if(candidates_, [&](const auto& entry) {
      return std::ranges::all_of(entry.second, [&](std::uint32_t later) {
        const auto place = numbers_.find({later, entry.first.second});
        return place != numbers_.end() && found_[place->second].missed;
      });
    });
  }

  bool finds_nothing(const State& state, const Step& step, const MessageLane& to) const {
    const auto uses = uses_of(system_, step);
    if (std::ranges::find(uses, to.model, &ModelUse::model) == uses.end()) return false;
    const std::uint32_t at = packed_.model_state(state, to.model);
    if (to.held[at] > to.on_way[at]) return false;
    for (const ModelUse& event : events_of(system_, step)) {
      const Alphabet& outputs = system_.models[event.model].automaton.outputs();
      if (event.model == to.model && event.kind == UseKind::take) {
        return to.kind == LaneKind::queue && !is_message_name(outputs.name(event.index));
      }
    }
    const auto arrived = after_arrivals(packed_.unpack(state));
    if (!arrived) return false;
    return std::ranges::none_of(
        enabled_steps(system_, *arrived, step.actor),
        [&](const Step& possible) { return possible.action == step.action; });
  }

  // With the message that is watched, and those before it, arrived; none: that is not possible.
  std::optional<GlobalState> after_arrivals(GlobalState state) const {
    const MessageLane& on = lanes_.all()[watch_.on()];
    for (std::uint32_t left = watch_.ahead() + 1; left > 0; --left) {
      const std::vector<Step> steps = enabled_steps(system_, state);
      const auto arrival = std::ranges::find_if(steps, [&](const Step& step) {
        if (doer_of(system_, step) != nobody || !lost_by(system_, step).empty()) return false;
        const GlobalState next = apply(system_, state, step);
        return on.on_way[next.models[on.model]] < on.on_way[state.models[on.model]];
      });
      if (arrival == steps.end()) return std::nullopt;
      state = apply(system_, state, *arrival);
    }
    return state;
  }

  const PackedSystem& packed_;
  PackedSteps<words> steps_;
  const System& system_;
  const MessageLanes& lanes_;
  const SearchLimits& limits_;
  std::vector<std::set<std::uint32_t>> users_;  // programs, by model
  Watch watch_;
  RowTable table_;
  std::vector<std::uint64_t> row_;
  // Where messages are on their way and where they go to; with the lanes that may be faster, of
  // which all is not known.
  std::map<Ends, std::vector<std::uint32_t>> candidates_;
  std::vector<Race> found_;
  std::map<Ends, std::size_t> numbers_;  // in found_, by the lanes of what is later and earlier
};

}  // namespace

bool has_late_messages(const System& system) {
  return std::ranges::any_of(system.connections, &ConnectionInstance::is_late);
}

Races find_races(const System& system, const SearchLimits& limits) {
  Races races;
  if (!has_late_messages(system)) return races;
  for (const auto& programs : find_components(system)) {
    const SystemPart part =
        is_whole(system, programs) ? SystemPart(system) : SystemPart(system, programs);
    if (part.system().nobodys_actions.empty()) continue;
    const MessageLanes lanes(part.system());
    const PackedSystem packed(part.system());
    Races found = with_words(packed.words(), [&](auto words) {
      return RaceSearch<words.value>(packed, lanes, limits).run();
    });
    std::ranges::move(found.all, std::back_inserter(races.all));
    races.is_complete = races.is_complete && found.is_complete;
    races.has_unknown = races.has_unknown || found.has_unknown;
    races.states += found.states;
  }
  std::stable_partition(races.all.begin(), races.all.end(),
                        [](const Race& race) { return race.missed.has_value(); });
  return races;
}

std::vector<std::string> describe_races(const Races& races) {
  constexpr std::size_t most = 10;
  std::vector<std::string> lines;
  for (const Race& race : races.all) {
    if (lines.size() == most) {
      lines.push_back(fmt::format("and {} more", races.all.size() - most));
      break;
    }
    std::string line = race.later == race.earlier
                           ? fmt::format(
                                 "what one sends to {0} may come before what another has "
                                 "sent to it before",
                                 race.earlier)
                           : fmt::format("{} may come before {}", race.later, race.earlier);
    if (race.missed) {
      line += fmt::format(", which {} then looks for and does not find (line {})", race.reader,
                          race.missed->line);
    }
    lines.push_back(std::move(line));
  }
  if (!races.is_complete) {
    lines.push_back(fmt::format("{} states were looked at for that, and not all: there may be more",
                                races.states));
  }
  if (races.has_unknown) {
    lines.emplace_back("it is not known what some models hold: over them nothing was followed");
  }
  return lines;
}

}  // namespace maide
