// The systems of bench_check: what robots' programs look like, in sizes of one's choice. Each is a
// system file and the models that it names, with one property that needs all of its states.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace maide::bench {

struct ModelText {
  std::string file;  // relative to the system file
  std::string dot;
};

struct SystemText {
  std::string name;
  std::string yaml;  // has the property `response`, LTL without fairness, which holds
  std::vector<ModelText> models;
  std::string promela;  // the same as one would write it for SPIN; "": nobody did
};

// Case study 2 of the paper, the row 90*: two producers of 9n/10 and n messages, a consumer of n
// pairs that does not wait for the first queue, which drops when it is full. States grow with n^2.
SystemText grasping(unsigned n);

// Dijkstra's philosophers, the last of whom takes his forks in the other order; forks are models.
SystemText philosophers(unsigned count);

// A camera whose images pass `stages` queues of `size` images; the last stage acknowledges each
// burst, and the camera has at most two bursts of `size` under way.
SystemText pipeline(unsigned stages, unsigned size);

// Stations that hand on a token over mailboxes of one message; who holds it reads what its sensor
// wrote into a queue of `size` meanwhile.
SystemText token_ring(unsigned stations, unsigned size);

// Robots that share one map. The planner of each holds it while it sends two messages, and waits
// for the reply. Its relay reads both, takes the map, gives it back and replies. Without
// `response`, with `promela`.
SystemText robots(unsigned count);

// Writes the file and its models into `folder`; returns the file.
std::filesystem::path write_system(const SystemText& system, const std::filesystem::path& folder);

}  // namespace maide::bench
