// A service as its rules say: two topics with numbers. Requests go from the clients to the server;
// an answer goes from the server to *all* clients, each of which throws away what answers none of
// its own open requests. Both directions keep the last `depth`.
//
// Callbacks of a node ask under their own names: a request is its run's until that run is over or
// has asked again, and then nobody's. Its client still takes the answer.
//
// The open requests of a program have numbers, the oldest 0. It receives the answer to that one
// alone; what it finds before, and what answers another open one, is handed over for that one. A
// time-out makes all that are open overdue, and the next request gives those up: what answers them
// is thrown away, as what answers others is. Behind a request that can not be answered any more no
// other is received, but the last one may be waited for: those between are given up.
//
// An executor that goes by rounds finds a client ready when any answer is in its queue. If its
// place in the round comes and the queue begins with answers to others, those are thrown away and
// nothing runs: all that are older than the first own answer, which then is taken in the same step
// (Cyclone DDS), or one (Fast DDS). Other clients lose such answers unseen.
//
// Between processes requests and answers are on their way for a while: each client has a wire to
// the server and one back. Or an answer alone is, and the call that gave it returns when all
// clients have it.
//
// Where anybody is the server there is no state between a request and its answer: whoever takes an
// answer takes it from the requests. They are kept sorted, for he answers them in any order.
//
// What programs do with a service are actions on its state. Its automaton has as transitions what
// programs, not nodes, do, for a run to be played on a real service.
// Invariant: an item is one request. Of the own answers in a client's queue at most one is that of
// a run, for a run's earlier requests are nobody's. The oldest answer in a client's queue is its
// own, and of a program one to an open request, except where an executor goes by rounds: over
// Cyclone DDS the queue then is one answer to others where it holds only such answers; over Fast
// DDS it is as it is. Of the open requests of a program at most the last two can not be answered.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "maide/check/rules/built_in_models.hpp"
#include "maide/check/rules/wire.hpp"
#include "maide/check/system/model_actions.hpp"

namespace maide {

struct ServiceShape {
  std::uint32_t depth = 10;           // at least 1
  bool is_depth_unknown = false;      // what would be lost at depth 1 goes beyond what is known
  std::vector<std::uint32_t> askers;  // by client: runs of callbacks that may wait; 0: a program
  std::uint32_t servers = 1;          // runs of the server's callback at once
  bool is_served_by_node = false;
  std::vector<bool> is_looked_at;  // by client: its executor goes by rounds
  bool takes_one_by_one = false;   // a look's client takes one answer, whosever it is: Fast DDS
  std::vector<std::string> names;  // of the clients
  // By client: what it and the server send each other is on its way for a while (wire.hpp).
  std::vector<bool> is_late;
  bool loses = false;  // so may be lost there
  // How many programs may answer, where a call returns when all clients have its answer; else 0.
  std::uint32_t callers = 0;
  bool is_in_stream = false;  // what is on its way comes in one order with what else is
  // The client that is anybody: what is answered to him vanishes. `is_open`: he is the only one,
  // and a request of his is there at any time.
  std::optional<std::uint32_t> anybody;
  bool is_open = false;
  // The server is anybody: an answer is there at any time to each request that he has not answered,
  // and whoever looks finds it or not. `may_not_answer`: it shows when he gets a request whether he
  // ever answers it.
  bool is_server_anybody = false, may_not_answer = false;
  std::string rmw;  // on which it is to run; may be empty
  std::string sul;  // the real system of programs' runs: "ros2 kind=service ..."; may be empty
};

class ServiceModel : public GrowingModel {
 public:
  struct Operation {
    enum class Kind : std::uint8_t {
      // What the server does. Where its callback runs several times at once, `run` is the number.
      serve,         // asks for a request
      take_request,  // takes the one that is due
      serve_at_once,
      answer,
      answer_due,      // an answer is due to some client: a condition
      own_answer_due,  // one is due to this client: a condition
      // What a client does.
      send,     // by the run number `run` of its callbacks; beyond them, or of a program: by nobody
      receive,  // asks for an answer
      take_answer,  // takes the one that is due; where none was asked for, that to the last request
      receive_at_once,
      time_out,  // all open requests are overdue
      // What a client does that is a node.
      hand_over,    // its callback takes an answer to one of its requests, for the run that asked
      take_own,     // for code of its own
      take_others,  // its place in a round comes, and what it takes is for nobody here
      wait,         // the run takes the answer that was handed over for it
      end_run,
      send_in_vain,  // the server is not there: the request is lost
      // What happens to ends.
      withdraw,  // the server is there no more: requests that it has not taken are lost
      // The server, if `caller` is 1: requests that it has not answered are lost, and those that
      // come later. The clients whose bits `run` has: what is for them is gone.
      die,
      begin_anew,      // so, those that have died: as in the beginning, whoever else is there
      server_is_dead,  // a condition
      // What nobody does.
      request_arrives,
      request_lost,
      answer_arrives,
      answer_lost,
      // The same, with which the call of `caller` returns.
      answer_returns,
      loss_returns,
    };
    Kind kind = Kind::send;
    std::uint32_t client = 0, run = 0;
    std::uint32_t caller = 0;  // of an answer: the number of the program that gives it
    // Of what is sent, where that is asked: the clients on whose wires it pushes out the oldest, a
    // bit each.
    std::optional<std::uint32_t> pushes_out{};
    auto operator<=>(const Operation&) const = default;
  };

  explicit ServiceModel(ServiceShape shape);

  InterfaceAutomaton start() const override;
  bool is_large() const override { return false; }
  // "a request of detector is not served, 2 answers to detector are not taken".
  std::string describe(StateId state) const override;
  std::optional<ServiceContents> service_contents(StateId state) const override;

  // The output that names what nobody does; start() has it where something is late.
  Symbol symbol_of(const Operation& operation) const;
  const ServiceShape& shape() const { return shape_; }
  // The use of the model that this is.
  ModelUse use(ModelActions& actions, std::uint32_t model, const Operation& operation);

 private:
  struct State;
  State unpack(const Contents& contents) const;
  static Contents pack(const State& state);
  std::vector<Follower> followers(const Contents& contents) const override;
  bool is_due(const Contents& contents) const override;
  std::optional<State> after(State state, const Operation& operation) const;
  // All that the operation may lead to; where the server is anybody that may be several.
  std::vector<State> all_after(const State& state, const Operation& operation) const;
  // The same, where the server is anybody.
  std::vector<State> all_after_anybody(const State& state, const Operation& operation) const;
  // The same, before what makes no difference is tidied away.
  std::optional<State> behind(State state, const Operation& operation) const;
  std::string text_of(const Operation& operation) const;

  void send(State& state, std::uint32_t item) const;
  // All that the server has not taken.
  void lose_requests(State& state) const;
  void die(State& state, bool is_server, std::uint32_t clients) const;
  // So are the server, if it is asked for, and the clients whose bits are set.
  static bool are_dead(const State& state, bool is_server, std::uint32_t clients);
  void begin_anew(State& state, bool is_server, std::uint32_t clients) const;
  void answer(State& state, std::uint32_t item, std::uint32_t caller) const;
  // What is answered to that client is on its way for a while.
  bool is_answered_late(std::uint32_t client) const {
    return shape_.is_late[client] || shape_.callers > 0;
  }
  std::uint32_t pushed_out_by(const State& state, const Operation& operation) const;
  // The client's queue gets an answer to that owner, or to another.
  void arrive(State& state, std::uint32_t client, std::uint32_t owner) const;
  bool has_wires() const;
  WireRules wire() const { return {shape_.depth, shape_.loses}; }
  // The first own answer of the node.
  std::optional<std::uint32_t> take_own(State& state, std::uint32_t client) const;
  // A request begins. Returns its owner.
  std::uint32_t begin_request(State& state, std::uint32_t client, std::uint32_t run) const;
  bool is_program(std::uint32_t client) const { return shape_.askers[client] == 0; }
  // Of a program's open requests: the answer to the oldest is there, and is taken.
  bool take_oldest(State& state, std::uint32_t client) const;
  // The answer to the last is there, and is taken; the others are given up.
  bool take_last(State& state, std::uint32_t client) const;
  // The oldest was answered.
  void complete(State& state, std::uint32_t client) const;
  void give_up_all(State& state, std::uint32_t client) const;
  // Gives up those behind one that can not be answered, but for the last.
  void tidy_open(State& state, std::uint32_t client) const;
  // The answer makes no difference to whoever finds it.
  bool is_thrown_away(std::uint32_t client, std::uint32_t owner) const;
  bool take_others(State& state, std::uint32_t client) const;
  // Drops answers to others that make no difference.
  void tidy(State& state, std::uint32_t client) const;
  // The requests of that run are nobody's from here on.
  void forget(State& state, std::uint32_t client, std::uint32_t run) const;
  std::uint32_t nobody(std::uint32_t client) const { return 1 + shape_.askers[client]; }

  ServiceShape shape_;
};

}  // namespace maide
