#include "maide/check/rules/wire.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

namespace maide {

void WireRules::put(std::vector<std::uint32_t>& items, std::uint32_t item) const {
  if (keep_last != 0 && items.size() >= room()) items.erase(items.begin());
  items.push_back(item);
}

namespace {

constexpr std::uint32_t not_met = ~std::uint32_t{0};

// "arrives(3)" of "write(3)".
std::string arrival_of(const std::string& letter) {
  const std::size_t values = letter.find('(');
  return "arrives" + (values == std::string::npos ? "" : letter.substr(values));
}

}  // namespace

WireModel::WireModel(WireRules rules, std::vector<std::string> inputs, std::uint32_t callers)
    : GrowingModel({rules.meets ? not_met : 0}),
      rules_(rules),
      inputs_(std::move(inputs)),
      callers_(callers) {}

InterfaceAutomaton WireModel::start() const {
  std::vector<std::string> outputs{"lost"};
  for (const std::string& input : inputs_) {
    const std::string name = arrival_of(input);
    if (std::ranges::find(outputs, name) == outputs.end()) outputs.push_back(name);
  }
  return {Alphabet(std::span<const std::string>(inputs_)),
          Alphabet(std::span<const std::string>(outputs)), 1};
}

Symbol WireModel::arrives(std::uint32_t letter) const {
  return start().outputs().find(arrival_of(input_of(letter))).value();
}

std::optional<GrowingModel::Contents> WireModel::after(Contents contents,
                                                       const Operation& operation) const {
  using Kind = Operation::Kind;
  if (contents.front() == not_met) return before_meeting(std::move(contents), operation);
  std::uint32_t abandoned = contents.front();
  std::vector<std::uint32_t> items(contents.begin() + 1, contents.end());
  const bool is_abandoned = abandoned > 0;
  const auto state = [&] {
    Contents next{abandoned};
    next.insert(next.end(), items.begin(), items.end());
    return next;
  };
  const auto put = [&] {
    const std::size_t before = items.size();
    rules_.put(items, operation.letter);
    if (items.size() == before && is_abandoned) --abandoned;  // it pushed out the oldest
    return state();
  };
  const auto take = [&] {
    items.erase(items.begin());
    if (is_abandoned) --abandoned;
    return state();
  };
  const bool is_put = operation.kind == Kind::put || operation.kind == Kind::add ||
                      operation.kind == Kind::push_out;
  if (is_put && callers_ > 0 && holds(items, caller_of(operation.letter))) return std::nullopt;
  const bool is_next = !items.empty() && items.front() == operation.letter;
  switch (operation.kind) {
    case Kind::put:
      if (!rules_.may_put(items.size())) return std::nullopt;
      return put();
    case Kind::add:
    case Kind::push_out:
      if ((items.size() < rules_.room()) != (operation.kind == Kind::add)) return std::nullopt;
      if (!rules_.may_put(items.size())) return std::nullopt;
      return put();
    case Kind::arrive_of_living:
    case Kind::arrive_of_dead:
      if (is_abandoned != (operation.kind == Kind::arrive_of_dead)) return std::nullopt;
      [[fallthrough]];
    case Kind::arrive:
      if (!is_next) return std::nullopt;
      return take();
    case Kind::lose_of_living:
    case Kind::lose_of_dead:
      if (is_abandoned != (operation.kind == Kind::lose_of_dead) || !is_next) return std::nullopt;
      [[fallthrough]];
    case Kind::lose:
      if (items.empty() || (!is_abandoned && !rules_.may_lose(items.size()))) return std::nullopt;
      return take();
    case Kind::clear: return Contents{0};
    case Kind::abandon: abandoned = static_cast<std::uint32_t>(items.size()); return state();
    case Kind::is_full:
      if (rules_.may_put(items.size())) return std::nullopt;
      return contents;
    case Kind::is_empty:
      if (!items.empty()) return std::nullopt;
      return contents;
    case Kind::is_used:
      if (items.empty()) return std::nullopt;
      return contents;
    case Kind::holds:
    case Kind::holds_none:
      if (holds(items, operation.letter) != (operation.kind == Kind::holds)) return std::nullopt;
      return contents;
    case Kind::meet: return std::nullopt;
    case Kind::has_met: return contents;
  }
  return std::nullopt;
}

std::optional<GrowingModel::Contents> WireModel::before_meeting(Contents contents,
                                                                const Operation& operation) const {
  using Kind = Operation::Kind;
  switch (operation.kind) {
    case Kind::put:
      if (rules_.kept == 0) return contents;
      if (contents.size() > rules_.kept) contents.erase(contents.begin() + 1);
      contents.push_back(operation.letter);
      return contents;
    case Kind::meet: contents.front() = 0; return contents;
    case Kind::is_empty:
    case Kind::holds_none: return contents;
    default: return std::nullopt;
  }
}

bool WireModel::holds(const std::vector<std::uint32_t>& items, std::uint32_t caller) const {
  return std::ranges::any_of(items, [&](std::uint32_t item) { return caller_of(item) == caller; });
}

bool WireModel::make_all(InterfaceAutomaton& automaton, bool writer_may_die, std::size_t most) {
  using Kind = Operation::Kind;
  for (StateId state = 0; state < automaton.size(); ++state) {
    if (automaton.size() > most) return false;
    const Contents at = contents(state);
    const auto add = [&](const Operation& operation) {
      if (auto next = after(at, operation)) state_of(automaton, std::move(*next));
    };
    const std::uint32_t letters = letter_of(0, std::max(callers_, 1U));
    for (std::uint32_t letter = 0; letter < letters; ++letter) add({Kind::put, letter});
    add({Kind::meet, 0});
    add({Kind::lose, 0});
    if (writer_may_die) add({Kind::abandon, 0});
    if (at.size() > 1) add({Kind::arrive, at[1]});
  }
  return true;
}

std::string WireModel::describe(StateId state) const {
  if (is_elsewhere(state)) return "";
  const Contents& at = contents(state);
  const std::size_t count = at.size() - 1;
  if (count == 0) return "";
  std::string values;
  for (auto item = at.begin() + 1; item != at.end(); ++item) {
    const std::string& input = input_of(*item);
    const std::size_t begin = input.find('(');
    if (begin == std::string::npos) continue;
    values += (values.empty() ? ": " : ", ") + input.substr(begin + 1, input.size() - begin - 2);
  }
  return (count == 1 ? "a message" : std::to_string(count) + " messages") + values;
}

std::optional<std::uint32_t> WireModel::held(StateId state) const {
  return is_elsewhere(state) ? 0 : static_cast<std::uint32_t>(contents(state).size() - 1);
}

std::string WireModel::text_of(const Operation& operation) const {
  using Kind = Operation::Kind;
  // Of several callers each has a number.
  const auto numbered = [&](std::uint32_t caller) {
    return callers_ > 1 ? " of caller " + std::to_string(caller + 1) : std::string();
  };
  const auto letter = [&] {
    return input_of(operation.letter) + numbered(caller_of(operation.letter));
  };
  switch (operation.kind) {
    case Kind::put: return letter() + " is sent";
    case Kind::add: return letter() + " is sent, and there is room";
    case Kind::push_out: return letter() + " pushes out the oldest";
    case Kind::arrive: return letter() + " arrives";
    case Kind::arrive_of_living: return letter() + " arrives, whose writer lives";
    case Kind::arrive_of_dead: return letter() + " arrives, whose writer has died";
    case Kind::lose_of_living: return letter() + " is lost, whose writer lives";
    case Kind::lose_of_dead: return letter() + " is lost, whose writer has died";
    case Kind::holds: return "something" + numbered(operation.letter) + " is to arrive";
    case Kind::holds_none: return "nothing" + numbered(operation.letter) + " is to arrive";
    case Kind::lose: return "the oldest is lost";
    case Kind::clear: return "its reader dies";
    case Kind::abandon: return "its writer dies";
    case Kind::is_full: return "is full";
    case Kind::is_empty: return "nothing is on its way";
    case Kind::is_used: return "something is on its way";
    case Kind::meet: return "its ends meet";
    case Kind::has_met: return "its ends have met";
  }
  return "";
}

ModelUse WireModel::use(ModelActions& actions, std::uint32_t model, const Operation& operation) {
  return actions.action(model, text_of(operation),
                        ModelActions::StepsOfState([this, &actions, model, operation](StateId at) {
                          if (is_elsewhere(at)) return std::vector<ModelStep>{{at, true}};
                          auto next = after(contents(at), operation);
                          if (!next) return std::vector<ModelStep>{};
                          return std::vector<ModelStep>{
                              {state_of(actions.automaton(model), std::move(*next)), false}};
                        }));
}

}  // namespace maide
