// maide-wrap-port as a server.
#pragma once

#include <poll.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "maide/wire/client/child_process.hpp"
#include "maide/wire/protocol/line_io.hpp"

namespace maide::test {

// maide-wrap-port --listen on a free port.
class ListeningWrapper {
 public:
  explicit ListeningWrapper(std::vector<std::string> arguments = {}) {
    std::vector<std::string> argv = {MAIDE_BINARY_DIR "/bin/maide-wrap-port", "--listen",
                                     "127.0.0.1:0"};
    argv.insert(argv.end(), arguments.begin(), arguments.end());
    process_ = std::make_unique<ChildProcess>(argv);
    LineSplitter lines;
    std::string bytes;
    std::optional<std::string> line;
    while (!(line = lines.take_line())) {
      pollfd waiting{process_->output.get(), POLLIN, 0};
      ::poll(&waiting, 1, 100);
      const ReadResult result = read_some(process_->output.get(), bytes);
      if (result == ReadResult::ended) throw std::runtime_error("it does not listen");
      if (result == ReadResult::some) lines.append(bytes);
    }
    address_ = line->substr(line->rfind(' ') + 1);
  }
  const std::string& address() const { return address_; }
  pid_t process() const { return process_->id(); }

  // It goes away, and so do the processes that serve its clients.
  void kill() { process_->kill(); }

 private:
  std::unique_ptr<ChildProcess> process_;
  std::string address_;
};

}  // namespace maide::test
