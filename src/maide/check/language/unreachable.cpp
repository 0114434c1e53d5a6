#include "maide/check/language/unreachable.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace maide::program_syntax {
namespace {

class Finder {
 public:
  explicit Finder(const std::string& file) : file_(file) {}

  // Where control can go from a block or statement.
  struct Ways {
    bool on = true, leaves = false, returns = false;  // to its end, out of the loop, the procedure
    void operator|=(const Ways& other) {
      on = on || other.on;
      leaves = leaves || other.leaves;
      returns = returns || other.returns;
    }
  };

  Ways ways(const Block& block) {
    Ways result;
    for (const Statement& statement : block.statements) {
      if (!result.on) {
        if (statement.kind == Statement::Kind::end_callback) return result;  // no text says it
        found_.push_back({file_, statement.line, statement.column});
        return result;
      }
      result.on = false;
      result |= ways(statement);
    }
    return result;
  }

  std::vector<SourcePosition> take() { return std::move(found_); }

 private:
  Ways ways(const Statement& statement) {
    using Kind = Statement::Kind;
    Ways result{false, false, false};
    switch (statement.kind) {
      case Kind::stop:
      case Kind::end_process:
      case Kind::leave_callback: return result;
      case Kind::leave: return {false, true, false};
      case Kind::next_round: return {false, false, false};
      case Kind::leave_procedure: return {false, false, true};
      case Kind::loop:
      case Kind::repeat:
      case Kind::repeat_while:
      case Kind::repeat_for: {
        const Ways body = ways(*statement.body);
        const bool is_endless = statement.kind == Kind::loop || is_always(statement);
        return {!is_endless || body.leaves, false, body.returns};
      }
      case Kind::inner: {
        const Ways body = ways(*statement.body);
        return {body.on || body.returns, false, false};
      }
      case Kind::choice:
      case Kind::when:
        result |= ways(*statement.body);
        result |= ways(*statement.otherwise);
        return result;
      case Kind::select:
      case Kind::rounds:
        for (const SelectArm& arm : statement.select_arms) {
          if (arm.body) result |= ways(*arm.body);
          for (const Arm& output : arm.arms) result |= ways(*output.body);
        }
        return result;
      default: break;
    }
    result.on = statement.arms.empty();
    for (const Arm& arm : statement.arms) result |= ways(*arm.body);
    return result;
  }

  // The condition of a `while` is `true`. A `repeat` whose body does not come to its end ends
  // without a round alone.
  bool is_always(const Statement& statement) const {
    if (statement.kind == Statement::Kind::repeat) {
      return statement.expression->is_constant() && statement.expression->value > 0 &&
             !Finder(file_).can_end(*statement.body);
    }
    return statement.kind == Statement::Kind::repeat_while && statement.expression->is_constant() &&
           statement.expression->value != 0;
  }

  bool can_end(const Block& block) {
    const Ways result = ways(block);
    return result.on || has_next_round(block);
  }

  static bool has_next_round(const Block& block) {
    return std::ranges::any_of(block.statements, [](const Statement& s) {
      if (s.kind == Statement::Kind::next_round) return true;
      if (s.body && has_next_round(*s.body)) return true;
      if (s.otherwise && has_next_round(*s.otherwise)) return true;
      for (const Arm& arm : s.arms) {
        if (has_next_round(*arm.body)) return true;
      }
      for (const SelectArm& arm : s.select_arms) {
        if (arm.body && has_next_round(*arm.body)) return true;
        for (const Arm& output : arm.arms) {
          if (has_next_round(*output.body)) return true;
        }
      }
      return false;
    });
  }

  std::string file_;
  std::vector<SourcePosition> found_;
};

}  // namespace

std::vector<SourcePosition> find_unreachable(const Tree& tree, const std::string& file) {
  Finder finder(file);
  finder.ways(tree.statements);
  std::vector<SourcePosition> found = finder.take();
  const auto place = [](const SourcePosition& at) { return std::pair(at.line, at.column); };
  std::ranges::sort(found, [&](const auto& a, const auto& b) { return place(a) < place(b); });
  const auto is_same = [&](const auto& a, const auto& b) { return place(a) == place(b); };
  found.erase(std::unique(found.begin(), found.end(), is_same), found.end());
  return found;
}

}  // namespace maide::program_syntax
