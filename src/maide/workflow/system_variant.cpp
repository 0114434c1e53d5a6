#include "maide/workflow/system_variant.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/check/system_file.hpp"

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

// Writes the count behind the keyword; false if it is not there.
bool write_count(std::string& text, const Repeat& repeat) {
  constexpr std::string_view keyword = "repeat";
  const std::size_t begin = offset_of(text, repeat.line, repeat.column);
  if (text.compare(begin, keyword.size(), keyword) != 0) return false;
  const std::size_t number = text.find_first_not_of(blanks, begin + keyword.size());
  if (number == std::string::npos) return false;
  const std::size_t end = text.find_first_not_of("0123456789", number);
  if (end == number || end == std::string::npos) return false;
  text.replace(number, end - number, std::to_string(repeat.count));
  return true;
}

}  // namespace

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

std::optional<System> make_variant(const System& system, const SystemVariant& variant) {
  const auto source = system.sources.find(system.file);
  if (source == system.sources.end()) return std::nullopt;
  std::string text = source->second;
  // From the end, so that places before stay right.
  std::vector<Repeat> repeats = variant.repeats;
  std::sort(repeats.begin(), repeats.end(), [](const Repeat& a, const Repeat& b) {
    return std::pair(a.line, a.column) > std::pair(b.line, b.column);
  });
  for (const Repeat& repeat : repeats) {
    if (!write_count(text, repeat)) return std::nullopt;
  }
  const ModelSource models = [&](const ModelRequest& request) {
    const auto changed = variant.models.find(request.instance);
    if (changed != variant.models.end()) return changed->second;
    const auto model = std::find_if(
        system.models.begin(), system.models.end(),
        [&](const ModelInstance& candidate) { return candidate.name == request.instance; });
    return model->automaton;
  };
  try {
    return parse_system(text, system.file, models);
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace maide
