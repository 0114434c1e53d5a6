#include "maide/wire/wrapper/wrapper_server.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <utility>
#include <variant>

#include "maide/base/error.hpp"
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
                             std::optional<std::string> received,
                             std::function<void()> on_configured)
    : in_(in),
      out_(out),
      on_configured_(std::move(on_configured)),
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

std::string WrapperServer::serve() {
  serve_lines();
  end_instance();
  return refusal_;
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
  if (const auto* error = std::get_if<protocol::ErrorReport>(&message)) {
    refusal_ = "refused: " + error->message;
    return Next::stop;
  }
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
    if (on_configured_) on_configured_();
    send(protocol::encode(protocol::Info{session_.info(), false}));
    return Next::go_on;
  } catch (const UsageError& error) {
    refusal_ = error.what();
    send_error(protocol::ErrorCode::option, error.what());
  } catch (const std::exception& error) {
    refusal_ = error.what();
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

ReceptionRules rules_for_clients(const WrapperDescription& description,
                                 std::optional<std::string> token) {
  ReceptionRules rules;
  rules.greeting = protocol::encode(hello_of(description, token.has_value()));
  rules.token = std::move(token);
  rules.awaited = "options";
  rules.judge = [](const std::string& line) {
    using Verdict = ReceptionRules::Verdict;
    const auto message = protocol::decode_to_wrapper(line, {});
    if (std::holds_alternative<protocol::Bye>(message)) return Verdict::drop;
    if (std::holds_alternative<protocol::Configure>(message)) return Verdict::ready;
    if (std::holds_alternative<protocol::Cancel>(message)) return Verdict::wait;
    throw protocol::ProtocolError("the first line must be of type 'configure'");
  };
  return rules;
}

}  // namespace maide
