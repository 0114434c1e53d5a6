#include "maide/wire/wrapper/wrapper_server.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <system_error>
#include <utility>
#include <variant>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/text.hpp"
#include "maide/wire/observe/thread_scan.hpp"
#include "maide/wire/protocol/line_io.hpp"

namespace maide {
namespace {

// Lines that wait to be played; a client that sends more of them is not read until some are done.
constexpr std::size_t most_waiting = 4096;

// The reader's own look at a line: cancellation overtakes the lines that wait, and a client that
// said bye waits for its answers even if it then closes its end.
template <typename Message>
bool is_a(const std::string& line) {
  constexpr std::size_t longest = 64;
  if (line.size() > longest) return false;
  try {
    return std::holds_alternative<Message>(protocol::decode_to_wrapper(line, {}));
  } catch (const protocol::ProtocolError&) {
    return false;
  }
}

}  // namespace

protocol::Hello hello_of(const WrapperDescription& description, bool needs_token) {
  protocol::Hello hello;
  hello.name = description.name;
  hello.versions = description.versions;
  hello.speaks_trees = hello.speaks_purposes = hello.speaks_av = true;
  hello.announces_steps = true;
  hello.needs_token = needs_token;
  hello.options = full_option_table(description);
  return hello;
}

WrapperServer::WrapperServer(SystemWrapper& wrapper, int in, int out,
                             std::optional<std::string> received)
    : in_(in),
      out_(out),
      watchdog_([this](const std::string& work) { leave(work + " did not end in time"); }),
      session_(wrapper, &watchdog_) {
  if (!received) send(protocol::encode(hello_of(wrapper.description(), false)));
  reader_ = std::thread(
      [this, first = std::move(received).value_or("")]() mutable { read_lines(std::move(first)); });
}

WrapperServer::~WrapperServer() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  reader_.join();
}

void WrapperServer::push(std::string line) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return stopping_ || lines_.size() < most_waiting; });
  lines_.push_back({++received_, std::move(line), std::chrono::steady_clock::now()});
  changed_.notify_all();
}

void WrapperServer::cancel() {
  const std::scoped_lock lock(mutex_);
  cancelled_up_to_ = received_;
}

void WrapperServer::end_reading(std::string problem) {
  const std::scoped_lock lock(mutex_);
  ended_ = true;
  problem_ = std::move(problem);
  changed_.notify_all();
}

void WrapperServer::read_lines(std::string bytes) {
  const SdkThread own;
  constexpr int piece_ms = 100;  // a server that stops is not kept waiting for its client
  LineSplitter splitter;
  bool said_bye = false;
  try {
    while (true) {
      splitter.append(bytes);
      bytes.clear();
      while (auto line = splitter.take_line()) {
        said_bye = is_a<protocol::Bye>(*line);
        if (is_a<protocol::Cancel>(*line)) {
          cancel();
        } else {
          push(std::move(*line));
        }
      }
      {
        const std::scoped_lock lock(mutex_);
        if (stopping_) return;
      }
      pollfd waiting{in_, POLLIN, 0};
      if (::poll(&waiting, 1, piece_ms) <= 0) continue;
      if (read_some(in_, bytes) != ReadResult::some) break;
    }
    if (!said_bye) cancel();
    end_reading("");
  } catch (const protocol::ProtocolError& error) {
    cancel();
    end_reading(error.what());
  }
}

std::optional<WrapperServer::Line> WrapperServer::pop() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return ended_ || !lines_.empty(); });
  if (lines_.empty()) return std::nullopt;
  Line line = std::move(lines_.front());
  lines_.pop_front();
  changed_.notify_all();
  return line;
}

void WrapperServer::send(const std::string& line) {
  const std::scoped_lock lock(output_mutex_);
  write_all(out_, line + '\n');  // a client that is gone is noticed by the reader
}

void WrapperServer::send_error(protocol::ErrorCode code, const std::string& message,
                               std::optional<std::uint64_t> id) {
  send(protocol::encode(protocol::ErrorReport{code, one_line(message), id}));
}

void WrapperServer::leave(const std::string& reason) {
  std::fprintf(stderr, "%s: %s\n", session_.info().name.c_str(), reason.c_str());
  protocol::Leaving leaving{reason, {}};
  if (const std::uint64_t id = playing_; id != no_query) leaving.id = id;
  send(protocol::encode(leaving));
  ::_exit(static_cast<int>(ExitStatus::system_failed));
}

void WrapperServer::serve() {
  serve_lines();
  end_instance();
}

void WrapperServer::end_instance() {
  const std::string stuck = session_.end_instance();
  if (!stuck.empty()) leave("a call of " + stuck + " could not be unblocked");
}

void WrapperServer::serve_lines() {
  while (const auto line = pop()) {
    try {
      if (handle(*line) == Next::stop) return;
    } catch (const protocol::ProtocolError& error) {
      send_error(protocol::ErrorCode::protocol, error.what());
      return;
    }
  }
  const std::scoped_lock lock(mutex_);
  if (!problem_.empty()) send_error(protocol::ErrorCode::protocol, problem_);
}

WrapperServer::Next WrapperServer::handle(const Line& line) {
  protocol::ToWrapper message = protocol::decode_to_wrapper(line.text, session_.info());
  if (std::holds_alternative<protocol::Bye>(message)) return Next::stop;
  if (std::holds_alternative<protocol::Token>(message)) return Next::go_on;  // see Reception
  if (const auto* options = std::get_if<protocol::Configure>(&message)) {
    return configure(*options);
  }
  if (!session_.is_configured()) {
    throw protocol::ProtocolError("the first line must be of type 'configure'");
  }
  if (const auto* purpose = std::get_if<protocol::Purpose>(&message)) {
    session_.add_purpose(purpose->purpose);
    send(protocol::encode(protocol::Ok{}));
  } else if (const auto* query = std::get_if<protocol::Run>(&message)) {
    run(*query, line);
  }
  return Next::go_on;
}

WrapperServer::Next WrapperServer::configure(const protocol::Configure& message) {
  if (session_.is_configured()) throw protocol::ProtocolError("'configure' came twice");
  try {
    session_.configure(message.options);
    // Its own connection is no part of the system.
    session_.ignore_socket(in_);
    session_.ignore_socket(out_);
    send(protocol::encode(protocol::Info{session_.info(), false}));
    return Next::go_on;
  } catch (const UsageError& error) {
    send_error(protocol::ErrorCode::option, error.what());
  } catch (const std::exception& error) {
    send_error(protocol::ErrorCode::system, error.what());
  }
  return Next::stop;
}

void WrapperServer::run(const protocol::Run& message, const Line& line) {
  const auto is_cancelled = [&] { return line.number <= cancelled_up_to_; };
  protocol::Answer answer;
  answer.id = message.id;
  WordObserver observer;
  if (message.announce) {
    observer.on_ready = [&] { send(protocol::encode(protocol::Ready{message.id})); };
    observer.on_step = [&](const SulStep& step) {
      send(protocol::encode(protocol::Step{message.id, step}, session_.info()));
    };
  }
  playing_ = message.id;
  try {
    if (is_cancelled()) {
      answer.answer.end = WordEnd::aborted;
    } else {
      answer.answer = session_.run(message.query, is_cancelled, line.arrived, observer);
    }
    send(protocol::encode(answer, session_.info(), message.query));
  } catch (const SystemProcessEnded& ended) {
    leave(ended.what());
  } catch (const std::exception& error) {
    send_error(protocol::ErrorCode::system, error.what(), message.id);
  }
  playing_ = no_query;
  if (is_cancelled()) {
    end_instance();
  } else {
    prepare_next();
  }
}

// While the answer travels and the learner thinks. Not while a word is still played: an instance
// that comes up would disturb the observation of quiescence.
void WrapperServer::prepare_next() {
  end_instance();
  {
    const std::scoped_lock lock(mutex_);
    if (ended_ && lines_.empty()) return;  // nobody will ask
  }
  session_.prepare();
}

namespace {

// Options are a few hundred bytes; the rest of a client's first piece may be there, too.
constexpr std::size_t most_bytes = std::size_t{1} << 16;

void set_blocking(int descriptor, bool is_blocking) {
  const int flags = ::fcntl(descriptor, F_GETFL);
  ::fcntl(descriptor, F_SETFL, is_blocking ? flags & ~O_NONBLOCK : flags | O_NONBLOCK);
}

// Of accept4: the connection was gone again, or a signal came.
bool is_passing(int error) {
  return error == EINTR || error == ECONNABORTED || error == EPROTO || error == EPERM ||
         error == ETIMEDOUT;
}

bool is_shortage(int error) {
  return error == EMFILE || error == ENFILE || error == ENOBUFS || error == ENOMEM;
}

}  // namespace

bool equal_in_constant_time(std::string_view left, std::string_view right) {
  std::size_t difference = left.size() ^ right.size();
  for (std::size_t i = 0; i < left.size(); ++i) {
    const char other = right.empty() ? '\0' : right[i % right.size()];
    difference |= static_cast<std::size_t>(static_cast<unsigned char>(left[i] ^ other));
  }
  return difference == 0;
}

Reception::Reception(int listener, const WrapperDescription& description,
                     std::optional<std::string> token, ReceptionSettings settings)
    : listener_(listener),
      token_(std::move(token)),
      settings_(settings),
      hello_(protocol::encode(hello_of(description, token_.has_value())) + '\n') {
  set_blocking(listener_, false);
}

bool Reception::has_room() const {
  return waiting_.size() < settings_.most_waiting ||
         std::any_of(waiting_.begin(), waiting_.end(),
                     [](const Waiting& client) { return !client.is_ready; });
}

int Reception::poll_limit(std::optional<std::chrono::milliseconds> limit) const {
  const auto oldest = std::find_if(waiting_.begin(), waiting_.end(),
                                   [](const Waiting& client) { return !client.is_ready; });
  if (oldest != waiting_.end()) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(oldest->since + settings_.limit -
                                                                   Clock::now());
    limit = std::max(std::chrono::milliseconds(0), std::min(left, limit.value_or(left)));
  }
  return limit ? static_cast<int>(limit->count()) : -1;
}

void Reception::wait(std::optional<std::chrono::milliseconds> limit) {
  std::vector<pollfd> sockets{{has_room() ? listener_ : -1, POLLIN, 0}};
  for (const Waiting& client : waiting_) {
    sockets.push_back({client.is_ready ? -1 : client.socket.get(), POLLIN, 0});
  }
  if (::poll(sockets.data(), sockets.size(), poll_limit(limit)) > 0) {
    auto socket = sockets.begin();
    for (auto client = waiting_.begin(); client != waiting_.end();) {
      const bool is_over = (++socket)->revents != 0 && read(*client) == Next::drop;
      client = is_over ? waiting_.erase(client) : std::next(client);
    }
    if (sockets.front().revents != 0) accept_all();
  }
  drop_late();
}

void Reception::accept_all() {
  while (has_room()) {
    Descriptor socket(::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    const int error = errno;
    if (socket.is_open()) {
      admit(std::move(socket));
    } else if (error == EAGAIN || error == EWOULDBLOCK) {
      return;
    } else if (is_shortage(error)) {
      if (drop_most_silent()) continue;
      constexpr int pause_ms = 50;  // clients that are served will go
      ::poll(nullptr, 0, pause_ms);
      return;
    } else if (!is_passing(error)) {
      throw UsageError("cannot accept clients any more: " + std::generic_category().message(error));
    }
  }
}

void Reception::admit(Descriptor socket) {
  if (waiting_.size() >= settings_.most_waiting) drop_most_silent();
  // It fits into the buffer of a new connection.
  if (write_some(socket.get(), hello_) != static_cast<std::ptrdiff_t>(hello_.size())) return;
  MAIDE_CHECK(waiting_.size() < settings_.most_waiting);
  Waiting& client = waiting_.emplace_back();
  client.socket = std::move(socket);
  client.since = Clock::now();
  client.is_known = !token_;
}

bool Reception::drop_most_silent() {
  const auto oldest = std::find_if(waiting_.begin(), waiting_.end(),
                                   [](const Waiting& client) { return !client.is_ready; });
  if (oldest == waiting_.end()) return false;
  tell(*oldest, protocol::ErrorCode::protocol, "too many connections wait for nothing");
  waiting_.erase(oldest);
  return true;
}

void Reception::drop_late() {
  const Clock::time_point now = Clock::now();
  waiting_.remove_if([&](const Waiting& client) {
    if (client.is_ready || now - client.since < settings_.limit) return false;
    tell(client, protocol::ErrorCode::protocol,
         fmt::format("no {} within {} s", client.is_known ? "options" : "token",
                     std::chrono::duration<double>(settings_.limit).count()));
    return true;
  });
}

Reception::Next Reception::read(Waiting& client) const {
  std::string bytes;
  switch (read_some(client.socket.get(), bytes)) {
    case ReadResult::nothing_yet: return Next::keep;
    case ReadResult::ended: return Next::drop;
    case ReadResult::some: break;
  }
  client.received += bytes;
  try {
    client.lines.append(bytes);
    while (!client.is_ready) {
      const std::optional<std::string> line = client.lines.take_line();
      if (!line) break;
      if (take(client, *line) == Next::drop) return Next::drop;
    }
    if (client.is_ready || client.received.size() <= most_bytes) return Next::keep;
    throw protocol::ProtocolError("the options are too long");
  } catch (const protocol::ProtocolError& error) {
    tell(client, protocol::ErrorCode::protocol, error.what());
    return Next::drop;
  }
}

Reception::Next Reception::take(Waiting& client, const std::string& line) const {
  if (!client.is_known) {
    std::string given;
    try {
      const auto message = protocol::decode_to_wrapper(line, {});
      if (const auto* token = std::get_if<protocol::Token>(&message)) given = token->token;
    } catch (const protocol::ProtocolError&) {
      // It is no token, whatever it is.
    }
    client.is_known = equal_in_constant_time(*token_, given);
    if (client.is_known) return Next::keep;
    tell(client, protocol::ErrorCode::token,
         given.empty() ? "a token is needed" : "the token is wrong");
    return Next::drop;
  }
  const auto message = protocol::decode_to_wrapper(line, {});
  if (std::holds_alternative<protocol::Bye>(message)) return Next::drop;
  if (std::holds_alternative<protocol::Configure>(message)) {
    client.is_ready = true;
  } else if (!std::holds_alternative<protocol::Token>(message) &&
             !std::holds_alternative<protocol::Cancel>(message)) {
    throw protocol::ProtocolError("the first line must be of type 'configure'");
  }
  return Next::keep;
}

std::optional<AcceptedClient> Reception::take_ready() {
  const auto ready = std::find_if(waiting_.begin(), waiting_.end(),
                                  [](const Waiting& client) { return client.is_ready; });
  if (ready == waiting_.end()) return std::nullopt;
  MAIDE_CHECK(ready->is_known);  // nobody is served without the token
  set_blocking(ready->socket.get(), true);
  AcceptedClient client{std::move(ready->socket), std::move(ready->received)};
  waiting_.erase(ready);
  return client;
}

// As much as the connection takes: nobody is waited for.
void Reception::tell(const Waiting& client, protocol::ErrorCode code, const std::string& message) {
  write_some(client.socket.get(),
             protocol::encode(protocol::ErrorReport{code, one_line(message), {}}) + '\n');
}

}  // namespace maide
