#include "maide/workflow/system_variant.hpp"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"
#include "maide/check/language/yaml_reader.hpp"

namespace maide {
namespace {

constexpr std::string_view blanks = " \t\r\n";

// The offset of a place in the text; its size if there is none.
std::size_t offset_of(std::string_view text, int line, int column) {
  std::size_t at = 0;
  for (int skipped = 1; skipped < line; ++skipped) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string_view::npos) return text.size();
    at = end + 1;
  }
  return std::min(text.size(), at + static_cast<std::size_t>(column - 1));
}

// Writes the number in the place of another; false if there is none.
bool write_number(std::string& text, std::size_t begin, std::int64_t number) {
  const std::size_t digits = begin < text.size() && text[begin] == '-' ? begin + 1 : begin;
  const std::size_t end = std::min(text.find_first_not_of("0123456789", digits), text.size());
  if (end <= digits) return false;
  text.replace(begin, end - begin, std::to_string(number));
  return true;
}

// Writes the count behind the keyword; false if it is not there.
bool write_count(std::string& text, const Repeat& repeat) {
  constexpr std::string_view keyword = "repeat";
  const std::size_t begin = offset_of(text, repeat.line, repeat.column);
  if (text.compare(begin, keyword.size(), keyword) != 0) return false;
  const std::size_t number = text.find_first_not_of(blanks, begin + keyword.size());
  return number != std::string::npos && write_number(text, number, repeat.count);
}

// The model that a request stands for in the system; of an array, any of its members. The system
// was read with the same requests.
const ModelInstance& instance_of(const System& system, const ModelRequest& request) {
  return *std::find_if(system.models.begin(), system.models.end(), [&](const auto& candidate) {
    return candidate.name == request.instance || candidate.name.starts_with(request.instance + "[");
  });
}

using Options = std::vector<std::pair<std::string, std::string>>;

// With which options each instance is learned, in the text as it was read.
std::map<std::string, Options> options_of_instances(const System& system, const std::string& text) {
  std::map<std::string, Options> result;
  parse_system(text, system.file, [&](const ModelRequest& request) {
    result[request.instance] = request.with;
    return instance_of(system, request).automaton;
  });
  return result;
}

}  // namespace

std::vector<NumberConstant> find_constants(const System& system) {
  std::vector<NumberConstant> constants;
  const auto source = system.sources.find(system.file);
  if (source == system.sources.end()) return constants;
  const YamlReader reader(source->second, system.file);
  const YAML::Node section = reader.load()["constants"];
  if (!section) return constants;
  for (const auto& [key, value] : reader.entries(section, "'constants'", {})) {
    const auto number = parse_number<std::int64_t>(value.Scalar());
    if (!number || value.Tag() == "!") continue;  // it is in quotes
    const SourcePosition place = reader.at(value);
    constants.push_back({key.Scalar(), place.line, place.column, *number});
  }
  return constants;
}

std::vector<Repeat> find_repeats(const System& system) {
  std::vector<Repeat> repeats;
  for (const Program& program : system.programs) {
    if (program.position.file != system.file) continue;
    for (const Program::Round& round : program.rounds) {
      if (round.count > 0) repeats.push_back({round.line, round.column, round.count});
    }
  }
  const auto place = [](const Repeat& repeat) { return std::pair(repeat.line, repeat.column); };
  std::sort(repeats.begin(), repeats.end(),
            [&](const Repeat& a, const Repeat& b) { return place(a) < place(b); });
  repeats.erase(std::unique(repeats.begin(), repeats.end(),
                            [&](const Repeat& a, const Repeat& b) { return place(a) == place(b); }),
                repeats.end());
  return repeats;
}

std::optional<System> make_variant(const System& system, const SystemVariant& variant,
                                   const ModelSource& learn, const RunControl& control) {
  const auto source = system.sources.find(system.file);
  if (source == system.sources.end()) return std::nullopt;
  std::string text = variant.text.empty() ? source->second : variant.text;
  // From the end, so that places before stay right.
  const auto from_the_end = [](auto changes) {
    std::sort(changes.begin(), changes.end(), [](const auto& a, const auto& b) {
      return std::pair(a.line, a.column) > std::pair(b.line, b.column);
    });
    return changes;
  };
  MAIDE_CHECK(variant.repeats.empty() || variant.constants.empty());
  for (const Repeat& repeat : from_the_end(variant.repeats)) {
    if (!write_count(text, repeat)) return std::nullopt;
  }
  for (const NumberConstant& constant : from_the_end(variant.constants)) {
    const std::size_t begin = offset_of(text, constant.line, constant.column);
    if (!write_number(text, begin, constant.value)) return std::nullopt;
  }
  try {
    std::map<std::string, Options> options;
    if (!variant.constants.empty()) options = options_of_instances(system, source->second);
    const ModelSource asked = [&](const ModelRequest& request) {
      const auto changed = variant.models.find(request.instance);
      if (changed != variant.models.end()) return changed->second;
      const auto known = options.find(request.instance);
      if (known == options.end() || known->second == request.with || request.learn.empty()) {
        return instance_of(system, request).automaton;
      }
      if (!learn) throw UsageError("no model was learned with these options");
      return learn(request);
    };
    return parse_system(text, system.file, asked, control);
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace maide
