#include "maide/extract/row_reader.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/call_walker.hpp"
#include "maide/extract/expression_walker.hpp"
#include "maide/extract/finite_loop.hpp"
#include "maide/extract/object_maker.hpp"
#include "maide/extract/type_names.hpp"

namespace maide::extract {
namespace {

// `_1`, `std::placeholders::_2`: which argument of the call; none: no placeholder.
int placeholder_of(const Expression& expression) {
  const std::string word = last_part(expression.text);
  const bool is_one = expression.kind == Expression::Kind::name && word.size() == 2 &&
                      word[0] == '_' && word[1] >= '1' && word[1] <= '9';
  return is_one ? word[1] - '1' : none;
}

}  // namespace

Value RowReader::apply(const ApiRow& row, const Expression& call, const Value& self) {
  Arguments arguments;
  if (row.means == "log") {  // what is said only sometimes is worked out only then
    std::vector<Code> code = writer_.aside([&] {
      writer_.enter_condition();
      arguments = walk_.expressions->evaluate_all(call.operands, call.place, 1);
      writer_.leave_condition();
    });
    if (has_steps(code)) {
      Code branch;
      branch.kind = Code::Kind::branch;
      branch.text = "*";
      branch.place = call.place;
      branch.arms.resize(2);
      branch.arms[0].code = std::move(code);
      writer_.append(std::move(branch));
    }
    return inert(row, call, self, arguments);
  }
  arguments = walk_.expressions->evaluate_all(call.operands, call.place, 1);
  if (row.means == "inert") {
    Value value = inert(row, call, self, arguments);
    walk_.calls->forget_arguments(call);
    return value;
  }
  if (row.means == "ok") {
    Value value;
    value.condition = "true";
    return value;
  }
  if (row.means == "make" || row.means == "node") {
    Value made = row.means == "make" ? make_pointed(call, std::move(arguments))
                                     : walk_.objects->make_plain_node(arguments, call.place);
    made.is_pointer = true;
    return made;
  }
  if (row.means == "forget_request") return communication_.forget(call, self, arguments);
  if (row.means == "shutdown") return shut_down(call);
  if (row.means == "refer") return refer(call, arguments);
  if (row.means == "bind") return bind(call, arguments);
  if (row.means == "watch") return watch(row, call, arguments);
  if (row.means == "calls") return call_some(call, arguments);
  if (row.means == "take") return take_out(call, arguments);
  if (row.means == "qos") return quality(row, call, self, arguments);
  if (EndMaker::knows(row.means)) return ends_.make(row.means, call, self, arguments);
  if (LockKeeper::knows(row.means)) return locks_.apply(row.means, call, self, arguments);
  if (ExecutorSpins::knows(row.means)) {
    return spins_.apply(row.means, call, self, arguments, communication_);
  }
  return communication_.apply(row.means, call, self, arguments);
}

Value RowReader::inert(const ApiRow& row, const Expression& call, const Value& self,
                       const Arguments& arguments) {
  const bool hands_on = row.returns == "first" && !arguments.empty();
  const Arguments others(arguments.begin() + (hands_on ? 1 : 0), arguments.end());
  if (any_matters(others)) writer_.hole(call.place, "an end is given to what keeps it", true);
  const bool is_constant = self.kind == Value::Kind::text || self.kind == Value::Kind::number;
  static const std::set<std::string> reads{"c_str", "size", "empty", "length", "data", "find"};
  const Expression& callee = call.operands[0];
  if (is_constant && !reads.contains(callee.text) && !callee.operands.empty()) {
    walk_.expressions->forget(callee.operands[0]);
  }
  return returned(row, call, self, arguments);
}

Value RowReader::returned(const ApiRow& row, const Expression& call, const Value& self,
                          const Arguments& arguments) const {
  if (row.returns == "self") {
    Value same = self;
    same.is_pointer = true;
    return same;
  }
  if (row.returns == "first") return arguments.empty() ? Value{} : arguments[0];
  if (row.returns == "element") {
    return data_value(is_message_type(self.type) ? "message"
                                                 : class_of_type(template_arguments(self.type)));
  }
  if (row.returns == "template") return data_value(class_of_type(call.operands[0].type));
  return length_of_time(call.operands[0].text, row.returns, arguments);
}

// Nothing that main does behind it is heard of. In a callback it ends what spins.
Value RowReader::shut_down(const Expression& call) {
  if (writer_.phase() == Phase::callback) writer_.hole(call.place, "a shutdown", false);
  if (writer_.phase() != Phase::start) return {};
  if (writer_.node() != none) {
    writer_.hole(call.place, "a shutdown in a constructor", false);
  } else {
    walk_.end_main();
  }
  return {};
}

// std::ref(x): somebody else may change it.
Value RowReader::refer(const Expression& call, const Arguments& arguments) {
  if (arguments.size() != 1) return unknown_value();
  walk_.expressions->share(call.operands[1]);
  Value value = arguments[0];
  value.is_pointer = true;
  return value;
}

Value RowReader::make_pointed(const Expression& call, Arguments arguments) {
  const std::string type = call.operands[0].type;
  walk_.objects->share_arguments(type, call.operands, 1);
  if (class_of_type(type) == "rclcpp::Node") {
    return walk_.objects->make_plain_node(arguments, call.place);
  }
  return walk_.objects->construct(type, std::move(arguments), call.place, "");
}

// std::move: what it is taken from has it no more.
Value RowReader::take_out(const Expression& call, const Arguments& arguments) {
  if (arguments.size() != 1) return unknown_value();
  const Expression& from = call.operands[1];
  const bool is_place =
      from.kind == Expression::Kind::name || from.kind == Expression::Kind::member;
  const bool is_parameter = from.variable != none && walk_.variable(from.variable).is_local;
  const bool is_lock = LockKeeper::is_guard(arguments[0].type);
  if (is_place && arguments[0].matters() && (!is_parameter || is_lock)) {
    writer_.hole(call.place, "an end goes elsewhere", true);
  } else if (is_place && arguments[0].matters()) {
    Value mixed = arguments[0];
    mixed.kind = Value::Kind::mixed;
    walk_.expressions->set_constant(from, mixed);
  }
  return arguments[0];
}

Value RowReader::bind(const Expression& call, const Arguments& arguments) {
  if (arguments.empty() || arguments[0].kind != Value::Kind::callable) {
    writer_.hole(call.place, "a bound function that is not known", any_matters(arguments));
    return unknown_value();
  }
  Value value = arguments[0];
  value.callable = std::make_shared<Callable>(*arguments[0].callable);
  Callable& callable = *value.callable;
  const Function& function = walk_.function(callable.function);
  std::size_t next = 1;
  if (!function.of_class.empty() && !function.is_static && !function.is_lambda) {
    const bool has_object = arguments.size() > 1 && arguments[1].kind == Value::Kind::object &&
                            callable.frame == nullptr;
    if (!has_object) {
      writer_.hole(call.place, "a method that is bound to what is not known", true);
      return unknown_value();
    }
    callable.self = arguments[1];
    next = 2;
  }
  bool is_strange = callable.is_bound;
  for (; next < arguments.size(); ++next) {
    BoundArgument bound{arguments[next], placeholder_of(call.operands[next + 1])};
    is_strange =
        is_strange || (bound.value.kind == Value::Kind::callable && bound.value.callable->is_bound);
    callable.bound.push_back(std::move(bound));
  }
  callable.is_bound = true;
  if (is_strange || callable.bound.size() != function.parameters.size()) {
    writer_.hole(call.place, "a bind in a bind, or of a number of arguments that does not fit",
                 true);
  }
  return value;
}

// What the library calls when it likes: it may do nothing that counts.
Value RowReader::watch(const ApiRow& row, const Expression& call, const Arguments& arguments) {
  for (const Value& argument : arguments) {
    if (!argument.matters()) continue;
    if (argument.kind == Value::Kind::callable) {
      walk_.model.watchers.push_back({argument, call.place});
    } else {
      writer_.hole(call.place, "an end is given to what keeps it", true);
    }
  }
  return data_value(row.returns);
}

// An algorithm that calls what it is given, any number of times.
Value RowReader::call_some(const Expression& call, const Arguments& arguments) {
  for (const Value& argument : arguments) {
    if (!argument.matters()) continue;
    if (argument.kind != Value::Kind::callable) {
      writer_.hole(call.place, "an end is given to what keeps it", true);
      continue;
    }
    const Function& function = walk_.function(argument.callable->function);
    Code loop;
    loop.kind = Code::Kind::loop;
    loop.place = call.place;
    loop.arms.resize(1);
    writer_.enter_condition();
    loop.arms[0].code = writer_.aside([&] {
      const CodeWriter::Scope scope(writer_);
      Code leave;
      leave.kind = Code::Kind::leave;
      const bool is_finite = is_finite_call(call, function, walk_.sources);
      writer_.branch_on("", call.place, [&] { writer_.append(leave); });
      const std::string last = is_finite ? writer_.choose_last(call.place) : "";
      walk_.calls->call_value(argument, Arguments(function.parameters.size()), call.place);
      if (is_finite) writer_.branch_on(last, call.place, [&] { writer_.append(leave); });
    });
    writer_.leave_condition();
    if (has_steps(loop.arms[0].code)) writer_.append(std::move(loop));
  }
  return unknown_value();
}

// ---- Objects of libraries ----

// `inert`; `keeps`: what it is given, and does nothing with it that counts; `publisher NAME DEPTH
// [kept]`: a publisher of the node that it is given.
Value RowReader::construct(const ApiRow& row, const std::string& of_class,
                           const Arguments& arguments, const Place& place) {
  if (row.means == "publisher")
    return ends_.make_publisher(row.returns, of_class, arguments, place);
  if (row.means != "keeps" && any_matters(arguments)) {
    writer_.hole(place, "an end is given to " + of_class, true);
  }
  return data_value(of_class);
}

bool RowReader::makes(const std::string& of_class) {
  return of_class == "rclcpp::QoS" || of_class == "rclcpp::SensorDataQoS" ||
         of_class == "rclcpp::SystemDefaultsQoS" || of_class == "rclcpp::ServicesQoS" ||
         of_class == "rclcpp::ParametersQoS" || of_class == "rclcpp::SubscriptionOptions" ||
         of_class == "rclcpp::PublisherOptions" || of_class == "rclcpp::KeepLast" ||
         LockKeeper::makes(of_class) || ExecutorSpins::makes(of_class);
}

Value RowReader::make(const std::string& of_class, const Arguments& arguments, const Place& place,
                      const std::string& hint) {
  if (LockKeeper::makes(of_class)) return locks_.make(of_class, arguments, place, hint);
  if (ExecutorSpins::makes(of_class)) return spins_.make(of_class, arguments, place, hint);
  if (of_class.ends_with("Options")) {
    return arguments.empty() ? walk_.objects->make_empty(of_class)
                             : walk_.objects->converted(of_class, arguments[0], place);
  }
  Value qos;
  qos.kind = Value::Kind::qos;
  qos.type = "rclcpp::QoS";
  if (of_class == "rclcpp::SensorDataQoS") {
    qos.text = "5";
    qos.is_best_effort = true;
  } else if (of_class == "rclcpp::ParametersQoS") {
    qos.text = "1000";
  } else if (of_class == "rclcpp::ServicesQoS") {
    qos.text = "10";
  }
  if (arguments.empty()) return qos;
  const Value& depth = arguments[0];
  const bool is_number = depth.kind == Value::Kind::number;
  if (depth.kind == Value::Kind::qos && of_class == "rclcpp::QoS") {
    qos = depth;
  } else if (depth.kind == Value::Kind::qos || (is_number && is_decimal(depth.text))) {
    qos.text = depth.text;
  } else if (!is_number && !depth.type.empty() && !is_plain_type(depth.type)) {
    writer_.hole(place, "a quality of service that is not known", false);
  }
  if (arguments.size() > 1) {
    writer_.hole(place, "a quality of service of two parts", false);
  }
  return qos;
}

Value RowReader::quality(const ApiRow& row, const Expression& call, const Value& self,
                         const Arguments& arguments) {
  if (self.kind != Value::Kind::qos) {
    writer_.hole(call.place, "a quality of service that is not known", false);
    return self;
  }
  Value value = self;
  if (row.returns == "best_effort") value.is_best_effort = true;
  if (row.returns == "reliable") value.is_best_effort = false;
  if (row.returns == "transient_local") value.is_transient = true;
  if (row.returns == "volatile") value.is_transient = false;
  if (row.returns == "depth") {
    const bool is_known = !arguments.empty() && arguments[0].kind == Value::Kind::number &&
                          is_decimal(arguments[0].text);
    value.text = is_known ? arguments[0].text : "";
  }
  // It changes the object itself, too.
  const Expression& callee = call.operands[0];
  if (!callee.operands.empty()) walk_.expressions->set_constant(callee.operands[0], value);
  return value;
}

}  // namespace maide::extract
