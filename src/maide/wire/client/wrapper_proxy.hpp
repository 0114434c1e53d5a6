// The wrapper as a Sul: the client's side of the protocol, over a child's pipes or TCP. It keeps
// several words in flight.
//
// The wrapper's process may die at any moment. It is then replaced, and the word in progress is
// asked again, alone, until it is answered or its death proves reproducible. A reproducible death
// is an answer, too (wrapper_connection.hpp). Anything else that is wrong with the wrapper is one
// clear WrapperError that names its endpoint. A proxy may be used from one thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "maide/sul/fatal_words.hpp"
#include "maide/sul/learning_purpose.hpp"
#include "maide/sul/sul.hpp"
#include "maide/wire/client/wrapper_connection.hpp"
#include "maide/wire/protocol/protocol.hpp"

namespace maide {

struct ProxySettings {
  std::chrono::milliseconds hello_limit{10'000};  // for the connection and the hello
  // For the answer to the options: a wrapper may have to start a broker or a name server first.
  std::chrono::milliseconds configure_limit{60'000};
  // How long a step may take, where the wrapper does not say so itself (option step-limit).
  std::chrono::milliseconds step_limit{10'000};
  std::size_t window = 32;  // words in flight
  std::string name{};       // that the wrapper must say; "": any
};

class WrapperProxy : public Sul {
 public:
  // Starts or connects to the wrapper and sets its options; one that dies meanwhile is started
  // again, three times at most. Throws WrapperError, UsageError (the options, in the wrapper's
  // words), Interrupted.
  WrapperProxy(WrapperEndpoint endpoint, std::map<std::string, std::string> options,
               ProxySettings settings = {}, const RunControl& control = {});
  // Ends the wrapper. Nothing of it is left behind.
  ~WrapperProxy() override;

  const SulInfo& info() const override { return info_; }
  void add_purpose(const LearningPurpose& purpose) override;
  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override;

  // Tells a wrapper that has dialled in that it is of no use, and why. It then does not dial again.
  void refuse(const std::string& why);

  // Deaths of the wrapper that were nobody's fault, or that of a word answered before.
  SulIncidents incidents() const override { return incidents_; }

  const std::string& endpoint() const { return endpoint_.name(); }

 private:
  class Context;
  struct Pending {
    SulQuery query;
    std::size_t index = 0;   // in the batch
    bool abandoned = false;  // its batch is over: the answer goes nowhere
  };
  struct Batch;
  struct Outcome;  // of a query that was asked alone

  void connect(const RunControl& control);
  void connect_or_lose(const RunControl& control);
  void set_up(const protocol::Hello& hello, const RunControl& control);
  void reconnect(const RunControl& control);
  void drop_connection();
  protocol::FromWrapper await_reply(const RunControl& control, const char* what);
  void send_purpose(const LearningPurpose& purpose, const RunControl& control);

  void run_batch(Batch& batch, const RunControl& control);
  void send_query(Batch& batch, std::size_t index);
  void fill_window(Batch& batch);
  void take_line(Batch& batch, const std::string& line);
  void take_answer(Batch& batch, protocol::Answer message);
  void deliver(Batch& batch, std::size_t index, SulAnswer answer);
  void put_back(Batch& batch);
  void recover(Batch& batch, Death death, bool was_announced);
  void abandon();
  [[noreturn]] void report(const protocol::ErrorReport& error, const SulQuery* query);

  // In word_isolation.cpp.
  void isolate(Batch& batch, const RunControl& control);
  Outcome ask_announced(const SulQuery& query, const RunControl& control);
  Outcome ask_prefixes(const SulQuery& query, const RunControl& control);
  Outcome ask_alone(const SulQuery& query, bool announced, const RunControl& control);
  bool take_line_alone(Outcome& outcome, const std::string& line, std::uint64_t id);
  [[noreturn]] void give_up(const SulQuery& query, const DeathRecord& record) const;

  // How long the wrapper may be silent: beside the steps there are the end of the word before, and
  // the reset.
  std::chrono::milliseconds silence_limit(std::size_t steps) const;
  std::chrono::milliseconds step_limit() const;
  std::string text_of(const SulQuery& query) const;
  std::string describe(const SulQuery& query) const;
  [[noreturn]] void fail(const std::string& message) const;

  WrapperEndpoint endpoint_;
  std::map<std::string, std::string> options_;
  ProxySettings settings_;
  SulInfo info_;
  bool open_outputs_ = false;
  bool announces_steps_ = false;
  std::vector<LearningPurpose> purposes_;  // to be told again to a wrapper that is started anew
  std::unique_ptr<WrapperConnection> connection_;
  std::map<std::uint64_t, Pending> pending_;  // by id: the oldest first
  std::uint64_t next_id_ = 1;
  FatalWords fatal_words_;  // others of the same batch may begin with them
  SulIncidents incidents_;
};

// What a wrapper says of itself, its options among it; it is started and ended for that.
protocol::Hello ask_hello(const WrapperEndpoint& endpoint, const ProxySettings& settings = {},
                          const RunControl& control = {});

// Shorthands.
std::unique_ptr<WrapperProxy> spawn_wrapper(std::vector<std::string> argv,
                                            std::map<std::string, std::string> options = {},
                                            const RunControl& control = {});
std::unique_ptr<WrapperProxy> connect_tcp(const std::string& host_port, const std::string& token,
                                          std::map<std::string, std::string> options = {},
                                          const RunControl& control = {});

}  // namespace maide
