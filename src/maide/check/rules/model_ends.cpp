#include "maide/check/rules/model_ends.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "maide/base/error.hpp"

namespace maide {
namespace {

std::string base_name(const std::string& symbol) { return symbol.substr(0, symbol.find('(')); }

// The number of the end in "write2": 1; that of "write" is 0.
std::size_t place_in(const std::string& symbol, std::size_t count) {
  const std::string name = base_name(symbol);
  for (std::size_t place = 1; place < count; ++place) {
    if (name.ends_with(std::to_string(place + 1))) return place;
  }
  return 0;
}

class EndedModelMaker {
 public:
  EndedModelMaker(const InterfaceAutomaton& model, const EndOptions& options)
      : model_(model), options_(options) {
    for (const std::string& name : model.outputs().names()) {
      is_collected_.push_back(options.collects && is_of_writer(model, name));
    }
    for (const ModelEnd& end : options.ends) may_come_.push_back(find_coming(end));
  }

  EndedModel run() {
    result_.automaton = InterfaceAutomaton(model_.inputs(), model_.outputs(), 0);
    result_.automaton.actors = model_.actors;
    result_.automaton.origin = model_.origin;
    result_.automaton.hidden_returns = model_.hidden_returns;
    result_.deaths.resize(options_.ends.size());
    state_of({model_.initial(), std::nullopt, Marks(options_.ends.size()), false});
    for (StateId state = 0; state < met_.size(); ++state) {
      expand(state);
      for (std::size_t end = 0; end < options_.ends.size(); ++end) add_death(state, end);
    }
    for (StateId state = 0; state < met_.size(); ++state) {
      Place cleared = met_[state];
      result_.collected.push_back(cleared.collected);
      cleared.collected.reset();
      result_.cleared.push_back(states_.at(cleared));
    }
    if (options_.may_leave) add_gone();
    return std::move(result_);
  }

 private:
  enum class Mark : std::uint8_t {
    none,
    throws_away,   // what is due to the end is thrown away
    disconnecting  // that, too, and the model takes `disconnect` as soon as it can
  };
  using Marks = std::vector<Mark>;  // by end
  struct Place {
    StateId at = 0;
    std::optional<Symbol> collected;
    Marks marks;
    bool is_lost = false;  // `disconnect` was never tried where it came
    auto operator<=>(const Place&) const = default;
  };

  // The states from which the end's outputs may come though it gives no input.
  std::vector<bool> find_coming(const ModelEnd& end) const {
    std::vector<bool> coming(model_.size());
    for (bool is_new = true; is_new;) {
      is_new = false;
      for (StateId state = 0; state < model_.size(); ++state) {
        if (coming[state]) continue;
        for (const auto& transition : model_.transitions(state)) {
          const Symbol symbol = transition.action.symbol;
          const bool is_input = transition.action.is_input();
          if (is_input && end.inputs[symbol]) continue;
          if ((is_input || !end.outputs[symbol]) && !coming[transition.target]) continue;
          is_new = coming[state] = true;
          break;
        }
      }
    }
    return coming;
  }

  StateId state_of(const Place& place) {
    const auto [known, is_new] = states_.try_emplace(place, static_cast<StateId>(met_.size()));
    const StateId state = known->second;
    if (is_new) {
      result_.automaton.add_state();
      met_.push_back(place);
      if (place.collected) {
        Place cleared = place;
        cleared.collected.reset();
        state_of(cleared);
      }
    }
    return state;
  }

  bool is_thrown_away(const Place& place, Symbol output) const {
    for (std::size_t end = 0; end < place.marks.size(); ++end) {
      if (place.marks[end] != Mark::none && options_.ends[end].outputs[output]) return true;
    }
    return false;
  }

  // The places after what is due to the writers was collected, what is due to dead ends was thrown
  // away, and `disconnect` was taken.
  void settle(const Place& place, std::vector<Place>& settled) const {
    bool is_settled = true;
    for (const auto& transition : model_.transitions(place.at)) {
      if (transition.action.is_input()) continue;
      const Symbol output = transition.action.symbol;
      const bool is_thrown = is_thrown_away(place, output);
      if (!is_thrown && !is_collected_[output]) continue;
      is_settled = false;
      Place next = place;
      next.at = transition.target;
      if (!is_thrown) next.collected = output;
      settle(next, settled);
    }
    if (is_settled) disconnect(place, settled);
  }

  void disconnect(const Place& place, std::vector<Place>& settled) const {
    for (std::size_t end = 0; end < place.marks.size(); ++end) {
      if (place.marks[end] != Mark::disconnecting || !model_.is_quiescent(place.at)) continue;
      const Symbol input = *options_.ends[end].disconnect;
      Place next = place;
      next.marks[end] = Mark::throws_away;
      if (is_beyond_learned(model_, place.at, input)) {
        if (options_.when_unexplored == WhenUnexplored::wait) continue;
        if (options_.when_unexplored == WhenUnexplored::drop) return settle(next, settled);
        return add({0, std::nullopt, Marks(place.marks.size()), true}, settled);
      }
      bool is_taken = false;
      for (const auto& transition : model_.transitions(place.at)) {
        if (transition.action != Action{Action::Kind::input, input}) continue;
        next.at = transition.target;
        settle(next, settled);
        is_taken = true;
      }
      if (is_taken) return;
    }
    Place next = place;
    for (std::size_t end = 0; end < next.marks.size(); ++end) {
      const bool is_over = next.marks[end] == Mark::throws_away && !may_come_[end][next.at];
      if (is_over) next.marks[end] = Mark::none;
    }
    add(next, settled);
  }

  static void add(const Place& place, std::vector<Place>& settled) {
    if (std::ranges::find(settled, place) == settled.end()) settled.push_back(place);
  }

  void expand(StateId state) {
    const Place place = met_[state];
    if (place.is_lost) {
      for (Symbol input = 0; input < model_.inputs().size(); ++input) {
        result_.automaton.mark_unexplored(state, input);
      }
      return;
    }
    for (const auto& transition : model_.transitions(place.at)) {
      Place next = place;
      next.at = transition.target;
      for (std::size_t end = 0; end < next.marks.size(); ++end) {
        const bool is_new_call = transition.action.is_input() && !transition.absorbed &&
                                 options_.ends[end].inputs[transition.action.symbol];
        if (is_new_call && next.marks[end] == Mark::throws_away) next.marks[end] = Mark::none;
      }
      std::vector<Place> settled;
      settle(next, settled);
      for (const Place& target : settled) {
        result_.automaton.add_transition(state, transition.action, state_of(target),
                                         transition.absorbed);
      }
    }
    for (const Symbol input : model_.unexplored(place.at)) {
      result_.automaton.mark_unexplored(state, input);
    }
  }

  void add_death(StateId state, std::size_t end) {
    Place place = met_[state];
    if (place.is_lost) {
      result_.deaths[end].push_back({{state, false}});
      return;
    }
    place.marks[end] = options_.ends[end].disconnect ? Mark::disconnecting : Mark::throws_away;
    if (options_.collects) place.collected.reset();
    std::vector<Place> settled;
    settle(place, settled);
    auto& steps = result_.deaths[end].emplace_back();
    for (const Place& target : settled) {
      steps.push_back({target.is_lost ? state : state_of(target), target.is_lost});
    }
  }

  void add_gone() {
    const StateId gone = result_.automaton.add_state();
    result_.gone = gone;
    result_.collected.emplace_back();
    result_.cleared.push_back(gone);
    for (auto& death : result_.deaths) death.push_back({{gone, false}});
  }

  const InterfaceAutomaton& model_;
  const EndOptions& options_;
  std::vector<bool> is_collected_;           // by output
  std::vector<std::vector<bool>> may_come_;  // by end, by state
  EndedModel result_;
  std::map<Place, StateId> states_;
  std::vector<Place> met_;
};

}  // namespace

ModelEnd find_end(const InterfaceAutomaton& model, const std::string& actor, std::size_t place,
                  std::size_t count, const std::set<std::string>& others) {
  ModelEnd end{std::vector<bool>(model.inputs().size()), std::vector<bool>(model.outputs().size()),
               std::nullopt};
  const auto add = [&](const Actor& owner) {
    for (const std::string& name : owner.inputs) {
      const auto symbol = model.inputs().find(name);
      if (symbol && place_in(name, count) == place) end.inputs[*symbol] = true;
    }
    for (const std::string& name : owner.outputs) {
      const auto symbol = model.outputs().find(name);
      if (symbol && place_in(name, count) == place) end.outputs[*symbol] = true;
    }
  };
  const std::string disconnect =
      place == 0 ? "disconnect" : "disconnect" + std::to_string(place + 1);
  for (const Actor& owner : model.actors) {
    const bool has_it = std::ranges::find(owner.inputs, disconnect) != owner.inputs.end();
    const bool is_its_own = owner.name == actor;
    const bool disconnects = has_it && (is_its_own || !others.contains(owner.name));
    if (disconnects) end.disconnect = model.inputs().find(disconnect);
    if (is_its_own || disconnects) add(owner);
  }
  return end;
}

EndedModel with_ends(const InterfaceAutomaton& model, const EndOptions& options) {
  const bool has_writer =
      std::ranges::any_of(model.actors, [](const Actor& actor) { return actor.name == "writer"; });
  if (options.collects && !has_writer) {
    throw UsageError("a topic's model names its actors, and one is the \"writer\"");
  }
  return EndedModelMaker(model, options).run();
}

}  // namespace maide
