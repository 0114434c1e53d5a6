#include "maide/extract/executor_spins.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/expression_walker.hpp"
#include "maide/extract/object_maker.hpp"
#include "maide/extract/type_names.hpp"

namespace maide::extract {
namespace {

const std::string single_executor = "rclcpp::executors::SingleThreadedExecutor";
const std::string multi_executor = "rclcpp::executors::MultiThreadedExecutor";

}  // namespace

bool ExecutorSpins::makes(const std::string& of_class) {
  return of_class == single_executor || of_class == multi_executor || of_class == "std::thread";
}

bool ExecutorSpins::knows(const std::string& word) {
  static const std::set<std::string> words{"spin",     "spin_some",  "spin_once", "spin_all",
                                           "add_node", "spin_until", "join"};
  return words.contains(word);
}

int ExecutorSpins::add_executor(bool is_multi, const std::string& threads, const Place& place) {
  Executor executor;
  executor.label = "executor_" + std::to_string(walk_.model.executors.size());
  executor.is_multi = is_multi;
  executor.threads = threads;
  executor.place = place;
  walk_.model.executors.push_back(std::move(executor));
  return static_cast<int>(walk_.model.executors.size()) - 1;
}

Value ExecutorSpins::make(const std::string& of_class, const std::vector<Value>& arguments,
                          const Place& place, const std::string& hint) {
  if (of_class == "std::thread") return make_thread(arguments, place, hint);
  const bool is_multi = of_class == multi_executor;
  std::string threads;
  if (arguments.size() == 2 && arguments[1].kind == Value::Kind::number) {
    threads = arguments[1].text;
  }
  const bool is_known = arguments.empty() || (arguments.size() == 1 && !any_matters(arguments)) ||
                        (arguments.size() == 2 && !threads.empty() && threads.size() == 1);
  if (!is_known || (arguments.size() == 2 && !is_multi)) {
    writer_.hole(place, "an executor of a number of threads that is not known", true);
  }
  if (writer_.phase() != Phase::start || writer_.node() != none || writer_.is_conditional()) {
    writer_.hole(place, "an executor that is made elsewhere than in main", true);
    return unknown_value();
  }
  Entity entity;
  entity.kind = Entity::Kind::executor;
  entity.label = walk_.objects->label_of(hint.empty() ? "executor" : hint, "executor");
  entity.group_entity = add_executor(is_multi, threads == "0" ? "" : threads, place);
  entity.place = place;
  return walk_.objects->make_entity(std::move(entity), of_class);
}

void ExecutorSpins::add_node(const Expression& call, const Value& self,
                             const Arguments& arguments) {
  const int node = arguments.empty() ? none : walk_.node_of(arguments[0]);
  const bool is_executor =
      self.kind == Value::Kind::entity && walk_.entity(self.index).kind == Entity::Kind::executor;
  if (node == none || !is_executor || writer_.is_conditional() || writer_.phase() != Phase::start) {
    return writer_.hole(call.place, "a node or executor that is not known, or added later", true);
  }
  if (writer_.is_silent()) return;
  const int executor = walk_.entity(self.index).group_entity;
  walk_.model.executors[static_cast<std::size_t>(executor)].nodes.push_back(node);
  if (writer_.has_begun()) {
    writer_.hole(call.place, "main communicates before it adds this node", false);
  }
}

int ExecutorSpins::spun(const Expression& call, const Value& self, const Arguments& arguments) {
  if (self.kind == Value::Kind::entity && walk_.entity(self.index).kind == Entity::Kind::executor) {
    return walk_.entity(self.index).group_entity;
  }
  const int node = arguments.empty() ? none : walk_.node_of(arguments[0]);
  if (self.matters() || node == none) {
    writer_.hole(call.place, "a spin of what is not known", any_matters(arguments));
    return none;
  }
  walk_.values.keep(arguments[0], ValueStore::for_ever);
  // rclcpp::spin(node): an executor of its own, the same each time.
  for (std::size_t i = 0; i < walk_.model.executors.size(); ++i) {
    const std::vector<int>& nodes = walk_.model.executors[i].nodes;
    if (nodes.size() == 1 && nodes[0] == node) return static_cast<int>(i);
  }
  const int executor = add_executor(false, "", call.place);
  walk_.model.executors[static_cast<std::size_t>(executor)].nodes.push_back(node);
  return executor;
}

// main is the program of one executor, and its code stands there.
bool ExecutorSpins::enter_main(int executor, const Place& place) {
  const bool is_main = writer_.phase() == Phase::start && writer_.node() == none;
  const bool is_other = walk_.main_executor != none && walk_.main_executor != executor;
  if (!is_main || is_other) {
    writer_.hole(place, is_other ? "main spins several executors" : "a spin outside of main", true);
    return false;
  }
  walk_.main_executor = executor;
  walk_.values.others_run = true;
  walk_.model.executors[static_cast<std::size_t>(executor)].is_spun = true;
  return true;
}

Value ExecutorSpins::spin(const std::string& word, const Expression& call, const Value& self,
                          const Arguments& arguments, Communication& communication) {
  const int executor = spun(call, self, arguments);
  if (executor == none || !enter_main(executor, call.place)) return unknown_value();
  if (word == "spin") {
    writer_.emit("spin;", call.place);
    walk_.end_main();  // ok() is true: it never returns
    return {};
  }
  const bool is_free = self.kind != Value::Kind::entity;
  const bool has_time = arguments.size() > (is_free ? 1U : 0U);
  if (word == "spin_once" && has_time &&
      !communication.is_for_ever(arguments[is_free ? 1U : 0U], call.place)) {
    Code code;
    code.kind = Code::Kind::timed;
    code.text = "spin once timeout 1000";
    code.place = call.place;
    code.arms.push_back({"", {}});
    writer_.append(std::move(code));
    return {};
  }
  const std::string kind = word.substr(5);
  writer_.emit("spin " + kind + ";", call.place);
  return {};
}

// spin_until_future_complete([node,] future [, time]).
Value ExecutorSpins::spin_until(const Expression& call, const Value& self,
                                const Arguments& arguments, Communication& communication) {
  const bool is_free = self.kind != Value::Kind::entity;
  const std::size_t future_at = is_free ? 1 : 0;
  if (arguments.size() <= future_at) {
    writer_.hole(call.place, "a spin of what is not known", any_matters(arguments));
    return unknown_value();
  }
  const bool is_node_start = writer_.phase() == Phase::start && writer_.node() != none;
  const bool is_own = is_free && walk_.node_of(arguments[0]) == writer_.node();
  if (writer_.phase() == Phase::start && !is_node_start) {
    const int executor = spun(call, self, arguments);
    if (executor == none || !enter_main(executor, call.place)) return unknown_value();
  } else if (!is_own) {
    writer_.hole(call.place, "a spin of what is not known", true);
    return unknown_value();
  }
  walk_.values.others_run = true;
  const int client = communication.client_of_last(arguments[future_at], call.place);
  if (client == none) return unknown_value();
  const std::string future = Communication::variable_of(arguments[future_at]);
  const std::string head = "spin until " + walk_.entity(client).label + " -> answer";
  const std::string status = writer_.fresh("s");
  writer_.set(status, "true");
  const bool has_time = arguments.size() > future_at + 1 &&
                        !communication.is_for_ever(arguments[future_at + 1], call.place);
  writer_.branch_on(future + " == pending", call.place, [&] {
    if (!has_time) {
      writer_.emit(head + ";", call.place);
      return writer_.set(future, "ready");
    }
    Code code;
    code.kind = Code::Kind::timed;
    code.text = head + " timeout 1000";
    code.place = call.place;
    code.arms.push_back({"", {}});
    code.arms[0].code.push_back({Code::Kind::set, status, "false", {}, {}});
    writer_.append(std::move(code));
    writer_.branch_on(status, call.place, [&] { writer_.set(future, "ready"); });
  });
  return status_value(status, writer_.program());
}

Value ExecutorSpins::apply(const std::string& word, const Expression& call, const Value& self,
                           const std::vector<Value>& arguments, Communication& communication) {
  if (word == "add_node") {
    add_node(call, self, arguments);
    return {};
  }
  if (word == "join") return join(call, self);
  if (word == "spin_until") return spin_until(call, self, arguments, communication);
  return spin(word, call, self, arguments, communication);
}

// ---- Threads ----

Value ExecutorSpins::make_thread(const Arguments& arguments, const Place& place,
                                 const std::string& hint) {
  Value value;
  if (arguments.empty()) {
    value.kind = Value::Kind::null;
    value.type = "std::thread";
    return value;
  }
  const bool is_node_start = writer_.phase() == Phase::start && writer_.node() != none;
  Value function = arguments[0];
  std::size_t first = 1;
  const bool is_method = function.kind == Value::Kind::callable && arguments.size() > 1 &&
                         arguments[1].kind == Value::Kind::object &&
                         !walk_.function(function.callable->function).of_class.empty() &&
                         !walk_.function(function.callable->function).is_lambda;
  if (is_method) {
    function.callable = std::make_shared<Callable>(*function.callable);
    function.callable->self = arguments[1];
    first = 2;
  }
  if (!is_node_start || writer_.is_conditional() || function.kind != Value::Kind::callable) {
    writer_.hole(place, "a thread that is made elsewhere than in a node's constructor", true);
    return unknown_value();
  }
  Thread thread;
  thread.label = walk_.objects->label_of(hint.empty() ? "work" : hint, "thread");
  thread.node = writer_.node();
  thread.function = function;
  thread.arguments.assign(arguments.begin() + static_cast<std::ptrdiff_t>(first), arguments.end());
  thread.place = place;
  Entity entity;
  entity.kind = Entity::Kind::thread;
  entity.label = thread.label;
  entity.place = place;
  entity.group_entity = static_cast<int>(walk_.model.threads.size());
  entity.node = thread.node;
  writer_.emit("run " + thread.label + ";", place);
  walk_.model.threads.push_back(std::move(thread));
  walk_.values.others_run = true;
  return walk_.objects->make_entity(std::move(entity), "std::thread");
}

Value ExecutorSpins::join(const Expression& call, const Value& self) {
  const bool is_thread = self.kind == Value::Kind::entity &&
                         walk_.entity(self.index).kind == Entity::Kind::thread &&
                         walk_.entity(self.index).node == writer_.node();
  if (!is_thread) {
    writer_.hole(call.place, "a join of what is not known", self.matters());
    return {};
  }
  writer_.emit("join " + walk_.entity(self.index).label + ";", call.place);
  return {};
}

}  // namespace maide::extract
