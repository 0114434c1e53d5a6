#include "maide/wire/wrapper_proxy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include "maide/base/error.hpp"

namespace maide {
namespace {

using Clock = std::chrono::steady_clock;

// Between looks at the stop token and the clock.
constexpr std::chrono::milliseconds piece{50};

// For messages that come before there are queries.
class NoQueries : public protocol::AnswerContext {
 public:
  const SulInfo& info() const override { return info_; }
  bool open_outputs() const override { return false; }
  const SulQuery* find_query(std::uint64_t) const override { return nullptr; }

 private:
  SulInfo info_;
};

// The next message, with everything that can go wrong before words are run.
protocol::FromWrapper await_message(WrapperConnection& connection, const WrapperEndpoint& endpoint,
                                    std::chrono::milliseconds limit, const RunControl& control,
                                    const char* what) {
  const Clock::time_point deadline = Clock::now() + limit;
  try {
    while (true) {
      if (control.should_stop()) connection.kill();
      control.check("starting the wrapper");
      if (const auto line = connection.receive(piece)) {
        return protocol::decode_from_wrapper(*line, NoQueries());
      }
      if (Clock::now() < deadline) continue;
      connection.kill();
      throw WrapperError(
          fmt::format("no {} within {} s", what, std::chrono::duration<double>(limit).count()),
          endpoint.name());
    }
  } catch (const ConnectionLost& lost) {
    throw WrapperError(fmt::format("no {}: {}", what, lost.what()), endpoint.name());
  } catch (const protocol::ProtocolError& error) {
    connection.kill();
    throw WrapperError(error.what(), endpoint.name());
  }
}

// Connected, and it has said hello, and been told the token.
std::unique_ptr<WrapperConnection> open_connection(const WrapperEndpoint& endpoint,
                                                   const ProxySettings& settings,
                                                   const RunControl& control,
                                                   protocol::Hello& hello) {
  auto connection = std::make_unique<WrapperConnection>(endpoint, settings.hello_limit,
                                                        [&] { return control.should_stop(); });
  auto message = await_message(*connection, endpoint, settings.hello_limit, control, "hello");
  auto* said = std::get_if<protocol::Hello>(&message);
  if (said == nullptr) {
    throw WrapperError("the wrapper's first line is not a hello", endpoint.name());
  }
  hello = std::move(*said);
  if (hello.needs_token) connection->send(protocol::encode(protocol::Token{endpoint.token()}));
  return connection;
}

// The most steps that it can take; for a tree an upper bound.
std::size_t depth_of(const SulQuery& query) {
  if (const Word* word = std::get_if<Word>(&query.inputs)) return word->size();
  return std::get<BasicDecisionTree<std::string>>(query.inputs).nodes.size();
}

}  // namespace

// The queries of one call of run().
struct WrapperProxy::Batch {
  std::span<const SulQuery> queries;
  const SulAnswerSink& sink;
  std::size_t next = 0;                  // the first that was never sent
  std::size_t answered = 0;              // how many are
  std::vector<std::size_t> again;        // to be sent again, last first
  std::vector<std::uint32_t> deaths;     // of the wrapper, by query
  std::size_t answered_since_start = 0;  // by the process that now runs
  Clock::time_point last_sign;           // of life
  bool leaving = false;                  // it said that it will end
  std::string leaving_reason;
};

class WrapperProxy::Context : public protocol::AnswerContext {
 public:
  explicit Context(const WrapperProxy& proxy) : proxy_(proxy) {}
  const SulInfo& info() const override { return proxy_.info_; }
  bool open_outputs() const override { return proxy_.open_outputs_; }
  const SulQuery* find_query(std::uint64_t id) const override {
    const auto found = proxy_.pending_.find(id);
    return found == proxy_.pending_.end() ? nullptr : &found->second.query;
  }

 private:
  const WrapperProxy& proxy_;
};

WrapperProxy::WrapperProxy(WrapperEndpoint endpoint, std::map<std::string, std::string> options,
                           ProxySettings settings, const RunControl& control)
    : endpoint_(std::move(endpoint)), options_(std::move(options)), settings_(settings) {
  connect(control);
}

WrapperProxy::~WrapperProxy() {
  if (connection_ && !pending_.empty()) connection_->send(protocol::encode(protocol::Cancel{}));
}

void WrapperProxy::fail(const std::string& message) const {
  throw WrapperError(message, endpoint_.name());
}

protocol::FromWrapper WrapperProxy::await_reply(const RunControl& control, const char* what) {
  auto message = await_message(*connection_, endpoint_, settings_.hello_limit, control, what);
  if (const auto* error = std::get_if<protocol::ErrorReport>(&message)) {
    if (error->code == protocol::ErrorCode::option) throw UsageError(error->message);
    fail(error->message);
  }
  return message;
}

void WrapperProxy::connect(const RunControl& control) {
  protocol::Hello hello;
  connection_ = open_connection(endpoint_, settings_, control, hello);
  // A wrapper that lists its options need not check them itself.
  if (!hello.options.empty()) OptionValues(hello.options, options_);
  connection_->send(protocol::encode(protocol::Configure{options_}));
  auto message = await_reply(control, "answer to the options");
  auto* reply = std::get_if<protocol::Info>(&message);
  if (reply == nullptr) fail("the wrapper did not answer the options with its inputs and outputs");
  SulInfo info = std::move(reply->info);
  info.name = hello.name;
  info.versions = hello.versions;
  info.speaks_trees = hello.speaks_trees;
  info.speaks_purposes = hello.speaks_purposes;
  info.speaks_av = hello.speaks_av;
  info_ = std::move(info);
  open_outputs_ = reply->open_outputs;
  for (const LearningPurpose& purpose : purposes_) send_purpose(purpose, control);
}

void WrapperProxy::reconnect(const RunControl& control) {
  const SulInfo before = info_;
  connection_.reset();
  connect(control);
  // Words that it answered and words that it will answer must be about the same system.
  const auto signature = [](const SulInfo& info) {
    std::string text = info.name + info.bound;
    for (const SulInput& input : info.inputs)
      text += fmt::format("|{}/{}", input.name, input.actor);
    for (const std::string& actor : info.actors) text += "|" + actor;
    return text;
  };
  if (signature(before) != signature(info_) || before.options != info_.options ||
      before.versions != info_.versions) {
    fail("the wrapper was started anew and is not the same any more");
  }
}

void WrapperProxy::send_purpose(const LearningPurpose& purpose, const RunControl& control) {
  connection_->send(protocol::encode(purpose));
  if (!std::holds_alternative<protocol::Ok>(await_reply(control, "answer to a purpose"))) {
    fail("the wrapper did not answer a purpose with ok");
  }
}

void WrapperProxy::add_purpose(const LearningPurpose& purpose) {
  if (!info_.speaks_purposes) {
    throw UsageError(fmt::format("{} takes no learning purpose", endpoint_.name()));
  }
  if (!pending_.empty()) {
    // Answers to an interrupted batch would come in between: a fresh start is simpler.
    pending_.clear();
    reconnect({});
  }
  send_purpose(purpose, {});
  purposes_.push_back(purpose);
}

void WrapperProxy::run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
                       const RunControl& control) {
  for (const SulQuery& query : batch) {
    const bool is_tree = !std::holds_alternative<Word>(query.inputs);
    if ((is_tree && !info_.speaks_trees) ||
        (query.translation == Translation::av && !info_.speaks_av)) {
      throw UsageError(fmt::format("{} does not understand {}", endpoint_.name(),
                                   is_tree ? "decision trees" : "the av translation"));
    }
  }
  Batch state{batch, sink,         0,     0, {}, std::vector<std::uint32_t>(batch.size()),
              0,     Clock::now(), false, ""};
  try {
    control.check("running words on the system");
    if (!connection_) reconnect(control);
    run_batch(state, control);
  } catch (...) {
    abandon();
    throw;
  }
}

void WrapperProxy::run_batch(Batch& batch, const RunControl& control) {
  while (batch.answered < batch.queries.size()) {
    control.check("running words on the system");
    try {
      if (!batch.leaving) fill_window(batch);
      if (const auto line = connection_->receive(piece)) {
        batch.last_sign = Clock::now();
        take_line(batch, *line);
      } else {
        check_silence(batch);
      }
    } catch (const ConnectionLost& lost) {
      recover(batch, batch.leaving ? batch.leaving_reason : lost.what(), batch.leaving, control);
    } catch (const protocol::ProtocolError& error) {
      // Whatever else it says means nothing either.
      connection_->kill();
      connection_.reset();
      pending_.clear();
      fail(error.what());
    }
  }
}

void WrapperProxy::fill_window(Batch& batch) {
  while (pending_.size() < settings_.window) {
    if (!batch.again.empty()) {
      const std::size_t index = batch.again.back();
      batch.again.pop_back();
      send_query(batch, index);
    } else if (batch.next < batch.queries.size()) {
      send_query(batch, batch.next++);
    } else {
      return;
    }
  }
}

void WrapperProxy::send_query(Batch& batch, std::size_t index) {
  if (pending_.empty()) batch.last_sign = Clock::now();
  const protocol::Run run{next_id_++, batch.queries[index]};
  connection_->send(protocol::encode(run, info_));
  pending_[run.id] = {run.query, index, false};
}

void WrapperProxy::take_line(Batch& batch, const std::string& line) {
  protocol::FromWrapper message = protocol::decode_from_wrapper(line, Context(*this));
  if (auto* answer = std::get_if<protocol::Answer>(&message)) {
    take_answer(batch, std::move(*answer));
  } else if (const auto* leaving = std::get_if<protocol::Leaving>(&message)) {
    if (batch.leaving) throw protocol::ProtocolError("'leaving' came twice");
    batch.leaving = true;
    batch.leaving_reason = leaving->reason;
  } else if (const auto* error = std::get_if<protocol::ErrorReport>(&message)) {
    const auto asked = error->id ? pending_.find(*error->id) : pending_.end();
    if (asked != pending_.end() && asked->second.abandoned) {
      pending_.erase(asked);
      return;
    }
    fail(asked == pending_.end()
             ? error->message
             : fmt::format("{}, {}", error->message, describe(asked->second.query)));
  } else {
    fail("the wrapper sent a line of a type that nobody asked for");
  }
}

void WrapperProxy::take_answer(Batch& batch, protocol::Answer message) {
  const auto asked = pending_.find(message.id);
  const Pending pending = std::move(asked->second);
  pending_.erase(asked);
  if (pending.abandoned) return;
  message.answer.attempts = 1 + batch.deaths[pending.index];
  ++batch.answered;
  ++batch.answered_since_start;
  batch.sink(pending.index, std::move(message.answer));
}

void WrapperProxy::recover(Batch& batch, const std::string& reason, bool was_announced,
                           const RunControl& control) {
  std::erase_if(pending_, [](const auto& entry) { return entry.second.abandoned; });
  // Words are played in the order in which they came: the oldest was the one. An announced end is
  // nobody's fault, as long as words are answered in between.
  const bool is_blamed = !was_announced || batch.answered_since_start == 0;
  if (is_blamed && !pending_.empty()) {
    const Pending& oldest = pending_.begin()->second;
    if (++batch.deaths[oldest.index] == 2) {
      fail(fmt::format("{}; it did so twice {}", reason, describe(oldest.query)));
    }
  }
  for (auto entry = pending_.rbegin(); entry != pending_.rend(); ++entry) {
    batch.again.push_back(entry->second.index);
  }
  std::sort(batch.again.rbegin(), batch.again.rend());
  pending_.clear();
  reconnect(control);
  batch.leaving = false;
  batch.answered_since_start = 0;
  batch.last_sign = Clock::now();
}

void WrapperProxy::abandon() {
  if (pending_.empty()) return;
  for (auto& [id, pending] : pending_) pending.abandoned = true;
  if (!connection_) return;
  connection_->send(protocol::encode(protocol::Cancel{}));
  try {
    // Out with it now; what comes back is of no interest any more, but must not be lost either.
    if (const auto line = connection_->receive(std::chrono::milliseconds(0))) {
      const auto message = protocol::decode_from_wrapper(*line, Context(*this));
      if (const auto* answer = std::get_if<protocol::Answer>(&message)) pending_.erase(answer->id);
    }
  } catch (const std::exception&) {
    // The next run() starts it anew.
    pending_.clear();
    connection_.reset();
  }
}

void WrapperProxy::check_silence(const Batch& batch) {
  // The wrapper watches its own steps; this is for one that cannot even do that. Beside the steps
  // there is the end of the word before, and the reset.
  std::size_t longest = 0;
  for (const auto& [id, pending] : pending_) longest = std::max(longest, depth_of(pending.query));
  const auto limit = step_limit() * static_cast<std::int64_t>(longest + 2) + piece;
  if (Clock::now() - batch.last_sign < limit) return;
  connection_->kill();
  connection_.reset();
  const std::string word = pending_.empty() ? "" : " " + describe(pending_.begin()->second.query);
  pending_.clear();
  fail(fmt::format("the wrapper hangs: no answer within {} s{}",
                   std::chrono::duration<double>(limit).count(), word));
}

std::chrono::milliseconds WrapperProxy::step_limit() const {
  // What a wrapper says is multiplied by the length of words: a day a step is as good as for ever.
  constexpr std::int64_t longest = 86'400'000;
  for (const auto& [key, value] : info_.options) {
    std::int64_t limit = 0;
    const char* end = value.data() + value.size();
    const auto [stop, error] = std::from_chars(value.data(), end, limit);
    if (!same_key(key, "step-limit") || error != std::errc() || stop != end || limit <= 0) continue;
    return std::chrono::milliseconds(std::min(limit, longest));
  }
  return settings_.step_limit;
}

std::string WrapperProxy::describe(const SulQuery& query) const {
  const auto name = [&](Symbol input) {
    return input < info_.inputs.size() ? info_.inputs[input].name : std::string(protocol::delta);
  };
  std::string text;
  if (const Word* word = std::get_if<Word>(&query.inputs)) {
    for (const Symbol input : *word) text += (text.empty() ? "" : " ") + name(input);
    return fmt::format("in the word \"{}\"", text);
  }
  const auto& nodes = std::get<BasicDecisionTree<std::string>>(query.inputs).nodes;
  return fmt::format("in a decision tree that begins with \"{}\"",
                     nodes.empty() ? "" : name(nodes.front().input));
}

protocol::Hello ask_hello(const WrapperEndpoint& endpoint, const ProxySettings& settings,
                          const RunControl& control) {
  protocol::Hello hello;
  static_cast<void>(open_connection(endpoint, settings, control, hello));
  return hello;
}

std::unique_ptr<WrapperProxy> spawn_wrapper(std::vector<std::string> argv,
                                            std::map<std::string, std::string> options,
                                            const RunControl& control) {
  return std::make_unique<WrapperProxy>(WrapperEndpoint::program(std::move(argv)),
                                        std::move(options), ProxySettings{}, control);
}

std::unique_ptr<WrapperProxy> connect_tcp(const std::string& host_port, const std::string& token,
                                          std::map<std::string, std::string> options,
                                          const RunControl& control) {
  return std::make_unique<WrapperProxy>(WrapperEndpoint::tcp(host_port, token), std::move(options),
                                        ProxySettings{}, control);
}

}  // namespace maide
