#include "maide/check/language/system_names.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace maide {
namespace {

constexpr std::string_view to_model = "<-";  // between a wire's model and its writer

}  // namespace

std::uint64_t member_count(const Dimensions& dimensions) {
  std::uint64_t count = 1;
  for (const auto& [low, high] : dimensions) {
    count *= static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) + 1;
    if (count > max_array_members) return count;
  }
  return count;
}

std::vector<Value> member_indices(const Dimensions& dimensions, std::uint64_t member) {
  std::vector<Value> indices(dimensions.size());
  for (std::size_t i = dimensions.size(); i-- > 0;) {
    const auto& [low, high] = dimensions[i];
    const auto width = static_cast<std::uint64_t>(high - low) + 1;
    indices[i] = low + static_cast<Value>(member % width);
    member /= width;
  }
  return indices;
}

std::string member_suffix(const Dimensions& dimensions, std::uint64_t member) {
  std::string text;
  for (const Value index : member_indices(dimensions, member)) {
    text += (text.empty() ? "[" : ",") + std::to_string(index);
  }
  return text.empty() ? text : text + "]";
}

std::optional<std::uint32_t> Service::client_of(const std::string& node,
                                                std::uint32_t program) const {
  for (std::uint32_t i = 0; i < clients.size(); ++i) {
    if (clients[i].is_of(node, program)) return i;
  }
  return std::nullopt;
}

bool Service::is_server(const std::string& node, std::uint32_t program) const {
  return server.is_of(node, program);
}

std::string wire_name(const std::string& model, const std::string& writer) {
  return model + std::string(to_model) + writer;
}

bool is_wire_to(const std::string& wire, const std::string& model) {
  return wire.starts_with(model) && wire.substr(model.size()).starts_with(to_model);
}

WireEnds ends_of_wire(const std::string& wire) {
  const std::size_t sign = wire.find(to_model);
  if (sign == std::string::npos) return {wire, ""};
  return {wire.substr(0, sign), wire.substr(sign + to_model.size())};
}

std::string array_of(const std::string& name) { return name.substr(0, name.find('[')); }

const Wire* Names::wire_of(std::uint32_t to, const std::string& node, std::uint32_t program) const {
  const auto place = wires.find(to);
  if (place == wires.end()) return nullptr;
  for (const Wire& wire : place->second) {
    if (wire.from.is_of(node, program)) return &wire;
  }
  return nullptr;
}

std::string name_at_client(const std::string& name, std::uint32_t client) {
  return client == 0 ? name : name + std::to_string(client + 1);
}

bool is_of_writer(const InterfaceAutomaton& model, const std::string& name) {
  // "write(3)" is the writer's if "write" is, and the other way round.
  const auto base_name = [](const std::string& symbol) {
    return symbol.substr(0, symbol.find('('));
  };
  const auto names = [&](const std::vector<std::string>& symbols) {
    return std::ranges::any_of(
        symbols, [&](const std::string& symbol) { return base_name(symbol) == base_name(name); });
  };
  return std::ranges::any_of(model.actors, [&](const Actor& actor) {
    return actor.name == "writer" && (names(actor.inputs) || names(actor.outputs));
  });
}

bool is_sending(const std::string& input) {
  constexpr std::array<std::string_view, 4> words{"write", "send", "answer", "publish"};
  const std::string base = input.substr(0, input.find('('));
  return std::ranges::any_of(words, [&](std::string_view word) {
    return base.starts_with(word) &&
           base.find_first_not_of("0123456789", word.size()) == std::string::npos;
  });
}

bool is_of_same_actor(const InterfaceAutomaton& automaton, Symbol input, Symbol output) {
  const auto has = [](const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
  };
  const std::string& in = automaton.inputs().name(input);
  const std::string& out = automaton.outputs().name(output);
  bool is_known = false;
  for (const Actor& actor : automaton.actors) {
    if (!has(actor.inputs, in)) continue;
    is_known = true;
    if (has(actor.outputs, out)) return true;
  }
  return !is_known;
}

}  // namespace maide
