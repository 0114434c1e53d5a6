#include "maide/workflow/system_spec.hpp"

#include <algorithm>
#include <string_view>

#include "maide/base/error.hpp"

namespace maide {
namespace {

bool take_prefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

void parse_target(SystemSpec& spec) {
  std::string_view rest = spec.text;
  if (take_prefix(rest, "sim:")) {
    spec.kind = SystemSpec::Kind::simulated;
  } else if (take_prefix(rest, "tcp://")) {
    spec.kind = SystemSpec::Kind::tcp;
  } else if (take_prefix(rest, "exec:")) {
    spec.kind = SystemSpec::Kind::program;
    spec.command = split_shell_words(rest);
  } else if (rest.find_first_of(":/= \t") != std::string_view::npos) {
    throw UsageError("unknown system '" + spec.text +
                     "': give a wrapper's name (port, cyclonedds), sim:FILE, tcp://HOST:PORT or "
                     "exec:PROGRAM");
  }
  spec.target = rest;
  if (spec.target.empty() || (spec.kind == SystemSpec::Kind::program && spec.command.empty())) {
    throw UsageError("nothing follows '" + spec.text + "' in the system's name");
  }
}

}  // namespace

SystemSpec parse_system_spec(const std::string& sul, std::span<const std::string> key_values) {
  if (sul.empty()) throw UsageError("the system's name is empty");
  SystemSpec spec;
  spec.text = sul;
  parse_target(spec);
  for (const std::string& word : key_values) {
    const std::size_t equals = word.find('=');
    if (equals == 0 || equals == std::string::npos) {
      throw UsageError("'" + word + "' is not an option of the system: write KEY=VALUE");
    }
    std::string key = word.substr(0, equals);
    std::replace(key.begin(), key.end(), '_', '-');
    if (!spec.options.emplace(key, word.substr(equals + 1)).second) {
      throw UsageError("option '" + key + "' of the system is given twice");
    }
  }
  return spec;
}

std::string origin_of(const SystemSpec& spec, const std::map<std::string, std::string>& options) {
  std::string text = quote_shell_word(spec.text);
  for (const auto& [key, value] : options) text += " " + quote_shell_word(key + "=" + value);
  return text;
}

}  // namespace maide
