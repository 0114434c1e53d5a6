// Runs the real program `maide` as a person would, for tests of the command line.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "maide/base/json.hpp"
#include "maide/base/subprocess.hpp"

namespace maide::test {

// maide with these arguments, its input empty; ended after ten minutes.
SubprocessResult run_maide(const std::vector<std::string>& arguments);

// A shell script in which "$maide" is the program; for redirections and pipes.
SubprocessResult run_with_maide(const std::string& script);

// What maide with these arguments shows on a terminal on which that is typed, whose end is Ctrl-D;
// its exit status. `typed` may have control characters, such as Ctrl-C ("\x03").
SubprocessResult run_on_terminal(const std::vector<std::string>& arguments,
                                 const std::string& typed);

// The one JSON object on standard output; fails the test if that is not what is there.
Json json_of(const SubprocessResult& result);

// Checks what every error must look like: nothing on standard output, exactly one line on standard
// error, which begins with "maide: " and contains `text`, and the exit status.
void expect_error(const SubprocessResult& result, int exit_status, const std::string& text);

// ---- Pages with a script ----

// Whether Node is there.
bool can_step_through();
// What step_through.py says of a page when these keys are pressed, a line each; fails the test
// where the page is not well-formed, loads something, or its script fails.
std::string step_through(const std::string& page, const std::string& keys);

}  // namespace maide::test
