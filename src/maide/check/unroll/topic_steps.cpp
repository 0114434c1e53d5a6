#include "maide/check/unroll/topic_steps.hpp"

#include <algorithm>
#include <functional>
#include <utility>

namespace maide::program_syntax {

// What other writers have on its way to models to which the program gives something at once. By
// reader; null: it has a wire of its own, or the model refuses nothing.
struct OfOthers {
  std::vector<const Wire*> counted;
  std::vector<std::uint32_t> held;

  bool has_room(std::size_t i, StateId state) const {
    return held[i] == 0 || has_room_for(*counted[i], state, held[i] + 1);
  }
  std::string text(std::size_t i) const {
    return held[i] == 0 ? "" : "; " + std::to_string(held[i]) + " on the way";
  }
  Uses conditions(ModelActions& actions) const {
    Uses uses;
    for (std::size_t i = 0; i < held.size(); ++i) {
      if (counted[i] != nullptr) uses.push_back(when_counted(*counted[i], actions, held[i]));
    }
    return uses;
  }
};

namespace {

using Living = std::vector<bool>;  // by reader
using Test = std::function<bool(StateId)>;

// What was collected from a reader's model.
struct Collected {
  enum class What : std::uint8_t { any, nothing, something, written, output };
  What what = What::any;
  Symbol symbol = 0;  // of an output

  bool is(const Topic::Reader& reader, const Alphabet& outputs, StateId state) const {
    const auto& collected = reader.collected[state];
    switch (what) {
      case What::any: return true;
      case What::nothing: return !collected;
      case What::something: return collected.has_value();
      case What::written: return collected && !outputs.name(*collected).starts_with("failed");
      case What::output: return collected == symbol;
    }
    return false;
  }

  std::string text(const Alphabet& outputs) const {
    switch (what) {
      case What::any: return "";
      case What::nothing: return "nothing returned";
      case What::something: return "returned";
      case What::written: return "returned, not failed";
      case What::output: return "returned " + outputs.name(symbol);
    }
    return "";
  }
};

// One way in which something is collected from those that live; by reader.
struct Case {
  std::vector<Collected> collected;
  std::string output;  // that is due to the writers; "" if none is
};

std::vector<Living> living_sets(const Topic& topic) {
  std::vector<Living> sets{Living(topic.readers.size(), true)};
  for (std::size_t i = 0; i < topic.readers.size(); ++i) {
    if (!topic.readers[i].gone) continue;
    for (std::size_t k = sets.size(); k-- > 0;) {
      sets.push_back(sets[k]);
      sets.back()[i] = false;
    }
  }
  return sets;
}

bool any_lives(const Living& living) {
  return std::find(living.begin(), living.end(), true) != living.end();
}

// Nothing is due to the writers.
std::vector<Case> cases_not_due(const Topic& topic, const Living& living) {
  using What = Collected::What;
  Case some{std::vector<Collected>(living.size()), ""};
  if (topic.delivers_one || !any_lives(living)) {
    for (Collected& collected : some.collected) collected.what = What::nothing;
    return {some};
  }
  std::vector<Case> cases;
  for (std::size_t first = 0; first < living.size(); ++first) {
    if (!living[first]) continue;
    cases.push_back(some);
    cases.back().collected[first].what = What::nothing;
    if (!topic.readers[first].has_returns()) break;
    some.collected[first].what = What::something;
  }
  return cases;
}

// The model of a reader, as a step on its topic sees it.
class ReaderModels {
 public:
  ReaderModels(const Topic& topic, ModelActions& actions, OfOthers others)
      : topic_(topic), actions_(actions), others_(std::move(others)) {}

  const Alphabet& outputs(std::size_t i) const { return automaton(i).outputs(); }
  const InterfaceAutomaton& automaton(std::size_t i) const {
    return actions_.model(topic_.readers[i].model).automaton;
  }

  // Something is due to the writers: the first failure among those that live, or what the first of
  // them returned.
  std::vector<Case> cases_due(const Living& living) const {
    using What = Collected::What;
    std::vector<Case> cases;
    Case before{std::vector<Collected>(living.size()), ""};
    for (std::size_t i = 0; i < living.size(); ++i) {
      if (topic_.delivers_one) before.collected[i].what = What::nothing;
      if (!topic_.delivers_one && living[i] && !topic_.readers[i].has_returns()) return {};
    }
    bool is_first = true;
    for (std::size_t i = 0; i < living.size(); ++i) {
      if (!living[i]) continue;
      for (Symbol symbol = 0; symbol < outputs(i).size(); ++symbol) {
        const std::string& name = outputs(i).name(symbol);
        const bool has_failed = name.starts_with("failed");
        if (!is_collected(i, symbol)) continue;
        if (!topic_.delivers_one && !has_failed && !is_first) continue;
        Case due = before;
        due.output = name;
        due.collected[i] = {What::output, symbol};
        for (std::size_t later = i + 1; later < living.size() && !topic_.delivers_one; ++later) {
          due.collected[later].what = has_failed ? What::something : What::written;
        }
        cases.push_back(std::move(due));
      }
      if (!topic_.delivers_one) before.collected[i].what = What::written;
      is_first = false;
    }
    return cases;
  }

  // A condition on the model of a reader that lives, or that its reader has died.
  void ask(std::size_t i, bool lives, const std::string& name, const Test& test, Uses& uses) {
    const Topic::Reader& reader = topic_.readers[i];
    if (lives && !reader.gone && name.empty()) return;
    const std::string whole = !lives ? "left" : !reader.gone ? name : "there: " + name;
    uses.push_back(actions_.action(reader.model, whole, [&] {
      std::vector<std::vector<ModelStep>> steps(automaton(i).size());
      for (StateId state = 0; state < steps.size(); ++state) {
        const bool is_gone = reader.gone == state;
        if (lives ? !is_gone && test(state) : is_gone) steps[state] = {{state, false}};
      }
      return steps;
    }));
  }
  void ask(std::size_t i, bool lives, const Collected& collected, Uses& uses) {
    ask(
        i, lives, collected.text(outputs(i)),
        [&](StateId state) { return collected.is(topic_.readers[i], outputs(i), state); }, uses);
  }

  // The reader's model takes the input: `before` was collected, `after` is, and is taken.
  struct Giving {
    Collected before, after;
    bool takes = false;
    bool tried = true, beyond = true;  // where it was tried; where it was not
  };
  void give(std::size_t i, Symbol input, const Giving& giving, Uses& uses) {
    const Topic::Reader& reader = topic_.readers[i];
    const ModelUse give{ModelUse::Kind::give, reader.model, input};
    const bool is_plain = !reader.gone && !reader.has_returns() && others_.held[i] == 0;
    if (is_plain && giving.tried && giving.beyond) {
      uses.push_back(give);
      return;
    }
    std::string name = automaton(i).inputs().name(input);
    if (!giving.beyond) name += ", tried there";
    if (!giving.tried) name += ", never tried there";
    if (const std::string text = giving.before.text(outputs(i)); !text.empty()) name += "; " + text;
    if (const std::string text = giving.after.text(outputs(i)); !text.empty())
      name += "; then " + text;
    if (giving.takes) name += ", and taken";
    name += others_.text(i);
    uses.push_back(actions_.action(reader.model, name, [&] {
      std::vector<std::vector<ModelStep>> steps(automaton(i).size());
      for (StateId state = 0; state < steps.size(); ++state) {
        if (reader.gone == state || !giving.before.is(reader, outputs(i), state)) continue;
        if (!others_.has_room(i, state)) continue;
        for (ModelStep step : model_steps(actions_.model(reader.model), state, give)) {
          if (!(step.is_beyond ? giving.beyond : giving.tried)) continue;
          if (!giving.after.is(reader, outputs(i), step.target)) continue;
          if (giving.takes) step.target = reader.cleared[step.target];
          if (std::find(steps[state].begin(), steps[state].end(), step) == steps[state].end()) {
            steps[state].push_back(step);
          }
        }
      }
      return steps;
    }));
  }

  // The writer takes what was collected from the model of a reader.
  void take(std::size_t i, bool lives, const Collected& collected, Uses& uses) {
    const Topic::Reader& reader = topic_.readers[i];
    if (!lives || collected.what == Collected::What::nothing) return ask(i, lives, collected, uses);
    uses.push_back(
        actions_.action(reader.model, "takes what it " + collected.text(outputs(i)), [&] {
          std::vector<std::vector<ModelStep>> steps(automaton(i).size());
          for (StateId state = 0; state < steps.size(); ++state) {
            if (reader.gone == state || !collected.is(reader, outputs(i), state)) continue;
            steps[state] = {{reader.cleared[state], false}};
          }
          return steps;
        }));
  }

  // Some reader's model takes the input there: of the ways that are tried, or never were.
  bool takes(std::size_t i, StateId state, Symbol input, bool tried, bool beyond,
             const Collected& after) const {
    if (!others_.has_room(i, state)) return false;
    const ModelInstance& model = actions_.model(topic_.readers[i].model);
    const auto steps = model_steps(model, state, {ModelUse::Kind::give, 0, input});
    return std::any_of(steps.begin(), steps.end(), [&](const ModelStep& step) {
      if (step.is_beyond) return beyond;
      return tried && after.is(topic_.readers[i], outputs(i), step.target);
    });
  }

 private:
  bool is_collected(std::size_t i, Symbol output) const {
    const auto& collected = topic_.readers[i].collected;
    return std::find(collected.begin(), collected.end(), output) != collected.end();
  }

  const Topic& topic_;
  ModelActions& actions_;
  OfOthers others_;
};

// For each number of messages that others may have on their way.
std::vector<OfOthers> find_others(const Topic& topic, const std::vector<const Wire*>& wires,
                                  const Names& names, const ModelActions& actions) {
  const std::size_t count = topic.readers.size();
  std::vector<OfOthers> all{{std::vector<const Wire*>(count), std::vector<std::uint32_t>(count)}};
  for (std::size_t i = 0; i < count; ++i) {
    const Wire* const counted =
        wires[i] == nullptr ? counted_wire(names, topic.readers[i].model) : nullptr;
    if (counted == nullptr) continue;
    for (OfOthers& others : all) others.counted[i] = counted;
    for (std::size_t k = all.size(); k-- > 0;) {
      for (std::uint32_t held = 1; held <= most_counted(*counted, actions); ++held) {
        all.push_back(all[k]);
        all.back().held[i] = held;
      }
    }
  }
  return all;
}

// Of steps that give nothing.
OfOthers no_others(const Topic& topic) {
  const std::size_t count = topic.readers.size();
  return {std::vector<const Wire*>(count), std::vector<std::uint32_t>(count)};
}

}  // namespace

void TopicSteps::set_caller(const Topic& topic, bool is_this, Uses& uses) {
  if (!topic.caller) return;
  const auto own = topic.mortal.find(number_);
  const Value value = is_this && own != topic.mortal.end() ? own->second : topic.nobody;
  uses.push_back(actions_.variable(*topic.caller, nullptr, value));
}

const std::vector<TopicSteps::Writing>& TopicSteps::writings(const Topic& topic,
                                                             const std::string& input,
                                                             WriteKind kind,
                                                             const std::string& node) {
  const auto [place, is_new] = writings_.try_emplace({&topic, input, kind, node});
  if (!is_new) return place->second;
  for (const OfOthers& others : find_others(topic, wires_to(topic, node), names_, actions_)) {
    for (const Living& living : living_sets(topic)) {
      add_writings(topic, input, kind, node, living, others, place->second);
    }
  }
  return place->second;
}

std::vector<const Wire*> TopicSteps::wires_to(const Topic& topic, const std::string& node) const {
  std::vector<const Wire*> wires;
  for (const Topic::Reader& reader : topic.readers) {
    wires.push_back(names_.wire_of(reader.model, node, number_));
  }
  return wires;
}

void TopicSteps::add_writings(const Topic& topic, const std::string& input, WriteKind kind,
                              const std::string& node, const std::vector<bool>& living,
                              const OfOthers& others, std::vector<Writing>& writings) {
  using What = Collected::What;
  using Giving = ReaderModels::Giving;
  ReaderModels steps(topic, actions_, others);
  const std::size_t count = topic.readers.size();
  const std::vector<const Wire*> wires = wires_to(topic, node);
  std::vector<std::optional<Symbol>> inputs;
  for (std::size_t i = 0; i < count; ++i) {
    inputs.push_back(steps.automaton(i).inputs().find(input));
    if (living[i] && !inputs[i] && !topic.delivers_one) return;  // this model does not know it
  }
  // `givings`: by reader; none of one that is not given the input.
  const auto add = [&](const std::vector<std::optional<Giving>>& givings, const Case& before,
                       const std::string& output, bool is_beyond) {
    Writing way;
    way.uses = others.conditions(actions_);
    std::vector<Sending> sent;
    for (std::size_t i = 0; i < count; ++i) {
      if (givings[i]) {
        way.events.push_back({ModelUse::Kind::give, topic.readers[i].model, *inputs[i]});
      }
      if (wires[i] != nullptr) {
        steps.ask(i, living[i], Collected(), way.uses);
        if (givings[i]) sent.push_back({wires[i], *inputs[i], number_});
        way.calls = way.calls || (givings[i] && !wires[i]->callers.empty());
      } else if (givings[i]) {
        steps.give(i, *inputs[i], *givings[i], way.uses);
      } else {
        steps.ask(i, living[i], before.collected[i], way.uses);
      }
    }
    if (!actions_.are_possible(way.uses)) return;
    set_caller(topic, output.empty(), way.uses);
    if (!output.empty()) {
      way.output = output;
      for (const ModelUse& event : taken_events(topic, output)) way.events.push_back(event);
    }
    way.is_beyond = is_beyond;
    for (Uses& uses : actions_.combine(ways_to_send(sent, actions_), {way.uses})) {
      way.uses = std::move(uses);
      writings.push_back(way);
    }
  };
  if (!any_lives(living)) {
    if (kind == WriteKind::arm_with_outputs) return;
    return add(std::vector<std::optional<Giving>>(count), {std::vector<Collected>(count), ""}, "",
               false);
  }
  const WhenUnexplored policy = actions_.model(topic.readers.front().model).when_unexplored;
  const bool with_beyond = kind == WriteKind::statement ||
                           (kind == WriteKind::bare_arm && policy == WhenUnexplored::drop);
  std::vector<Case> after;
  if (kind == WriteKind::statement) {
    after.push_back({std::vector<Collected>(count), ""});
  } else {
    after = steps.cases_due(living);
    if (kind == WriteKind::bare_arm) {
      for (Case& other : cases_not_due(topic, living)) after.push_back(std::move(other));
    }
  }
  for (const Case& before : cases_not_due(topic, living)) {
    for (std::size_t chosen = 0; chosen < (topic.delivers_one ? count : 1); ++chosen) {
      const auto is_given = [&](std::size_t i) {
        return living[i] && inputs[i] && (!topic.delivers_one || i == chosen);
      };
      if (topic.delivers_one && !is_given(chosen)) continue;
      for (const Case& then : after) {
        std::vector<std::optional<Giving>> givings(count);
        bool is_of_others = false;
        for (std::size_t i = 0; i < count; ++i) {
          const bool takes = !then.output.empty();
          if (is_given(i)) {
            givings[i] = Giving{before.collected[i], then.collected[i], takes, true, with_beyond};
          } else {
            is_of_others = is_of_others || then.collected[i].what == What::output;
          }
        }
        if (!is_of_others) add(givings, before, then.output, false);
      }
      if (kind == WriteKind::statement || policy != WhenUnexplored::stop) continue;
      for (std::size_t first = 0; first < count; ++first) {
        if (!is_given(first) || wires[first] != nullptr) continue;
        std::vector<std::optional<Giving>> givings(count);
        for (std::size_t i = 0; i < count; ++i) {
          if (is_given(i))
            givings[i] = Giving{before.collected[i], {}, false, i != first, i >= first};
        }
        add(givings, before, "", true);
      }
    }
  }
}

Uses TopicSteps::taken_events(const Topic& topic, const std::string& output) const {
  Uses events;
  for (const Topic::Reader& reader : topic.readers) {
    const auto symbol = actions_.model(reader.model).automaton.outputs().find(output);
    if (symbol) events.push_back({ModelUse::Kind::take, reader.model, *symbol});
  }
  return events;
}

std::vector<TopicSteps::Taking> TopicSteps::takings(const Topic& topic) {
  ReaderModels steps(topic, actions_, no_others(topic));
  std::vector<Taking> takings;
  for (const Living& living : living_sets(topic)) {
    for (const Case& due : steps.cases_due(living)) {
      Taking way{{}, taken_events(topic, due.output), due.output};
      for (std::size_t i = 0; i < living.size(); ++i) {
        steps.take(i, living[i], due.collected[i], way.uses);
      }
      if (!actions_.are_possible(way.uses)) continue;
      set_caller(topic, false, way.uses);
      takings.push_back(std::move(way));
    }
  }
  return takings;
}

std::vector<Uses> TopicSteps::quiet_of(const Topic& topic, const std::string& node) {
  return idle_of(topic, {}, node);
}

std::vector<Uses> TopicSteps::idle_of(const Topic& topic, const std::vector<WriteArm>& arms,
                                      const std::string& node) {
  std::vector<Uses> ways;
  // A test of nothing but that nothing is due does not depend on them.
  const std::vector<OfOthers> all =
      arms.empty() ? std::vector<OfOthers>{no_others(topic)}
                   : find_others(topic, wires_to(topic, node), names_, actions_);
  for (const OfOthers& others : all) add_idle(topic, arms, node, others, ways);
  return ways;
}

void TopicSteps::add_idle(const Topic& topic, const std::vector<WriteArm>& arms,
                          const std::string& node, const OfOthers& others,
                          std::vector<Uses>& result) {
  ReaderModels steps(topic, actions_, others);
  const std::vector<const Wire*> wires = wires_to(topic, node);
  const std::size_t count = topic.readers.size();
  const bool may_cut =
      actions_.model(topic.readers.front().model).when_unexplored == WhenUnexplored::stop;
  // By reader a condition; all of them are one way in which it can be.
  struct Condition {
    std::string name;
    std::vector<Test> tests;
    std::vector<Uses> waits;  // of a wire: nothing can be sent, in one of these ways
  };
  using Way = std::vector<Condition>;
  const auto with = [](Way way, std::size_t i, const std::string& name, Test test) {
    way[i].name += (way[i].name.empty() ? "" : ", ") + name;
    way[i].tests.push_back(std::move(test));
    return way;
  };
  // Ways in which some of those that live fail the test, or all do.
  const auto failing = [&](const Way& way, const Living& living, bool all, const std::string& name,
                           const std::function<bool(std::size_t, StateId)>& test) {
    std::vector<Way> ways;
    Way before = way;
    for (std::size_t i = 0; i < count; ++i) {
      if (!living[i]) continue;
      if (wires[i] != nullptr) {
        Way one = before;
        one[i].waits = ways_to_wait(*wires[i], actions_);
        if (one[i].waits.empty()) {
          if (all) return std::vector<Way>();
        } else if (all) {
          before = std::move(one);
        } else {
          ways.push_back(std::move(one));
        }
        continue;
      }
      Way one = with(before, i, "not " + name, [=](StateId state) { return !test(i, state); });
      if (all) {
        before = std::move(one);
        continue;
      }
      ways.push_back(std::move(one));
      before = with(before, i, name, [=](StateId state) { return test(i, state); });
    }
    if (all) ways.push_back(std::move(before));
    return ways;
  };
  const auto refusals = [&](const Way& way, const Living& living, const WriteArm& arm) {
    const auto takes = [&steps, &arm](std::size_t i, StateId state, bool tried, bool beyond,
                                      Collected::What after) {
      const auto input = steps.automaton(i).inputs().find(arm.input);
      return input && steps.takes(i, state, *input, tried, beyond, {after, 0});
    };
    using What = Collected::What;
    const bool is_bare = arm.kind == WriteKind::bare_arm;
    const auto can = [=](std::size_t i, StateId state) {
      return takes(i, state, true, is_bare || may_cut, What::any);
    };
    const auto returns = [=](std::size_t i, StateId state) {
      return takes(i, state, true, false, What::something);
    };
    const auto cut = [=](std::size_t i, StateId state) {
      return may_cut && takes(i, state, false, true, What::any);
    };
    if (topic.delivers_one && !is_bare) {
      return failing(way, living, true, arm.input + " at once", [=](std::size_t i, StateId state) {
        return returns(i, state) || cut(i, state);
      });
    }
    std::vector<Way> ways = failing(way, living, topic.delivers_one, arm.input, can);
    if (is_bare) return ways;
    Way all = way;
    for (std::size_t i = 0; i < count; ++i) {
      if (!living[i]) continue;
      all = with(all, i, arm.input + " tried there",
                 [=](StateId state) { return can(i, state) && !cut(i, state); });
    }
    for (Way& late : failing(all, living, false, arm.input + " at once", returns)) {
      ways.push_back(std::move(late));
    }
    return ways;
  };
  for (const Living& living : living_sets(topic)) {
    const bool is_taken = !any_lives(living) &&
                          std::any_of(arms.begin(), arms.end(),
                                      [](auto& arm) { return arm.kind == WriteKind::bare_arm; });
    if (is_taken) continue;
    for (const Case& before : cases_not_due(topic, living)) {
      Way way(count);
      for (std::size_t i = 0; i < count; ++i) {
        if (!living[i] || wires[i] != nullptr) continue;
        const std::string text = before.collected[i].text(steps.outputs(i));
        way = with(way, i, text.empty() ? "nothing due" : text + ", nothing due",
                   [&, i](StateId state) {
                     return before.collected[i].is(topic.readers[i], steps.outputs(i), state) &&
                            steps.automaton(i).is_quiescent(state);
                   });
      }
      std::vector<Way> ways{std::move(way)};
      for (const WriteArm& arm : arms) {
        if (!any_lives(living)) break;  // no output follows
        std::vector<Way> more;
        for (const Way& known : ways) {
          for (Way& longer : refusals(known, living, arm)) more.push_back(std::move(longer));
        }
        ways = std::move(more);
      }
      for (const Way& one : ways) {
        Uses uses = others.conditions(actions_);
        std::vector<Uses> waits{{}};
        for (std::size_t i = 0; i < count; ++i) {
          if (!one[i].waits.empty()) waits = actions_.combine(waits, one[i].waits);
          steps.ask(
              i, living[i], one[i].name.empty() ? "" : one[i].name + others.text(i),
              [&](StateId state) {
                return std::all_of(one[i].tests.begin(), one[i].tests.end(),
                                   [&](const Test& test) { return test(state); });
              },
              uses);
        }
        if (!actions_.are_possible(uses)) continue;
        for (Uses& together : actions_.combine(waits, {uses}))
          result.push_back(std::move(together));
      }
    }
  }
}

}  // namespace maide::program_syntax
