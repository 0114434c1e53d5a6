// Sends, waits, futures and timers: what a node's code does with its ends.
//
// A future is a variable of the program of the values none, pending, ready and old. A wait for one
// that is not the last of its client cuts the run, for the language waits for the last request.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "maide/extract/walk.hpp"

namespace maide::extract {

class Communication {
 public:
  explicit Communication(Walk& walk) : walk_(walk), writer_(walk.writer) {}

  Value apply(const std::string& word, const Expression& call, const Value& self,
              const std::vector<Value>& arguments);
  // remove_pending_request(future): its answer comes to nobody.
  Value forget(const Expression& call, const Value& self, const std::vector<Value>& arguments);
  // Whether a wait of that time has no end; notes where that is not known.
  bool is_for_ever(const Value& time, const Place& place);
  // The client whose request this future is of, if the program that is being written sent it;
  // cuts the run where it may be of an older one.
  int client_of_last(const Value& future, const Place& place);
  static std::string variable_of(const Value& future) {
    return "f_" + std::to_string(future.index);
  }

 private:
  Value publish(Entity& entity, const Expression& call);
  Value presence(Entity& entity, const Expression& call, const std::vector<Value>& arguments);
  Value set_timer(Entity& entity, const std::string& word, const Expression& call);
  Value send(int client, const Expression& call, const std::vector<Value>& arguments);
  void add_callback(Entity& entity, const Expression& call, const Value& callback);
  Value wait(const std::string& word, const Expression& call, const Value& self);
  Value wait_for(const std::string& future, const std::string& label, const Place& place);
  bool is_usable(const Entity& entity) const;

  struct Sent {
    int client = none, program = 0;
    bool is_given_up = false;
  };
  Walk& walk_;
  CodeWriter& writer_;
  std::map<int, Sent> futures_;
  int next_future_ = 0;
};

}  // namespace maide::extract
