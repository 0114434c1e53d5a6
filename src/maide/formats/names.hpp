// Names of symbols in files. In attributes and labels a name is written as it is. A name that
// contains a separator of such lists is written in double quotes, with \" and \\ inside. Every name
// round-trips. For formats that are programs, `Identifiers` makes legal and distinct identifiers of
// names.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace maide {

// `name` in double quotes, with \ before each " and \.
std::string quote_name(std::string_view name);

// Takes a quoted name off the front of `text` (which begins with "). Returns false, and leaves
// `text` alone, if the closing quote is missing.
bool take_quoted_name(std::string_view& text, std::string& name);

// Without white space at both ends.
std::string_view trim(std::string_view text);

// "write,tryread": names separated by commas.
std::string join_names(std::span<const std::string> names);
// Inverse of join_names; white space around names is ignored, "" is no name at all. Throws
// UsageError "..." (without a place) for an empty name or an unfinished quote.
std::vector<std::string> split_names(std::string_view text);

// Text from a file for a message: on one line, in single quotes, at most some 60 bytes of it.
std::string shown(std::string_view text);

// ---- Identifiers ----
//
// Legal and unique identifiers out of names of any kind, for the formats that are programs in some
// language.
class Identifiers {
 public:
  // `reserved`: keywords and other words that must not be given out.
  explicit Identifiers(std::span<const std::string_view> reserved);

  // `wanted`, if it is an identifier ([A-Za-z][A-Za-z0-9_]*) that is neither reserved nor given out
  // before. Otherwise the nearest one: other characters become '_', and a number is appended. The
  // same calls give the same identifiers.
  std::string unique(std::string_view wanted);
  // One for each name; `prefix` goes before each.
  std::vector<std::string> unique(std::span<const std::string> names, std::string_view prefix = "");

 private:
  std::unordered_set<std::string> taken_;
};

// Words that a program must not use as identifiers, keywords and names that its tools predefine.
std::span<const std::string_view> promela_reserved();
std::span<const std::string_view> smv_reserved();
std::span<const std::string_view> cpp_reserved();

// Text for the inside of a comment: on one line, without what could end the comment.
std::string comment_text(std::string_view text);

}  // namespace maide
