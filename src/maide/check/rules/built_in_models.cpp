#include "maide/check/rules/built_in_models.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {
namespace {

Action input(Symbol symbol) { return {Action::Kind::input, symbol}; }
Action output(Symbol symbol) { return {Action::Kind::output, symbol}; }

}  // namespace

InterfaceAutomaton make_mutex(bool has_trylock) {
  InterfaceAutomaton mutex =
      has_trylock ? InterfaceAutomaton({"lock", "unlock", "trylock"}, {"yes", "no"}, 4)
                  : InterfaceAutomaton({"lock", "unlock"}, {}, 2);
  mutex.add_transition(0, input(0), 1);
  mutex.add_transition(1, input(1), 0);
  if (!has_trylock) return mutex;
  for (const StateId at : {0, 1}) {
    mutex.add_transition(at, input(2), 2 + at);
    mutex.add_transition(2 + at, output(at), 1);
  }
  return mutex;
}

InterfaceAutomaton make_semaphore(std::uint32_t count) {
  InterfaceAutomaton semaphore({"acquire", "release"}, {}, std::size_t{count} + 1);
  for (StateId taken = 0; taken < count; ++taken) {
    semaphore.add_transition(taken, input(0), taken + 1);
    semaphore.add_transition(taken + 1, input(1), taken);
  }
  semaphore.origin = {{"count", std::to_string(count)}};
  return semaphore;
}

std::span<const BuiltInModel> built_in_models() {
  static constexpr BuiltInModel rows[] = {
      {"mutex", "", [](std::uint32_t tries) { return make_mutex(tries != 0); }},
      {"semaphore", "count", make_semaphore},
  };
  return rows;
}

const BuiltInModel* find_built_in(std::string_view name) {
  const auto rows = built_in_models();
  const auto row = std::find_if(rows.begin(), rows.end(),
                                [&](const BuiltInModel& each) { return each.name == name; });
  return row == rows.end() ? nullptr : &*row;
}

double queue_states(const QueueSize& queue) {
  const double letters = queue.values.empty() ? 1 : static_cast<double>(queue.values.size());
  if (queue.is_unknown) return 2 * letters + 5;
  double words = 0, longest = 1;
  for (std::uint32_t length = 0; length <= queue.size; ++length, longest *= letters)
    words += longest;
  // Contents when nobody waits, contents behind a message that is due, a reader that waits.
  return words + (words - longest / letters) * letters + 1;
}

namespace {

InterfaceAutomaton make_queue_of_unknown_size(const QueueSize& queue) {
  InterfaceAutomaton automaton = GrowingQueue(queue).start();
  automaton.origin = {{"depth", unknown_depth}};
  const auto letters = static_cast<Symbol>(std::max<std::size_t>(queue.values.size(), 1));
  std::vector<Symbol> asking{letters};
  if (queue.has_tryread) asking.push_back(letters + 1);
  const auto ask = [&](StateId from, StateId to) {
    for (const Symbol symbol : asking) automaton.add_transition(from, input(symbol), to);
  };
  const auto mark_unexplored = [&](StateId state) {
    for (const Symbol symbol : asking) automaton.mark_unexplored(state, symbol);
  };
  const StateId empty = automaton.initial();
  const StateId waiting = automaton.add_state(), many = automaton.add_state();
  automaton.add_transition(empty, input(letters), waiting);
  if (queue.has_tryread) {
    const StateId null = automaton.add_state();
    automaton.add_transition(empty, input(letters + 1), null);
    automaton.add_transition(null, output(letters), empty);
  }
  for (Symbol letter = 0; letter < letters; ++letter) {
    const StateId one = automaton.add_state(), due = automaton.add_state();
    automaton.add_transition(empty, input(letter), one);
    automaton.add_transition(waiting, input(letter), due);
    ask(one, due);
    automaton.add_transition(due, output(letter), empty);
    automaton.add_transition(many, input(letter), many);
    for (Symbol second = 0; second < letters; ++second) {
      automaton.add_transition(one, input(second), many);
    }
  }
  if (letters > 1) {
    mark_unexplored(many);
    return automaton;
  }
  const StateId due = automaton.add_state(), rest = automaton.add_state();
  ask(many, due);
  automaton.add_transition(due, output(0), rest);
  automaton.add_transition(rest, input(0), many);
  mark_unexplored(rest);
  return automaton;
}

}  // namespace

bool has_unknown_depth(const InterfaceAutomaton& automaton) {
  const auto depth = automaton.origin.find("depth");
  return depth != automaton.origin.end() && depth->second == unknown_depth;
}

namespace {
constexpr const char* unknown_code_key = "unknown-code-of";  // a callback
}  // namespace

InterfaceAutomaton make_unknown_code(const std::string& callback) {
  const std::vector<std::string> inputs{"begin"}, outputs;
  InterfaceAutomaton automaton(Alphabet(std::span<const std::string>(inputs)),
                               Alphabet(std::span<const std::string>(outputs)), 1);
  automaton.origin = {{unknown_code_key, callback}};
  automaton.mark_unexplored(0, 0);
  return automaton;
}

std::optional<std::string> find_unknown_code(const InterfaceAutomaton& automaton) {
  const auto callback = automaton.origin.find(unknown_code_key);
  if (callback == automaton.origin.end()) return std::nullopt;
  return callback->second;
}

InterfaceAutomaton make_queue(const QueueSize& queue) {
  if (queue.keeps_nothing) {
    const auto letters = static_cast<Symbol>(std::max<std::size_t>(queue.values.size(), 1));
    const InterfaceAutomaton whole = GrowingQueue(queue).start();
    const std::vector<std::string>& all = whole.inputs().names();
    const std::vector<std::string> written(all.begin(), all.begin() + letters);
    InterfaceAutomaton automaton(Alphabet(std::span<const std::string>(written)), {}, 1);
    automaton.actors = {{"writer", written, {}}, {"reader", {}, {}}};
    for (Symbol letter = 0; letter < letters; ++letter) {
      automaton.add_transition(0, input(letter), 0);
    }
    return automaton;
  }
  if (queue.is_unknown) return make_queue_of_unknown_size(queue);
  GrowingQueue states(queue);
  InterfaceAutomaton automaton = states.start();
  automaton.origin.clear();
  for (StateId state = 0; state < automaton.size(); ++state) states.expand(automaton, state);
  return automaton;
}

// ---- models that grow ---------------------------------------------------------------------------

GrowingModel::GrowingModel(Contents initial) {
  states_.emplace(initial, 0);
  met_.push_back(std::move(initial));
  is_expanded_.push_back(false);
}

StateId GrowingModel::state_of(InterfaceAutomaton& automaton, Contents contents) {
  if (is_cut_down_) {
    const auto place = states_.find(contents);
    return place != states_.end() ? place->second : static_cast<StateId>(met_.size() - 1);
  }
  const auto [place, is_new] = states_.try_emplace(contents, static_cast<StateId>(met_.size()));
  if (is_new) {
    automaton.add_state();
    met_.push_back(std::move(contents));
    is_expanded_.push_back(false);
  }
  return place->second;
}

void GrowingModel::expand(InterfaceAutomaton& automaton, StateId state) {
  if (is_expanded_[state]) return;
  is_expanded_[state] = true;
  for (Follower& next : followers(Contents(met_[state]))) {
    const StateId target = state_of(automaton, std::move(next.contents));
    automaton.add_transition(state, next.action, target);
  }
}

void GrowingModel::expand_with_messages(InterfaceAutomaton& automaton, StateId state) {
  expand(automaton, state);
  for (std::size_t i = 0; i < automaton.transitions(state).size(); ++i) {
    const StateId target = automaton.transitions(state)[i].target;
    if (is_due(met_[target])) expand(automaton, target);
  }
}

InterfaceAutomaton GrowingModel::cut_down(const InterfaceAutomaton& automaton,
                                          const std::vector<bool>& reached,
                                          std::vector<StateId>& numbers) {
  MAIDE_CHECK(!is_cut_down_);
  InterfaceAutomaton result = start();
  constexpr StateId none = ~StateId{0};
  numbers.assign(automaton.size(), none);
  std::vector<StateId> kept{automaton.initial()};
  numbers[automaton.initial()] = 0;
  const auto keep = [&](StateId state) {
    if (numbers[state] != none) return;
    numbers[state] = result.add_state();
    kept.push_back(state);
  };
  for (StateId state = 0; state < automaton.size(); ++state) {
    if (!reached[state]) continue;
    MAIDE_CHECK(is_expanded_[state]);
    keep(state);
    for (const auto& transition : automaton.transitions(state)) {
      if (is_due(met_[transition.target])) keep(transition.target);
    }
  }
  const StateId elsewhere = result.add_state();
  for (Symbol input = 0; input < result.inputs().size(); ++input) {
    result.mark_unexplored(elsewhere, input);
  }
  std::replace(numbers.begin(), numbers.end(), none, elsewhere);
  std::vector<Contents> met;
  for (const StateId state : kept) {
    for (const auto& transition : automaton.transitions(state)) {
      result.add_transition(numbers[state], transition.action, numbers[transition.target]);
    }
    met.push_back(met_[state]);
  }
  states_.clear();
  for (StateId state = 0; state < met.size(); ++state) states_.emplace(met[state], state);
  met.emplace_back();  // elsewhere
  met_ = std::move(met);
  is_cut_down_ = true;
  return result;
}

GrowingQueue::GrowingQueue(QueueSize queue)
    : GrowingModel(queue.values.empty() ? Contents{idle, 0} : Contents{idle}),
      queue_(std::move(queue)) {
  if (!queue_.values.empty()) letters_ = static_cast<Symbol>(queue_.values.size());
}

InterfaceAutomaton GrowingQueue::start() const {
  std::vector<std::string> inputs, outputs;
  for (const std::string& value : queue_.values) {
    inputs.push_back("write" + value);
    outputs.push_back("message" + value);
  }
  if (queue_.values.empty()) {
    inputs = {"write"};
    outputs = {"message"};
  }
  const auto written = static_cast<std::ptrdiff_t>(inputs.size());
  inputs.emplace_back("read");
  if (queue_.has_tryread) {
    inputs.emplace_back("tryread");
    outputs.emplace_back("null");
  }
  InterfaceAutomaton automaton(Alphabet(std::span<const std::string>(inputs)),
                               Alphabet(std::span<const std::string>(outputs)), 1);
  automaton.actors = {{"writer", {inputs.begin(), inputs.begin() + written}, {}},
                      {"reader", {inputs.begin() + written, inputs.end()}, outputs}};
  automaton.origin[queue_.drops_oldest ? "depth" : "size"] = std::to_string(queue_.size);
  return automaton;
}

void GrowingQueue::add(Contents& contents, Symbol letter) const {
  if (is_counted()) {
    ++contents[1];
  } else {
    contents.push_back(letter);
  }
}

Symbol GrowingQueue::take_oldest(Contents& contents) const {
  if (is_counted()) {
    --contents[1];
    return 0;
  }
  const Symbol oldest = contents[1];
  contents.erase(contents.begin() + 1);
  return oldest;
}

std::vector<GrowingModel::Follower> GrowingQueue::followers(const Contents& contents) const {
  Contents free = contents;
  free[0] = idle;
  if (is_due(contents)) return {{output(contents[0] - first_message), free}};
  std::vector<Follower> result;
  for (Symbol letter = 0; letter < letters_; ++letter) {
    Contents next = contents;
    if (contents[0] == waiting) {
      next[0] = first_message + letter;
    } else if (kept(contents) < queue_.size) {
      add(next, letter);
    } else if (queue_.drops_oldest) {
      take_oldest(next);
      add(next, letter);
    } else {
      continue;
    }
    result.push_back({input(letter), std::move(next)});
  }
  if (contents[0] == waiting) return result;
  const auto take = [&](Symbol asking, std::uint32_t otherwise) {
    Contents next = contents;
    next[0] = kept(contents) == 0 ? otherwise : first_message + take_oldest(next);
    result.push_back({input(asking), std::move(next)});
  };
  take(letters_, waiting);
  if (queue_.has_tryread) take(letters_ + 1, null());
  return result;
}

}  // namespace maide
