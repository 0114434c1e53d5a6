// Unrolling of a program's syntax tree into its automaton. The idea: a place in the program is a
// stack of frames (block, index in it, rounds left), hash-consed, as in a continuation; `settle`
// walks a place forward through everything that costs no step until it rests before a statement
// that steps, collecting the labels it passes. Control states are the resting places with their
// labels, so a label on a loop holds on the first round only.
// Invariant: settling ends, because each round of a loop's or a repeat's body takes a step (a body
// without one is an error in a loop, and is walked once in a repeat).
#include "maide/check/language/program.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

#include "maide/base/hash.hpp"
#include "maide/check/language/program_syntax.hpp"

namespace maide {

bool Program::has_label(ControlState state, std::uint32_t label) const {
  const auto& set = label_sets[states[state].label_set];
  return std::binary_search(set.begin(), set.end(), label);
}

bool Program::may_end() const {
  return std::any_of(states.begin(), states.end(),
                     [](const State& state) { return state.edge_count == 0; });
}

bool Program::may_reach(std::uint32_t label) const {
  return std::any_of(label_sets.begin(), label_sets.end(), [&](const auto& set) {
    return std::binary_search(set.begin(), set.end(), label);
  });
}

namespace program_syntax {
namespace {

using FrameId = std::uint32_t;
constexpr FrameId no_frame = 0;  // nothing is left to do: the program ends
constexpr std::uint32_t for_ever = ~std::uint32_t{0};

struct Frame {
  const Block* block = nullptr;
  std::uint32_t index = 0;   // of the next statement
  std::uint32_t rounds = 1;  // of the block, this one included
  FrameId parent = no_frame;
  bool operator==(const Frame&) const = default;
};

struct FrameHash {
  std::size_t operator()(const Frame& frame) const {
    std::size_t hash = std::hash<const void*>{}(frame.block);
    for (const std::uint32_t part : {frame.index, frame.rounds, frame.parent}) {
      hash = hash_mix(hash, part);
    }
    return hash;
  }
};

// Some statement of the block takes a step, or ends the program.
bool takes_step(const Block& block) {
  return std::any_of(block.begin(), block.end(), [](const Statement& statement) {
    switch (statement.kind) {
      case Statement::Kind::skip: return false;
      case Statement::Kind::repeat: return statement.count > 0 && takes_step(*statement.body);
      default: return true;
    }
  });
}

class Unroller {
 public:
  Unroller(const Tree& tree, const std::string& name, const SourcePosition& position)
      : tree_(tree) {
    program_.name = name;
    program_.position = position;
    program_.labels = tree.labels;
    program_.label_sets.emplace_back();
    program_.rounds.emplace_back();
    frames_.emplace_back();
    frame_rounds_.push_back(0);
  }

  Program run() {
    check_loops(tree_.statements);
    settle(intern({&tree_.statements, 0, 1, no_frame}));
    for (std::size_t next = 0; next < places_.size(); ++next) expand(places_[next]);
    return std::move(program_);
  }

 private:
  // A resting place: before the statement, or (`awaits`) after its input was given.
  struct Place {
    FrameId frame = no_frame;
    bool awaits = false;
    std::uint32_t label_set = 0;
    auto operator<=>(const Place&) const = default;
  };
  struct PlaceHash {
    std::size_t operator()(const Place& place) const {
      return hash_mix(hash_mix(0, std::size_t{place.frame} * 2 + place.awaits), place.label_set);
    }
  };

  // And notes which blocks are bodies of loops.
  void check_loops(const Block& block) {
    for (const Statement& statement : block) {
      if (statement.kind == Statement::Kind::loop && !takes_step(*statement.body)) {
        throw ParseError(
            "this loop would go round for ever without a step: nothing in it gives "
            "an input, waits or chooses",
            {program_.position.file, statement.line, statement.column});
      }
      if (statement.kind == Statement::Kind::loop || statement.kind == Statement::Kind::repeat) {
        loops_.emplace(statement.body.get(), &statement);
      }
      if (statement.body) check_loops(*statement.body);
      if (statement.otherwise) check_loops(*statement.otherwise);
      for (const Arm& arm : statement.arms) check_loops(*arm.body);
    }
  }

  // `before`: the frame of the same block and round that it follows; none: it is the first.
  FrameId intern(const Frame& frame, FrameId before = no_frame) {
    const auto [place, is_new] =
        frame_ids_.try_emplace(frame, static_cast<FrameId>(frames_.size()));
    if (is_new) {
      frames_.push_back(frame);
      frame_rounds_.push_back(before == no_frame ? make_round(frame) : frame_rounds_[before]);
    }
    return place->second;
  }

  // The round of the innermost loop that a block's first frame is in.
  std::uint32_t make_round(const Frame& first) {
    const std::uint32_t outer = frame_rounds_[first.parent];
    const auto loop = loops_.find(first.block);
    if (loop == loops_.end()) return outer;
    const Statement& statement = *loop->second;
    Program::Round round{outer, statement.line, statement.column, 0, 0};
    if (statement.kind == Statement::Kind::repeat) {
      round.number = statement.count - first.rounds + 1;
      round.count = statement.count;
    }
    program_.rounds.push_back(round);
    return static_cast<std::uint32_t>(program_.rounds.size() - 1);
  }

  // The frame behind the statement of `id`.
  FrameId behind(FrameId id) {
    Frame frame = frames_[id];
    ++frame.index;
    return intern(frame, id);
  }

  // The control state in which a program rests that goes on at `id`; new ones are queued.
  ControlState settle(FrameId id) {
    std::vector<std::uint32_t> labels;
    for (; id != no_frame; id = pass(id)) {
      const Frame frame = frames_[id];
      if (frame.index == frame.block->size()) continue;
      const Statement& statement = (*frame.block)[frame.index];
      labels.insert(labels.end(), statement.labels.begin(), statement.labels.end());
      if (statement.kind == Statement::Kind::stop) {
        id = no_frame;
        break;
      }
      if (statement.kind == Statement::Kind::give || statement.kind == Statement::Kind::wait ||
          statement.kind == Statement::Kind::choice) {
        break;
      }
    }
    const bool awaits = id != no_frame && statement_at(id).kind == Statement::Kind::wait;
    return control_state({id, awaits, intern_labels(std::move(labels))});
  }

  const Statement& statement_at(FrameId id) const {
    return (*frames_[id].block)[frames_[id].index];
  }

  // Where control goes from `id` without a step: at a block's end, at a loop, repeat or skip.
  FrameId pass(FrameId id) {
    const Frame frame = frames_[id];
    if (frame.index == frame.block->size()) {
      if (frame.rounds == 1) return frame.parent;
      const std::uint32_t left = frame.rounds == for_ever ? for_ever : frame.rounds - 1;
      return intern({frame.block, 0, left, frame.parent});
    }
    const Statement& statement = (*frame.block)[frame.index];
    const FrameId next = behind(id);
    if (statement.kind == Statement::Kind::loop) {
      return intern({statement.body.get(), 0, for_ever, next});
    }
    if (statement.kind == Statement::Kind::repeat && statement.count > 0) {
      const std::uint32_t rounds = takes_step(*statement.body) ? statement.count : 1;
      return intern({statement.body.get(), 0, rounds, next});
    }
    return next;
  }

  std::uint32_t intern_labels(std::vector<std::uint32_t> labels) {
    if (labels.empty()) return 0;
    std::sort(labels.begin(), labels.end());
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    auto& sets = program_.label_sets;
    const auto [place, is_new] =
        label_set_ids_.try_emplace(labels, static_cast<std::uint32_t>(sets.size()));
    if (is_new) sets.push_back(std::move(labels));
    return place->second;
  }

  ControlState control_state(const Place& place) {
    const auto [entry, is_new] =
        control_states_.try_emplace(place, static_cast<ControlState>(places_.size()));
    if (is_new) {
      if (places_.size() == max_control_states) throw too_large(place);
      places_.push_back(place);
    }
    return entry->second;
  }

  ParseError too_large(const Place& place) const {
    SourcePosition where = program_.position;
    if (place.frame != no_frame) {
      where.line = statement_at(place.frame).line;
      where.column = statement_at(place.frame).column;
    }
    return ParseError("program " + program_.name + " unrolls to more than " +
                          std::to_string(max_control_states) + " control states",
                      where);
  }

  void expand(const Place place) {
    program_.states.push_back({static_cast<std::uint32_t>(program_.edges.size()), 0,
                               place.label_set, frame_rounds_[place.frame]});
    if (place.frame == no_frame) return;
    const Statement& statement = statement_at(place.frame);
    const auto add = [&](ProgramEdge edge) { program_.edges.push_back(edge); };
    using Kind = ProgramEdge::Kind;
    if (statement.kind == Statement::Kind::choice) {
      for (const Symbol branch : {0U, 1U}) {
        const Block* body = branch == 0 ? statement.body.get() : statement.otherwise.get();
        const ControlState target = settle(intern({body, 0, 1, behind(place.frame)}));
        add({Kind::choice, 0, branch, target, statement.line, statement.column});
      }
    } else if (place.awaits) {
      for (const Arm& arm : statement.arms) {
        const ControlState target = settle(intern({arm.body.get(), 0, 1, behind(place.frame)}));
        add({arm.is_quiet ? Kind::quiet : Kind::take, statement.model, arm.output, target, arm.line,
             arm.column});
      }
    } else {
      const ControlState target = statement.arms.empty() ? settle(behind(place.frame))
                                                         : control_state({place.frame, true, 0});
      add({Kind::give, statement.model, statement.input, target, statement.line, statement.column});
    }
    auto& state = program_.states.back();
    state.edge_count = static_cast<std::uint32_t>(program_.edges.size()) - state.first_edge;
  }

  const Tree& tree_;
  Program program_;
  std::vector<Frame> frames_;                // [no_frame] is not used
  std::vector<std::uint32_t> frame_rounds_;  // by frame: index into the program's rounds
  std::unordered_map<Frame, FrameId, FrameHash> frame_ids_;
  std::unordered_map<const Block*, const Statement*> loops_;  // by body
  std::map<std::vector<std::uint32_t>, std::uint32_t> label_set_ids_;
  std::unordered_map<Place, ControlState, PlaceHash> control_states_;
  std::vector<Place> places_;  // by control state
};

}  // namespace

Program unroll(const Tree& tree, const std::string& name, const SourcePosition& position) {
  return Unroller(tree, name, position).run();
}

}  // namespace program_syntax

Program parse_program(const std::string& name, const ScalarText& text,
                      std::span<const ProgramInterface> models) {
  const program_syntax::Tree tree = program_syntax::parse(text, models);
  Program program = program_syntax::unroll(tree, name, text.position(0));
  program.unreachable = program_syntax::find_unreachable(tree, program.position.file);
  program.last_line = text.position(text.value().find_last_not_of(" \t\r\n")).line;
  return program;
}

}  // namespace maide
