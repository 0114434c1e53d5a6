#include "maide/join/valued_queue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"

namespace maide {
namespace {

constexpr std::string_view write_name = "write", message_name = "message";
constexpr std::size_t endless = ~std::size_t{0};

bool is_read(const std::string& input) { return input == "read" || input == "tryread"; }

// How many messages come when nothing is written any more and the reader goes on reading: the
// messages that are there. By state.
class MessageCounter {
 public:
  MessageCounter(const InterfaceAutomaton& model, Symbol message)
      : model_(model), message_(message), counts_(model.size()), is_open_(model.size(), char{0}) {}

  // `endless` where it does not end.
  std::size_t count(StateId state) {
    if (counts_[state]) return *counts_[state];
    if (is_open_[state] != 0) return 0;  // reads that bring nothing
    is_open_[state] = 1;
    std::size_t most = 0;
    for (const auto& transition : model_.transitions(state)) {
      if (transition.absorbed) continue;
      const Symbol symbol = transition.action.symbol;
      if (transition.action.is_input() && !is_read(model_.inputs().name(symbol))) continue;
      const bool is_message = !transition.action.is_input() && symbol == message_;
      if (is_message && is_open_[transition.target] != 0) return endless;
      const std::size_t behind = count(transition.target);
      if (behind == endless) return endless;
      most = std::max(most, behind + (is_message ? 1 : 0));
    }
    is_open_[state] = 0;
    counts_[state] = most;
    return most;
  }

 private:
  const InterfaceAutomaton& model_;
  const Symbol message_;
  std::vector<std::optional<std::size_t>> counts_;
  std::vector<char> is_open_;
};

class QueueMaker {
 public:
  QueueMaker(const InterfaceAutomaton& model, std::span<const std::string> values, LossRule rule,
             std::size_t most_states)
      : model_(model), values_(values), rule_(rule), most_states_(most_states) {}

  std::optional<InterfaceAutomaton> make() {
    const auto write = model_.inputs().find(write_name);
    const auto message = model_.outputs().find(message_name);
    if (!write || !message || !model_.is_deterministic()) return std::nullopt;
    write_ = *write;
    message_ = *message;
    MessageCounter counter(model_, message_);
    for (StateId state = 0; state < model_.size(); ++state) {
      counts_.push_back(counter.count(state));
      if (counts_.back() == endless) return std::nullopt;
    }
    make_alphabets();
    state_of({model_.initial(), {}});
    for (StateId state = 0; state < met_.size(); ++state) {
      if (!expand(state, Place(met_[state]))) return std::nullopt;
    }
    return std::move(result_);
  }

 private:
  // A state of the model and the messages that are there, oldest first.
  using Place = std::pair<StateId, Word>;

  std::vector<std::string> with_values(std::span<const std::string> names,
                                       std::string_view valued) const {
    std::vector<std::string> result;
    for (const std::string& name : names) {
      if (name != valued) {
        result.push_back(name);
        continue;
      }
      for (const std::string& value : values_) result.push_back(fmt::format("{}({})", name, value));
    }
    return result;
  }

  void make_alphabets() {
    const std::vector<std::string> inputs = with_values(model_.inputs().names(), write_name);
    const std::vector<std::string> outputs = with_values(model_.outputs().names(), message_name);
    result_ = InterfaceAutomaton(Alphabet(std::span<const std::string>(inputs)),
                                 Alphabet(std::span<const std::string>(outputs)), 0);
    for (const Actor& actor : model_.actors) {
      result_.actors.push_back({actor.name, with_values(actor.inputs, write_name),
                                with_values(actor.outputs, message_name)});
    }
    result_.origin = model_.origin;
    result_.hidden_returns = with_values(model_.hidden_returns, write_name);
  }

  StateId state_of(Place place) {
    const auto [entry, is_new] = states_.try_emplace(place, static_cast<StateId>(met_.size()));
    if (is_new) {
      if (met_.size() == most_states_) {
        throw UsageError(fmt::format(
            "with {} values it has more than {} states: give it fewer values, or a smaller depth",
            values_.size(), most_states_));
      }
      result_.add_state();
      met_.push_back(std::move(place));
    }
    return entry->second;
  }

  Action input(const std::string& name) const {
    return {Action::Kind::input, *result_.inputs().find(name)};
  }
  std::string valued(std::string_view name, Symbol value) const {
    return fmt::format("{}({})", name, values_[value]);
  }

  // False if the rule does not explain what the model does there.
  bool expand(StateId number, const Place& place) {
    const auto& [at, kept] = place;
    for (const Symbol symbol : model_.unexplored(at)) {
      const std::string& name = model_.inputs().name(symbol);
      for (Symbol value = 0; symbol == write_ && value < values_.size(); ++value) {
        result_.mark_unexplored(number, input(valued(name, value)).symbol);
      }
      if (symbol != write_) result_.mark_unexplored(number, input(name).symbol);
    }
    for (const auto& transition : model_.transitions(at)) {
      if (!follow(number, kept, transition)) return false;
    }
    return true;
  }

  bool follow(StateId number, const Word& kept, const InterfaceAutomaton::Transition& transition) {
    const std::size_t left = counts_[transition.target];
    const auto add = [&](Action action, Word messages) {
      const StateId target =
          transition.absorbed ? number : state_of({transition.target, std::move(messages)});
      result_.add_transition(number, action, target, transition.absorbed);
    };
    if (!transition.action.is_input()) {
      const std::string& name = model_.outputs().name(transition.action.symbol);
      if (transition.action.symbol != message_) {
        if (left != kept.size()) return false;
        add({Action::Kind::output, *result_.outputs().find(name)}, kept);
        return true;
      }
      if (kept.empty() || left + 1 != kept.size()) return false;
      const std::string message = valued(message_name, kept.front());
      add({Action::Kind::output, *result_.outputs().find(message)}, {kept.begin() + 1, kept.end()});
      return true;
    }
    const std::string& name = model_.inputs().name(transition.action.symbol);
    if (transition.action.symbol == write_) return write(kept, left, add);
    // All is lost, or nothing is.
    if (!transition.absorbed && left != kept.size() && left != 0) return false;
    add(input(name), left == 0 ? Word{} : kept);
    return true;
  }

  template <typename Add>
  bool write(const Word& kept, std::size_t left, const Add& add) {
    for (Symbol value = 0; value < values_.size(); ++value) {
      Word messages = kept;
      messages.push_back(value);
      while (messages.size() > left) {
        messages.erase(rule_ == LossRule::oldest ? messages.begin() : messages.end() - 1);
      }
      if (messages.size() < left) return false;
      add(input(valued(write_name, value)), std::move(messages));
    }
    return true;
  }

  const InterfaceAutomaton& model_;
  std::span<const std::string> values_;
  const LossRule rule_;
  const std::size_t most_states_;
  Symbol write_ = 0, message_ = 0;
  std::vector<std::size_t> counts_;  // by state of the model
  InterfaceAutomaton result_;
  std::map<Place, StateId> states_;
  std::vector<Place> met_;
};

}  // namespace

std::string_view to_string(LossRule rule) {
  return rule == LossRule::oldest ? "the oldest is lost" : "the newest is lost";
}

std::string payload_of(std::span<const std::string> values) {
  std::string list;
  for (const std::string& value : values) list += (list.empty() ? "" : ",") + value;
  return "values:" + list;
}

std::optional<InterfaceAutomaton> make_valued_queue(const InterfaceAutomaton& model,
                                                    std::span<const std::string> values,
                                                    LossRule rule, std::size_t most_states) {
  return QueueMaker(model, values, rule, most_states).make();
}

}  // namespace maide
