#include "maide/report/violation_text.hpp"

#include <fmt/format.h>

#include <functional>
#include <map>
#include <optional>

namespace maide {
namespace {

using Operator = FormulaNode::Operator;

class Violation {
 public:
  Violation(const System& system, const Trace& trace, const std::vector<GlobalState>& states)
      : system_(system), trace_(trace), states_(states), interfaces_(system.interfaces()) {
    const bool loops = trace.loop_start.has_value();
    length_ = states.size() + (loops ? 0 : 1);
    loop_ = loops ? *trace.loop_start + 1 : length_ - 1;
  }

  // Why the formula is `value` at the position.
  std::string why(const Formula& formula, std::size_t at, bool value) {
    const auto left = [&](std::size_t where, bool wanted) {
      return why(formula->left, where, wanted);
    };
    switch (formula->op) {
      case Operator::negation: return left(at, !value);
      case Operator::next: return left(at + 1 < length_ ? at + 1 : loop_, value);
      case Operator::conjunction:
      case Operator::disjunction: return why_of_two(formula, at, value);
      case Operator::implication:
        if (value) return holds(formula, at, true);
        return left(at, true) + ", but " + why(formula->right, at, false);
      case Operator::globally:
        if (value) return text(formula->left) + " holds for ever " + from(at);
        return left(first(at, [&](std::size_t i) { return !truth(formula->left)[i]; }), false);
      case Operator::finally:
        if (!value) return never(formula->left, at);
        return left(first(at, [&](std::size_t i) { return truth(formula->left)[i]; }), true);
      case Operator::until:
      case Operator::weak_until: return why_until(formula, at, value);
      case Operator::release: return why_release(formula, at, value);
      default: return holds(formula, at, value);
    }
  }

 private:
  const std::vector<bool>& truth(const Formula& formula) {
    const auto [place, is_new] = truths_.try_emplace(formula.get());
    if (is_new) place->second = evaluate_on_run(system_, formula, trace_, states_);
    return place->second;
  }

  // The first position from `at` on, in the order of the run.
  std::optional<std::size_t> find_first(std::size_t at,
                                        const std::function<bool(std::size_t)>& is_it) const {
    for (std::size_t i = at; i < length_; ++i) {
      if (is_it(i)) return i;
    }
    for (std::size_t i = loop_; i < at; ++i) {
      if (is_it(i)) return i;
    }
    return std::nullopt;
  }

  // The same, or `at` itself where only what follows a cut would show it.
  std::size_t first(std::size_t at, const std::function<bool(std::size_t)>& is_it) const {
    return find_first(at, is_it).value_or(at);
  }

  std::string text(const Formula& formula) const {
    std::string result = to_string(formula, {system_.programs, interfaces_});
    if (result.starts_with('(')) result = result.substr(1, result.size() - 2);
    return result;
  }

  std::string where(std::size_t at) const {
    if (at == 0) return "at the start";
    return at > trace_.steps.size() ? "at the end" : fmt::format("after step {}", at);
  }
  std::string from(std::size_t at) const {
    return at == 0                    ? "from the start"
           : at > trace_.steps.size() ? "from the end on"
                                      : fmt::format("from step {} on", at);
  }

  std::string holds(const Formula& formula, std::size_t at, bool value) const {
    const bool is_event = formula->op == Operator::atom && formula->atom.is_event();
    if (is_event && value) return fmt::format("step {} is {}", at, text(formula));
    return text(formula) + (value ? " holds " : " does not hold ") + where(at);
  }

  std::string never(const Formula& formula, std::size_t at) {
    if (formula->op == Operator::negation) {
      return text(formula->left) + " holds always " + from(at);
    }
    if (formula->op == Operator::globally) {  // fails again and again
      const std::size_t place =
          first(loop_, [&](std::size_t i) { return !truth(formula->left)[i]; });
      return text(formula->left) + " does not hold for ever: again and again, " +
             why(formula->left, place, false);
    }
    return text(formula) + " never holds" + (at == 0 ? "" : " " + from(at));
  }

  // && and ||, either of which may be wanted true or false.
  std::string why_of_two(const Formula& formula, std::size_t at, bool value) {
    const bool one_is_enough = (formula->op == Operator::disjunction) == value;
    const auto is = [&](const Formula& part) { return truth(part)[at] == value; };
    if (one_is_enough) {
      return why(is(formula->left) ? formula->left : formula->right, at, value);
    }
    return why(formula->left, at, value) + ", and " + why(formula->right, at, value);
  }

  std::string why_until(const Formula& formula, std::size_t at, bool value) {
    const auto& left = truth(formula->left);
    const auto& right = truth(formula->right);
    const auto end = find_first(at, [&](std::size_t i) { return right[i] || !left[i]; });
    if (!end) return value ? holds(formula, at, true) : never(formula->right, at);
    if (value) return why(formula->right, *end, true);
    return why(formula->left, *end, false) + ", before " + text(formula->right) + " holds";
  }

  std::string why_release(const Formula& formula, std::size_t at, bool value) {
    if (value) return holds(formula, at, true);
    const std::size_t end = first(at, [&](std::size_t i) { return !truth(formula->right)[i]; });
    return why(formula->right, end, false) + ", and " + text(formula->left) +
           " did not hold before";
  }

  const System& system_;
  const Trace& trace_;
  const std::vector<GlobalState>& states_;
  std::vector<ProgramInterface> interfaces_;
  std::size_t length_ = 0, loop_ = 0;
  std::map<const FormulaNode*, std::vector<bool>> truths_;
};

}  // namespace

std::string describe_violation(const System& system, const Formula& formula, const Trace& trace,
                               const std::vector<GlobalState>& states) {
  return Violation(system, trace, states).why(formula, 0, false);
}

}  // namespace maide
