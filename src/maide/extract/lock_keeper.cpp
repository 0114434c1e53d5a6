#include "maide/extract/lock_keeper.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/call_walker.hpp"
#include "maide/extract/expression_walker.hpp"
#include "maide/extract/object_maker.hpp"
#include "maide/extract/type_names.hpp"

namespace maide::extract {

bool LockKeeper::is_guard(const std::string& type) {
  return type == "std::lock_guard" || type == "std::unique_lock" || type == "std::scoped_lock";
}

bool LockKeeper::makes(const std::string& of_class) {
  return of_class == "std::mutex" || of_class == "std::recursive_mutex" ||
         of_class == "std::condition_variable" || of_class == "std::condition_variable_any";
}

bool LockKeeper::knows(const std::string& word) {
  static const std::set<std::string> words{"lock",    "unlock",   "trylock",    "cv_wait",
                                           "cv_time", "cv_until", "notify_one", "notify_all"};
  return words.contains(word);
}

bool LockKeeper::is_mutex(const Value& value) {
  return value.kind == Value::Kind::entity && walk_.entity(value.index).kind == Entity::Kind::mutex;
}

Value LockKeeper::make(const std::string& of_class, const std::vector<Value>& arguments,
                       const Place& place, const std::string& hint) {
  const bool is_mutex = of_class.ends_with("mutex");
  if (!arguments.empty()) writer_.hole(place, "a lock that is made of another", true);
  if (writer_.phase() != Phase::start || writer_.is_conditional()) {
    writer_.hole(place, "a lock that is made later", true);
    return unknown_value();
  }
  Entity entity;
  entity.kind = is_mutex ? Entity::Kind::mutex : Entity::Kind::condition;
  entity.is_reentrant = of_class == "std::recursive_mutex";
  entity.place = place;
  entity.label =
      walk_.objects->label_of(hint.empty() ? (is_mutex ? "mutex" : "condition") : hint, "lock");
  return walk_.objects->make_entity(std::move(entity), of_class);
}

void LockKeeper::lock(const Value& of, const Place& place) {
  writer_.emit(walk_.entity(of.index).label + ".lock;", place);
}

void LockKeeper::unlock(const Value& of, const Place& place) {
  writer_.emit(walk_.entity(of.index).label + ".unlock;", place);
}

// A guard of its own right gives back at the end of its scope what it has then. It has a variable
// of the program for that, for it may be given back and taken again before.
void LockKeeper::declare_guard(const Statement& declaration, const std::string& type) {
  const Place& place = declaration.place;
  const bool is_unique = type == "std::unique_lock";
  const std::vector<Value> arguments =
      walk_.expressions->evaluate_all(declaration.expressions, place);
  const std::string policy =
      arguments.size() == 2 ? last_part(declaration.expressions[1].text) : "";
  const bool is_known = !arguments.empty() && is_mutex(arguments[0]) && !declaration.is_set &&
                        (arguments.size() == 1 || (is_unique && policy == "defer_lock") ||
                         (arguments.size() == 2 && policy == "adopt_lock"));
  if (!is_known) return writer_.hole(place, "a lock of what is not known", true);
  const Value& mutex = arguments[0];
  const std::string held = writer_.fresh("h");
  writer_.set(held, policy == "defer_lock" ? "false" : "true");
  if (policy.empty()) lock(mutex, place);
  Value guard = mutex;
  guard.type = type;
  guard.text = held;
  guard.program = writer_.program();
  walk_.values.declare(declaration.variable, guard);
  if (!is_unique) {
    return writer_.at_scope_end([this, mutex, place] { unlock(mutex, place); });
  }
  writer_.at_scope_end([this, mutex, held, place] {
    writer_.branch_on(held, place, [&] { unlock(mutex, place); });
  });
}

Value LockKeeper::apply(const std::string& word, const Expression& call, const Value& self,
                        const std::vector<Value>& arguments) {
  const bool is_condition =
      self.kind == Value::Kind::entity && walk_.entity(self.index).kind == Entity::Kind::condition;
  if (word.starts_with("cv_") || word.starts_with("notify")) {
    if (!is_condition) {
      writer_.hole(call.place, "a condition variable that is not known", any_matters(arguments));
      return unknown_value();
    }
    if (word.starts_with("cv_")) return wait(word, call, self, arguments);
    // Of a condition at which nobody waits nothing is heard; write_system() leaves it out.
    writer_.emit(walk_.entity(self.index).label + "." + word + ";", call.place);
    return {};
  }
  const bool is_guard = self.type == "std::unique_lock";
  const bool is_strange = is_guard && self.program != writer_.program();
  if (!is_mutex(self) || word == "trylock" || is_strange) {
    writer_.hole(call.place, "a lock that is not known", self.matters());
    return unknown_value();
  }
  word == "lock" ? lock(self, call.place) : unlock(self, call.place);
  if (is_guard) writer_.set(self.text, word == "lock" ? "true" : "false");
  return {};
}

// ---- Condition variables ----

void LockKeeper::wait_once(const std::string& label, bool is_timed, const std::string& timed_out,
                           const Place& place) {
  if (!is_timed) return writer_.emit(label + ".wait;", place);
  Code code;
  code.kind = Code::Kind::timed;
  code.text = label + ".wait timeout 1000";
  code.place = place;
  code.arms.push_back({"", {}});
  code.arms[0].code.push_back({Code::Kind::set, timed_out, "true", {}, {}});
  writer_.append(std::move(code));
}

// wait(lock), wait(lock, predicate), wait_for(lock, time), wait_for(lock, time, predicate).
Value LockKeeper::wait(const std::string& word, const Expression& call, const Value& condition,
                       const std::vector<Value>& arguments) {
  const bool is_timed = word != "cv_wait";
  const bool is_known = !arguments.empty() && is_mutex(arguments[0]) &&
                        arguments[0].type == "std::unique_lock" &&
                        arguments[0].program == writer_.program();
  Entity& entity = walk_.entity(condition.index);
  const bool is_other =
      is_known && entity.group_entity != none && entity.group_entity != arguments[0].index;
  if (!is_known || is_other) {
    writer_.hole(call.place, "a wait with a lock that is not known", any_matters(arguments));
    return unknown_value();
  }
  entity.group_entity = arguments[0].index;
  const std::string label = entity.label;
  const std::size_t predicate_at = is_timed ? 2 : 1;
  const std::string timed_out = writer_.fresh("s");
  writer_.set(timed_out, "false");
  Value result;
  result.program = writer_.program();
  if (arguments.size() <= predicate_at) {
    wait_once(label, is_timed, timed_out, call.place);
    return result;
  }
  wait_until(label, arguments[predicate_at], is_timed, timed_out, call.place);
  return result;
}

void LockKeeper::wait_until(const std::string& label, const Value& predicate, bool is_timed,
                            const std::string& timed_out, const Place& place) {
  // while (!predicate()) { wait; if it took too long: the predicate once more, and out }
  Code loop;
  loop.kind = Code::Kind::loop;
  loop.place = place;
  loop.arms.resize(1);
  writer_.enter_condition();
  loop.arms[0].code = writer_.aside([&] {
    const CodeWriter::Scope scope(writer_);
    const Value holds = walk_.calls->call_value(predicate, {}, place);
    const auto leave = [&] {
      Code out;
      out.kind = Code::Kind::leave;
      writer_.append(std::move(out));
    };
    writer_.branch_on(holds.condition == "false" ? "" : holds.condition, place, leave);
    writer_.branch_on(timed_out, place, leave);
    wait_once(label, is_timed, timed_out, place);
  });
  writer_.leave_condition();
  writer_.append(std::move(loop));
}

}  // namespace maide::extract
