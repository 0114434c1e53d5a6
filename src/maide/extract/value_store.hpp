// What variables are worth while functions are walked through: those of activations, of objects,
// and globals.
//
// Only what matters is kept: ends, objects, functions, futures, and constants. A variable is known
// as long as one thing was put into it, once, on every way. One that is set in a loop, under a
// condition, in a callback or through something that is not followed has any value.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "maide/extract/code_writer.hpp"
#include "maide/extract/model.hpp"
#include "maide/extract/sources.hpp"

namespace maide::extract {

// Where a value is kept.
struct Slot {
  enum class Kind : std::uint8_t { nowhere, variable, field } kind = Kind::nowhere;
  int variable = none, object = none;
  std::string name;
  bool is_through_reference = false;
};

class ValueStore {
 public:
  // `mixed` is filled with what turns out to have several values, and used by the next pass.
  ValueStore(const Sources& sources, Model& model, CodeWriter& writer, std::set<std::string>& mixed)
      : sources_(sources), model_(model), writer_(writer), mixed_(mixed) {}

  Frame& frame() { return *frame_; }
  const std::shared_ptr<Frame>& shared_frame() const { return frame_; }
  std::shared_ptr<Frame> enter(std::shared_ptr<Frame> frame) {
    return std::exchange(frame_, std::move(frame));
  }

  Slot slot_of(const Variable& variable, int index) const;
  // The key of the field that this name means in the object.
  std::string field_of(int object, const std::string& name, int variable) const;
  Value read(const Slot& slot);
  // `name`: of a member of the object's class or its bases; `variable`: that member, if it is
  // known.
  Value read_field(int object, const std::string& name, int variable);
  // A local variable, with its first value.
  void declare(int variable, Value value);
  void declare_global(int variable, Value value) {
    keep(value, for_ever);
    globals_[variable] = std::move(value);
  }
  bool has_global(int variable) const { return globals_.contains(variable); }
  void store(const Slot& slot, const Value& value, const Place& place);
  void set_field(int object, const Variable& member, Value value);
  // It may have been changed by somebody who is not followed: constants are none any more.
  void forget(const Slot& slot);
  // Whether a thread or a spin runs beside what is written now: it sees fields as they were, too.
  bool others_run = false;
  // An end or object has a holder, an object or what lives as long as main: it does not go with
  // its scope.
  void keep(const Value& value, int holder);
  static constexpr int for_ever = none;
  // Something else may change it from here on: a reference, a pointer. What it is worth is never
  // known then, before neither: other code may come later.
  void share(const Slot& slot);
  bool is_shared(int variable) const { return is_shared_key(key_of(variable)); }
  void forget_what_is_set_in(const Statement& loop);
  Value data_of(int variable) const;

 private:
  Value* local(int variable);
  void put(Value& kept, const Value& value, const std::string& key, const Place& place);
  void forget_constant(Value& kept, const std::string& key);
  bool is_end(const Value& value) const;
  void put_object(Value& kept, const Value& value, const Place& place);
  const Variable* find_member(const std::string& of_class, const std::string& name) const;
  bool is_shared_key(const std::string& key) const { return mixed_.contains("any " + key); }
  void store_local(Value& kept, const Value& value, const Place& place);
  std::string key_of(int object, const std::string& name) const {
    return model_.objects[static_cast<std::size_t>(object)].of_class + "." + name;
  }
  std::string key_of(int variable) const;
  Value& field(int object, const std::string& name) {
    return model_.objects[static_cast<std::size_t>(object)].fields[name];
  }

  const Sources& sources_;
  Model& model_;
  CodeWriter& writer_;
  std::set<std::string>& mixed_;
  std::shared_ptr<Frame> frame_ = std::make_shared<Frame>();
  std::map<int, Value> globals_;
};

}  // namespace maide::extract
