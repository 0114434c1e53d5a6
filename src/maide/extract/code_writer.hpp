// Writes programs while functions are walked through: blocks, branches, and flags.
//
// A return, a break, a continue and a throw raise a flag, a variable of the program. What would be
// left out stands under a condition on it. So what is to be done at the end of a scope, such as to
// give a lock back, is done on every way.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/extract/model.hpp"

namespace maide::extract {

// What kind of code is walked through. In a callback or thread a hole has a place.
enum class Phase : std::uint8_t { start, callback, unreached };

class CodeWriter {
 public:
  explicit CodeWriter(Model& model) : model_(model) {}

  // What is asked for is done when the scope ends, last things first.
  class Scope {
   public:
    explicit Scope(CodeWriter& owner) : owner_(owner), outer_(owner.scope_) { owner.scope_ = this; }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope() {
      while (!ends_.empty()) {
        const std::function<void()> end = std::move(ends_.back());
        ends_.pop_back();
        end();
      }
      owner_.scope_ = outer_;
    }
    void at_end(std::function<void()> end) { ends_.push_back(std::move(end)); }

   private:
    CodeWriter& owner_;
    Scope* outer_;
    std::vector<std::function<void()>> ends_;
  };

  // Writes a program by `body`; what is being written goes on behind it.
  Program write(Phase phase, int node, const std::function<void()>& body);

  void emit(std::string text, const Place& place);
  void append(Code code) {
    if (code.kind == Code::Kind::select || code.kind == Code::Kind::timed) ++written_;
    blocks_.back()->push_back(std::move(code));
  }
  void set(const std::string& name, const std::string& value);
  // A variable of this program, whose name begins so.
  std::string fresh(const std::string& stem, std::vector<std::string> values = {});
  void declare(const std::string& name, std::vector<std::string> values) {
    if (variables_ != nullptr) variables_->push_back({name, std::move(values)});
  }
  void hole(const Place& place, const std::string& text, bool escapes);
  // A hole that cuts no run: what is written stands for most of what may be.
  void note(const Place& place, const std::string& text);
  void branch_on(
      const std::string& condition, const Place& place, const std::function<void()>& then,
      const std::function<void()>& otherwise = [] {});
  // The same, of two sides that nothing tells apart.
  void either(
      const Place& place, const std::function<void()>& one,
      const std::function<void()>& other = [] {}) {
    branch_on("", place, one, other);
  }
  // A variable that says whether this is the last time round: it is at last, if code comes here
  // again and again.
  std::string choose_last(const Place& place);
  // What is written by `body`, apart from the program.
  std::vector<Code> aside(const std::function<void()>& body);
  // Goes through code for the account alone: nothing is written, no hole noted.
  void unwritten(const std::function<void()>& body);
  // The rest of the innermost scope is done only if no flag was raised since then.
  void guard_rest(const std::set<std::string>& before);
  void at_scope_end(std::function<void()> end) { scope_->at_end(std::move(end)); }

  void raise(const std::string& flag);
  void lower(const std::string& flag) { raised_.erase(flag); }
  const std::set<std::string>& raised() const { return raised_; }
  void restore_raised(std::set<std::string> flags) { raised_ = std::move(flags); }

  Phase phase() const { return phase_; }
  int node() const { return node_; }
  int program() const { return program_; }
  bool is_silent() const { return silent_ > 0; }
  // Whether what is walked through may be done not at all, or several times.
  bool is_conditional() const { return conditional_ > 0; }
  void enter_condition() { ++conditional_; }
  void leave_condition() { --conditional_; }
  // Whether the program that is being written has steps.
  bool has_begun() const;
  // How many steps and branches were written so far.
  std::size_t written() const { return written_; }
  std::string& throw_flag() { return throw_flag_; }
  int& tries() { return tries_; }

 private:
  void say(const Hole& found);
  Model& model_;
  std::vector<std::vector<Code>*> blocks_;
  std::vector<CodeVariable>* variables_ = nullptr;
  std::set<std::string> raised_;  // flags that may be set and that nothing has looked at yet
  Scope* scope_ = nullptr;
  Phase phase_ = Phase::start;
  std::string throw_flag_;
  int tries_ = 0;  // around what is written
  int node_ = none;
  int program_ = 0, programs_ = 0;
  int conditional_ = 0, silent_ = 0;
  int next_name_ = 0;
  std::size_t written_ = 0;
};

}  // namespace maide::extract
