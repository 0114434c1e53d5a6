#include "maide/extract/communication.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace maide::extract {
namespace {

// Whether both are the same function with the same things around it.
bool is_same_callable(const Value& one, const Value& other) {
  if (one.kind != other.kind || one.index != other.index) return false;
  if (one.kind != Value::Kind::callable) return true;
  const Callable& a = *one.callable;
  const Callable& b = *other.callable;
  if (a.function != b.function || a.self.index != b.self.index ||
      a.bound.size() != b.bound.size()) {
    return false;
  }
  for (std::size_t i = 0; i < a.bound.size(); ++i) {
    if (!is_same_callable(a.bound[i].value, b.bound[i].value)) return false;
  }
  const Frame* around = a.frame.get();
  const Frame* other_around = b.frame.get();
  for (; around != nullptr && other_around != nullptr && around != other_around;
       around = around->outer.get(), other_around = other_around->outer.get()) {
    if (around->values.size() != other_around->values.size()) return false;
    for (const auto& [variable, value] : around->values) {
      const auto same = other_around->values.find(variable);
      if (same == other_around->values.end() || value.kind != same->second.kind) return false;
      const bool is_followed = value.matters() && value.kind != Value::Kind::future;
      if (is_followed && !is_same_callable(value, same->second)) return false;
    }
  }
  return around == other_around;
}

constexpr std::size_t most_callbacks = 8;  // of one client

}  // namespace

// Ends of this node alone; main has those of the nodes that it spins.
bool Communication::is_usable(const Entity& entity) const {
  return writer_.node() == none || entity.node == writer_.node();
}

Value Communication::apply(const std::string& word, const Expression& call, const Value& self,
                           const std::vector<Value>& arguments) {
  static const std::map<std::string, Entity::Kind> kinds{{"publish", Entity::Kind::publisher},
                                                         {"send", Entity::Kind::client},
                                                         {"there", Entity::Kind::client},
                                                         {"cancel", Entity::Kind::timer},
                                                         {"reset", Entity::Kind::timer}};
  if (word == "get" || word == "wait" || word == "wait_for") return wait(word, call, self);
  const auto kind = kinds.find(word);
  const bool is_known = kind != kinds.end() && self.kind == Value::Kind::entity &&
                        walk_.entity(self.index).kind == kind->second;
  if (!is_known) {
    std::vector<Value> all = arguments;
    all.push_back(self);
    writer_.hole(call.place, word + " of what is not known", any_matters(all));
    return unknown_value();
  }
  Entity& entity = walk_.entity(self.index);
  if (!is_usable(entity)) {
    writer_.hole(call.place, word + " at an end of another node", true);
    return unknown_value();
  }
  if (writer_.node() == none && !writer_.is_silent()) walk_.main_uses.insert(entity.node);
  if (word == "publish") return publish(entity, call);
  if (word == "there") return presence(entity, call, arguments);
  if (word == "send") return send(self.index, call, arguments);
  return set_timer(entity, word, call);
}

Value Communication::publish(Entity& entity, const Expression& call) {
  writer_.emit(entity.label + ".write;", call.place);
  return {};
}

// What waits shorter than no time waits for ever.
bool Communication::is_for_ever(const Value& time, const Place& place) {
  const Sign sign = sign_of(time);
  if (sign == Sign::unknown)
    writer_.note(place, "a time that may be negative, and then is for ever");
  return sign == Sign::negative;
}

// A wait of some time ends at any time. What is seen then is the value; it is kept, for a server
// may come later.
Value Communication::presence(Entity& entity, const Expression& call,
                              const std::vector<Value>& arguments) {
  entity.is_looked_for = true;
  const bool is_look = call.operands[0].text == "service_is_ready";
  const bool waits = !is_look && arguments.empty();
  const auto wait_for_ever = [&] {
    writer_.emit("wait " + entity.label + " -> there;", call.place);
  };
  Value value;
  value.program = writer_.program();
  if (waits) {
    wait_for_ever();
    value.condition = "true";
    return value;
  }
  if (!is_look && is_for_ever(arguments[0], call.place)) {
    wait_for_ever();
    value.condition = "true";
    return value;
  }
  const std::string seen = writer_.fresh("p");
  writer_.branch_on(
      entity.label + ".there", call.place, [&] { writer_.set(seen, "true"); },
      [&] { writer_.set(seen, "false"); });
  value.condition = seen;
  value.presence = is_look ? "" : entity.label;
  return value;
}

Value Communication::set_timer(Entity& entity, const std::string& word, const Expression& call) {
  if (writer_.node() == none) {
    writer_.hole(call.place, "a timer that main changes", true);
    return {};
  }
  const bool is_cancel = word == "cancel";
  entity.is_cancelled = true;
  writer_.emit(entity.label + "_on = " + (is_cancel ? "false;" : "true;"), call.place);
  return {};
}

void Communication::add_callback(Entity& entity, const Expression& call, const Value& callback) {
  if (callback.kind != Value::Kind::callable) {
    writer_.hole(call.place, "a callback that is not known", true);
    return;
  }
  const bool is_there = std::ranges::any_of(
      entity.callbacks, [&](const Value& other) { return is_same_callable(other, callback); });
  if (is_there) return;
  if (entity.callbacks.size() < most_callbacks) {
    entity.callbacks.push_back(callback);
  } else {
    writer_.hole(call.place, "a client with too many callbacks", true);
  }
}

Value Communication::send(int client, const Expression& call, const std::vector<Value>& arguments) {
  Entity& entity = walk_.entity(client);
  std::vector<Value> rest(arguments.begin() + (arguments.empty() ? 0 : 1), arguments.end());
  if (!arguments.empty() && arguments[0].matters()) {
    writer_.hole(call.place, "an end is given to a request", true);
  }
  if (rest.size() > 1) writer_.hole(call.place, "arguments that are not followed", true);
  if (rest.empty()) {
    entity.is_asked_without = true;
  } else {
    add_callback(entity, call, rest[0]);
  }
  for (const auto& [other, sent] : futures_) {  // they are of older requests from here on
    if (sent.client != client || sent.program != writer_.program()) continue;
    const std::string name = "f_" + std::to_string(other);
    writer_.branch_on(name + " == pending", call.place, [&] { writer_.set(name, "old"); });
  }
  Value future;
  future.kind = Value::Kind::future;
  future.type = "std::future";
  future.program = writer_.program();
  future.index = next_future_++;
  const std::string name = variable_of(future);
  writer_.declare(name, {"none", "pending", "ready", "old"});
  writer_.emit(entity.label + ".send;", call.place);
  writer_.set(name, "pending");
  futures_[future.index] = {client, writer_.program()};
  return future;
}

// ---- Futures ----

Value Communication::forget(const Expression& call, const Value& self,
                            const std::vector<Value>& arguments) {
  const bool is_client = self.kind == Value::Kind::entity;
  const auto sent = arguments.empty() ? futures_.end() : futures_.find(arguments[0].index);
  const bool is_own = is_client && !arguments.empty() && arguments[0].kind == Value::Kind::future &&
                      sent != futures_.end() && sent->second.program == writer_.program() &&
                      walk_.entity(self.index).callbacks.empty();
  if (is_own) {
    sent->second.is_given_up = true;
    writer_.set(variable_of(arguments[0]), "none");
  } else {
    writer_.hole(call.place, "a request that is given up", false);
  }
  return {};
}

int Communication::client_of_last(const Value& future, const Place& place) {
  const auto found = futures_.find(future.index);
  const bool is_own = future.kind == Value::Kind::future && found != futures_.end() &&
                      found->second.program == writer_.program();
  if (!is_own) {
    writer_.hole(place, "a wait for a future that is not known", false);
    return none;
  }
  // A future is known only where its request was sent on every way, so it is none here. Another
  // request may have come since.
  const std::string name = variable_of(future);
  const auto others = std::ranges::count_if(futures_, [&](const auto& other) {
    return other.second.client == found->second.client && other.second.program == writer_.program();
  });
  if (found->second.is_given_up) {  // it throws std::future_error
    writer_.branch_on(name + " == none", place, [&] { writer_.raise(writer_.throw_flag()); });
  }
  if (others > 1) {
    writer_.branch_on(name + " == none || " + name + " == old", place, [&] {
      writer_.hole(place, "a future whose request is not the last", false);
    });
  }
  return found->second.client;
}

Value Communication::wait(const std::string& word, const Expression& call, const Value& self) {
  const bool is_in_callback = self.type == "ready future";
  if (is_in_callback && word != "wait_for") return data_value("message");
  if (is_in_callback) {
    Value ready;
    ready.kind = Value::Kind::status;
    ready.condition = "true";
    return ready;
  }
  const int client = client_of_last(self, call.place);
  Value value = data_value("message");
  if (client == none) return value;
  const std::string name = variable_of(self);
  const std::string label = walk_.entity(client).label;
  if (word == "wait_for") return wait_for(name, label, call.place);
  writer_.branch_on(name + " == pending", call.place, [&] {
    writer_.emit("wait " + label + " -> answer;", call.place);
    writer_.set(name, "ready");
  });
  return value;
}

Value Communication::wait_for(const std::string& future, const std::string& label,
                              const Place& place) {
  const std::string status = writer_.fresh("s");
  writer_.set(status, "true");
  writer_.branch_on(future + " == pending", place, [&] {
    Code code;
    code.kind = Code::Kind::select;
    code.place = place;
    code.arms.push_back({"on " + label + "!answer", {}});
    code.arms.push_back({"timeout 1000", {}});
    code.arms[0].code.push_back({Code::Kind::set, future, "ready", {}, {}});
    code.arms[1].code.push_back({Code::Kind::set, status, "false", {}, {}});
    writer_.append(std::move(code));
  });
  return status_value(status, writer_.program());
}

}  // namespace maide::extract
