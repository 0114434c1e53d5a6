// Ends of nodes: publishers, subscriptions, services, clients, timers and callback groups, with
// their names, depths, groups and callbacks. What is no constant is a hole.
#pragma once

#include <string>
#include <vector>

#include "maide/extract/walk.hpp"

namespace maide::extract {

class EndMaker {
 public:
  explicit EndMaker(Walk& walk) : walk_(walk), writer_(walk.writer) {}

  static bool knows(const std::string& word);
  Value make(const std::string& word, const Expression& call, const Value& self,
             const std::vector<Value>& arguments);

  // Of an object of a library that has one: `NAME DEPTH [kept]`, and the node among its arguments.
  Value make_publisher(const std::string& what, const std::string& of_class,
                       const std::vector<Value>& arguments, const Place& place);

 private:
  // What a call has at this place; `nothing` where it has no such argument.
  struct Given {
    const Expression* expression = nullptr;
    Value value;
  };
  static Given at(const Expression& call, const std::vector<Value>& arguments, std::size_t place);
  int find_made_here(const Entity& entity) const;
  Value known_client(int index) const;
  void read_arguments(Entity& entity, const std::string& word, const Expression& call,
                      const std::vector<Value>& arguments);
  void set_quality(Entity& entity, const Given& quality);
  void set_callback(Entity& entity, const Given& callback);
  void set_group(Entity& entity, const Given& group);
  void set_options(Entity& entity, const Given& options);
  void refuse_more(const Expression& call, const std::vector<Value>& arguments, std::size_t most);
  void set_kind_of_group(Entity& entity, const Expression& call,
                         const std::vector<Value>& arguments);
  std::string resolve(const std::string& name, int node) const;
  std::string label_for(const Entity& entity, const std::string& word) const;

  Walk& walk_;
  CodeWriter& writer_;
};

}  // namespace maide::extract
