// A wrapper for a server that speaks lines of text over TCP: FTP, SMTP, POP3, Redis, a robot's
// console. Each input is a line that is sent; the output is what kind of answer comes. Every word
// has a connection of its own. What differs from server to server stands first. `maide new wrapper
// --tcp HOST:PORT --cpp` writes this file with your server's address and lines.
//
//   g++ -std=c++20 lines_wrapper.cpp -o maide-wrap-lines $(pkg-config --cflags --libs maide)
//   maide learn exec:./maide-wrap-lines -o server.dot
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <chrono>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "maide/wrapper.hpp"

namespace {

// ---- Yours to change ----

const std::string server = "127.0.0.1:2121";
// Input -> the line that is sent.
const std::map<std::string, std::string, std::less<>> lines_of_inputs = {
    {"HELP", "HELP"}, {"NOOP", "NOOP"}, {"QUIT", "QUIT"}};
// Sent when a word begins, so that no word sees what an earlier one left: "FLUSHALL" of Redis.
const std::vector<std::string> lines_of_reset = {};
constexpr std::string_view line_end = "\r\n";

// What the model may call an answer. Nothing that is another one in each run may be in it (times,
// lengths, numbers of sessions), or the model has a state for each.
const std::vector<std::string> outputs = {"1xx", "2xx", "3xx", "4xx", "5xx", "ok", "error", "text"};

std::string name(std::string_view answer) {
  const char first = answer.empty() ? ' ' : answer.front();
  if (first >= '1' && first <= '5') return std::string(1, first) + "xx";
  return first == '+' ? "ok" : first == '-' ? "error" : "text";
}

// Whether nothing more will come: the last line is ended, and does not say that it goes on, as
// "220-" does in FTP.
bool is_whole(std::string_view answer) {
  if (!answer.ends_with('\n')) return false;
  const std::string_view last = answer.substr(answer.rfind('\n', answer.size() - 2) + 1);
  const auto is_digit = [&](std::size_t i) {
    return std::isdigit(static_cast<unsigned char>(last[i])) != 0;
  };
  return last.size() < 4 || last[3] != '-' || !is_digit(0) || !is_digit(1) || !is_digit(2);
}

// ---- The wrapper ----

int connect_to(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos) throw maide::UsageError("no port (server=" + address + ")");
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int failure = ::getaddrinfo(address.substr(0, colon).c_str(),
                                    address.substr(colon + 1).c_str(), &wanted, &found);
  if (failure != 0)
    throw std::runtime_error(std::string(::gai_strerror(failure)) + " (" + address + ")");
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> list(found, ::freeaddrinfo);
  for (const addrinfo* one = found; one != nullptr; one = one->ai_next) {
    const int file = ::socket(one->ai_family, one->ai_socktype | SOCK_CLOEXEC, one->ai_protocol);
    if (file < 0) continue;
    if (::connect(file, one->ai_addr, one->ai_addrlen) == 0) {
      const int at_once = 1;
      ::setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
      return file;
    }
    ::close(file);
  }
  throw std::runtime_error("no connection to " + address);
}

class Connection : public maide::SystemInstance {
 public:
  // `greets`: whether the server speaks first.
  Connection(const std::string& address, int patience, bool greets, maide::EventSink& sink)
      : sink_(sink),
        patience_(patience),
        file_(connect_to(address)),
        stop_(::eventfd(0, EFD_CLOEXEC)) {
    if (greets) hear();
    for (const std::string& line : lines_of_reset) {
      send(line);
      hear();
    }
  }
  ~Connection() override {
    ::close(file_);
    ::close(stop_);
  }

  void call(std::string_view input) override {
    if (!is_closed_) {
      send(lines_of_inputs.find(input)->second);
      const std::string answer = hear();
      if (!answer.empty()) sink_.report(name(answer));
    }
    if (is_closed_) sink_.report("closed");
  }
  void shutdown() override { ::eventfd_write(stop_, 1); }

  // The answer; as much of it as came, if the server then said nothing for so many milliseconds. It
  // sleeps and looks again, by which the SDK sees that the step is not over: the server is a
  // process that it does not watch.
  std::string hear() {
    std::string answer;
    std::array<char, 65536> bytes;
    auto last = std::chrono::steady_clock::now();
    while (!is_closed_ && !is_whole(answer)) {
      std::array<pollfd, 2> files{{{file_, POLLIN, 0}, {stop_, POLLIN, 0}}};
      ::poll(files.data(), files.size(), 0);
      if (files[1].revents != 0) break;
      if (files[0].revents == 0) {
        if (std::chrono::steady_clock::now() - last >= std::chrono::milliseconds(patience_)) break;
        std::this_thread::sleep_for(std::chrono::microseconds(50));
        continue;
      }
      const ssize_t count = ::recv(file_, bytes.data(), bytes.size(), 0);
      if (count <= 0) is_closed_ = true;
      if (count > 0) answer.append(bytes.data(), static_cast<std::size_t>(count));
      last = std::chrono::steady_clock::now();
    }
    return answer;
  }

 private:
  void send(const std::string& line) {
    const std::string text = line + std::string(line_end);
    if (::send(file_, text.data(), text.size(), MSG_NOSIGNAL) < 0) is_closed_ = true;
  }

  maide::EventSink& sink_;
  int patience_;
  int file_;
  int stop_;
  bool is_closed_ = false;
};

class LinesWrapper : public maide::SystemWrapper {
 public:
  LinesWrapper() {
    description_.name = "lines";
    description_.summary = "A server that speaks lines of text over TCP";
    description_.versions = {{"wrapper", "1"}};
    description_.options = {
        maide::OptionSpec::text("server", server, "where the server listens, HOST:PORT"),
        maide::OptionSpec::integer(
            "patience", 500, 1, 60000,
            "milliseconds after which a server that says nothing has nothing to say"),
    };
  }
  const maide::WrapperDescription& description() const override { return description_; }

  maide::SystemSetup configure(const maide::OptionValues& options) override {
    address_ = options.text("server");
    patience_ = static_cast<int>(options.number("patience"));
    maide::SystemSetup setup;
    setup.actors = {"client"};
    for (const auto& entry : lines_of_inputs) setup.inputs.push_back({entry.first, "client", {}});
    for (const std::string& output : outputs) setup.events.push_back({output, "client"});
    setup.events.push_back({"closed", "client"});
    return setup;
  }

  std::unique_ptr<maide::SystemInstance> reset(maide::EventSink& sink) override {
    if (!is_known_) {
      Connection first(address_, patience_, false, sink);
      greets_ = !first.hear().empty();
      is_known_ = true;
    }
    return std::make_unique<Connection>(address_, patience_, greets_, sink);
  }

 private:
  maide::WrapperDescription description_;
  std::string address_;
  int patience_ = 0;
  bool is_known_ = false, greets_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  LinesWrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
