// The steps of `select`: each arm whose guard holds and whose model can take its part, and
// `otherwise` or `timeout` where there is none.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/unroll/edge_writer.hpp"

namespace maide::program_syntax {

class SelectSteps : public EdgeWriter {
 public:
  using EdgeWriter::EdgeWriter;

 protected:
  void expand_select(const Place& place, const Statement& statement, const Values& values);
  // An arm that waits for no other: its steps where its guard holds, and `also` is possible.
  // Behind it control goes on at `next`.
  void expand_guarded_arm(const Place& place, const SelectArm& arm, const Values& values,
                          const Uses& also, FrameId next);
  // The arm's steps where its guard holds, which asks for `conditions`.
  void expand_arm(const Place& place, const SelectArm& arm, const Values& values,
                  const Uses& conditions, std::uint32_t fair, FrameId next);
  // What an arm for an input does with its model in one of its steps.
  struct InputWay {
    Uses uses;                     // the first is of the model
    std::optional<Symbol> output;  // that is taken, too
    bool is_beyond = false;        // the input was never tried there
    std::string error{};           // where it is one
  };
  std::vector<InputWay> ways_of(const SelectArm& arm, std::uint32_t model, Symbol input);

 private:
  static std::string text_of_arm(const SelectArm& arm);
  // None of the outputs that the arm awaits ever follows its input.
  [[noreturn]] void fail_without_output(const SelectArm& arm, const std::string& input,
                                        const Alphabet& outputs, const Values& values) const;
  // `otherwise` and `timeout`: no arm whose guard holds can be taken, and none of their models has
  // an output due.
  void expand_otherwise(const Place& place, const Statement& statement, const SelectArm& waiting,
                        const Values& values);
  // What its time-out does: a program's requests that its arms wait for are overdue, and who waits
  // at a condition does so no more.
  Uses overdue_in(const Statement& statement, const Values& values);
  // Each is one way in which that can be. None: some arm can be taken whatever the models do.
  std::vector<Uses> idle_uses(const Statement& statement, const std::vector<std::int8_t>& guards,
                              const Values& values);
  static TopicSteps::WriteKind kind_of(const SelectArm& arm);
  // Of a mutex that knows its holder.
  std::vector<InputWay> ways_to_lock(const SelectArm& arm, std::uint32_t model, Symbol input);
  void expand_waking(const Place& place, const SelectArm& arm, const Values& values,
                     std::uint32_t fair);
  // The steps of an arm that writes to a topic, or takes what was written.
  template <typename Add>
  void expand_topic_arm(const Place& place, const SelectArm& arm, const Topic& topic,
                        const Values& values, FrameId next, const Add& add);
};

}  // namespace maide::program_syntax
