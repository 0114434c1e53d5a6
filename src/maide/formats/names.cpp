#include "maide/formats/names.hpp"

#include "maide/base/error.hpp"

namespace maide {

std::string quote_name(std::string_view name) {
  std::string text = "\"";
  for (const char letter : name) {
    if (letter == '"' || letter == '\\') text += '\\';
    text += letter;
  }
  return text + '"';
}

bool take_quoted_name(std::string_view& text, std::string& name) {
  std::string taken;
  for (std::size_t place = 1; place < text.size(); ++place) {
    char letter = text[place];
    if (letter == '"') {
      text.remove_prefix(place + 1);
      name = std::move(taken);
      return true;
    }
    if (letter == '\\' && place + 1 < text.size()) letter = text[++place];
    taken += letter;
  }
  return false;
}

namespace {
bool is_space(char letter) {
  return letter == ' ' || letter == '\t' || letter == '\n' || letter == '\r' || letter == '\f' ||
         letter == '\v';
}
}  // namespace

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

std::string join_names(std::span<const std::string> names) {
  std::string text;
  for (const std::string& name : names) {
    if (&name != &names.front()) text += ',';
    const bool plain = !name.empty() && name.front() != '"' && trim(name) == name &&
                       name.find(',') == std::string::npos;
    text += plain ? name : quote_name(name);
  }
  return text;
}

std::vector<std::string> split_names(std::string_view text) {
  std::vector<std::string> names;
  text = trim(text);
  while (!text.empty()) {
    std::string name;
    if (text.front() == '"') {
      if (!take_quoted_name(text, name)) throw UsageError("unfinished quote in a list of names");
      text = trim(text);
      if (!text.empty() && text.front() != ',') {
        throw UsageError("missing comma after " + shown(name) + " in a list of names");
      }
    } else {
      const std::string_view plain = text.substr(0, text.find(','));
      name = trim(plain);
      text.remove_prefix(plain.size());
    }
    if (name.empty()) throw UsageError("an empty name in a list of names");
    names.push_back(std::move(name));
    if (text.empty()) break;
    text = trim(text.substr(1));
    if (text.empty()) throw UsageError("a list of names ends with a comma");
  }
  return names;
}

std::string shown(std::string_view text) {
  constexpr std::size_t limit = 60;
  std::string result = "'";
  for (const char letter : text.substr(0, limit)) {
    const auto code = static_cast<unsigned char>(letter);
    result += code < 0x20 || code == 0x7f ? ' ' : letter;
  }
  // Cut between characters, not inside one: UTF-8 continuation bytes are 10xxxxxx.
  if (text.size() > limit) {
    std::size_t cut = limit;
    while (cut > 0 && (static_cast<unsigned char>(text[cut]) & 0xc0) == 0x80) --cut;
    result.resize(1 + cut);
    result += "...";
  }
  return result + "'";
}

}  // namespace maide
