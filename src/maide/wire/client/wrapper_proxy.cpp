#include "maide/wire/client/wrapper_proxy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"
#include "maide/wire/client/proxy_state.hpp"

namespace maide {
namespace {

using Clock = std::chrono::steady_clock;

// The next message, with everything that can go wrong before words are run. Throws ConnectionLost
// too, for a wrapper that died may be started again.
// Why there is no hello, mostly.
constexpr std::string_view causes_of_silence =
    "; mostly the hello is not flushed, or the command is no wrapper";
constexpr std::string_view causes_of_nonsense =
    "; mostly the wrapper prints to standard output before its hello (say that on standard error), "
    "or the command is no wrapper";

protocol::FromWrapper await_message(WrapperConnection& connection, const WrapperEndpoint& endpoint,
                                    std::chrono::milliseconds limit, const RunControl& control,
                                    const char* what) {
  const Clock::time_point deadline = Clock::now() + limit;
  const bool is_hello = std::string_view(what) == "hello";
  try {
    while (true) {
      if (control.should_stop()) connection.kill();
      control.check("starting the wrapper");
      if (const auto line = connection.receive(wire_piece)) {
        return protocol::decode_from_wrapper(*line);
      }
      if (Clock::now() < deadline) continue;
      connection.kill();
      throw WrapperError(
          fmt::format("no {} within {} s{}", what, std::chrono::duration<double>(limit).count(),
                      is_hello ? causes_of_silence : ""),
          endpoint.name());
    }
  } catch (const ConnectionLost& lost) {
    throw ConnectionLost(fmt::format("no {}: {}", what, lost.what()));
  } catch (const protocol::ProtocolError& error) {
    connection.kill();
    std::string message = error.what();
    if (is_hello && message.starts_with("a line is not ")) message += causes_of_nonsense;
    throw WrapperError(message, endpoint.name());
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

// Calls `start` until no wrapper dies in it: one that dies while it starts may have been killed,
// and is started again, so often. `died` hears of each death that was survived.
constexpr int most_restarts = 3;

template <typename Start, typename Died>
void start_patiently(const WrapperEndpoint& endpoint, Start&& start, Died&& died) {
  for (int restarts = 0;; ++restarts) {
    try {
      start();
      return;
    } catch (const ConnectionLost& lost) {
      if (restarts == most_restarts) {
        throw WrapperError(fmt::format("{}; it was started {} times", lost.what(), restarts + 1),
                           endpoint.name());
      }
      died(lost.what());
    }
  }
}

// The most steps that it can take; for a tree an upper bound.
std::size_t depth_of(const SulQuery& query) {
  if (const Word* word = std::get_if<Word>(&query.inputs)) return word->size();
  return std::get<BasicDecisionTree<std::string>>(query.inputs).nodes.size();
}

}  // namespace

std::string describe_silence(std::chrono::milliseconds limit) {
  return fmt::format("the wrapper hangs: no answer within {} s",
                     std::chrono::duration<double>(limit).count());
}

WrapperProxy::WrapperProxy(WrapperEndpoint endpoint, std::map<std::string, std::string> options,
                           ProxySettings settings, const RunControl& control)
    : endpoint_(std::move(endpoint)), options_(std::move(options)), settings_(std::move(settings)) {
  connect(control);
}

WrapperProxy::~WrapperProxy() {
  if (connection_ && !pending_.empty()) connection_->send(protocol::encode(protocol::Cancel{}));
}

void WrapperProxy::fail(const std::string& message) const {
  throw WrapperError(message, endpoint_.name());
}

protocol::FromWrapper WrapperProxy::await_reply(const RunControl& control, const char* what) {
  auto message = await_message(*connection_, endpoint_, settings_.configure_limit, control, what);
  if (const auto* error = std::get_if<protocol::ErrorReport>(&message)) {
    if (error->code == protocol::ErrorCode::option) throw UsageError(error->message);
    fail(error->message);
  }
  return message;
}

void WrapperProxy::connect(const RunControl& control) {
  start_patiently(
      endpoint_, [&] { connect_or_lose(control); },
      [&](const char* reason) {
        connection_.reset();
        incidents_.add({reason, "", ""});
      });
}

void WrapperProxy::connect_or_lose(const RunControl& control) {
  protocol::Hello hello;
  connection_ = open_connection(endpoint_, settings_, control, hello);
  try {
    set_up(hello, control);
  } catch (const Interrupted&) {
    throw;
  } catch (const Error& error) {
    refuse(error.what());
    throw;
  }
}

void WrapperProxy::refuse(const std::string& why) {
  if (!connection_ || !endpoint_.has_dialled()) return;
  connection_->send(protocol::encode(
      protocol::ErrorReport{protocol::ErrorCode::system, one_line(why), std::nullopt}));
}

void WrapperProxy::set_up(const protocol::Hello& hello, const RunControl& control) {
  if (!settings_.name.empty() && hello.name != settings_.name) {
    fail("it is a wrapper of '" + hello.name + "', not of '" + settings_.name + "'");
  }
  // A wrapper that lists its options need not check them itself.
  if (!hello.options.empty()) OptionValues(hello.options, options_);
  connection_->send(protocol::encode(protocol::Configure{options_}));
  auto message = await_reply(control, "answer to the options");
  auto* reply = std::get_if<protocol::Info>(&message);
  if (reply == nullptr) fail("the wrapper did not answer the options with its inputs and outputs");
  SulInfo info = std::move(reply->info);
  info.name = hello.name;
  info.versions = hello.versions;
  for (const auto& [part, number] : reply->versions) info.versions[part] = number;
  info.speaks_trees = hello.speaks_trees;
  info.speaks_purposes = hello.speaks_purposes;
  info.speaks_av = hello.speaks_av;
  info_ = std::move(info);
  open_outputs_ = reply->open_outputs;
  announces_steps_ = hello.announces_steps;
  for (const LearningPurpose& purpose : purposes_) send_purpose(purpose, control);
}

void WrapperProxy::drop_connection() {
  pending_.clear();
  if (connection_) connection_->kill();
  connection_.reset();
}

void WrapperProxy::reconnect(const RunControl& control) {
  const SulInfo before = info_;
  connection_.reset();
  try {
    connect(control);
  } catch (const UsageError& error) {
    // Its options were taken before, so this one is another wrapper, and of no use.
    fail(error.what());
  }
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
  try {
    if (!connection_) reconnect({});
    send_purpose(purpose, {});
  } catch (const ConnectionLost& lost) {
    fail(lost.what());
  }
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
  Batch state{.queries = batch, .sink = sink};
  MAIDE_CHECK(std::ranges::all_of(pending_, [](const auto& one) { return one.second.abandoned; }));
  try {
    control.check("running words on the system");
    fatal_words_ = {};  // what lasts longer is for whoever asks to remember
    run_batch(state, control);
  } catch (...) {
    abandon();
    throw;
  }
}

void WrapperProxy::run_batch(Batch& batch, const RunControl& control) {
  while (batch.answered < batch.queries.size()) {
    control.check("running words on the system");
    if (batch.suspect) {
      isolate(batch, control);
      continue;
    }
    if (!connection_) {
      reconnect(control);
      batch.last_sign = Clock::now();
    }
    try {
      if (!batch.leaving) fill_window(batch);
      if (pending_.empty() && !batch.leaving) continue;
      if (const auto line = connection_->receive(wire_piece)) {
        batch.last_sign = Clock::now();
        take_line(batch, *line);
        continue;
      }
      // The wrapper watches its own steps; this is for one that cannot even do that.
      std::size_t longest = 0;
      for (const auto& [id, pending] : pending_) {
        longest = std::max(longest, depth_of(pending.query));
      }
      const auto limit = silence_limit(longest);
      if (Clock::now() - batch.last_sign >= limit) {
        recover(batch, {WordEnd::hang, describe_silence(limit), {}, false}, false);
      }
    } catch (const ConnectionLost& lost) {
      const std::string reason = batch.leaving ? batch.leaving->reason : lost.what();
      recover(batch, {WordEnd::crash, reason, {}, false}, batch.leaving.has_value());
    } catch (const protocol::ProtocolError& error) {
      // Whatever else it says means nothing either.
      drop_connection();
      fail(error.what());
    }
  }
}

void WrapperProxy::fill_window(Batch& batch) {
  while (pending_.size() < settings_.window) {
    std::size_t index = 0;
    if (!batch.again.empty()) {
      index = batch.again.back();
      batch.again.pop_back();
    } else if (batch.next < batch.queries.size()) {
      index = batch.next++;
    } else {
      return;
    }
    if (auto known = fatal_words_.find(batch.queries[index])) {
      deliver(batch, index, std::move(*known));
    } else {
      send_query(batch, index);
    }
  }
}

void WrapperProxy::send_query(Batch& batch, std::size_t index) {
  if (pending_.empty()) batch.last_sign = Clock::now();
  MAIDE_CHECK(pending_.empty() || pending_.rbegin()->first < next_id_);  // the oldest comes first
  const protocol::Run run{next_id_++, batch.queries[index]};
  connection_->send(protocol::encode(run, info_));
  pending_[run.id] = {run.query, index, false};
}

void WrapperProxy::deliver(Batch& batch, std::size_t index, SulAnswer answer) {
  MAIDE_CHECK(index < batch.next && batch.answered < batch.queries.size());
  ++batch.answered;
  batch.sink(index, std::move(answer));
}

void WrapperProxy::take_line(Batch& batch, const std::string& line) {
  protocol::FromWrapper message = protocol::decode_from_wrapper(line, Context(*this));
  if (auto* answer = std::get_if<protocol::Answer>(&message)) {
    take_answer(batch, std::move(*answer));
  } else if (auto* leaving = std::get_if<protocol::Leaving>(&message)) {
    if (batch.leaving) throw protocol::ProtocolError("'leaving' came twice");
    batch.leaving = std::move(*leaving);
  } else if (const auto* error = std::get_if<protocol::ErrorReport>(&message)) {
    const auto asked = error->id ? pending_.find(*error->id) : pending_.end();
    if (asked != pending_.end() && asked->second.abandoned) {
      pending_.erase(asked);
      return;
    }
    report(*error, asked == pending_.end() ? nullptr : &asked->second.query);
  } else {
    fail("the wrapper sent a line of a type that nobody asked for");
  }
}

void WrapperProxy::report(const protocol::ErrorReport& error, const SulQuery* query) {
  fail(query == nullptr ? error.message : fmt::format("{}, {}", error.message, describe(*query)));
}

void WrapperProxy::take_answer(Batch& batch, protocol::Answer message) {
  const auto asked = pending_.find(message.id);
  MAIDE_CHECK(asked != pending_.end());  // decoding refuses answers to nothing
  const Pending pending = std::move(asked->second);
  pending_.erase(asked);
  if (pending.abandoned) return;
  if (is_fatal(message.answer.end)) {
    // It says so itself; but only what happens again in a fresh process is believed.
    message.answer.steps.pop_back();
    batch.suspect = Batch::Suspect();
    batch.suspect->index = pending.index;
    batch.suspect->record.add(
        {message.answer.end, message.answer.reason, std::move(message.answer.steps), false});
    put_back(batch);
    return;
  }
  ++batch.answered_since_start;
  batch.last_answered = pending.index;
  deliver(batch, pending.index, std::move(message.answer));
}

// Ends the process; what it has not answered will be asked again.
void WrapperProxy::put_back(Batch& batch) {
  for (const auto& [id, pending] : pending_) {
    const bool is_suspect = batch.suspect && batch.suspect->index == pending.index;
    if (!pending.abandoned && !is_suspect) batch.again.push_back(pending.index);
  }
  std::sort(batch.again.rbegin(), batch.again.rend());
  MAIDE_CHECK(std::ranges::adjacent_find(batch.again) == batch.again.end());  // nothing twice
  if (batch.suspect && batch.last_answered) {
    batch.suspect->after = text_of(batch.queries[*batch.last_answered]);
  }
  batch.leaving.reset();
  batch.answered_since_start = 0;
  drop_connection();
}

void WrapperProxy::recover(Batch& batch, Death death, bool was_announced) {
  // Words are played in the order in which they came: the oldest was the one, unless the wrapper
  // says better. An announced end between words is nobody's fault, as long as words are answered.
  auto blamed = pending_.end();
  if (batch.leaving && batch.leaving->id) blamed = pending_.find(*batch.leaving->id);
  if (blamed == pending_.end() && (!was_announced || batch.answered_since_start == 0)) {
    blamed = pending_.begin();
  }
  if (blamed != pending_.end() && !blamed->second.abandoned) {
    batch.suspect = Batch::Suspect();
    batch.suspect->index = blamed->second.index;
    batch.suspect->record.add(std::move(death));
  } else {
    const std::string after =
        batch.last_answered ? text_of(batch.queries[*batch.last_answered]) : "";
    incidents_.add({std::move(death.reason), after, ""});
  }
  put_back(batch);
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

std::chrono::milliseconds WrapperProxy::silence_limit(std::size_t steps) const {
  return step_limit() * static_cast<std::int64_t>(steps + 2) + wire_piece;
}

std::chrono::milliseconds WrapperProxy::step_limit() const {
  // What a wrapper says is multiplied by the length of words: a day a step is as good as for ever.
  constexpr std::int64_t longest = 86'400'000;
  for (const auto& [key, value] : info_.options) {
    if (!same_key(key, "step-limit")) continue;
    const auto limit = parse_number<std::int64_t>(value);
    if (limit && *limit > 0) return std::chrono::milliseconds(std::min(*limit, longest));
  }
  return settings_.step_limit;
}

std::string WrapperProxy::text_of(const SulQuery& query) const {
  const auto name = [&](Symbol input) {
    return input < info_.inputs.size() ? info_.inputs[input].name : std::string(protocol::delta);
  };
  if (const Word* word = std::get_if<Word>(&query.inputs)) {
    std::string text;
    for (const Symbol input : *word) text += (text.empty() ? "" : " ") + name(input);
    return text;
  }
  const auto& nodes = std::get<BasicDecisionTree<std::string>>(query.inputs).nodes;
  return nodes.empty() ? "" : name(nodes.front().input) + " ...";
}

std::string WrapperProxy::describe(const SulQuery& query) const {
  const bool is_word = std::holds_alternative<Word>(query.inputs);
  return fmt::format("in the {} \"{}\"", is_word ? "word" : "decision tree", text_of(query));
}

protocol::Hello ask_hello(const WrapperEndpoint& endpoint, const ProxySettings& settings,
                          const RunControl& control) {
  protocol::Hello hello;
  start_patiently(
      endpoint, [&] { static_cast<void>(open_connection(endpoint, settings, control, hello)); },
      [](const char*) {});
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
