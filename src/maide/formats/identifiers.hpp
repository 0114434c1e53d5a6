// Legal and unique identifiers out of names of any kind, for the formats that are programs in some
// language.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace maide {

class Identifiers {
 public:
  // `reserved`: keywords and other words that must not be given out.
  explicit Identifiers(std::span<const std::string_view> reserved);

  // `wanted` if it is an identifier ([A-Za-z][A-Za-z0-9_]*) that is neither reserved nor given out
  // before; else the nearest that is: other characters become '_', and a number is appended. The
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
