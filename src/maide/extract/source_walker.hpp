// Goes through functions as they would run, and gives what they do as programs.
//
// Each call is inlined, a row of a table, or a hole (call_walker.hpp, row_reader.hpp); each
// statement and expression that has no rule is a hole, too.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/call_walker.hpp"
#include "maide/extract/expression_walker.hpp"
#include "maide/extract/object_maker.hpp"
#include "maide/extract/row_reader.hpp"
#include "maide/extract/statement_walker.hpp"
#include "maide/extract/walk.hpp"

namespace maide::extract {

class SourceWalker {
 public:
  // `mixed`: fields and variables that turned out to have several values, for the next pass.
  SourceWalker(const Sources& sources, const ApiTable& table, Model& model,
               std::set<std::string>& mixed);
  SourceWalker(const SourceWalker&) = delete;
  SourceWalker& operator=(const SourceWalker&) = delete;

  // Global variables and static members get their first values.
  void make_globals();
  // Calls it, and gives the program that this is. `node`: whose code it is; none: main's.
  Program run(const Value& callable, const std::vector<Value>& arguments, Phase phase, int node);
  // Makes an object of the class, with what is not known as arguments. What its constructor does
  // is in its node, if it is one.
  Program make_alone(const Class& entry);
  bool was_read(int function) const { return walk_.read.contains(function); }
  // Functions that were gone through: a walk that is thrown away is none.
  const std::set<int>& read_functions() const { return walk_.read; }
  void restore_read_functions(std::set<int> read) { walk_.read = std::move(read); }
  const NameLookup& names() const { return walk_.names; }
  // Of the last run(): whether it was a main that spins for ever.
  bool take_main_is_over() { return std::exchange(main_is_over_, false); }
  // The executor that main spun, and the nodes whose ends it used; both are forgotten then.
  int take_main_executor() { return std::exchange(walk_.main_executor, none); }
  std::set<int> take_main_uses() { return std::exchange(walk_.main_uses, {}); }

 private:
  Walk walk_;
  bool main_is_over_ = false;
  ExpressionWalker expressions_;
  StatementWalker statements_;
  CallWalker calls_;
  ObjectMaker objects_;
  RowReader rows_;
};

}  // namespace maide::extract
