#include "maide/extract/name_lookup.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/type_names.hpp"

namespace maide::extract {

bool is_message_type(const std::string& type) {
  return type.find("::msg::") != std::string::npos || type.find("::srv::") != std::string::npos ||
         type.find("::action::") != std::string::npos || type == "message";
}

NameLookup::NameLookup(const Sources& sources, const ApiTable& table)
    : sources_(sources), table_(table) {
  std::set<std::pair<std::string, std::vector<std::string>>> bodies;
  for (std::size_t i = 0; i < sources.functions.size(); ++i) {
    const Function& function = sources.functions[i];
    if (function.is_lambda) continue;
    by_name_.emplace(function.name, static_cast<int>(i));
    bodies.emplace(function.full_name(), function.parameter_types);
  }
  for (const Declaration& declaration : sources.declarations) {
    if (!bodies.contains({declaration.name, declaration.parameters})) {
      without_body_.insert(declaration.name);
    }
  }
}

std::vector<std::string> NameLookup::scopes_around(const std::string& scope) const {
  std::vector<std::string> scopes;
  for (std::string at = scope; !at.empty(); at = outer_part(at)) {
    scopes.push_back(at);
    const auto found = sources_.classes.find(at);
    if (found == sources_.classes.end()) continue;
    for (const std::string& base : found->second.bases) {
      for (std::string around = outer_part(at);; around = outer_part(around)) {
        scopes.push_back(around.empty() ? base : around + "::" + base);
        if (around.empty()) break;
      }
    }
  }
  scopes.emplace_back();
  for (const std::string& used : sources_.namespaces) scopes.push_back(used);
  return scopes;
}

const Class* NameLookup::find_class(const std::string& name, const std::string& scope) const {
  if (name.empty()) return nullptr;
  for (const std::string& around : scopes_around(scope)) {
    const auto found = sources_.classes.find(around.empty() ? name : around + "::" + name);
    if (found != sources_.classes.end()) return &found->second;
  }
  return nullptr;
}

std::string NameLookup::api_base(const std::string& of_class) const {
  const Class* entry = find_class(of_class, "");
  if (entry == nullptr) return table_.has_class(of_class) ? of_class : "";
  for (const std::string& base : entry->bases) {
    const Class* known = find_class(base, entry->name);
    if (known == entry) continue;
    std::string found = api_base(known != nullptr ? known->name : base);
    if (!found.empty()) return found;
  }
  return {};
}

bool NameLookup::derives_from(const std::string& of_class, const std::string& base) const {
  const Class* entry = find_class(of_class, "");
  return entry != nullptr && std::ranges::any_of(entry->bases, [&](const std::string& name) {
           const Class* known = find_class(name, outer_part(entry->name));
           return known != nullptr && known != entry &&
                  (known->name == base || derives_from(known->name, base));
         });
}

bool NameLookup::is_overridden(const Class& entry, const std::string& method) const {
  const auto [first, last] = by_name_.equal_range(method);
  return std::any_of(first, last, [&](const auto& named) {
    const Function& function = sources_.functions[static_cast<std::size_t>(named.second)];
    return derives_from(function.of_class, entry.name);
  });
}

bool NameLookup::has_unknown_base(const Class& entry) const {
  return std::ranges::any_of(entry.bases, [&](const std::string& base) {
    const Class* known = find_class(base, outer_part(entry.name));
    return known == nullptr ? !table_.has_class(base) : has_unknown_base(*known);
  });
}

bool NameLookup::is_node_class(const std::string& of_class) const {
  return api_base(of_class) == "rclcpp::Node";
}

bool NameLookup::is_known_type(const std::string& type, const std::string& scope) const {
  return type.empty() || is_plain_type(type) || table_.has_class(type) || is_message_type(type) ||
         find_class(type, scope) != nullptr;
}

bool NameLookup::takes(const Function& function, std::size_t count) {
  std::size_t least = 0;
  for (const auto& value : function.defaults) least += value.empty() ? 1 : 0;
  return count >= least && count <= function.parameters.size();
}

bool NameLookup::is_elsewhere(const std::string& full_name) const {
  return without_body_.contains(full_name);
}

std::vector<int> NameLookup::all_methods(const Class& entry, const std::string& name) const {
  std::vector<int> found;
  const auto [first, last] = by_name_.equal_range(name);
  for (auto next = first; next != last; ++next) {
    if (sources_.functions[static_cast<std::size_t>(next->second)].of_class == entry.name) {
      found.push_back(next->second);
    }
  }
  return found;
}

// A name in a derived class hides those of its bases, unless `using` brings them back: so where
// both have one that fits and the base's is not virtual, nobody knows.
Overloads NameLookup::methods(const Class& entry, const std::string& name,
                              std::size_t count) const {
  Overloads found;
  for (const int method : all_methods(entry, name)) {
    if (takes(sources_.functions[static_cast<std::size_t>(method)], count)) {
      found.bodies.push_back(method);
    }
  }
  found.may_be_elsewhere = is_elsewhere(entry.name + "::" + name);
  const bool is_own = entry.declared.contains(name) || !found.bodies.empty();
  for (const std::string& base : entry.bases) {
    const Class* known = find_class(base, outer_part(entry.name));
    if (known == nullptr || known == &entry) continue;
    const Overloads inherited = methods(*known, name, count);
    if (!is_own) {
      found.bodies.insert(found.bodies.end(), inherited.bodies.begin(), inherited.bodies.end());
      found.may_be_elsewhere = found.may_be_elsewhere || inherited.may_be_elsewhere;
    } else if (std::ranges::any_of(inherited.bodies, [&](int method) {
                 return !sources_.functions[static_cast<std::size_t>(method)].is_virtual;
               })) {
      found.may_be_elsewhere = true;
    }
  }
  return found;
}

Overloads NameLookup::constructors(const Class& entry, std::size_t count) const {
  Overloads found;
  const std::string name = last_part(entry.name);
  for (const int method : all_methods(entry, name)) {
    if (takes(sources_.functions[static_cast<std::size_t>(method)], count)) {
      found.bodies.push_back(method);
    }
  }
  found.may_be_elsewhere = is_elsewhere(entry.name + "::" + name);
  return found;
}

Overloads NameLookup::free_functions(const std::string& name, const std::string& scope,
                                     std::size_t count) const {
  Overloads found;
  const std::vector<std::string> scopes = scopes_around(scope);
  std::size_t all = 0;
  const auto [first, last] = by_name_.equal_range(last_part(name));
  for (auto next = first; next != last; ++next) {
    const Function& function = sources_.functions[static_cast<std::size_t>(next->second)];
    const bool is_free = function.of_class.empty() || function.is_static;
    if (!is_free || !takes(function, count)) continue;
    ++all;
    const bool is_seen = std::ranges::any_of(scopes, [&](const std::string& around) {
      return function.full_name() == (around.empty() ? name : around + "::" + name);
    });
    if (is_seen) found.bodies.push_back(next->second);
  }
  for (const std::string& around : scopes) {
    found.may_be_elsewhere =
        found.may_be_elsewhere || is_elsewhere(around.empty() ? name : around + "::" + name);
  }
  // Arguments may bring further ones, of their own namespaces.
  if (name.find("::") == std::string::npos && all > found.bodies.size()) {
    found.may_be_elsewhere = true;
  }
  return found;
}

}  // namespace maide::extract
