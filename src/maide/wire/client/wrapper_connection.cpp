#include "maide/wire/client/wrapper_connection.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/wire/protocol/protocol.hpp"
#include "maide/wire/protocol/tcp.hpp"

namespace maide {
namespace {

// How long a wrapper that was told to end, or whose output ended, may take to do so.
constexpr std::chrono::milliseconds grace{500};

}  // namespace

WrapperEndpoint WrapperEndpoint::program(std::vector<std::string> argv, std::string name) {
  if (argv.empty()) throw UsageError("no program to start as a wrapper");
  WrapperEndpoint endpoint;
  endpoint.name_ = name.empty() ? join(argv, " ") : std::move(name);
  endpoint.argv_ = std::move(argv);
  return endpoint;
}

WrapperEndpoint WrapperEndpoint::tcp(const std::string& host_port, std::string token) {
  static_cast<void>(tcp::parse_address(host_port));
  WrapperEndpoint endpoint;
  endpoint.host_port_ = host_port;
  endpoint.token_ = std::move(token);
  endpoint.name_ = "tcp://" + host_port;
  return endpoint;
}

WrapperConnection::WrapperConnection(const WrapperEndpoint& endpoint,
                                     std::chrono::milliseconds limit,
                                     const std::function<bool()>& should_stop) {
  try {
    if (endpoint.is_tcp()) {
      socket_ = tcp::connect(tcp::parse_address(endpoint.host_port()), limit, should_stop);
    } else {
      child_ = std::make_unique<ChildProcess>(endpoint.argv());
    }
  } catch (const std::runtime_error& error) {
    throw WrapperError(error.what(), endpoint.name());
  }
}

WrapperConnection::~WrapperConnection() {
  try {
    if (!ended_) {
      send(protocol::encode(protocol::Bye{}));
      flush();
    }
  } catch (const std::exception&) {
    // It is gone already.
  }
  if (!child_) return;
  child_->input.reset();
  child_->wait(grace);
}

void WrapperConnection::send(std::string_view line) {
  outgoing_ += line;
  outgoing_ += '\n';
}

void WrapperConnection::flush() {
  if (outgoing_.empty()) return;
  const std::ptrdiff_t count = write_some(write_descriptor(), outgoing_);
  if (count < 0) {
    // What it still said before it went is worth reading.
    outgoing_.clear();
    return;
  }
  outgoing_.erase(0, static_cast<std::size_t>(count));
}

void WrapperConnection::transfer(std::chrono::milliseconds limit) {
  flush();
  const auto wants_to_write = static_cast<short>(outgoing_.empty() ? 0 : POLLOUT);
  std::array<pollfd, 3> waiting = {pollfd{read_descriptor(), POLLIN, 0},
                                   pollfd{child_ ? child_->errors.get() : -1, POLLIN, 0},
                                   pollfd{-1, POLLOUT, 0}};
  if (wants_to_write != 0) waiting[2].fd = write_descriptor();
  if (::poll(waiting.data(), waiting.size(), static_cast<int>(limit.count())) <= 0) {
    // What the wrapper started may hold its output open longer than it lives. What it said itself
    // has been read if nothing was there after it was seen to have ended.
    if (child_gone_) ended_ = true;
    child_gone_ = child_ && child_->wait(std::chrono::milliseconds(0));
    return;
  }
  if (waiting[1].revents != 0) child_->collect_errors();
  if (waiting[2].revents != 0) flush();
  if (waiting[0].revents == 0) return;
  std::string bytes;
  switch (read_some(read_descriptor(), bytes)) {
    case ReadResult::some: lines_.append(bytes); break;
    case ReadResult::ended: ended_ = true; break;
    case ReadResult::nothing_yet: break;
  }
}

std::optional<std::string> WrapperConnection::receive(std::chrono::milliseconds limit) {
  if (auto line = lines_.take_line()) {
    flush();
    return line;
  }
  if (!ended_) transfer(limit);
  if (auto line = lines_.take_line()) return line;
  if (!ended_) return std::nullopt;
  throw_lost();
}

void WrapperConnection::throw_lost() {
  const std::string cut = lines_.has_rest() ? " in the middle of a line" : "";
  if (!child_) throw ConnectionLost("the wrapper closed the connection" + cut);
  std::string text;
  if (child_->wait(grace)) {
    text = "the wrapper " + child_->describe_end() + cut;
  } else {
    text = "the wrapper closed its output" + cut;
    child_->kill();
  }
  child_->collect_errors();
  const std::string last_words = child_->last_error_line();
  throw ConnectionLost(last_words.empty() ? text : text + ": " + last_words);
}

void WrapperConnection::kill() {
  ended_ = true;
  if (child_) child_->kill();
}

namespace {

constexpr std::size_t most_deaths = 6;

// Durations and who was busy may differ from run to run.
bool is_same_step(const SulStep& left, const SulStep& right) {
  return left.status == right.status && left.events == right.events;
}

bool is_same_place(const Death& left, const Death& right) {
  return left.end == right.end && left.in_reset == right.in_reset && left.before && right.before &&
         std::equal(left.before->begin(), left.before->end(), right.before->begin(),
                    right.before->end(), is_same_step);
}

}  // namespace

DeathRecord::Verdict DeathRecord::add(Death death) {
  deaths_.push_back(std::move(death));
  const auto here = std::count_if(deaths_.begin(), deaths_.end(),
                                  [&](const Death& other) { return is_same_place(other, last()); });
  const std::size_t needed = last().end == WordEnd::hang ? 2 : 3;
  if (here >= 2 && deaths_.size() >= needed) return Verdict::reproducible;
  return deaths_.size() > most_deaths ? Verdict::hopeless : Verdict::ask_again;
}

}  // namespace maide
