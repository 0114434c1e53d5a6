#include "maide/formats/names.hpp"

#include <array>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/text_cursor.hpp"

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
  if (text.size() > limit) {  // cut between characters, not inside one
    std::size_t cut = limit;
    while (cut > 0 && is_continuation(text[cut])) --cut;
    result.resize(1 + cut);
    result += "...";
  }
  return result + "'";
}

// Reserved words are those of the tools as documented, and what they predefine.

namespace {

// The C preprocessor, which spin runs too, replaces the last line's words on some systems.
constexpr auto promela_words = std::to_array<std::string_view>(
    {"active",    "assert",  "atomic",  "bit",        "bool",
     "break",     "byte",    "c_code",  "c_decl",     "c_expr",
     "c_state",   "c_track", "chan",    "D_proctype", "d_step",
     "do",        "else",    "empty",   "enabled",    "eval",
     "false",     "fi",      "for",     "full",       "get_priority",
     "goto",      "hidden",  "if",      "in",         "init",
     "inline",    "int",     "len",     "local",      "ltl",
     "mtype",     "nempty",  "never",   "nfull",      "notrace",
     "np_",       "od",      "of",      "pc_value",   "pid",
     "print",     "printf",  "printm",  "priority",   "proctype",
     "provided",  "return",  "run",     "select",     "set_priority",
     "short",     "show",    "skip",    "STDIN",      "timeout",
     "trace",     "true",    "typedef", "unless",     "unsigned",
     "xr",        "xs",      "always",  "eventually", "until",
     "weakuntil", "release", "implies", "equivalent", "stronguntil",
     "X",         "U",       "V",       "W",          "linux",
     "unix"});

constexpr auto smv_words = std::to_array<std::string_view>(
    {"MODULE",     "DEFINE",     "MDEFINE",  "CONSTANTS",  "VAR",        "IVAR",
     "FROZENVAR",  "INIT",       "TRANS",    "INVAR",      "SPEC",       "CTLSPEC",
     "LTLSPEC",    "PSLSPEC",    "COMPUTE",  "NAME",       "INVARSPEC",  "FAIRNESS",
     "JUSTICE",    "COMPASSION", "ISA",      "ASSIGN",     "CONSTRAINT", "SIMPWFF",
     "CTLWFF",     "LTLWFF",     "PSLWFF",   "COMPWFF",    "IN",         "MIN",
     "MAX",        "MIRROR",     "PRED",     "PREDICATES", "process",    "array",
     "of",         "boolean",    "integer",  "real",       "word",       "word1",
     "bool",       "signed",     "unsigned", "extend",     "resize",     "sizeof",
     "uwconst",    "swconst",    "EX",       "AX",         "EF",         "AF",
     "EG",         "AG",         "E",        "F",          "O",          "G",
     "H",          "X",          "Y",        "Z",          "A",          "U",
     "S",          "V",          "T",        "BU",         "EBF",        "ABF",
     "EBG",        "ABG",        "case",     "esac",       "mod",        "next",
     "init",       "union",      "in",       "xor",        "xnor",       "self",
     "TRUE",       "FALSE",      "count",    "abs",        "max",        "min",
     "bswtime",    "clock",      "const",    "continuous", "cos",        "exp",
     "floor",      "FUN",        "ITYPE",    "lin",        "ln",         "noncontinuous",
     "pi",         "pow",        "sin",      "sqrt",       "tan",        "time",
     "time_since", "time_until", "toint",    "typeof",     "URGENT",     "LTL2SMV",
     "main",       "READ",       "WRITE",    "CONST",      "urgent",     "at",
     "now"});

// Beside the keywords, macros that a standard header or a compiler may define.
constexpr auto cpp_words = std::to_array<std::string_view>({"alignas",
                                                            "alignof",
                                                            "and",
                                                            "and_eq",
                                                            "asm",
                                                            "assert",
                                                            "auto",
                                                            "bitand",
                                                            "bitor",
                                                            "bool",
                                                            "break",
                                                            "case",
                                                            "catch",
                                                            "char",
                                                            "char16_t",
                                                            "char32_t",
                                                            "char8_t",
                                                            "class",
                                                            "co_await",
                                                            "co_return",
                                                            "co_yield",
                                                            "compl",
                                                            "concept",
                                                            "const",
                                                            "const_cast",
                                                            "consteval",
                                                            "constexpr",
                                                            "constinit",
                                                            "continue",
                                                            "decltype",
                                                            "default",
                                                            "delete",
                                                            "do",
                                                            "double",
                                                            "dynamic_cast",
                                                            "else",
                                                            "enum",
                                                            "explicit",
                                                            "export",
                                                            "extern",
                                                            "false",
                                                            "final",
                                                            "float",
                                                            "for",
                                                            "friend",
                                                            "goto",
                                                            "if",
                                                            "import",
                                                            "inline",
                                                            "int",
                                                            "long",
                                                            "module",
                                                            "mutable",
                                                            "namespace",
                                                            "new",
                                                            "noexcept",
                                                            "not",
                                                            "not_eq",
                                                            "nullptr",
                                                            "operator",
                                                            "or",
                                                            "or_eq",
                                                            "override",
                                                            "private",
                                                            "protected",
                                                            "public",
                                                            "register",
                                                            "reinterpret_cast",
                                                            "requires",
                                                            "return",
                                                            "short",
                                                            "signed",
                                                            "sizeof",
                                                            "static",
                                                            "static_assert",
                                                            "static_cast",
                                                            "struct",
                                                            "switch",
                                                            "template",
                                                            "this",
                                                            "thread_local",
                                                            "throw",
                                                            "true",
                                                            "try",
                                                            "typedef",
                                                            "typeid",
                                                            "typename",
                                                            "union",
                                                            "unsigned",
                                                            "using",
                                                            "virtual",
                                                            "void",
                                                            "volatile",
                                                            "wchar_t",
                                                            "while",
                                                            "xor",
                                                            "xor_eq",
                                                            "EOF",
                                                            "NULL",
                                                            "TRUE",
                                                            "FALSE",
                                                            "BUFSIZ",
                                                            "EXIT_FAILURE",
                                                            "EXIT_SUCCESS",
                                                            "INFINITY",
                                                            "NAN",
                                                            "RAND_MAX",
                                                            "errno",
                                                            "linux",
                                                            "unix",
                                                            "stdin",
                                                            "stdout"});

std::string sanitized(std::string_view name) {
  std::string text;
  for (const char letter : name) {
    if (is_continuation(letter)) continue;
    text += is_letter(letter) || is_digit(letter) ? letter : '_';
  }
  if (text.empty() || !is_letter(text.front())) text.insert(0, "x");
  return text;
}

}  // namespace

Identifiers::Identifiers(std::span<const std::string_view> reserved) {
  for (const std::string_view word : reserved) taken_.emplace(word);
}

std::string Identifiers::unique(std::string_view wanted) {
  const std::string base = sanitized(wanted);
  std::string name = base;
  for (int number = 2; !taken_.insert(name).second; ++number) {
    name = base + "_" + std::to_string(number);
  }
  return name;
}

std::vector<std::string> Identifiers::unique(std::span<const std::string> names,
                                             std::string_view prefix) {
  std::vector<std::string> identifiers;
  identifiers.reserve(names.size());
  for (const std::string& name : names) identifiers.push_back(unique(std::string(prefix) + name));
  return identifiers;
}

std::span<const std::string_view> promela_reserved() { return promela_words; }
std::span<const std::string_view> smv_reserved() { return smv_words; }
std::span<const std::string_view> cpp_reserved() { return cpp_words; }

std::string comment_text(std::string_view text) {
  std::string result;
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (letter == '/' && result.ends_with('*')) result += ' ';
    if (letter == '*' && result.ends_with('/')) result += ' ';
    if (letter == '-' && result.ends_with('-')) result += ' ';
    result += code < 0x20 || code == 0x7f ? ' ' : letter;
  }
  if (result.ends_with('\\')) result += '.';  // would join the next line to a // comment
  return result;
}

}  // namespace maide
