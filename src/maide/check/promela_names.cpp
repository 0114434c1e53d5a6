#include "maide/check/promela_names.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

namespace maide {
namespace {

// Words of the language and of what SPIN generates from it; every identifier that carries a prefix
// is safe anyway.
bool is_reserved(const std::string& word) {
  static const std::set<std::string> words{
      "active",   "always",       "and",         "assert",
      "atomic",   "bit",          "bool",        "break",
      "byte",     "c_code",       "c_decl",      "c_expr",
      "c_state",  "c_track",      "chan",        "cond_expr",
      "cut",      "D_proctype",   "d_step",      "do",
      "else",     "empty",        "enabled",     "equivalent",
      "eval",     "eventually",   "event",       "false",
      "fi",       "for",          "full",        "get_priority",
      "goto",     "hidden",       "if",          "implies",
      "in",       "init",         "inline",      "InChannel",
      "int",      "len",          "local",       "ltl",
      "mtype",    "nempty",       "never",       "next",
      "nfull",    "notrace",      "np_",         "od",
      "of",       "or",           "OutChannel",  "pc_value",
      "pid",      "print",        "printf",      "printm",
      "priority", "proctype",     "provided",    "quiet",
      "R",        "release",      "return",      "run",
      "select",   "set_priority", "short",       "show",
      "skip",     "strong",       "stronguntil", "timeout",
      "trace",    "true",         "typedef",     "U",
      "unless",   "unsigned",     "until",       "V",
      "W",        "weakuntil",    "X",           "xr",
      "xs",       "not",          "const",       "define",
      "ifdef",    "include",      "unix",        "linux"};
  if (words.contains(word)) return true;
  // Labels and macros of the text itself, and labels with a meaning.
  for (const std::string_view prefix : {"end", "accept", "progress", "T0", "is_cut", "never"}) {
    if (word.starts_with(prefix)) return true;
  }
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  return word.size() > 1 && (word[0] == 's' || word[0] == 'p') &&
         std::all_of(word.begin() + 1, word.end(), is_digit);
}

std::string sanitise(std::string_view name) {
  std::string word;
  for (const char c : name.substr(0, 40)) {
    word += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  }
  return word;
}

}  // namespace

const std::string& PromelaNames::of(std::string_view prefix, std::string_view name) {
  const auto [entry, is_new] =
      known_.try_emplace({std::string(prefix), std::string(name)}, std::string());
  if (!is_new) return entry->second;
  std::string word = std::string(prefix) + sanitise(name);
  if (!std::isalpha(static_cast<unsigned char>(word[0])) || is_reserved(word)) word = "n_" + word;
  std::string candidate = word;
  for (int number = 2; !taken_.insert(candidate).second; ++number) {
    candidate = word + "_" + std::to_string(number);
  }
  return entry->second = candidate;
}

}  // namespace maide
