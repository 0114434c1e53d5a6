#include "maide/formats/actors_text.hpp"

#include "maide/base/error.hpp"
#include "maide/formats/names.hpp"

namespace maide {

namespace {

constexpr std::string_view separators = " \t\r\n\f\v:;";

std::string word(const std::string& name) {
  const bool plain = !name.empty() && name.front() != '"' && name.front() != '?' &&
                     name.front() != '!' && name.find_first_of(separators) == std::string::npos;
  return plain ? name : quote_name(name);
}

std::string take_word(std::string_view& text) {
  std::string name;
  if (!text.empty() && text.front() == '"') {
    if (!take_quoted_name(text, name)) throw UsageError("unfinished quote in the list of actors");
  } else {
    const std::string_view plain = text.substr(0, text.find_first_of(separators));
    name = plain;
    text.remove_prefix(plain.size());
    if (name.empty()) {
      throw UsageError("a name is missing in the list of actors before " + shown(text));
    }
  }
  text = trim(text);
  return name;
}

}  // namespace

std::string actors_to_text(std::span<const Actor> actors) {
  std::string text;
  for (const Actor& actor : actors) {
    if (&actor != &actors.front()) text += "; ";
    text += word(actor.name) + ":";
    for (const std::string& input : actor.inputs) text += " ?" + word(input);
    for (const std::string& output : actor.outputs) text += " !" + word(output);
  }
  return text;
}

std::vector<Actor> actors_from_text(std::string_view text) {
  std::vector<Actor> actors;
  text = trim(text);
  while (!text.empty()) {
    Actor actor;
    actor.name = take_word(text);
    if (!text.starts_with(':')) {
      throw UsageError("':' expected after actor " + shown(actor.name));
    }
    text = trim(text.substr(1));
    while (text.starts_with('?') || text.starts_with('!')) {
      auto& list = text.front() == '?' ? actor.inputs : actor.outputs;
      text.remove_prefix(1);
      list.push_back(take_word(text));
    }
    actors.push_back(std::move(actor));
    if (text.empty()) break;
    if (!text.starts_with(';')) {
      throw UsageError("?input, !output or ';' expected in the list of actors before " +
                       shown(text));
    }
    text = trim(text.substr(1));
  }
  return actors;
}

}  // namespace maide
