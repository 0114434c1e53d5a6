// An object of Python's as a system under learning: reset() and step(input), or query_many(words).
// Python's lock is held while the object works, and not otherwise. What it raises ends the run,
// which keeps what was learned, and is kept to be raised again.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/sul/sul.hpp"

namespace maide::python {

namespace py = pybind11;

// The first thing that Python threw; the rest follows from it.
class Thrown {
 public:
  // Within a catch block, with Python's lock.
  void keep(py::error_already_set& error) {
    if (value_) return;
    value_ = error.value();
    if (error.trace()) PyException_SetTraceback(value_.ptr(), error.trace().ptr());
  }
  bool is_empty() const { return !value_; }
  py::object take() { return value_ ? std::move(value_) : py::none(); }

 private:
  py::object value_;
};

// Plays words on a Python object, with Python's lock for each word. A symbol costs the call of its
// step() and a look into a dictionary: outputs that were seen have their names there.
class PythonSul : public Sul {
 public:
  PythonSul(py::object system, const std::vector<py::object>& inputs, std::string name,
            std::shared_ptr<Thrown> thrown)
      : system_(std::move(system)), inputs_(inputs), thrown_(std::move(thrown)) {
    info_.name = std::move(name);
    info_.actors = {"system"};
    info_.has_actors = info_.names_actors = false;
    info_.speaks_av = info_.speaks_purposes = false;
    for (const py::object& input : inputs_) info_.inputs.push_back({py::str(input), 0, {}});
    if (py::hasattr(system_, "query_many")) {
      query_many_ = system_.attr("query_many");
      info_.speaks_trees = false;
    } else {
      reset_ = system_.attr("reset");
      step_ = system_.attr("step");
    }
  }
  ~PythonSul() override {
    const py::gil_scoped_acquire lock;
    names_.release().dec_ref();
    query_many_ = reset_ = step_ = system_ = py::object();
    inputs_.clear();
  }

  const SulInfo& info() const override { return info_; }
  void add_purpose(const LearningPurpose&) override {
    throw UsageError("an object takes no learning purpose");
  }

  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override {
    if (query_many_) return run_words(batch, sink, control);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      control.check("running words on the system");
      sink(i, within_python([&] { return play(batch[i]); }));
    }
  }

 private:
  // What Python throws ends the run.
  template <typename Work>
  auto within_python(Work work) -> decltype(work()) {
    const py::gil_scoped_acquire lock;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      return work();
    } catch (py::error_already_set& error) {
      thrown_->keep(error);
      throw Interrupted(std::string("the system's object raised ") +
                        std::string(py::str(error.type().attr("__name__"))));
    }
  }

  SulAnswer play(const SulQuery& query) {
    SulAnswer answer;
    using Clock = std::chrono::steady_clock;
    using std::chrono::microseconds;
    const auto start = Clock::now();
    call(PyObject_CallNoArgs(reset_.ptr()));
    const auto ready = Clock::now();
    if (const Word* word = std::get_if<Word>(&query.inputs)) {
      answer.steps.reserve(word->size());
      for (const Symbol input : *word) step(input, answer);
    } else {
      const auto& nodes = std::get<BasicDecisionTree<std::string>>(query.inputs).nodes;
      for (std::size_t node = 0; node < nodes.size();) {
        step(nodes[node].input, answer);
        const std::string_view output = output_of(answer.steps.back());
        std::size_t next = nodes.size();
        for (const auto& [expected, child] : nodes[node].branches) {
          if (expected == output) next = child;
        }
        node = next;
      }
    }
    // What each step took is not asked: the clock costs as much as the rest.
    answer.reset_duration = answer.reset_wait =
        std::chrono::duration_cast<microseconds>(ready - start);
    if (!answer.steps.empty()) {
      answer.steps.back().duration = std::chrono::duration_cast<microseconds>(Clock::now() - ready);
    }
    return answer;
  }

  void run_words(std::span<const SulQuery> batch, const SulAnswerSink& sink,
                 const RunControl& control) {
    control.check("running words on the system");
    std::vector<SulAnswer> answers = within_python([&] {
      py::list words;
      for (const SulQuery& query : batch) {
        py::list word;
        for (const Symbol input : std::get<Word>(query.inputs)) word.append(inputs_[input]);
        words.append(std::move(word));
      }
      return read_answers(batch, query_many_(words));
    });
    for (std::size_t i = 0; i < answers.size(); ++i) sink(i, std::move(answers[i]));
  }

  std::vector<SulAnswer> read_answers(std::span<const SulQuery> batch, const py::object& given) {
    std::vector<SulAnswer> answers;
    for (const py::handle outputs : given) {
      const std::size_t place = answers.size();
      SulAnswer& answer = answers.emplace_back();
      if (place >= batch.size()) break;
      answer.inputs = std::get<Word>(batch[place].inputs);
      for (const py::handle output : outputs) add_output(output.ptr(), answer);
      if (answer.steps.size() != answer.inputs.size()) {
        throw UsageError("query_many() gave " + std::to_string(answer.steps.size()) +
                         " outputs to a word of " + std::to_string(answer.inputs.size()));
      }
    }
    if (answers.size() != batch.size()) {
      throw UsageError("query_many() was asked " + std::to_string(batch.size()) +
                       " words and answered " + std::to_string(answers.size()));
    }
    return answers;
  }

  void step(Symbol input, SulAnswer& answer) {
    const py::object output = call(PyObject_CallOneArg(step_.ptr(), inputs_[input].ptr()));
    answer.inputs.push_back(input);
    add_output(output.ptr(), answer);
  }

  static py::object call(PyObject* result) {
    if (result == nullptr) throw py::error_already_set();
    return py::reinterpret_steal<py::object>(result);
  }

  void add_output(PyObject* output, SulAnswer& answer) {
    SulStep& step = answer.steps.emplace_back();
    if (output == Py_None) return;
    PyObject* known = PyDict_GetItemWithError(names_.ptr(), output);
    std::string fresh;
    if (known != nullptr) {
      fresh = text_of(known);
    } else {
      const bool is_hashable = PyErr_Occurred() == nullptr;
      PyErr_Clear();
      const py::str name = call(PyObject_Str(output));
      fresh = text_of(name.ptr());
      if (is_hashable) names_[py::handle(output)] = name;
    }
    if (!fresh.empty()) step.events.push_back({0, std::move(fresh)});
  }

  static std::string text_of(PyObject* text) {
    Py_ssize_t size = 0;
    const char* bytes = PyUnicode_AsUTF8AndSize(text, &size);
    if (bytes == nullptr) throw py::error_already_set();
    return std::string(bytes, static_cast<std::size_t>(size));
  }

  static std::string_view output_of(const SulStep& step) {
    return step.events.empty() ? "quiet" : std::string_view(step.events.front().output);
  }

  py::object system_, reset_, step_, query_many_;
  std::vector<py::object> inputs_;
  py::dict names_;  // of outputs that were seen, as texts
  SulInfo info_;
  std::shared_ptr<Thrown> thrown_;
};

}  // namespace maide::python
