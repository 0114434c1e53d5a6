#include "maide/check/rules/open_topic.hpp"

#include <span>

namespace maide {

InterfaceAutomaton make_open_topic(const std::vector<std::string>& values, bool has_tryread) {
  std::vector<std::string> inputs{"read"}, outputs;
  for (const std::string& value : values) outputs.push_back("message(" + value + ")");
  if (values.empty()) outputs.emplace_back("message");
  const auto messages = static_cast<Symbol>(outputs.size());
  if (has_tryread) {
    inputs.emplace_back("tryread");
    outputs.emplace_back("null");
  }
  using Kind = Action::Kind;
  const StateId rest = 0, asked = 1, tried = 2;
  InterfaceAutomaton topic(Alphabet(std::span<const std::string>(inputs)),
                           Alphabet(std::span<const std::string>(outputs)), has_tryread ? 3 : 2);
  topic.actors = {{"writer", {}, {}}, {"reader", inputs, outputs}};
  for (Symbol input = 0; input < inputs.size(); ++input) {
    const StateId behind = input == 0 ? asked : tried;
    topic.add_transition(rest, {Kind::input, input}, behind);
    for (Symbol message = 0; message < messages; ++message) {
      topic.add_transition(behind, {Kind::output, message}, rest);
    }
    if (behind == tried) topic.add_transition(tried, {Kind::output, messages}, rest);
  }
  return topic;
}

}  // namespace maide
