// kill -9 of the service that a middleware needs beside the wrapper (a broker, a master), and of
// the wrapper itself, while a model is learned.
#pragma once

#include <cstddef>
#include <string>

#include "wrapper_checks.hpp"

namespace maide::test {

// Learns from maide-wrap-`name` again and again while its service and it are killed in turn, at
// moments that chance chooses, until there were `kills`, or as many as the environment says in
// MAIDE_TEST_KILLS. Fails the test unless each run ends with `model` and as many words as an
// undisturbed one, and no process is left behind.
void expect_same_model_when_killed(const std::string& name, const SystemOptions& options,
                                   const Mealy& model, std::size_t kills);

}  // namespace maide::test
