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

#include <algorithm>
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

// An answer may come in pieces, so silence ends it. Return `whole` where nothing more can come, for
// instance because the answer tells its length: that is quicker.
enum class End { silence, more, whole };

// "220-" of FTP and SMTP says that more comes.
End find_end(std::string_view answer) {
  std::string_view last = answer.substr(0, answer.find_last_not_of("\r\n") + 1);
  last = last.substr(last.rfind('\n') + 1);
  const auto is_digit = [&](std::size_t i) {
    return std::isdigit(static_cast<unsigned char>(last[i])) != 0;
  };
  const bool goes_on =
      last.size() >= 4 && last[3] == '-' && is_digit(0) && is_digit(1) && is_digit(2);
  return goes_on ? End::more : End::silence;
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

using Duration = std::chrono::steady_clock::duration;

// How long a silence ends an answer: `patience` before its first byte, `settle` behind that. Settle
// grows to a multiple of the longest silence that was seen within an answer.
struct Waits {
  Duration patience{}, settle{}, most_settle{};
  Duration greeting{};  // before the first byte of a greeting
};

class Connection : public maide::SystemInstance {
 public:
  // `greets`: whether the server speaks first. The waits live longer.
  Connection(const std::string& address, Waits& waits, bool greets, maide::EventSink& sink)
      : sink_(sink), waits_(waits), file_(connect_to(address)), stop_(::eventfd(0, EFD_CLOEXEC)) {
    if (greets && hear(waits.greeting).empty()) {
      throw std::runtime_error("the server greets, but did not: raise greeting=");
    }
    for (const std::string& line : lines_of_reset) {
      send(line);
      hear(waits.patience);
    }
  }
  ~Connection() override {
    ::close(file_);
    ::close(stop_);
  }

  void call(std::string_view input) override {
    if (!is_closed_) {
      send(lines_of_inputs.find(input)->second);
      const std::string answer = hear(waits_.patience);
      if (!answer.empty()) sink_.report(name(answer));
    }
    if (is_closed_) sink_.report("closed");
  }
  void shutdown() override { ::eventfd_write(stop_, 1); }

  // Sends a line and listens longer than usual, to see how long the silences are.
  void measure(const std::string& line) {
    if (is_closed_) return;
    send(line);
    const Duration usual = waits_.settle;
    waits_.settle = waits_.most_settle / 2;
    longest_ = {};
    hear(waits_.patience);
    waits_.settle = std::max(usual, std::min(4 * longest_, waits_.most_settle));
  }

  // The answer: what comes until there is a silence; before its first byte, of `limit`. It sleeps
  // and looks again, by which the SDK sees that the step is not over: the server is a process that
  // it does not watch.
  std::string hear(Duration limit) {
    std::string answer;
    std::array<char, 65536> bytes;
    auto last = std::chrono::steady_clock::now();
    End end = End::more;
    while (!is_closed_ && end != End::whole) {
      std::array<pollfd, 2> files{{{file_, POLLIN, 0}, {stop_, POLLIN, 0}}};
      ::poll(files.data(), files.size(), 0);
      if (files[1].revents != 0) break;
      const Duration silence = std::chrono::steady_clock::now() - last;
      if (files[0].revents == 0) {
        if (silence >= limit) break;
        std::this_thread::sleep_for(std::chrono::microseconds(50));
        continue;
      }
      // Else a server that writes twice waits 40 ms for the acknowledgement of the first.
      const int at_once = 1;
      ::setsockopt(file_, IPPROTO_TCP, TCP_QUICKACK, &at_once, sizeof at_once);
      const ssize_t count = ::recv(file_, bytes.data(), bytes.size(), 0);
      if (count <= 0) is_closed_ = true;
      if (end == End::silence) {
        longest_ = std::max(longest_, silence);
        waits_.settle = std::max(waits_.settle, std::min(4 * silence, waits_.most_settle));
      }
      if (count > 0) answer.append(bytes.data(), static_cast<std::size_t>(count));
      end = find_end(answer);
      limit = end == End::more ? waits_.patience : waits_.settle;
      last = std::chrono::steady_clock::now();
    }
    return answer;
  }

 private:
  void send(const std::string& line) {
    std::string text;  // "\n" in the line begins a further one
    for (const char letter : line + '\n') {
      text += letter == '\n' ? std::string(line_end) : std::string(1, letter);
    }
    if (::send(file_, text.data(), text.size(), MSG_NOSIGNAL) < 0) is_closed_ = true;
  }

  maide::EventSink& sink_;
  Waits& waits_;
  Duration longest_{};  // silence within an answer
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
        maide::OptionSpec::integer(
            "settle", 20, 1, 60000,
            "milliseconds of silence behind which an answer is whole, at least"),
        maide::OptionSpec::integer(
            "greeting", 2000, 0, 60000,
            "milliseconds in which a server that speaks first does so; 0: it never does"),
    };
  }
  const maide::WrapperDescription& description() const override { return description_; }

  maide::SystemSetup configure(const maide::OptionValues& options) override {
    address_ = options.text("server");
    const auto wait = [&](const char* key) {
      return std::chrono::milliseconds(options.number(key));
    };
    waits_ = {wait("patience"), wait("settle"), std::max(wait("patience"), wait("settle")),
              wait("greeting")};
    maide::SystemSetup setup;
    setup.actors = {"client"};
    for (const auto& entry : lines_of_inputs) setup.inputs.push_back({entry.first, "client", {}});
    for (const std::string& output : outputs) setup.events.push_back({output, "client"});
    setup.events.push_back({"closed", "client"});
    return setup;
  }

  std::unique_ptr<maide::SystemInstance> reset(maide::EventSink& sink) override {
    if (!is_known_) meet(sink);
    return std::make_unique<Connection>(address_, waits_, greets_, sink);
  }

 private:
  // Whether the server greets, and how long it is silent within an answer. Three connections are
  // open at once, so that a server that greets late is waited for once.
  void meet(maide::EventSink& sink) {
    std::vector<std::unique_ptr<Connection>> three;
    while (three.size() < 3 && waits_.greeting > Duration{}) {
      three.push_back(std::make_unique<Connection>(address_, waits_, false, sink));
    }
    const auto until = std::chrono::steady_clock::now() + waits_.greeting;
    std::size_t greeted = 0;
    for (const auto& one : three) {
      const Duration left = until - std::chrono::steady_clock::now();
      if (!one->hear(std::max(left, Duration{})).empty()) ++greeted;
    }
    if (greeted != 0 && greeted != three.size()) {
      throw std::runtime_error(
          "the server greets on some connections and not on others, or late: raise greeting=");
    }
    three.clear();
    greets_ = greeted != 0;
    Connection measured(address_, waits_, greets_, sink);
    for (const auto& entry : lines_of_inputs) measured.measure(entry.second);
    is_known_ = true;
  }

  maide::WrapperDescription description_;
  std::string address_;
  Waits waits_;
  bool is_known_ = false, greets_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  LinesWrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
