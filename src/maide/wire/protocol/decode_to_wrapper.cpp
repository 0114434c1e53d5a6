// Lines of a client as messages, checked as those of a wrapper are: neither side believes the
// other.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/wire/protocol/json_members.hpp"
#include "maide/wire/protocol/protocol.hpp"

namespace maide::protocol {
namespace {

Symbol input_symbol(const std::string& name, const SulInfo& info, Translation translation) {
  for (Symbol input = 0; input < info.inputs.size(); ++input) {
    if (info.inputs[input].name == name) return input;
  }
  if (translation == Translation::av && name == delta) {
    return static_cast<Symbol>(info.inputs.size());
  }
  throw ProtocolError(fmt::format("unknown input '{}'", excerpt(name)));
}

// No path comes back to a node: a query ends. Nodes are taken away once nothing leads to them
// (A. B. Kahn, "Topological sorting of large networks", CACM 1962); on a cycle some remain.
void check_ends(const BasicDecisionTree<std::string>& tree) {
  std::vector<std::size_t> leading(tree.nodes.size(), 0);
  for (const auto& node : tree.nodes) {
    for (const auto& branch : node.branches) ++leading[branch.second];
  }
  std::vector<std::size_t> free;
  for (std::size_t node = 0; node < leading.size(); ++node) {
    if (leading[node] == 0) free.push_back(node);
  }
  std::size_t taken = 0;
  for (; !free.empty(); ++taken) {
    const std::size_t node = free.back();
    free.pop_back();
    for (const auto& branch : tree.nodes[node].branches) {
      if (--leading[branch.second] == 0) free.push_back(branch.second);
    }
  }
  if (taken < tree.nodes.size()) throw ProtocolError("a decision tree goes in a circle");
}

BasicDecisionTree<std::string> decode_tree(const Json& json, const SulInfo& info,
                                           Translation translation) {
  BasicDecisionTree<std::string> tree;
  for (const Json& row : json) {
    auto& node = tree.nodes.emplace_back();
    node.input = input_symbol(text_member(row, "input"), info, translation);
    const Json* branches = find_member(row, "branches");
    if (branches == nullptr) continue;
    if (!branches->is_object()) throw ProtocolError("'branches' is not an object");
    for (const auto& [output, next] : branches->items()) {
      const std::uint64_t target = to_number(next, "branches", json.size() - 1);
      node.branches.emplace_back(output, static_cast<std::uint32_t>(target));
    }
  }
  check_ends(tree);
  return tree;
}

Run decode_run(const Json& json, const SulInfo& info) {
  Run run;
  run.id = id_member(json);
  run.announce = flag_member(json, "announce");
  run.query.translation =
      find_name(text_member(json, "translation", "eager"), "translation", translation_names);
  if (find_member(json, "tree") != nullptr) {
    run.query.inputs = decode_tree(list_member(json, "tree"), info, run.query.translation);
    return run;
  }
  member(json, "word");
  Word word;
  for (const std::string& name : texts_member(json, "word")) {
    word.push_back(input_symbol(name, info, run.query.translation));
  }
  run.query.inputs = std::move(word);
  return run;
}

Purpose decode_purpose(const Json& json) {
  constexpr std::uint64_t most_states = 1'000'000;
  const std::uint64_t states = to_number(member(json, "states"), "states", most_states);
  if (states == 0) throw ProtocolError("a purpose without states");
  try {
    InterfaceAutomaton automaton(Alphabet(texts_member(json, "inputs")),
                                 Alphabet(texts_member(json, "outputs")), states);
    const auto to_state = [&](const Json& number) {
      return static_cast<StateId>(to_number(number, "transitions", states - 1));
    };
    automaton.set_initial(to_state(member(json, "initial")));
    for (const Json& row : list_member(json, "transitions")) {
      if (!row.is_array() || row.size() != 3) {
        throw ProtocolError("a transition is not [from, action, to]");
      }
      const std::string name = to_text(row[1], "transitions");
      const bool is_input = name.starts_with('?');
      if (!is_input && !name.starts_with('!')) {
        throw ProtocolError("an action does not begin with ? or !");
      }
      const Alphabet& alphabet = is_input ? automaton.inputs() : automaton.outputs();
      automaton.add_transition(to_state(row[0]),
                               {is_input ? Action::Kind::input : Action::Kind::output,
                                alphabet.at(name.substr(1), "action")},
                               to_state(row[2]));
    }
    return {LearningPurpose(std::move(automaton), find_name(text_member(json, "at_bound", "refuse"),
                                                            "at_bound", at_bound_names))};
  } catch (const UsageError& error) {
    throw ProtocolError(error.what());
  }
}

}  // namespace

ToWrapper decode_to_wrapper(std::string_view line, const SulInfo& info) {
  const Json json = parse_object(line);
  const std::string type = text_member(json, "type");
  if (type == "run") return decode_run(json, info);
  if (type == "configure") return Configure{map_member(json, "options")};
  if (type == "purpose") return decode_purpose(json);
  if (type == "cancel") return Cancel{};
  if (type == "bye") return Bye{};
  if (type == "token") return Token{text_member(json, "token")};
  throw ProtocolError(fmt::format("unknown type '{}' of line", excerpt(type)));
}

}  // namespace maide::protocol
