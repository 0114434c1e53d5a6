// Which class or function of the sources a name means, by C++'s rules as far as they are sure.
//
// A name is looked for in the scope of its use, then in the scopes around it, then in namespaces
// that some `using namespace` names. What is not found there is not known, whatever else ends with
// the same word.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "maide/extract/api_table.hpp"
#include "maide/extract/sources.hpp"

namespace maide::extract {

// Functions that a call may mean.
struct Overloads {
  std::vector<int> bodies;
  bool may_be_elsewhere = false;  // one that fits has no body here, or may have none
};

class NameLookup {
 public:
  NameLookup(const Sources& sources, const ApiTable& table);

  // `scope`: the class or namespace in which the name stands.
  const Class* find_class(const std::string& name, const std::string& scope) const;
  // The class of the tables from which it derives; empty if there is none.
  std::string api_base(const std::string& of_class) const;
  bool is_node_class(const std::string& of_class) const;
  // Whether the class of the sources is another one's, by one step or several.
  bool derives_from(const std::string& of_class, const std::string& base) const;
  // Whether a class that derives from it has a method of that name, too.
  bool is_overridden(const Class& entry, const std::string& method) const;
  bool is_known_type(const std::string& type, const std::string& scope) const;
  // Whether some base is neither among the sources nor in a table.
  bool has_unknown_base(const Class& entry) const;
  Overloads methods(const Class& entry, const std::string& name, std::size_t count) const;
  Overloads constructors(const Class& entry, std::size_t count) const;
  Overloads free_functions(const std::string& name, const std::string& scope,
                           std::size_t count) const;
  // All methods of the class itself that have this name.
  std::vector<int> all_methods(const Class& entry, const std::string& name) const;

 private:
  static bool takes(const Function& function, std::size_t count);
  std::vector<std::string> scopes_around(const std::string& scope) const;
  bool is_elsewhere(const std::string& full_name) const;

  const Sources& sources_;
  const ApiTable& table_;
  std::set<std::string> without_body_;       // full names of which one declaration has no body
  std::multimap<std::string, int> by_name_;  // functions by their last word
};

bool is_message_type(const std::string& type);

}  // namespace maide::extract
