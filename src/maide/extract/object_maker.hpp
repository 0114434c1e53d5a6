// Objects, and the nodes among them: what constructors, member initialisers and first values do.
#pragma once

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
  // What a variable of this type becomes that is made from `value` by `=`: a copy of an object, an
  // object of the sources that its constructor makes of something else, or the value itself.
  Value converted(const std::string& type, Value value, const Place& place);
  // Of a class of the sources: who may change the arguments from `first` on is not followed.
  void share_arguments(const std::string& type, const std::vector<Expression>& given,
                       std::size_t first);
  // What a variable or member of this kind is worth at first.
  Value first_value(const Variable& variable, const std::vector<Expression>& expressions,
                    bool is_set, const Place& place);
  // Of a class of the sources, by its full name.
  Value make(const std::string& of_class, const Arguments& arguments, const Place& place);
  // A node of no class of its own.
  Value make_plain_node(const Arguments& arguments, const Place& place);
  // An object without fields.
  Value make_empty(const std::string& of_class);
  Value make_entity(Entity entity, const std::string& type);
  std::string label_of(const std::string& name, const std::string& stem) const;

 private:
  Value construct_known(const std::string& of_class, const Arguments& arguments, const Place& place,
                        const std::string& hint);
  void name_node(Node& node, const Arguments& arguments, const Place& place);
  void begin_node(Value& self, const std::string& name, const Place& place);
  void fill(const Value& self, const Class& entry, const Arguments& arguments, const Place& place);
  Value copy(const Value& value, const Place& place);
  void refuse_parts(const std::string& type, const Place& place);
  bool has_code(const std::string& type) const;
  void fill_in_order(const Value& self, const Class& entry, const Arguments& arguments,
                     const Place& place);
  void make_bases(const Value& self, const Class& entry, const Function* maker, const Place& place);
  void make_members(const Value& self, const Class& entry, const Function* maker);
  void initialise_api_base(const Value& self, const Class& entry, const Initialiser& initialiser);

  Walk& walk_;
  CodeWriter& writer_;
};

}  // namespace maide::extract
