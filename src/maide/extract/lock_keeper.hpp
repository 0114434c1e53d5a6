// Mutexes, their guards, and condition variables.
#pragma once

#include <string>
#include <vector>

#include "maide/extract/walk.hpp"

namespace maide::extract {

class LockKeeper {
 public:
  explicit LockKeeper(Walk& walk) : walk_(walk), writer_(walk.writer) {}

  // std::lock_guard, std::unique_lock, std::scoped_lock.
  static bool is_guard(const std::string& type);
  // `std::lock_guard<std::mutex> guard(mutex_);`
  void declare_guard(const Statement& declaration, const std::string& type);

  static bool makes(const std::string& of_class);
  Value make(const std::string& of_class, const std::vector<Value>& arguments, const Place& place,
             const std::string& hint);
  static bool knows(const std::string& word);
  Value apply(const std::string& word, const Expression& call, const Value& self,
              const std::vector<Value>& arguments);

 private:
  void lock(const Value& of, const Place& place);
  void unlock(const Value& of, const Place& place);
  Value wait(const std::string& word, const Expression& call, const Value& condition,
             const std::vector<Value>& arguments);
  void wait_until(const std::string& label, const Value& predicate, bool is_timed,
                  const std::string& timed_out, const Place& place);
  void wait_once(const std::string& label, bool is_timed, const std::string& timed_out,
                 const Place& place);
  bool is_mutex(const Value& value);

  Walk& walk_;
  CodeWriter& writer_;
};

}  // namespace maide::extract
