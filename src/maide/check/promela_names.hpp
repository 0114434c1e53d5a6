// Names of a system as Promela identifiers: readable, distinct, and no keywords.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>

namespace maide {

class PromelaNames {
 public:
  // The identifier of `name` with `prefix`; the same for the same pair.
  const std::string& of(std::string_view prefix, std::string_view name);

 private:
  std::map<std::pair<std::string, std::string>, std::string> known_;
  std::set<std::string> taken_;
};

}  // namespace maide
