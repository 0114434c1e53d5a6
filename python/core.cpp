// Python's module maide._core: what the package `maide` (python/__init__.py) is made of.
//
//   ObjectSystem   an object with reset() and step(), as a system that commands may be told of
//   run_command    a command of the command line, within this process: its options are those of the
//                  one table, its result is the JSON object
//   AskedSystem    a wrapper that answers words
//   AnyModel       a model of any kind
//
// Python's lock is not held while a command works, but for python_sul.hpp.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/json.hpp"
#include "maide/base/log.hpp"
#include "maide/base/version.hpp"
#include "maide/cli/command.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/formats/exporters.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/report/picture.hpp"
#include "maide/sul/ia_translation.hpp"
#include "maide/sul/ia_translator.hpp"
#include "python_sul.hpp"

namespace py = pybind11;

namespace maide::python {
namespace {

using Clock = std::chrono::steady_clock;

// ---- Errors ----

// Python's classes of errors, by the exit status of Maide's.
struct ErrorClasses {
  py::object base, usage, failed;
};

ErrorClasses& error_classes() {
  static auto* classes = new ErrorClasses();  // as long as the process: Python may be gone before
  return *classes;
}

void set_python_error(const Error& error) {
  const ErrorClasses& classes = error_classes();
  const py::object& kind = error.status() == ExitStatus::usage           ? classes.usage
                           : error.status() == ExitStatus::system_failed ? classes.failed
                                                                         : classes.base;
  PyErr_SetString(kind.ptr(), error.what());
}

// ---- An object as a system ----

// An object that the commands may be told of by its name.
class ObjectSystem {
 public:
  ObjectSystem(py::object object, std::vector<py::object> inputs, std::string name,
               std::optional<Mealy> reference)
      : object_(std::move(object)),
        inputs_(std::move(inputs)),
        name_(std::move(name)),
        reference_(std::move(reference)),
        system_([this] { return open(); }) {}

  std::string text() const { return system_.text(); }
  Thrown& thrown() { return *thrown_; }

 private:
  OpenedSystem open() const {
    const py::gil_scoped_acquire lock;
    OpenedSystem opened;
    try {
      opened.sul = std::make_unique<PythonSul>(object_, inputs_, name_, thrown_);
    } catch (py::error_already_set& error) {
      thrown_->keep(error);
      throw Interrupted("the object is no system");
    }
    opened.reference = reference_;
    return opened;
  }

  py::object object_;
  std::vector<py::object> inputs_;
  std::string name_;
  std::optional<Mealy> reference_;
  std::shared_ptr<Thrown> thrown_ = std::make_shared<Thrown>();
  EmbeddedSystem system_;  // last: it refers to the others
};

// ---- Commands ----

// Tells a Python function of the progress, at most ten times a second, and looks for Ctrl-C. What
// the function throws, and Ctrl-C, ask the work to stop.
class Watch : public ProgressObserver {
 public:
  Watch(py::object callback, Thrown& thrown) : callback_(std::move(callback)), thrown_(thrown) {}

  std::stop_token token() const { return stop_.get_token(); }

  // On the thread that works, without Python's lock.
  void on_progress(const Progress& progress) override {
    {
      const std::lock_guard lock(mutex_);
      last_ = progress;
      phase_ = progress.phase;
      is_new_ = true;
    }
    if (is_caller_working_) look();
  }

  // On the thread that called, without Python's lock.
  void look() {
    if (Clock::now() < next_) return;
    next_ = Clock::now() + std::chrono::milliseconds(100);
    const py::gil_scoped_acquire python;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      tell();
    } catch (py::error_already_set& error) {
      thrown_.keep(error);
      stop_.request_stop();
    }
  }

  // Runs the work on this thread, as objects of Python may want, or on another, so that this one
  // may look for Ctrl-C. Without Python's lock.
  void run(bool is_of_caller, const std::function<void()>& work) {
    is_caller_working_ = is_of_caller;
    if (is_of_caller) return work();
    std::exception_ptr error;
    bool is_over = false;
    std::thread worker([&] {
      try {
        work();
      } catch (...) {
        error = std::current_exception();
      }
      const std::lock_guard lock(mutex_);
      is_over = true;
      over_.notify_one();
    });
    std::unique_lock lock(mutex_);
    while (!over_.wait_for(lock, std::chrono::milliseconds(20), [&] { return is_over; })) {
      lock.unlock();
      look();
      lock.lock();
    }
    lock.unlock();
    worker.join();
    if (error) std::rethrow_exception(error);
  }

 private:
  void tell() {
    Progress progress;
    std::string phase;
    {
      const std::lock_guard lock(mutex_);
      if (callback_.is_none() || !is_new_) return;
      progress = last_;
      phase = phase_;
      is_new_ = false;
    }
    callback_(py::dict(py::arg("phase") = phase, py::arg("states") = progress.states,
                       py::arg("words") = progress.words, py::arg("symbols") = progress.symbols,
                       py::arg("done") = progress.done, py::arg("total") = progress.total));
  }

  py::object callback_;
  Thrown& thrown_;
  std::stop_source stop_;
  std::mutex mutex_;
  std::condition_variable over_;
  Progress last_;
  std::string phase_;  // what `last_.phase` points to may be gone
  bool is_new_ = false, is_caller_working_ = false;
  Clock::time_point next_{};
};

const cli::Command& find_command(const std::string& name) {
  return find_row(cli::command_table(), "command", std::string_view(name));
}

// (status, JSON text, what Python threw or None). Throws Maide's errors.
py::tuple run_command(const std::string& name, const std::vector<std::string>& arguments,
                      const py::object& progress, ObjectSystem* system) {
  Thrown own;
  Thrown& thrown = system != nullptr ? system->thrown() : own;
  Watch watch(progress, thrown);
  std::string result;
  ExitStatus status = ExitStatus::ok;
  std::exception_ptr error;
  {
    const py::gil_scoped_release unlocked;
    try {
      watch.run(system != nullptr, [&] {
        const cli::Command& command = find_command(name);
        cli::CommandLine line("maide " + name, std::string(command.summary));
        const cli::RunFunction run = command.set_up(line);
        if (!line.parse(arguments, "")) throw UsageError("help is in the pages of 'maide'");
        cli::CommonOptions options;
        options.json = options.quiet = options.embedded = true;
        options.progress = &watch;
        cli::Context context(options, watch.token());
        status = run(context);
        result = context.take_result(status);
      });
    } catch (const Error&) {
      error = std::current_exception();
    }
  }
  if (error && thrown.is_empty()) std::rethrow_exception(error);
  return py::make_tuple(static_cast<int>(status), result, thrown.take());
}

// The names of a command's options, without dashes, and whether each takes a value.
py::dict command_options(const std::string& name) {
  cli::CommandLine line("maide " + name, "");
  find_command(name).set_up(line);
  py::dict options;
  for (const cli::Argument& argument : line.all()) {
    for (const std::string& long_name : argument.long_names()) {
      options[py::str(long_name)] = argument.takes_value();
    }
  }
  return options;
}

// ---- Systems that answer words ----

class AskedSystem {
 public:
  AskedSystem(const std::string& name, const std::vector<std::string>& key_values,
              std::size_t jobs) {
    const SystemSpec spec = parse_system_spec(name, key_values);
    SystemAccess access;
    access.jobs = jobs;
    opened_ = open_system(spec, access);
    translator_.emplace(*opened_.sul, Translation::eager);
  }

  IaTranslator& translator() {
    if (!translator_) throw UsageError("the system is closed");
    return *translator_;
  }
  void close() {
    translator_.reset();
    opened_.sul.reset();
  }

  std::vector<std::vector<std::string>> query_many(
      const std::vector<std::vector<std::string>>& words) {
    std::vector<Query> queries;
    for (const auto& names : words) {
      Word word;
      for (const std::string& input : names) {
        word.push_back(translator().inputs().at(input, "input"));
      }
      queries.emplace_back(std::move(word));
    }
    Thrown thrown;
    Watch watch(py::none(), thrown);
    std::vector<MealyAnswer> answers;
    std::exception_ptr error;
    {
      const py::gil_scoped_release unlocked;
      RunControl control;
      control.stop = watch.token();
      control.progress = &watch;
      try {
        watch.run(false, [&] { answers = translator().run(queries, control); });
      } catch (const Error&) {
        error = std::current_exception();
      }
    }
    if (!thrown.is_empty()) {
      const py::object value = thrown.take();
      PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(value.ptr())), value.ptr());
      throw py::error_already_set();
    }
    if (error) std::rethrow_exception(error);
    std::vector<std::vector<std::string>> outputs;
    for (const MealyAnswer& answer : answers) {
      auto& names = outputs.emplace_back();
      for (const Symbol output : answer.outputs) {
        names.push_back(translator().outputs().name(output));
      }
    }
    return outputs;
  }

 private:
  OpenedSystem opened_;
  std::optional<IaTranslator> translator_;
};

// ---- Models ----

// In a class of its own: pybind11 takes a variant for one of its members.
struct AnyModel {
  Model model;
};

// (source, input, output, target) of a Mealy machine of either kind; (source, action, target) of an
// interface automaton, whose actions are "?input" and "!output".
py::list transitions_of(const AnyModel& any) {
  const Model& model = any.model;
  py::list list;
  if (const auto* automaton = std::get_if<InterfaceAutomaton>(&model)) {
    for (StateId state = 0; state < automaton->size(); ++state) {
      for (const auto& transition : automaton->transitions(state)) {
        list.append(py::make_tuple(state, automaton->name(transition.action), transition.target));
      }
    }
    return list;
  }
  const auto* deterministic = std::get_if<Mealy>(&model);
  const NondeterministicMealy machine = deterministic != nullptr
                                            ? NondeterministicMealy(*deterministic)
                                            : std::get<NondeterministicMealy>(model);
  for (StateId state = 0; state < machine.size(); ++state) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      for (const auto& choice : machine.choices(state, input)) {
        list.append(py::make_tuple(state, machine.inputs().name(input),
                                   machine.outputs().name(choice.output), choice.target));
      }
    }
  }
  return list;
}

// What Model(...) of the package asks for all at once.
py::dict describe(const AnyModel& any) {
  return std::visit(
      [](const auto& its) {
        return py::dict(py::arg("states") = its.size(), py::arg("initial") = its.initial(),
                        py::arg("inputs") = its.inputs().names(),
                        py::arg("outputs") = its.outputs().names(), py::arg("origin") = its.origin);
      },
      any.model);
}

// Of rows (source, input, output, target), sources and targets numbered from 0.
AnyModel make_mealy(
    std::size_t states, StateId initial, const std::vector<std::string>& inputs,
    const std::vector<std::tuple<StateId, std::string, std::string, StateId>>& rows) {
  Mealy machine(Alphabet(std::span<const std::string>(inputs)), Alphabet(), states);
  if (initial >= states) throw UsageError("the initial state is none of the machine's");
  machine.set_initial(initial);
  for (const auto& [source, input, output, target] : rows) {
    if (source >= states || target >= states) throw UsageError("a transition of no state");
    const Symbol symbol = machine.inputs().at(input, "input");
    machine.set_transition(source, symbol, machine.intern_output(output), target);
  }
  if (!machine.is_complete()) {
    throw UsageError("a Mealy machine has a transition for each state and input");
  }
  return {std::move(machine)};
}

std::string export_model(const AnyModel& any, const std::string& format, const std::string& name) {
  std::ostringstream out;
  find_exporter(format).write(out, any.model, {name, MarkLoss::accept});
  return std::move(out).str();
}

std::string picture(const AnyModel& any, const std::string& format) {
  if (!size_of(any.model).is_drawable()) return "";
  const std::string dot = model_picture(any.model);
  return format == "svg" ? draw_svg(dot, {}) : draw_tikz(dot, {});
}

py::object define_error(py::module_& module, const char* name, const char* doc,
                        const py::object& bases) {
  const std::string full = std::string("maide.") + name;
  auto error = py::reinterpret_steal<py::object>(
      PyErr_NewExceptionWithDoc(full.c_str(), doc, bases.ptr(), nullptr));
  module.attr(name) = error;
  return error;
}

}  // namespace
}  // namespace maide::python

PYBIND11_MODULE(_core, module) {
  using namespace maide;
  using namespace maide::python;

  set_up_log("maide", LogLevel::quiet);
  module.attr("version") = std::string(version());
  ErrorClasses& errors = error_classes();
  const py::object exception = py::reinterpret_borrow<py::object>(PyExc_Exception);
  const py::object value_error = py::reinterpret_borrow<py::object>(PyExc_ValueError);
  errors.base = define_error(module, "Error", "An error of Maide: one line, what is wrong (where).",
                             exception);
  errors.usage = define_error(module, "UsageError", "Arguments or input that cannot be used.",
                              py::make_tuple(errors.base, value_error));
  errors.failed = define_error(module, "SystemFailed",
                               "The system under learning, or its wrapper, failed.", errors.base);
  py::register_exception_translator(
      [](std::exception_ptr thrown) {  // NOLINT: the signature is given
        try {
          if (thrown) std::rethrow_exception(thrown);
        } catch (const Error& error) {
          set_python_error(error);
        }
      });

  module.def("look_for_wrappers_in",
             [](const std::string& folder) { look_for_wrappers_in(folder); });
  module.def("command_options", &command_options);
  module.def("run_command", &run_command, py::arg("name"), py::arg("arguments"),
             py::arg("progress") = py::none(), py::arg("system") = nullptr);

  py::class_<ObjectSystem>(module, "ObjectSystem")
      .def(py::init([](py::object system, std::vector<py::object> inputs, std::string name,
                       const AnyModel* reference) {
             std::optional<Mealy> machine;
             if (reference != nullptr) machine = std::get<Mealy>(reference->model);
             return std::make_unique<ObjectSystem>(std::move(system), std::move(inputs),
                                                   std::move(name), std::move(machine));
           }),
           py::arg("system"), py::arg("inputs"), py::arg("name"), py::arg("reference") = nullptr)
      .def_property_readonly("text", &ObjectSystem::text);

  py::class_<AskedSystem>(module, "System")
      .def(py::init<const std::string&, const std::vector<std::string>&, std::size_t>(),
           py::call_guard<py::gil_scoped_release>())
      .def("query_many", &AskedSystem::query_many)
      .def("close", &AskedSystem::close, py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("name",
                             [](AskedSystem& system) { return system.translator().info().name; })
      .def_property_readonly(
          "inputs", [](AskedSystem& system) { return system.translator().inputs().names(); })
      .def_property_readonly("options",
                             [](AskedSystem& system) { return system.translator().info().options; })
      .def_property_readonly(
          "versions", [](AskedSystem& system) { return system.translator().info().versions; });

  py::class_<AnyModel>(module, "Model")
      .def_static("read", [](const std::string& path) { return AnyModel{read_model(path)}; })
      .def_static("parse", [](const std::string& text,
                              const std::string& file) { return AnyModel{read_dot(text, file)}; })
      .def_static("make", &make_mealy)
      .def("describe", &describe)
      .def("transitions", &transitions_of)
      .def("export", &export_model)
      .def("picture", &picture, py::call_guard<py::gil_scoped_release>())
      .def(
          "is_automaton",
          [](const AnyModel& any) { return std::holds_alternative<InterfaceAutomaton>(any.model); })
      .def("to_mealy", [](const AnyModel& any) {
        const auto* automaton = std::get_if<InterfaceAutomaton>(&any.model);
        return automaton == nullptr ? any : AnyModel{to_mealy(*automaton, Translation::eager)};
      });
}
