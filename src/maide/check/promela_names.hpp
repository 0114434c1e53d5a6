// Names of a system as Promela identifiers: readable, distinct, and free of the meanings that SPIN
// and the text of a system give to words of their own.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "maide/formats/identifiers.hpp"

namespace maide {

class PromelaNames {
 public:
  PromelaNames();
  // The identifier of `name` with `prefix`; the same for the same pair.
  const std::string& of(std::string_view prefix, std::string_view name);

 private:
  std::map<std::pair<std::string, std::string>, std::string> known_;
  Identifiers identifiers_;
};

}  // namespace maide
