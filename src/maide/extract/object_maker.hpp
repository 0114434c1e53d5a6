// Objects, and the nodes among them: what constructors, member initialisers and first values do.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "maide/extract/walk.hpp"

namespace maide::extract {

class ObjectMaker {
 public:
  using Arguments = std::vector<Value>;
  explicit ObjectMaker(Walk& walk) : walk_(walk), writer_(walk.writer) {}

  // `hint`: the variable that it is for.
  Value construct(const std::string& type, Arguments arguments, const Place& place,
                  const std::string& hint);
  // Of a class of the sources, by its full name.
  Value make(const std::string& of_class, const Arguments& arguments, const Place& place);
  // A node of no class of its own.
  Value make_plain_node(const Arguments& arguments, const Place& place);
  Value make_entity(Entity entity, const std::string& type);
  std::string label_of(const std::string& name, const std::string& stem) const;

 private:
  Value construct_known(const std::string& of_class, const Arguments& arguments, const Place& place,
                        const std::string& hint);
  void begin_node(Value& self, const std::string& name, const Place& place);
  void fill(const Value& self, const Class& entry, const Arguments& arguments, const Place& place);
  void run_initialisers(const Value& self, const Class& entry, const Function& maker,
                        std::set<std::string>& initialised);
  void initialise_api_base(const Value& self, const Class& entry, const Initialiser& initialiser);
  void initialise_member(const Value& self, const Variable& member, std::vector<Value> values,
                         const Initialiser& initialiser);
  void default_members(const Value& self, const Class& entry,
                       const std::set<std::string>& initialised);

  Walk& walk_;
  CodeWriter& writer_;
};

}  // namespace maide::extract
