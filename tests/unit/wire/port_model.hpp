// The reference port's behaviour written down by hand, from the tables of YARP 3.9.1's ports: what
// the port wrapper must answer to every word. Not derived from the port's code.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "maide/sul/sul.hpp"

namespace maide::test {

class PortModel {
 public:
  explicit PortModel(const SulInfo& info) : info_(info), kind_(info.options.at("kind")) {}

  SulStep step(Symbol input) {
    const std::string& name = info_.inputs[input].name;
    SulStep step;
    if (name == "write" ? writer_waits_ : reader_waits_) {
      step.status = StepStatus::refused;
      return step;
    }
    if (name == "write" && is_beyond_bound()) {
      step.status =
          info_.options.at("at-bound") == "absorb" ? StepStatus::absorbed : StepStatus::unexplored;
      return step;
    }
    name == "write" ? write() : read(name == "tryread");
    // Canonical order: the writer's events before the reader's.
    for (const std::string& event : writer_events_) add(step, 0, event);
    for (const std::string& event : reader_events_) add(step, 1, event);
    writer_events_.clear();
    reader_events_.clear();
    if (writer_waits_) step.busy.push_back(0);
    if (reader_waits_) step.busy.push_back(1);
    return step;
  }

 private:
  bool is_beyond_bound() const {
    return kind_ == "strict" && kept_.size() >= std::stoul(info_.options.at("size"));
  }
  void write() {
    ++written_;
    if (kind_ == "buffered") kept_.clear();
    kept_.push_back(written_);
    if (kind_ == "port" && !reader_waits_) {
      writer_waits_ = true;
    } else {
      writer_events_.push_back("written");
    }
    if (reader_waits_) deliver();
  }
  void read(bool at_once) {
    if (!kept_.empty()) {
      deliver();
    } else if (at_once) {
      reader_events_.push_back("null");
    } else {
      reader_waits_ = true;
    }
  }
  void deliver() {
    const std::size_t number = kept_.front();
    kept_.pop_front();
    reader_waits_ = false;
    if (writer_waits_) writer_events_.push_back("written");
    writer_waits_ = false;
    if (info_.options.at("payload") == "none") {
      reader_events_.push_back("message");
    } else {
      reader_events_.push_back(number == last_read_ + 1 ? "next" : "gap");
    }
    last_read_ = number;
  }
  void add(SulStep& step, std::uint32_t actor, const std::string& event) const {
    for (const SulOutput& output : info_.outputs) {
      if (output.name == event) step.events.push_back({actor, event});
    }
  }

  const SulInfo& info_;
  std::string kind_;
  std::deque<std::size_t> kept_;
  std::size_t written_ = 0, last_read_ = 0;
  bool writer_waits_ = false, reader_waits_ = false;
  std::vector<std::string> writer_events_, reader_events_;
};

// The answer as one line, to compare and to print: "write: quiet [writer]".
inline std::string to_line(const std::vector<SulStep>& steps, const Word& word,
                           const SulInfo& info) {
  std::string line;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    line += info.inputs[word[i]].name + ": " + mealy_output(steps[i], Translation::eager);
    if (!steps[i].busy.empty()) line += " [";
    for (const std::uint32_t actor : steps[i].busy) line += info.actors[actor] + ' ';
    if (!steps[i].busy.empty()) line.back() = ']';
    line += "; ";
  }
  return line;
}

}  // namespace maide::test
