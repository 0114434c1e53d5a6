#include "maide/wire/client/wrapper_connection.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <variant>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/text.hpp"
#include "maide/wire/protocol/protocol.hpp"
#include "maide/wire/protocol/tcp.hpp"

namespace maide {
namespace {

// How long a wrapper that was told to end, or whose output ended, may take to do so.
constexpr std::chrono::milliseconds grace{500};

// Between the end of a connection and the sight of the one that takes its place, whichever is
// first. They were made in the right order, so this is for what gets lost on the way.
constexpr std::chrono::seconds most_apart{1};

bool dials_again(const std::string& received) {
  const auto message =
      protocol::decode_from_wrapper(std::string_view(received).substr(0, received.find('\n')));
  return std::get<protocol::Hello>(message).dials_again;
}

// A wrapper that dials in says hello by itself, behind the token.
ReceptionRules rules_for_wrappers(std::optional<std::string> token, DialIns::Warn warn) {
  ReceptionRules rules;
  rules.token = std::move(token);
  rules.awaited = "hello";
  rules.judge = [](const std::string& line) {
    if (std::holds_alternative<protocol::Hello>(protocol::decode_from_wrapper(line))) {
      return ReceptionRules::Verdict::ready;
    }
    throw protocol::ProtocolError("the first line must be of type 'hello'");
  };
  // Anybody can fill a log with them.
  constexpr int most_warnings = 20;
  rules.on_refusal = [warn = std::move(warn), left = most_warnings](
                         const std::string& peer, const std::string& why) mutable {
    if (warn && left-- > 0) warn(fmt::format("a connection of {} is refused: {}", peer, why));
  };
  return rules;
}

}  // namespace

DialIns::DialIns(const std::string& host_port, std::optional<std::string> token, Warn warn)
    : listener_(listen_guarded(host_port, token)),
      reception_(listener_.socket.get(), rules_for_wrappers(std::move(token), std::move(warn))),
      thread_([this](const std::stop_token& stop) { receive(stop); }) {}

DialIns::~DialIns() = default;

void DialIns::receive(const std::stop_token& stop) {
  constexpr std::chrono::milliseconds piece{50};  // between looks at the stop token
  try {
    while (!stop.stop_requested()) {
      reception_.wait(piece);
      while (auto client = reception_.take_ready()) {
        const bool again = dials_again(client->received);
        const std::scoped_lock lock(mutex_);
        ready_.push_back({std::move(*client), again});
        changed_.notify_all();
      }
    }
  } catch (...) {
    const std::scoped_lock lock(mutex_);
    error_ = std::current_exception();
    changed_.notify_all();
  }
}

std::optional<AcceptedClient> DialIns::take_replacement(std::chrono::milliseconds limit,
                                                        const std::function<bool()>& should_stop) {
  constexpr std::chrono::milliseconds piece{50};
  const auto deadline = std::chrono::steady_clock::now() + limit;
  std::unique_lock lock(mutex_);
  ++waiting_;
  while (ready_.empty() && !should_stop() && std::chrono::steady_clock::now() < deadline) {
    changed_.wait_for(lock, piece);
  }
  --waiting_;
  if (ready_.empty()) return std::nullopt;
  auto next = std::ranges::find_if(ready_, &Ready::dials_again);
  if (next == ready_.end()) next = ready_.begin();
  AcceptedClient client = std::move(next->client);
  ready_.erase(next);
  return client;
}

// The mutex is held.
std::deque<DialIns::Ready>::iterator DialIns::find_newcomer() {
  if (ready_.size() <= waiting_) return ready_.end();
  const auto limit = std::chrono::steady_clock::now() - most_apart;
  return std::ranges::find_if(
      ready_, [&](const Ready& one) { return !one.dials_again || one.since <= limit; });
}

std::optional<AcceptedClient> DialIns::take_newcomer(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  constexpr std::chrono::milliseconds piece{50};  // while one is kept for another
  auto next = find_newcomer();
  for (; next == ready_.end(); next = find_newcomer()) {
    if (stop.stop_requested()) return std::nullopt;
    if (error_) std::rethrow_exception(error_);
    if (ready_.empty()) {
      changed_.wait(lock, stop, [this] { return error_ || !ready_.empty(); });
    } else {
      changed_.wait_for(lock, piece);
    }
  }
  AcceptedClient client = std::move(next->client);
  ready_.erase(next);
  return client;
}

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

WrapperEndpoint WrapperEndpoint::dialled(std::shared_ptr<DialIns> dial_ins, AcceptedClient first) {
  WrapperEndpoint endpoint;
  endpoint.dial_ins_ = std::move(dial_ins);
  endpoint.name_ = "the wrapper of " + first.peer;
  endpoint.first_ = std::make_shared<std::optional<AcceptedClient>>(std::move(first));
  return endpoint;
}

AcceptedClient WrapperEndpoint::take_connection(const std::function<bool()>& should_stop) const {
  MAIDE_CHECK(has_dialled());
  auto client = std::exchange(*first_, std::nullopt);
  if (!client) client = dial_ins_->take_replacement(most_apart, should_stop);
  if (client) return std::move(*client);
  if (should_stop()) throw Interrupted("stopped while a wrapper was to dial again");
  throw std::runtime_error(fmt::format("it does not dial again within {} s", most_apart.count()));
}

WrapperConnection::WrapperConnection(const WrapperEndpoint& endpoint,
                                     std::chrono::milliseconds limit,
                                     const std::function<bool()>& should_stop) {
  try {
    if (endpoint.is_program()) {
      child_ = std::make_unique<ChildProcess>(endpoint.argv());
    } else if (endpoint.has_dialled()) {
      AcceptedClient client = endpoint.take_connection(should_stop);
      socket_ = std::move(client.socket);
      tcp::set_up(socket_.get());
      lines_.append(client.received);
    } else {
      socket_ = tcp::connect(tcp::parse_address(endpoint.host_port()), limit, should_stop);
    }
  } catch (const Interrupted&) {
    throw;
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
  const auto here = std::ranges::count_if(
      deaths_, [&](const Death& other) { return is_same_place(other, last()); });
  const std::size_t needed = last().end == WordEnd::hang ? 2 : 3;
  if (here >= 2 && deaths_.size() >= needed) return Verdict::reproducible;
  return deaths_.size() > most_deaths ? Verdict::hopeless : Verdict::ask_again;
}

}  // namespace maide
