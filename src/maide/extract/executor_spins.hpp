// Executors and who spins them; threads.
#pragma once

#include <string>
#include <vector>

#include "maide/extract/communication.hpp"
#include "maide/extract/walk.hpp"

namespace maide::extract {

class ExecutorSpins {
 public:
  explicit ExecutorSpins(Walk& walk) : walk_(walk), writer_(walk.writer) {}

  static bool makes(const std::string& of_class);
  Value make(const std::string& of_class, const std::vector<Value>& arguments, const Place& place,
             const std::string& hint);
  static bool knows(const std::string& word);
  Value apply(const std::string& word, const Expression& call, const Value& self,
              const std::vector<Value>& arguments, Communication& communication);

 private:
  using Arguments = std::vector<Value>;
  Value make_thread(const Arguments& arguments, const Place& place, const std::string& hint);
  int add_executor(bool is_multi, const std::string& threads, const Place& place);
  void add_node(const Expression& call, const Value& self, const Arguments& arguments);
  // The executor that a call spins; none, and a hole, where it is not known.
  int spun(const Expression& call, const Value& self, const Arguments& arguments);
  Value spin(const std::string& word, const Expression& call, const Value& self,
             const Arguments& arguments, Communication& communication);
  Value spin_until(const Expression& call, const Value& self, const Arguments& arguments,
                   Communication& communication);
  bool enter_main(int executor, const Place& place);
  Value join(const Expression& call, const Value& self);

  Walk& walk_;
  CodeWriter& writer_;
};

}  // namespace maide::extract
