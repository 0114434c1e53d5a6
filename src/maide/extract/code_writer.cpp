#include "maide/extract/code_writer.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace maide::extract {

Program CodeWriter::write(Phase phase, int node, const std::function<void()>& body) {
  Program program;
  const auto blocks = std::exchange(blocks_, {&program.code});
  auto* const variables = std::exchange(variables_, &program.variables);
  const auto raised = std::exchange(raised_, {});
  Scope* const scope = std::exchange(scope_, nullptr);
  const Phase outer_phase = std::exchange(phase_, phase);
  const int outer_node = std::exchange(node_, node);
  const int outer_program = std::exchange(program_, ++programs_);
  const int conditional = std::exchange(conditional_, 0);
  const int tries = std::exchange(tries_, 0);
  const std::string thrown = std::exchange(throw_flag_, fresh("t"));
  {
    const Scope whole(*this);
    body();
  }
  simplify(program.code);
  throw_flag_ = thrown;
  tries_ = tries;
  conditional_ = conditional;
  program_ = outer_program;
  node_ = outer_node;
  phase_ = outer_phase;
  scope_ = scope;
  raised_ = raised;
  variables_ = variables;
  blocks_ = blocks;
  return program;
}

void CodeWriter::emit(std::string text, const Place& place) {
  Code code;
  code.text = std::move(text);
  code.place = place;
  ++written_;
  append(std::move(code));
}

void CodeWriter::set(const std::string& name, const std::string& value) {
  Code code;
  code.kind = Code::Kind::set;
  code.text = name;
  code.value = value;
  append(std::move(code));
}

std::string CodeWriter::fresh(const std::string& stem, std::vector<std::string> values) {
  std::string name = stem + "_" + std::to_string(next_name_++);
  if (variables_ != nullptr) variables_->push_back({name, std::move(values)});
  return name;
}

void CodeWriter::hole(const Place& place, const std::string& text, bool escapes) {
  if (silent_ > 0) return;
  const bool is_placed = phase_ == Phase::callback && !blocks_.empty();
  const std::size_t written = written_;
  if (is_placed) emit("unknown;", place);
  written_ = written;
  say({text, place, is_placed && !escapes});
}

void CodeWriter::note(const Place& place, const std::string& text) {
  if (silent_ == 0) say({text, place, false});
}

// Each once.
void CodeWriter::say(const Hole& found) {
  if (std::ranges::find(model_.holes, found) == model_.holes.end()) model_.holes.push_back(found);
}

std::vector<Code> CodeWriter::aside(const std::function<void()>& body) {
  std::vector<Code> code;
  blocks_.push_back(&code);
  body();
  blocks_.pop_back();
  return code;
}

void CodeWriter::unwritten(const std::function<void()>& body) {
  const std::set<std::string> before = raised_;
  const std::size_t written = written_;
  ++silent_;
  ++conditional_;
  aside([&] {
    const Scope scope(*this);
    body();
  });
  --conditional_;
  --silent_;
  written_ = written;
  raised_ = before;
}

void CodeWriter::branch_on(const std::string& condition, const Place& place,
                           const std::function<void()>& then,
                           const std::function<void()>& otherwise) {
  if (condition == "true" || condition == "false") {
    (condition == "true" ? then : otherwise)();
    return unwritten(condition == "true" ? otherwise : then);
  }
  Code code;
  code.kind = Code::Kind::branch;
  code.text = condition.empty() ? "*" : condition;
  code.place = place;
  code.arms.resize(2);
  ++conditional_;
  for (const bool is_first : {true, false}) {
    code.arms[is_first ? 0 : 1].code = aside([&] {
      const Scope scope(*this);
      (is_first ? then : otherwise)();
    });
  }
  --conditional_;
  append(std::move(code));
}

std::string CodeWriter::choose_last(const Place& place) {
  std::string last = fresh("l");
  set(last, "false");
  branch_on("fair *", place, [&] { set(last, "true"); });
  return last;
}

void CodeWriter::guard_rest(const std::set<std::string>& before) {
  std::string condition;
  std::set<std::string> guarded;
  for (const std::string& flag : raised_) {
    if (before.contains(flag)) continue;
    condition += (condition.empty() ? "!" : " && !") + flag;
    guarded.insert(flag);
  }
  if (condition.empty()) return;
  // In the rest they are lowered, so that who raises one there is seen.
  for (const std::string& flag : guarded) raised_.erase(flag);
  auto code = std::make_shared<Code>();
  code->kind = Code::Kind::branch;
  code->text = condition;
  code->arms.resize(2);
  blocks_.push_back(&code->arms[0].code);
  ++conditional_;
  scope_->at_end([this, code, guarded] {
    --conditional_;
    blocks_.pop_back();
    append(std::move(*code));
    raised_.insert(guarded.begin(), guarded.end());
  });
}

bool CodeWriter::has_begun() const {
  return std::ranges::any_of(blocks_, [](const auto* block) { return has_steps(*block); });
}

void CodeWriter::raise(const std::string& flag) {
  set(flag, "true");
  raised_.insert(flag);
}

}  // namespace maide::extract
