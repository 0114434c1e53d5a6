// What reads the clock of a node whose timers go by a topic: each message makes each timer due, or
// not. That it makes one due comes again and again on fair runs; that it does not need never come.
//
//   loop { idle select { on clock.read { message { if fair * { "robot.tick.due" = true; } } } } }
#pragma once

#include <vector>

#include "maide/check/language/code.hpp"
#include "maide/check/language/program_tree.hpp"

namespace maide {

// `clock`: the topic. `place`: where the file names it.
syntax::Code make_clock_code(const syntax::Term& clock,
                             const std::vector<program_syntax::Callback>& callbacks,
                             const SourcePosition& place);

}  // namespace maide
