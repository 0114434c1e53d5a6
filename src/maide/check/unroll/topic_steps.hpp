// Steps of a program with a topic: a write goes to the models of all readers that live, or to one
// of them, and what their calls return is collected and taken once. Each is a combined step, or a
// few that exclude each other: for each set of readers that live, and where the step depends on
// what was collected, for the first reader of which nothing was.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "maide/check/system/model_actions.hpp"
#include "maide/check/unroll/wire_uses.hpp"

namespace maide::program_syntax {

struct OfOthers;

class TopicSteps {
 public:
  // `number`: of the program. Keeps references.
  TopicSteps(std::uint32_t number, ModelActions& actions, const Names& names)
      : number_(number), actions_(actions), names_(names) {}

  // A write of this program, and the taking of what is collected for it if that is due at once.
  struct Writing {
    Uses uses, events;
    std::optional<std::string> output;  // that is taken
    bool is_beyond = false;             // the input was never tried in some model
    bool calls = false;                 // the program waits for its arrival
  };
  enum class WriteKind : std::uint8_t {
    statement,
    bare_arm,          // `on t.write { }`
    arm_with_outputs,  // `on t.write -> written { }`: only where the output is due at once
  };
  // `node`: of the callback in whose code it stands; "" without one. Here and below.
  const std::vector<Writing>& writings(const Topic& topic, const std::string& input, WriteKind kind,
                                       const std::string& node);
  // The writer takes what was collected.
  struct Taking {
    Uses uses, events;
    std::string output;
  };
  std::vector<Taking> takings(const Topic& topic);
  // For a writer: no model has an output due, and what it wrote is not collected.
  std::vector<Uses> quiet_of(const Topic& topic, const std::string& node);
  // That, and none of these arms can be taken: inputs, and whether they name outputs.
  struct WriteArm {
    std::string input;
    WriteKind kind = WriteKind::bare_arm;
  };
  std::vector<Uses> idle_of(const Topic& topic, const std::vector<WriteArm>& arms,
                            const std::string& node);
  // The wires from this program to the topic's readers; null: of one that gets all at once.
  std::vector<const Wire*> wires_to(const Topic& topic, const std::string& node) const;

 private:
  void add_writings(const Topic& topic, const std::string& input, WriteKind kind,
                    const std::string& node, const std::vector<bool>& living,
                    const OfOthers& others, std::vector<Writing>& writings);
  Uses taken_events(const Topic& topic, const std::string& output) const;
  void add_idle(const Topic& topic, const std::vector<WriteArm>& arms, const std::string& node,
                const OfOthers& others, std::vector<Uses>& ways);
  // The variable that says whose call has not returned, set to this program or to nobody.
  void set_caller(const Topic& topic, bool is_this, Uses& uses);

  std::uint32_t number_ = 0;
  ModelActions& actions_;
  const Names& names_;
  std::map<std::tuple<const Topic*, std::string, WriteKind, std::string>, std::vector<Writing>>
      writings_;
};

}  // namespace maide::program_syntax
