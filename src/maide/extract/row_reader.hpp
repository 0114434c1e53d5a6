// What rows of the tables mean: who does what a word says.
#pragma once

#include <string>
#include <vector>

#include "maide/extract/communication.hpp"
#include "maide/extract/end_maker.hpp"
#include "maide/extract/executor_spins.hpp"
#include "maide/extract/lock_keeper.hpp"
#include "maide/extract/walk.hpp"

namespace maide::extract {

class RowReader {
 public:
  explicit RowReader(Walk& walk)
      : walk_(walk),
        writer_(walk.writer),
        ends_(walk),
        communication_(walk),
        locks_(walk),
        spins_(walk) {}

  // Evaluates the call's arguments, and does what the row says.
  Value apply(const ApiRow& row, const Expression& call, const Value& self);
  // Whether an object of this class of a library is followed, and one of it.
  static bool makes(const std::string& of_class);
  Value make(const std::string& of_class, const std::vector<Value>& arguments, const Place& place,
             const std::string& hint);
  // An object of a class that has a row "()".
  Value construct(const ApiRow& row, const std::string& of_class,
                  const std::vector<Value>& arguments, const Place& place);
  LockKeeper& locks() { return locks_; }

 private:
  using Arguments = std::vector<Value>;
  Value inert(const ApiRow& row, const Expression& call, const Value& self,
              const Arguments& arguments);
  Value returned(const ApiRow& row, const Expression& call, const Value& self,
                 const Arguments& arguments) const;
  Value make_pointed(const Expression& call, Arguments arguments);
  Value bind(const Expression& call, const Arguments& arguments);
  Value watch(const ApiRow& row, const Expression& call, const Arguments& arguments);
  Value call_some(const Expression& call, const Arguments& arguments);
  Value shut_down(const Expression& call);
  Value refer(const Expression& call, const Arguments& arguments);
  Value take_out(const Expression& call, const Arguments& arguments);
  Value quality(const ApiRow& row, const Expression& call, const Value& self,
                const Arguments& arguments);

  Walk& walk_;
  CodeWriter& writer_;
  EndMaker ends_;
  Communication communication_;
  LockKeeper locks_;
  ExecutorSpins spins_;
};

}  // namespace maide::extract
