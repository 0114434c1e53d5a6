#include "maide/extract/entries.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/source_walker.hpp"
#include "maide/extract/type_names.hpp"

namespace maide::extract {
namespace {

class Pass {
 public:
  Pass(const Sources& sources, const ApiTable& table, std::set<std::string>& mixed)
      : sources_(sources), walker_(sources, table, model_, mixed) {}

  Model run() {
    for (const auto& [place, text] : sources_.faults) model_.holes.push_back({text, place, false});
    walker_.make_globals();
    find_mains();
    make_components();
    run_callbacks();
    run_watchers();
    look_at_the_rest();
    look_at_ends();
    std::ranges::sort(model_.holes);
    return std::move(model_);
  }

 private:
  static Value callable(int function) {
    Value value;
    value.kind = Value::Kind::callable;
    value.callable = std::make_shared<Callable>();
    value.callable->function = function;
    return value;
  }

  void hole(std::string text, const Place& place) {
    model_.holes.push_back({std::move(text), place, false});
  }

  // ---- main ----

  void find_mains() {
    for (std::size_t i = 0; i < sources_.functions.size(); ++i) {
      const Function& function = sources_.functions[i];
      if (function.full_name() != "main") continue;
      const std::size_t nodes = model_.nodes.size(), executors = model_.executors.size();
      Program program = walker_.run(callable(static_cast<int>(i)), {}, Phase::start, none);
      a_main_ends_ = a_main_ends_ || !walker_.take_main_is_over();
      give_main(std::move(program), nodes, executors, function.place);
    }
  }

  void give_main(Program program, std::size_t first_node, std::size_t first_executor,
                 const Place& place) {
    int main = walker_.take_main_executor();
    for (std::size_t k = first_executor; k < model_.executors.size(); ++k) own_nodes(k, place);
    std::vector<int> idle;
    for (std::size_t k = first_node; k < model_.nodes.size(); ++k) {
      if (model_.nodes[k].executor == none) idle.push_back(static_cast<int>(k));
    }
    if (main == none && !idle.empty()) {  // nobody spins them: main alone runs
      main = static_cast<int>(model_.executors.size());
      Executor executor;
      executor.nodes = idle;
      executor.place = place;
      executor.is_spun = true;
      executor.label = "executor_" + std::to_string(main);
      model_.executors.push_back(std::move(executor));
      own_nodes(static_cast<std::size_t>(main), place);
      idle.clear();
      if (!has_steps(program.code)) program.code.push_back({Code::Kind::step, "skip;", {}, {}, {}});
    }
    for (const int node : idle) {
      hole("a node that nothing here spins", model_.nodes[static_cast<std::size_t>(node)].place);
    }
    const std::set<int> uses = walker_.take_main_uses();
    if (main != none) return set_main(std::move(program), main, uses, place);
    if (has_steps(program.code)) hole("main communicates and spins nothing", place);
  }

  void own_nodes(std::size_t executor, const Place& place) {
    Executor& entry = model_.executors[executor];
    if (!entry.is_spun) hole("an executor that nothing here spins", entry.place);
    for (const int index : entry.nodes) {
      Node& node = model_.nodes[static_cast<std::size_t>(index)];
      if (node.executor != none) hole("a node on two executors", place);
      node.executor = static_cast<int>(executor);
    }
  }

  void set_main(Program program, int main, const std::set<int>& uses, const Place& place) {
    Executor& executor = model_.executors[static_cast<std::size_t>(main)];
    const bool spins_only = program.code.size() == 1 && program.code[0].text == "spin;";
    if (spins_only) return;
    const bool uses_others = std::ranges::any_of(
        uses, [&](int node) { return executor.nodes.empty() || node != executor.nodes[0]; });
    if (executor.is_multi) hole("main does more than spin an executor of several threads", place);
    if (uses_others) hole("main uses ends of several nodes", place);
    executor.has_main = true;
    executor.main = std::move(program);
  }

  // ---- Nodes that something outside makes ----

  bool is_base(const Class& entry) const {
    return std::ranges::any_of(sources_.classes, [&](const auto& other) {
      return std::ranges::any_of(other.second.bases, [&](const std::string& base) {
        return walker_.names().find_class(base, outer_part(other.first)) == &entry;
      });
    });
  }

  bool is_made(const std::string& name) const {
    return std::ranges::any_of(model_.objects,
                               [&](const Object& object) { return object.of_class == name; });
  }

  void make_components() {
    for (const auto& named : sources_.classes) {
      const bool is_node = walker_.names().is_node_class(named.first);
      const bool is_component =
          std::ranges::find(sources_.components, named.first) != sources_.components.end();
      if (is_node && !is_made(named.first) && (is_component || !is_base(named.second))) {
        const std::size_t objects = model_.objects.size();
        walker_.make_alone(named.second);
        if (objects < model_.objects.size()) model_.objects[objects].holders.push_back(none);
      }
    }
    for (const auto& named : sources_.classes) {
      const Class& entry = named.second;
      if (!is_made(named.first) && !is_base(entry) && makes_ends(entry)) make_part(entry);
    }
  }

  // Whether code of the class and its bases names what makes an end.
  bool makes_ends(const Class& entry) const {
    static const std::set<std::string> makers{"create_publisher", "create_subscription",
                                              "create_service", "create_client",
                                              "create_wall_timer"};
    const std::string text = sources_.text_of(entry);
    return std::ranges::any_of(
        makers, [&](const std::string& maker) { return text.find(maker) != std::string::npos; });
  }

  // A class that is no node and has one, such as a plugin. Nothing here makes it; it is looked at
  // as if somebody made it once.
  void make_part(const Class& entry) {
    const std::size_t entities = model_.entities.size(), nodes = model_.nodes.size(),
                      holes = model_.holes.size(), threads = model_.threads.size(),
                      objects = model_.objects.size();
    const std::set<int> read = walker_.read_functions();
    Program program = walker_.make_alone(entry);
    const bool has_ends = std::any_of(
        model_.entities.begin() + static_cast<std::ptrdiff_t>(entities), model_.entities.end(),
        [](const Entity& entity) { return entity.node != none; });
    if (!has_ends) {
      model_.entities.resize(entities);
      walker_.restore_read_functions(read);
      model_.nodes.resize(nodes);
      model_.holes.resize(holes);
      model_.threads.resize(threads);
      return;
    }
    hole(entry.name + " is made by nothing here: taken as made once", entry.place);
    model_.objects[objects].holders.push_back(none);
    if (model_.nodes.size() == nodes + 1) {
      model_.nodes.back().start = std::move(program);
    } else if (has_steps(program.code)) {
      hole("a constructor that communicates: " + entry.name, entry.place);
    }
  }

  // ---- Callbacks and threads ----

  // Walking through a callback may bring further ones, of clients.
  void run_callbacks() {
    for (std::size_t i = 0; i < model_.entities.size(); ++i) {
      for (std::size_t k = 0; k < model_.entities[i].callbacks.size(); ++k) {
        const Entity entity = model_.entities[i];
        run_callback(static_cast<int>(i), k, entity);
      }
    }
    for (std::size_t i = 0; i < model_.threads.size(); ++i) {
      const Thread thread = model_.threads[i];
      Program program =
          walker_.run(thread.function, thread.arguments, Phase::callback, thread.node);
      model_.threads[i].program = std::move(program);
    }
    for (std::size_t i = 0; i < model_.entities.size(); ++i) {  // those that threads brought
      std::size_t& done = done_[static_cast<int>(i)];
      for (; done < model_.entities[i].callbacks.size();) {
        const Entity entity = model_.entities[i];
        run_callback(static_cast<int>(i), done, entity);
      }
    }
  }

  static bool answers_later(const Function& function, const std::vector<Value>& arguments) {
    return arguments.empty() || function.parameter_types[0] == "auto" ||
           arguments[0].type == "rclcpp::Service" ||
           (arguments.size() == 2 && arguments[0].type == "rmw_request_id_t") ||
           arguments.size() > 3;
  }

  std::vector<Value> arguments_of(const Callable& callable, const Entity& entity) {
    const Function& function = sources_.functions[static_cast<std::size_t>(callable.function)];
    std::size_t count = function.parameters.size();
    std::vector<Value> arguments(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::string type = class_of_type(function.parameter_types[i]);
      arguments[i].type = type == "auto" ? "message" : type;
      if (entity.kind == Entity::Kind::client) arguments[i].type = "ready future";
    }
    const auto refuse_later = [&](const std::vector<Value>& of_call) {
      if (entity.kind == Entity::Kind::service && answers_later(function, of_call)) {
        hole("a service that may answer later", entity.place);
      }
    };
    if (!callable.is_bound) {
      refuse_later(arguments);
      return arguments;
    }
    std::vector<Value> given;  // in the order of the placeholders
    for (std::size_t i = 0; i < callable.bound.size() && i < count; ++i) {
      if (callable.bound[i].placeholder == none) continue;
      const auto place = static_cast<std::size_t>(callable.bound[i].placeholder);
      if (given.size() <= place) given.resize(place + 1);
      given[place] = arguments[i];
    }
    refuse_later(given);
    return given;
  }

  static Code either(std::vector<Code> one, std::vector<Code> other) {
    Code choice;
    choice.kind = Code::Kind::branch;
    choice.text = "*";
    choice.arms = {{"", std::move(one)}, {"", std::move(other)}};
    return choice;
  }

  void run_callback(int index, std::size_t which, const Entity& entity) {
    done_[index] = which + 1;
    const Value& callback = entity.callbacks[which];
    const std::vector<Value> arguments = arguments_of(*callback.callable, entity);
    Program program = walker_.run(callback, arguments, Phase::callback, entity.node);
    if (which == 0) {
      model_.programs[index] = std::move(program);
      return;
    }
    // A client whose answers go to several functions: any of them.
    Program& all = model_.programs[index];
    all.code = {either(std::move(all.code), std::move(program.code))};
    all.variables.insert(all.variables.end(), program.variables.begin(), program.variables.end());
  }

  void run_watchers() {
    for (std::size_t i = 0; i < model_.watchers.size(); ++i) {
      const Watcher watcher = model_.watchers[i];
      const Callable& callable = *watcher.function.callable;
      const Function& function = sources_.functions[static_cast<std::size_t>(callable.function)];
      std::vector<Value> arguments(function.parameters.size());
      for (std::size_t k = 0; k < arguments.size(); ++k) {
        arguments[k].type = class_of_type(function.parameter_types[k]);
      }
      const Program program = walker_.run(watcher.function, arguments, Phase::unreached, none);
      if (has_steps(program.code))
        hole("a callback of a library that does something", watcher.place);
    }
  }

  // Whether what lives as long as main has it, by one step or several.
  bool is_held(const std::vector<int>& holders, std::size_t steps = 0) const {
    return steps <= model_.objects.size() && std::ranges::any_of(holders, [&](int holder) {
             return holder == none ||
                    is_held(model_.objects[static_cast<std::size_t>(holder)].holders, steps + 1);
           });
  }

  // Of nodes: what nobody keeps goes with its scope.
  void look_at_ends() {
    static const std::map<Entity::Kind, std::string> names{
        {Entity::Kind::subscription, "subscription"},
        {Entity::Kind::service, "service"},
        {Entity::Kind::timer, "timer"},
        {Entity::Kind::group, "callback group"}};
    for (const Node& node : model_.nodes) {
      Object& object = model_.objects[static_cast<std::size_t>(node.object)];
      if (is_held(object.holders)) continue;
      hole("a node that nobody keeps", node.place);
      object.holders.push_back(none);  // said once
    }
    for (const Entity& entity : model_.entities) {
      const bool is_client = entity.kind == Entity::Kind::client && !entity.callbacks.empty();
      if (is_client && entity.is_asked_without) {  // any of its answers calls something, or none
        Program& program = model_.programs[static_cast<int>(&entity - model_.entities.data())];
        program.code = {either(std::move(program.code), {})};
      }
      if (is_client && !is_held(entity.holders)) hole("a client that nobody keeps", entity.place);
      const auto name = names.find(entity.kind);
      if (name == names.end() || entity.node == none || is_held(entity.holders)) continue;
      hole("a " + name->second + " that nobody keeps", entity.place);
    }
  }

  // ---- What no entry reaches ----

  // It may be called from elsewhere, by an operator, a conversion, or at the end of an object.
  bool may_be_called(std::size_t index) const {
    const Function& function = sources_.functions[index];
    const Class* entry = walker_.names().find_class(function.of_class, "");
    // Nodes live as long as their executor is spun, unless main comes to its end.
    const bool is_node = walker_.names().is_node_class(function.of_class);
    if (function.is_destructor && is_node && !a_main_ends_) return false;
    const bool is_override =
        function.is_virtual && entry != nullptr && walker_.names().has_unknown_base(*entry);
    const bool is_hidden =
        function.is_destructor || function.name.starts_with("operator") || is_override;
    return is_hidden || !walker_.was_read(static_cast<int>(index));
  }

  // By the first of the objects of its class, or by one of which nothing is known.
  Value called_by_somebody(std::size_t index) const {
    const Function& function = sources_.functions[index];
    Value value = callable(static_cast<int>(index));
    value.callable->self.type = function.of_class;
    for (std::size_t k = 0; k < model_.objects.size(); ++k) {
      if (model_.objects[k].of_class != function.of_class) continue;
      value.callable->self.kind = Value::Kind::object;
      value.callable->self.index = static_cast<int>(k);
      break;
    }
    return value;
  }

  void look_at_the_rest() {
    const std::size_t holes = model_.holes.size(), entities = model_.entities.size(),
                      nodes = model_.nodes.size(), executors = model_.executors.size(),
                      threads = model_.threads.size();
    std::vector<std::pair<std::string, Place>> found;
    for (std::size_t i = 0; i < sources_.functions.size(); ++i) {
      if (!may_be_called(i)) continue;
      const Function& function = sources_.functions[i];
      std::vector<Value> arguments(function.parameters.size());
      for (std::size_t k = 0; k < arguments.size(); ++k) {
        arguments[k].type = class_of_type(function.parameter_types[k]);
      }
      const Program program = walker_.run(called_by_somebody(i), arguments, Phase::unreached, none);
      const bool is_idle = !has_steps(program.code) && model_.holes.size() == holes &&
                           model_.entities.size() == entities;
      model_.holes.resize(holes);
      model_.entities.resize(entities);
      model_.nodes.resize(nodes);
      model_.executors.resize(executors);
      model_.threads.resize(threads);
      if (is_idle) continue;
      found.emplace_back(function.is_lambda ? "a lambda that nothing here calls"
                                            : function.full_name() + " is called by nothing here",
                         function.place);
    }
    for (auto& [text, place] : found) hole(std::move(text), place);
  }

  const Sources& sources_;
  Model model_;
  SourceWalker walker_;
  bool a_main_ends_ = false;         // one that does not spin for ever
  std::map<int, std::size_t> done_;  // callbacks of each end that were run
};

}  // namespace

Model read_entries(const Sources& sources, const ApiTable& table) {
  std::set<std::string> mixed;
  for (;;) {
    const std::size_t before = mixed.size();
    Model model = Pass(sources, table, mixed).run();
    if (mixed.size() == before) return model;
  }
}

}  // namespace maide::extract
