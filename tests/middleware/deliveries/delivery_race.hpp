// Messages on their way, as a real middleware delivers them. A writer writes a map, and then there
// is a notice. A reader that has the notice looks for the map: a miss is a round in which the map
// is not there yet. Each middleware has a program that plays such rounds and prints one line of
// JSON.
#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>

namespace maide::deliveries {

enum class Topic : std::uint8_t { map, notice };
constexpr std::array both_topics{Topic::map, Topic::notice};

// KEY=VALUE of the command line; a program may add what both ends have to know.
class Settings {
 public:
  // Throws std::runtime_error where there is no '='.
  Settings(int count, const char* const* words);

  std::string text(const std::string& key, const std::string& otherwise) const;
  // Throws std::runtime_error where it is no number.
  std::uint32_t number(const std::string& key, std::uint32_t otherwise) const;
  bool is(const std::string& key, const std::string& value, const std::string& otherwise) const {
    return text(key, otherwise) == value;
  }
  void add(const std::string& key, const std::string& value) { values_[key] = value; }

  bool has_two_processes() const { return is("ends", "processes", "threads"); }
  bool is_reliable() const { return is("reliability", "reliable", "reliable"); }

 private:
  std::map<std::string, std::string> values_;
};

class Writer {
 public:
  virtual ~Writer() = default;
  virtual void write(Topic topic, std::uint32_t number, std::size_t size) = 0;
};

// Which topics have something unread.
struct Found {
  bool map = false, notice = false;
};

// A look that asks `has_data(topic)` of one topic after the other. Between two questions a thread
// may lose its processor; here it does.
template <typename HasData>
Found look_in_turn(const HasData& has_data) {
  Found found;
  found.map = has_data(Topic::map);
  std::this_thread::sleep_for(std::chrono::microseconds(100));
  found.notice = has_data(Topic::notice);
  return found;
}

class Reader {
 public:
  virtual ~Reader() = default;
  // Takes all that is there, without waiting; the newest number, if there is one.
  virtual std::optional<std::uint32_t> take(Topic topic) = 0;
  // Waits for either topic, at most so long, and tells what was found.
  virtual Found look(std::chrono::milliseconds limit) = 0;
};

// What one process has of the middleware.
class Middleware {
 public:
  virtual ~Middleware() = default;
  // Called once each, at most.
  virtual std::unique_ptr<Writer> make_writer() = 0;
  virtual std::unique_ptr<Reader> make_reader() = 0;
};

// What library=slow does to a thread, or to another process that has one.
void slow_down(pid_t thread);

struct Program {
  // Called before there is a second process; may be empty.
  std::function<void(Settings&)> prepare;
  // Called in each process. What it throws ends the program.
  std::function<std::unique_ptr<Middleware>(const Settings&)> start;
};

// The main() of such a program. All have these settings:
// - ends=threads: of one process. With participants the reader has a participant of its own, with
//   processes a process of its own.
// - notice=topic: the notice is a message of another topic. The reader waits for it, then tries the
//   map.
// - notice=call: the notice is a word of shared memory, which the writer sets when its call has
//   returned. Does the call return before the reader can have the map?
// - notice=look: as topic, but the reader has both only by looks at both topics at once, one after
//   the other without a pause. A miss is a look that finds the notice and not the map.
// - size=100: bytes of a map.
// - rounds=200.
// - reliability=reliable, or best_effort.
// - library=slow: all share one processor, which the middleware's own threads get only where the
// two
//   ends rest. A message that such a thread hands over comes late then.
// Prints {"rounds", "misses", "late", "lost", "unnoticed"}: of the misses, late ones came within
// some time, lost ones did not; where the notice itself was lost nothing is said of the map.
int run(int count, char** words, const Program& program);

}  // namespace maide::deliveries
