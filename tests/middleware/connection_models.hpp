// What a connection between one writer and one reader should do, written by hand: the minimal Mealy
// machines over write and tryread (and disconnect and connect of the reader) of the ways to treat a
// message for which there is no room. Middleware differs in which of them it follows under which
// configuration, never in these.
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

// What a write without a reader does.
enum class WhenAlone {
  lose,          // the message is lost, the writer is not told
  as_when_full,  // there is no room
};

struct ConnectionModel {
  std::size_t capacity = 1;
  WhenFull when_full = WhenFull::drop_oldest;
  bool payload_gap = false;  // `next`, `gap` and `old` instead of `message`
  // A reader that disconnects loses what it has not read.
  bool reconnects = false;
  WhenAlone when_alone = WhenAlone::lose;
  std::string read_alone = "null";  // what a read says while disconnected
  // Messages that the writer keeps for a reader that connects, which has room for the newest.
  std::size_t replayed = 0;
  // Messages that found no room and that the writer keeps, but that never arrive, whatever room
  // there is later: nor does anything written after them.
  std::size_t stranded = 0;
  // The writer hears of messages that were read, and so of room, only in batches of this size.
  std::size_t credit_batch = 1;
  bool reads_all = false;  // a read gives all messages that are there
};

// Inputs write, tryread, and where it reconnects disconnect, connect; outputs of the reader and,
// for `fail`, `failed`; all else is quiet. Minimal.
Mealy make_connection(const ConnectionModel& model);

}  // namespace maide::test
