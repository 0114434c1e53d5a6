#include "maide/wire/wrapper/full_setup.hpp"

#include <algorithm>
#include <map>
#include <span>
#include <stdexcept>
#include <utility>

#include "maide/base/error.hpp"

namespace maide {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

std::size_t count_of(const OptionValues& options, std::string_view key) {
  return options.has(key) ? static_cast<std::size_t>(options.number(key)) : 1;
}

}  // namespace

std::string symbol_name(std::string_view name, std::size_t end, std::string_view value) {
  std::string symbol(name.substr(0, name.find('(')));
  const std::string_view arguments = name.substr(symbol.size());
  if (end > 0) symbol += std::to_string(end + 1);
  symbol += arguments;
  if (!value.empty()) symbol += "(" + std::string(value) + ")";
  return symbol;
}

FullSetup::FullSetup(SystemSetup setup, const OptionValues& options)
    : setup_(std::move(setup)),
      writers_(count_of(options, "writers")),
      readers_(count_of(options, "readers")) {
  if (options.has("payload")) {
    tells_gaps_ = options.is("payload", "gap");
    values = options.list_behind("payload", "values");
  }
  if (tells_gaps_ && writers_ > 1) {
    throw UsageError(
        "option payload: gap needs writers=1, because the number in a message does not say whose "
        "it is");
  }
  for (const std::string& actor : setup_.actors) {
    for (std::size_t end = 0; end < ends_of(actor); ++end)
      actors.push_back(symbol_name(actor, end));
  }
  add_inputs();
  add_events();
}

FullSetup::Side FullSetup::side_of(const std::string& actor) const {
  if (contains(setup_.of_writer, actor)) return Side::writer;
  return contains(setup_.of_reader, actor) ? Side::reader : Side::neither;
}

std::size_t FullSetup::ends_of(const std::string& actor) const {
  const Side side = side_of(actor);
  return side == Side::writer ? writers_ : side == Side::reader ? readers_ : 1;
}

bool FullSetup::carries_value(const std::string& input) const {
  return !values.empty() &&
         contains(setup_.in_flight ? setup_.in_flight->sends : MessagesInFlight().sends, input);
}

std::vector<std::string> FullSetup::base_names(const std::string& event) const {
  if (event != setup_.message_event || !tells_gaps_) return {event};
  if (setup_.messages_come_again) return {"next", "gap", "old"};
  return {"next", "gap"};
}

std::vector<std::string> FullSetup::observed_names(const std::string& event,
                                                   std::size_t end) const {
  std::vector<std::string> names;
  for (const std::string& base : base_names(event)) {
    if (event != setup_.message_event || values.empty()) {
      names.push_back(symbol_name(base, end));
    } else {
      for (const std::string& value : values) names.push_back(symbol_name(base, end, value));
    }
  }
  return names;
}

void FullSetup::add_inputs() {
  for (const SystemSetup::Input& input : setup_.inputs) {
    for (std::size_t end = 0; end < ends_of(input.actor); ++end) {
      Input full{symbol_name(input.name, end),
                 symbol_name(input.actor, end),
                 side_of(input.actor),
                 {input.name, end, 0},
                 {}};
      for (const std::string& event : input.returns) {
        for (std::string& name : observed_names(event, end)) full.returns.push_back(name);
      }
      if (!carries_value(input.name)) {
        inputs.push_back(std::move(full));
        continue;
      }
      for (std::size_t value = 0; value < values.size(); ++value) {
        full.name = symbol_name(input.name, end, values[value]);
        full.call.value = value + 1;
        inputs.push_back(full);
      }
    }
  }
}

void FullSetup::add_events() {
  for (const SystemSetup::Event& event : setup_.events) {
    for (std::size_t end = 0; end < ends_of(event.actor); ++end) {
      const std::string actor = symbol_name(event.actor, end);
      for (const std::string& base : base_names(event.name)) {
        const bool has_value = event.name == setup_.message_event && !values.empty();
        for (const std::string& value : has_value ? values : std::vector<std::string>{""}) {
          events.push_back(
              {symbol_name(base, end, value), actor, side_of(event.actor), base, end, event.name});
        }
      }
    }
  }
}

std::vector<std::string> FullSetup::names_in_purpose(
    const std::string& name, bool is_input, const std::vector<std::size_t>& readers) const {
  std::vector<std::string> names;
  const auto is_meant = [&](Side side, std::size_t end) {
    return side != Side::reader || std::ranges::find(readers, end) != readers.end();
  };
  if (is_input) {
    for (const Input& input : inputs) {
      if (input.call.input != name) continue;
      if (is_meant(input.side, input.call.end)) names.push_back(input.name);
    }
  } else {
    for (const Event& event : events) {
      if (event.base == name && is_meant(event.side, event.end)) names.push_back(event.name);
    }
  }
  return names;
}

LearningPurpose FullSetup::purpose_for(const LearningPurpose& purpose,
                                       const std::vector<std::size_t>& readers) const {
  const InterfaceAutomaton& known = purpose.automaton();
  std::vector<std::string> all_inputs;
  std::map<Symbol, std::vector<std::string>> input_names, output_names;
  for (Symbol symbol = 0; symbol < known.inputs().size(); ++symbol) {
    auto& names = input_names[symbol] =
        names_in_purpose(known.inputs().name(symbol), true, readers);
    all_inputs.insert(all_inputs.end(), names.begin(), names.end());
  }
  for (Symbol symbol = 0; symbol < known.outputs().size(); ++symbol) {
    output_names[symbol] = names_in_purpose(known.outputs().name(symbol), false, readers);
  }
  InterfaceAutomaton renamed(Alphabet(std::span<const std::string>(all_inputs)), Alphabet(),
                             known.size());
  renamed.set_initial(known.initial());
  for (StateId state = 0; state < known.size(); ++state) {
    for (const auto& transition : known.transitions(state)) {
      const bool is_input = transition.action.is_input();
      const auto& names = (is_input ? input_names : output_names)[transition.action.symbol];
      for (const std::string& name : names) {
        const Symbol symbol = is_input ? *renamed.inputs().find(name) : renamed.intern_output(name);
        renamed.add_transition(state, {transition.action.kind, symbol}, transition.target);
      }
    }
  }
  return LearningPurpose(std::move(renamed), purpose.at_bound());
}

std::vector<LearningPurpose> FullSetup::purposes_for(const LearningPurpose& purpose,
                                                     bool shared) const {
  if (writers_ == 1 && readers_ == 1 && values.empty()) return {purpose};
  std::vector<LearningPurpose> result;
  std::vector<std::size_t> all;
  for (std::size_t reader = 0; reader < readers_; ++reader) {
    if (!shared) result.push_back(purpose_for(purpose, {reader}));
    all.push_back(reader);
  }
  if (shared) result.push_back(purpose_for(purpose, all));
  return result;
}

}  // namespace maide
