// What the two forms of a system in Promela have in common: lines that know their meaning, names,
// the idling process and the claim of a formula.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/check/engines/export/promela_system.hpp"
#include "maide/formats/names.hpp"

namespace maide {

inline constexpr std::size_t most_promela_names = 250;  // SPIN's numbers of processes are bytes

// Names of a system as Promela identifiers. They are readable, distinct, and none of the words that
// SPIN or the text of a system uses itself.
class PromelaNames {
 public:
  PromelaNames();
  // The identifier of `name` with `prefix`; the same for the same pair.
  const std::string& of(std::string_view prefix, std::string_view name);
  // One that no other call gives.
  std::string another(std::string_view prefix, std::string_view name);

 private:
  std::map<std::pair<std::string, std::string>, std::string> known_;
  Identifiers identifiers_;
};

class PromelaText {
 public:
  PromelaText() { result_.lines.emplace_back(); }

  void line(const std::string& text, const PromelaLine& meaning = {});
  // The file's name and what the text is for.
  void heading(const System& system, PromelaOptions::Purpose purpose);
  // Once nothing can happen any more, the last state repeats and the last event is forgotten. A
  // process does that: pan's own extension of finite runs is lost under weak fairness. `head` is
  // "proctype", or "active proctype".
  void idling(std::string_view head, bool has_events);
  // Macros p0, p1, ... of the formula's atoms, `expressions` in their order, and the claim over
  // these. With cuts, each literal holds once `cut` does.
  void claim(const Formula& formula, const std::vector<std::string>& expressions, bool has_cuts);

  PromelaSystem& result() { return result_; }

 private:
  PromelaSystem result_;
};

// For comments.
std::string promela_comment(std::string text);

// Programs and models as processes that meet on channels.
PromelaSystem write_promela_rendezvous(const System& system, const PromelaOptions& options);
// Models as variables, each step one d_step.
PromelaSystem write_promela_steps(const System& system, const PromelaOptions& options);

}  // namespace maide
