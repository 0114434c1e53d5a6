#include "maide/check/rules/system_options.hpp"

#include "maide/base/text.hpp"

namespace maide {

SystemOptions system_options_of(const ModelInstance& model) {
  SystemOptions options;
  const auto& origin = model.read_automaton().origin;
  const auto sul = origin.find("sul");
  std::string_view text = model.is_learned ? std::string_view(model.origin) : std::string_view();
  if (sul != origin.end()) text = sul->second;
  for (const std::string_view word : split(text, ' ')) {
    const std::size_t at = word.find('=');
    if (at == std::string_view::npos) {
      if (!word.empty()) options.emplace("", word);
    } else {
      options.emplace(word.substr(0, at), word.substr(at + 1));
    }
  }
  return options;
}

bool is(const SystemOptions& options, const std::string& name, std::string_view value) {
  const auto place = options.find(name);
  return place != options.end() && place->second == value;
}

bool is_over_fast_dds(const ModelInstance& model) {
  const SystemOptions system = system_options_of(model);
  return is(system, "", "ros2") && is(system, "rmw", "fastrtps");
}

}  // namespace maide
