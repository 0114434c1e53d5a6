// What a connection between one writer and one reader should do, written by hand: the minimal Mealy
// machines over write and tryread of the three ways to treat a message for which there is no room.
// Middleware differs in which of them it follows under which configuration, never in these.
#pragma once

#include <cstddef>
#include <string>

#include "maide/automata/mealy.hpp"

namespace maide::test {

enum class WhenFull {
  drop_oldest,  // make room
  drop_newest,  // the message is lost, the writer is not told
  fail,         // the write says `failed`, the message was not sent
  block,        // the write waits until there is room
};

struct ConnectionModel {
  std::size_t capacity = 1;
  WhenFull when_full = WhenFull::drop_oldest;
  bool payload_gap = false;  // `next` and `gap` instead of `message`
};

// Inputs write, tryread; outputs of the reader and, for `fail`, `failed`; a write that fits is
// quiet. Minimal.
Mealy make_connection(const ConnectionModel& model);

}  // namespace maide::test
