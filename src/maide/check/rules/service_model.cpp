#include "maide/check/rules/service_model.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {
namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};
constexpr std::uint32_t others = 0;  // in a client's queue: an answer to another's request
// Of a program: one that was given up, and the oldest open one; the others follow it.
constexpr std::uint32_t given_up = 1, oldest = 2;

// A request: its client, and whose it is (1 + run, or nobody's; of a program as above).
std::uint32_t item_of(std::uint32_t client, std::uint32_t owner) { return (client << 16) | owner; }
std::uint32_t client_of(std::uint32_t item) { return item >> 16; }
std::uint32_t owner_of(std::uint32_t item) { return item & 0xFFFF; }

// An answer on its way: its owner, and the number of the caller that gave it.
std::uint32_t coming_of(std::uint32_t owner, std::uint32_t caller) { return caller << 16 | owner; }
std::uint32_t caller_of(std::uint32_t coming) { return coming >> 16; }

}  // namespace

struct ServiceModel::State {
  struct Client {
    std::vector<std::uint32_t> answers;  // owners, or `others`; oldest first, which is its own
    std::uint32_t waits = 0;             // in `receive`: 1, and 2 when the answer is due
    // By run, or by open request of a program: whether its answer was handed over.
    std::vector<std::uint32_t> handed;
    std::uint32_t is_overdue = 0;       // of a program: all of them are
    std::vector<std::uint32_t> sent;    // requests on their way, oldest first
    std::vector<std::uint32_t> coming;  // answers on their way (coming_of), oldest first
    std::uint32_t is_dead = 0;
  };
  std::uint32_t server_waits = 0;       // in `serve`
  std::uint32_t due = none;             // a request that is due to the server
  std::vector<std::uint32_t> requests;  // oldest first
  std::vector<std::uint32_t> served;    // by run of the server: the request served last, or none
  std::vector<Client> clients;
  std::uint32_t is_server_dead = 0;
  bool is_beyond = false;  // something was pushed out, or not: the depth would tell

  bool owes_answer() const {
    return std::ranges::any_of(clients, [](const Client& c) { return c.waits == 2; });
  }
  // Calls visit(owner) for each request of the client, and each answer to one; it may change it.
  template <typename Visit>
  void for_each_owner(std::uint32_t client, const Visit& visit) {
    const auto visit_item = [&](std::uint32_t& item) {
      if (item == none || client_of(item) != client) return;
      std::uint32_t owner = owner_of(item);
      visit(owner);
      item = item_of(client, owner);
    };
    visit_item(due);
    for (auto* const items : {&requests, &served, &clients[client].sent}) {
      for (std::uint32_t& item : *items) visit_item(item);
    }
    for (std::uint32_t& owner : clients[client].answers) visit(owner);
    for (std::uint32_t& coming : clients[client].coming) {
      std::uint32_t owner = owner_of(coming);
      visit(owner);
      coming = coming_of(owner, caller_of(coming));
    }
  }
  // An answer of that caller is on its way to a client, but for that one.
  bool is_coming(std::uint32_t caller, std::size_t but_for) const {
    for (std::size_t i = 0; i < clients.size(); ++i) {
      const auto& coming = clients[i].coming;
      if (i != but_for && std::ranges::find(coming, caller, caller_of) != coming.end()) return true;
    }
    return false;
  }
};

// Answers to others that are older than all own ones push nothing out: an own one is pushed out by
// `depth` answers behind it. So they count only for who finds them, by their number or at all.
void ServiceModel::tidy(State& state, std::uint32_t client) const {
  // Nothing is there that it could push out when it arrives, nor will be.
  auto& coming = state.clients[client].coming;
  const bool is_counted = shape_.callers > 0 || shape_.is_in_stream;
  const auto counts = [&](std::uint32_t owner) { return !is_thrown_away(client, owner); };
  if (!is_counted && !shape_.is_looked_at[client] && state.clients[client].answers.empty()) {
    coming.erase(coming.begin(), std::ranges::find_if(coming, counts, owner_of));
  }
  if (shape_.is_looked_at[client] && shape_.takes_one_by_one) return;
  auto& answers = state.clients[client].answers;
  const bool is_something_there = !answers.empty();
  answers.erase(answers.begin(), std::ranges::find_if(answers, counts));
  if (is_something_there && answers.empty() && shape_.is_looked_at[client]) {
    answers.push_back(others);
  }
}

ServiceModel::ServiceModel(ServiceShape shape)
    : GrowingModel([&] {
        State state;
        state.served.assign(shape.servers, none);
        for (const std::uint32_t askers : shape.askers) {
          state.clients.emplace_back().handed.assign(askers, 0);
        }
        return pack(state);
      }()),
      shape_(std::move(shape)) {}

InterfaceAutomaton ServiceModel::start() const {
  std::vector<std::string> inputs{"serve", "answer"}, outputs{"request"};
  for (std::uint32_t client = 0; client < shape_.askers.size(); ++client) {
    inputs.push_back(name_at_client("send", client));
    inputs.push_back(name_at_client("receive", client));
    outputs.push_back(name_at_client("answer", client));
  }
  const std::vector<std::string> taken = outputs;
  for (const char* const name :
       {"request_arrives", "request_lost", "answer_arrives", "answer_lost"}) {
    for (std::uint32_t client = 0; client < shape_.askers.size() && has_wires(); ++client) {
      outputs.push_back(name_at_client(name, client));
    }
  }
  InterfaceAutomaton automaton(Alphabet(std::span<const std::string>(inputs)),
                               Alphabet(std::span<const std::string>(outputs)), 1);
  automaton.actors = {
      {"server", {inputs.begin(), inputs.begin() + 2}, {taken.begin(), taken.begin() + 1}},
      {"client", {inputs.begin() + 2, inputs.end()}, {taken.begin() + 1, taken.end()}}};
  automaton.origin["depth"] =
      shape_.is_depth_unknown ? unknown_depth : std::to_string(shape_.depth);
  if (!shape_.rmw.empty()) automaton.origin["rmw"] = shape_.rmw;
  if (!shape_.sul.empty()) automaton.origin["sul"] = shape_.sul;
  return automaton;
}

bool ServiceModel::has_wires() const {
  return shape_.callers > 0 || std::ranges::find(shape_.is_late, true) != shape_.is_late.end();
}

Symbol ServiceModel::symbol_of(const Operation& operation) const {
  const auto clients = static_cast<Symbol>(shape_.askers.size());
  using Kind = Operation::Kind;
  const Kind kind = operation.kind == Kind::answer_returns ? Kind::answer_arrives
                    : operation.kind == Kind::loss_returns ? Kind::answer_lost
                                                           : operation.kind;
  const auto row = static_cast<Symbol>(kind) - static_cast<Symbol>(Kind::request_arrives);
  return 1 + clients + row * clients + operation.client;
}

GrowingModel::Contents ServiceModel::pack(const State& state) {
  Contents contents{state.is_server_dead, state.server_waits, state.due,
                    static_cast<std::uint32_t>(state.requests.size())};
  contents.insert(contents.end(), state.requests.begin(), state.requests.end());
  contents.insert(contents.end(), state.served.begin(), state.served.end());
  for (const State::Client& client : state.clients) {
    contents.push_back(client.is_dead);
    contents.push_back(client.waits);
    contents.push_back(client.is_overdue);
    for (const auto* const row : {&client.answers, &client.handed, &client.sent, &client.coming}) {
      contents.push_back(static_cast<std::uint32_t>(row->size()));
      contents.insert(contents.end(), row->begin(), row->end());
    }
  }
  return contents;
}

ServiceModel::State ServiceModel::unpack(const Contents& contents) const {
  auto at = contents.begin();
  const auto read = [&](std::size_t count) {
    std::vector<std::uint32_t> values(at, at + static_cast<std::ptrdiff_t>(count));
    at += static_cast<std::ptrdiff_t>(count);
    return values;
  };
  State state;
  state.is_server_dead = *at++;
  state.server_waits = *at++;
  state.due = *at++;
  const std::size_t requests = *at++;
  state.requests = read(requests);
  state.served = read(shape_.servers);
  state.clients.resize(shape_.askers.size());
  for (State::Client& client : state.clients) {
    client.is_dead = *at++;
    client.waits = *at++;
    client.is_overdue = *at++;
    for (auto* const row : {&client.answers, &client.handed, &client.sent, &client.coming}) {
      const std::size_t size = *at++;
      *row = read(size);
    }
  }
  return state;
}

void ServiceModel::send(State& state, std::uint32_t item) const {
  if (state.is_server_dead != 0) return;
  if (state.server_waits != 0) {
    state.server_waits = 0;
    state.due = item;
    return;
  }
  if (state.requests.size() == shape_.depth) {
    state.requests.erase(state.requests.begin());
    state.is_beyond = shape_.is_depth_unknown;
  }
  state.requests.push_back(item);
}

void ServiceModel::lose_requests(State& state) const {
  state.requests.clear();
  state.due = none;
  for (State::Client& client : state.clients) client.sent.clear();
}

void ServiceModel::die(State& state, bool is_server, std::uint32_t clients) const {
  if (is_server) {
    lose_requests(state);
    state.is_server_dead = 1;
    state.server_waits = 0;
    state.served.assign(shape_.servers, none);
  }
  for (std::uint32_t number = 0; number < state.clients.size(); ++number) {
    if ((clients >> number & 1) == 0) continue;
    for (std::uint32_t run = 0; run < shape_.askers[number]; ++run) forget(state, number, run);
    State::Client& client = state.clients[number];
    client.is_dead = 1;
    client.waits = 0;
    if (is_program(number)) give_up_all(state, number);
    client.answers.clear();
    client.coming.clear();
  }
}

bool ServiceModel::are_dead(const State& state, bool is_server, std::uint32_t clients) {
  for (std::size_t number = 0; number < state.clients.size(); ++number) {
    if ((clients >> number & 1) != 0 && state.clients[number].is_dead == 0) return false;
  }
  return !is_server || state.is_server_dead != 0;
}

void ServiceModel::begin_anew(State& state, bool is_server, std::uint32_t clients) const {
  if (is_server) {
    lose_requests(state);
    state.is_server_dead = 0;
  }
  for (std::uint32_t number = 0; number < state.clients.size(); ++number) {
    if ((clients >> number & 1) == 0) continue;
    // Answers to requests of its old life are strangers'.
    state.for_each_owner(number, [](std::uint32_t& owner) { owner = others; });
    State::Client& client = state.clients[number];
    client.is_dead = 0;
    client.waits = 0;
    client.is_overdue = 0;
    client.handed.assign(shape_.askers[number], 0);
  }
}

void ServiceModel::answer(State& state, std::uint32_t item, std::uint32_t caller) const {
  for (std::uint32_t number = 0; number < state.clients.size(); ++number) {
    if (state.clients[number].is_dead != 0 || shape_.anybody == number) continue;
    const std::uint32_t owner = client_of(item) == number ? owner_of(item) : others;
    if (!is_answered_late(number)) {
      arrive(state, number, owner);
      continue;
    }
    wire().put(state.clients[number].coming, coming_of(owner, caller));
    tidy(state, number);
  }
}

std::uint32_t ServiceModel::pushed_out_by(const State& state, const Operation& operation) const {
  std::uint32_t pushed = 0;
  for (std::uint32_t number = 0; number < state.clients.size(); ++number) {
    const State::Client& client = state.clients[number];
    const bool is_request = operation.kind == Operation::Kind::send;
    const bool is_put = is_request ? number == operation.client : is_answered_late(number);
    const auto& on_way = is_request ? client.sent : client.coming;
    if (is_put && on_way.size() >= wire().room()) pushed |= 1U << number;
  }
  return pushed;
}

void ServiceModel::arrive(State& state, std::uint32_t number, std::uint32_t owner) const {
  State::Client& client = state.clients[number];
  if (client.waits == 1) {  // then its queue is empty, and stays so
    if (owner == oldest) client.waits = 2;
    if (owner > oldest) client.handed[owner - oldest] = 1;
    return;
  }
  if (client.answers.size() == shape_.depth) {
    // One to others would be thrown away unread, unless each is taken by itself.
    if (client.answers.front() != others ||
        (shape_.is_looked_at[number] && shape_.takes_one_by_one)) {
      state.is_beyond = shape_.is_depth_unknown;
    }
    client.answers.erase(client.answers.begin());
  }
  client.answers.push_back(owner);
  tidy(state, number);
}

std::optional<std::uint32_t> ServiceModel::take_own(State& state, std::uint32_t client) const {
  auto& answers = state.clients[client].answers;
  if (answers.empty() || answers.front() == others) return std::nullopt;
  const std::uint32_t owner = answers.front();
  answers.erase(answers.begin());
  tidy(state, client);
  return owner;
}

bool ServiceModel::take_others(State& state, std::uint32_t client) const {
  auto& answers = state.clients[client].answers;
  if (answers.empty() || answers.front() != others) return false;
  answers.erase(answers.begin());
  return true;
}

void ServiceModel::forget(State& state, std::uint32_t client, std::uint32_t run) const {
  state.for_each_owner(client, [&](std::uint32_t& owner) {
    if (owner == 1 + run) owner = nobody(client);
  });
  state.clients[client].handed[run] = 0;
}

// ---- the requests of a program ------------------------------------------------------------------

bool ServiceModel::is_thrown_away(std::uint32_t client, std::uint32_t owner) const {
  return owner == others || (is_program(client) && owner == given_up);
}

bool ServiceModel::take_oldest(State& state, std::uint32_t number) const {
  State::Client& client = state.clients[number];
  if (!client.handed.empty() && std::exchange(client.handed.front(), 0) != 0) return true;
  while (!client.answers.empty()) {
    const std::uint32_t owner = client.answers.front();
    client.answers.erase(client.answers.begin());
    if (owner == oldest) {
      tidy(state, number);
      return true;
    }
    if (owner > oldest) client.handed[owner - oldest] = 1;
  }
  tidy(state, number);
  return false;
}

bool ServiceModel::take_last(State& state, std::uint32_t number) const {
  State::Client& client = state.clients[number];
  if (client.handed.empty()) return false;
  const auto last = static_cast<std::uint32_t>(client.handed.size() - 1);
  const auto answer = std::ranges::find(client.answers, oldest + last);
  if (client.handed[last] == 0 && answer == client.answers.end()) return false;
  if (client.handed[last] == 0) client.answers.erase(client.answers.begin(), answer + 1);
  give_up_all(state, number);
  return true;
}

void ServiceModel::complete(State& state, std::uint32_t number) const {
  State::Client& client = state.clients[number];
  MAIDE_CHECK(!client.handed.empty());
  client.handed.erase(client.handed.begin());
  state.for_each_owner(number, [](std::uint32_t& owner) {
    if (owner > oldest) --owner;
  });
}

std::uint32_t ServiceModel::begin_request(State& state, std::uint32_t number,
                                          std::uint32_t run) const {
  State::Client& client = state.clients[number];
  if (is_program(number)) {
    if (std::exchange(client.is_overdue, 0) != 0) give_up_all(state, number);
    client.handed.push_back(0);
    return static_cast<std::uint32_t>(given_up + client.handed.size());
  }
  if (run >= shape_.askers[number]) return nobody(number);
  forget(state, number, run);
  return 1 + run;
}

void ServiceModel::give_up_all(State& state, std::uint32_t number) const {
  // An answer that is due is to the oldest, which stays open until it is taken.
  state.clients[number].handed.assign(state.clients[number].waits == 2 ? 1 : 0, 0);
  state.for_each_owner(number, [](std::uint32_t& owner) {
    if (owner >= oldest) owner = given_up;
  });
  tidy(state, number);
}

void ServiceModel::tidy_open(State& state, std::uint32_t number) const {
  State::Client& client = state.clients[number];
  if (client.handed.empty()) {
    client.is_overdue = 0;
    return;
  }
  const std::size_t last = client.handed.size() - 1;
  std::vector<std::uint32_t> is_open = client.handed;
  if (client.waits == 2) is_open.front() = 1;
  state.for_each_owner(number, [&](const std::uint32_t& owner) {
    if (owner >= oldest) is_open[owner - oldest] = 1;
  });
  const auto lost = static_cast<std::size_t>(std::ranges::find(is_open, 0U) - is_open.begin());
  if (lost + 1 >= last) return;
  client.handed = {client.handed.begin(), client.handed.begin() + static_cast<long>(lost) + 1};
  client.handed.push_back(0);
  state.for_each_owner(number, [&](std::uint32_t& owner) {
    if (owner < oldest + lost) return;
    owner = owner == oldest + last ? static_cast<std::uint32_t>(oldest + lost + 1) : given_up;
  });
  tidy(state, number);
}

std::optional<ServiceModel::State> ServiceModel::after(State state,
                                                       const Operation& operation) const {
  auto next = behind(std::move(state), operation);
  for (std::uint32_t client = 0; next && client < next->clients.size(); ++client) {
    if (is_program(client)) tidy_open(*next, client);
  }
  return next;
}

std::vector<ServiceModel::State> ServiceModel::all_after(const State& state,
                                                         const Operation& operation) const {
  if (shape_.is_server_anybody) return all_after_anybody(state, operation);
  std::vector<State> all;
  if (auto next = after(state, operation)) all.push_back(std::move(*next));
  return all;
}

// ---- anybody is the server ----------------------------------------------------------------------

std::vector<ServiceModel::State> ServiceModel::all_after_anybody(const State& state,
                                                                 const Operation& operation) const {
  using Kind = Operation::Kind;
  std::vector<State> all;
  const auto add = [&](std::optional<State> next) {
    if (!next) return;
    std::erase_if(next->requests, [&](std::uint32_t item) {
      return is_thrown_away(client_of(item), owner_of(item));
    });
    std::ranges::sort(next->requests);
    const Contents contents = pack(*next);
    const bool is_known =
        std::ranges::any_of(all, [&](const State& known) { return pack(known) == contents; });
    if (!is_known) all.push_back(std::move(*next));
  };
  // Without that request, which he answers or loses.
  const auto without = [&](std::size_t request) {
    State before = state;
    before.requests.erase(before.requests.begin() + static_cast<std::ptrdiff_t>(request));
    return before;
  };
  if (operation.kind == Kind::send) {
    if (shape_.may_not_answer) {
      Operation in_vain = operation;
      in_vain.kind = Kind::send_in_vain;
      add(after(state, in_vain));
    }
    if (state.requests.size() < shape_.depth) {
      add(after(state, operation));
    } else {
      for (std::size_t i = 0; i < state.requests.size(); ++i) add(after(without(i), operation));
    }
    return all;
  }
  const bool takes = operation.kind == Kind::hand_over || operation.kind == Kind::take_own ||
                     operation.kind == Kind::take_answer || operation.kind == Kind::receive_at_once;
  add(after(state, operation));
  if (!takes || !all.empty()) return all;
  for (std::size_t i = 0; i < state.requests.size(); ++i) {
    const std::uint32_t item = state.requests[i];
    if (client_of(item) != operation.client || (i > 0 && state.requests[i - 1] == item)) continue;
    State before = without(i);
    answer(before, item, 0);
    add(after(std::move(before), operation));
  }
  return all;
}

std::optional<ServiceModel::State> ServiceModel::behind(State state,
                                                        const Operation& operation) const {
  using Kind = Operation::Kind;
  const auto [kind, number, run, caller, pushes_out] = operation;
  if (pushes_out && *pushes_out != pushed_out_by(state, operation)) return std::nullopt;
  const auto when = [&](bool is_possible) {
    return is_possible ? std::optional(std::move(state)) : std::nullopt;
  };
  const bool takes_requests = state.due == none;
  const bool serves = takes_requests && state.server_waits == 0;
  MAIDE_CHECK(number < state.clients.size());  // what the server does has the number 0
  State::Client& client = state.clients[number];
  switch (kind) {
    case Kind::serve:
      if (!serves) return std::nullopt;
      if (state.requests.empty()) {
        state.server_waits = 1;  // of anybody one comes then
      } else {
        state.due = state.requests.front();
        state.requests.erase(state.requests.begin());
      }
      return state;
    case Kind::take_request:
      if (shape_.is_open && std::exchange(state.server_waits, 0) != 0) {
        state.due = item_of(*shape_.anybody, given_up);
      }
      if (state.due == none) return std::nullopt;
      state.served[run] = std::exchange(state.due, none);
      return state;
    case Kind::serve_at_once:
      if (!serves) return std::nullopt;
      if (shape_.is_open) {
        state.served[run] = item_of(*shape_.anybody, given_up);
        return state;
      }
      if (state.requests.empty()) return std::nullopt;
      state.served[run] = state.requests.front();
      state.requests.erase(state.requests.begin());
      return state;
    case Kind::answer:
      if (state.served[run] == none) return std::nullopt;
      for (std::uint32_t i = 0; i < state.clients.size(); ++i) {
        if (state.clients[i].waits == 2 && !is_answered_late(i)) return std::nullopt;
      }
      answer(state, std::exchange(state.served[run], none), caller);
      return state;
    case Kind::answer_due: return when(state.owes_answer());
    case Kind::own_answer_due: return when(client.waits == 2);
    case Kind::send: {
      if (!takes_requests && !shape_.is_late[number]) return std::nullopt;
      const std::uint32_t item =
          item_of(number, shape_.anybody == number ? given_up : begin_request(state, number, run));
      if (state.is_server_dead != 0) return state;
      if (shape_.is_late[number]) {
        wire().put(client.sent, item);
      } else {
        send(state, item);
      }
      return state;
    }
    case Kind::receive:
      if (client.waits != 0) return std::nullopt;
      client.waits = take_oldest(state, number) ? 2 : 1;
      return state;
    case Kind::take_answer:
      if (client.waits == 0) return when(take_last(state, number));
      if (client.waits != 2) return std::nullopt;
      client.waits = 0;
      complete(state, number);
      return state;
    case Kind::receive_at_once:
      if (client.waits != 0 || !take_oldest(state, number)) return std::nullopt;
      complete(state, number);
      return state;
    case Kind::time_out: client.is_overdue = 1; return state;
    case Kind::hand_over:
    case Kind::take_own: {
      const auto owner = take_own(state, number);
      if (!owner) return std::nullopt;
      if (kind == Kind::hand_over && *owner != nobody(number)) client.handed[*owner - 1] = 1;
      return state;
    }
    case Kind::take_others: return when(take_others(state, number));
    case Kind::wait:
      if (client.handed[run] == 0) return std::nullopt;
      client.handed[run] = 0;
      return state;
    case Kind::end_run: forget(state, number, run); return state;
    case Kind::send_in_vain: begin_request(state, number, run); return state;
    case Kind::withdraw: lose_requests(state); return state;
    case Kind::die: die(state, caller != 0, run); return state;
    case Kind::begin_anew:
      if (!are_dead(state, caller != 0, run)) return std::nullopt;
      begin_anew(state, caller != 0, run);
      return state;
    case Kind::server_is_dead: return when(state.is_server_dead != 0);
    case Kind::request_arrives:
    case Kind::request_lost: {
      const bool arrives = kind == Kind::request_arrives;
      if (client.sent.empty() || !takes_requests) return std::nullopt;
      if (!arrives && client.is_dead == 0 && !wire().may_lose(client.sent.size())) {
        return std::nullopt;
      }
      const std::uint32_t item = client.sent.front();
      client.sent.erase(client.sent.begin());
      if (arrives) send(state, item);
      return state;
    }
    case Kind::answer_arrives:
    case Kind::answer_lost:
    case Kind::answer_returns:
    case Kind::loss_returns: {
      const bool arrives = kind == Kind::answer_arrives || kind == Kind::answer_returns;
      if (client.coming.empty() || client.waits == 2) return std::nullopt;
      if (!arrives && state.is_server_dead == 0 && !wire().may_lose(client.coming.size())) {
        return std::nullopt;
      }
      const std::uint32_t coming = client.coming.front();
      const bool returns = kind == Kind::answer_returns || kind == Kind::loss_returns;
      if (returns && caller_of(coming) != caller) return std::nullopt;
      if (shape_.callers > 0 && state.is_coming(caller_of(coming), number) == returns) {
        return std::nullopt;
      }
      client.coming.erase(client.coming.begin());
      if (arrives) arrive(state, number, owner_of(coming));
      tidy(state, number);
      return state;
    }
  }
  return std::nullopt;
}

std::vector<GrowingModel::Follower> ServiceModel::followers(const Contents& contents) const {
  using Kind = Operation::Kind;
  std::vector<Follower> result;
  const auto add = [&](Action::Kind way, Symbol symbol, const Operation& operation) {
    const auto next = after(unpack(contents), operation);
    if (next && !next->is_beyond) result.push_back({{way, symbol}, pack(*next)});
  };
  if (shape_.is_open || shape_.is_server_anybody) return result;  // no real one does that alone
  // The symbols of start().
  if (!shape_.is_served_by_node) {
    add(Action::Kind::input, 0, {Kind::serve, 0, 0});
    add(Action::Kind::input, 1, {Kind::answer, 0, 0});
    add(Action::Kind::output, 0, {Kind::take_request, 0, 0});
  }
  for (std::uint32_t client = 0; client < shape_.askers.size(); ++client) {
    if (shape_.askers[client] > 0) continue;
    add(Action::Kind::input, 2 + 2 * client, {Kind::send, client, none});
    add(Action::Kind::input, 3 + 2 * client, {Kind::receive, client, none});
    if (unpack(contents).clients[client].waits == 2) {
      add(Action::Kind::output, 1 + client, {Kind::take_answer, client, none});
    }
  }
  return result;
}

bool ServiceModel::is_due(const Contents& contents) const {
  const State state = unpack(contents);
  return (state.due != none && !shape_.is_served_by_node) || state.owes_answer();
}

std::string ServiceModel::describe(StateId at) const {
  if (is_elsewhere(at)) return "";
  const State state = unpack(contents(at));
  std::vector<std::string> parts;
  const auto add = [&](std::size_t count, const std::string& what, const std::string& rest) {
    if (count == 0) return;
    const std::string one = what == "answer" ? "an " : "a ";
    parts.push_back((count == 1 ? one + what : std::to_string(count) + " " + what + "s") + rest);
  };
  for (std::uint32_t number = 0; number < state.clients.size(); ++number) {
    const State::Client& client = state.clients[number];
    const auto is_own = [&](std::uint32_t item) {
      return item != none && client_of(item) == number;
    };
    const auto count = [&](const std::vector<std::uint32_t>& items) {
      return static_cast<std::size_t>(std::ranges::count_if(items, is_own));
    };
    const std::string& name = shape_.names[number];
    add(client.sent.size(), "request", " of " + name + " on its way");
    add(static_cast<std::size_t>(std::ranges::count_if(
            client.coming, [](std::uint32_t coming) { return owner_of(coming) != others; })),
        "answer", " to " + name + " on its way");
    add(count(state.requests) + (is_own(state.due) ? 1 : 0), "request",
        " of " + name + " not served");
    add(count(state.served), "request", " of " + name + " served and not answered");
    const auto strangers = static_cast<std::size_t>(std::ranges::count(client.answers, others));
    add(client.answers.size() - strangers, "answer", " to " + name + " not taken");
    const bool is_any_number = shape_.is_looked_at[number] && !shape_.takes_one_by_one &&
                               client.answers.size() == strangers;
    if (strangers > 0 && is_any_number) {
      parts.push_back("answers to others in the queue of " + name);
    } else {
      add(strangers, "answer", " to others in the queue of " + name);
    }
    add(static_cast<std::size_t>(std::ranges::count(client.handed, 1U)), "answer",
        " handed over to its callback");
  }
  if (parts.empty()) return "nothing is on its way";
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

std::optional<ServiceContents> ServiceModel::service_contents(StateId at) const {
  ServiceContents result;
  result.answers.resize(shape_.askers.size());
  result.sent.resize(shape_.askers.size());
  result.coming.resize(shape_.askers.size());
  if (is_elsewhere(at)) return result;
  const State state = unpack(contents(at));
  if (state.due != none) result.requests.push_back(client_of(state.due));
  for (const std::uint32_t item : state.requests) result.requests.push_back(client_of(item));
  for (const std::uint32_t item : state.served) {
    if (item != none) result.served.push_back(client_of(item));
  }
  for (std::uint32_t number = 0; number < state.clients.size(); ++number) {
    const State::Client& client = state.clients[number];
    const auto own_of = [&](const std::vector<std::uint32_t>& answers) {
      return static_cast<std::uint32_t>(std::ranges::count_if(
          answers, [&](auto answer) { return !is_thrown_away(number, owner_of(answer)); }));
    };
    const auto handed = static_cast<std::uint32_t>(std::ranges::count(client.handed, 1U));
    result.answers[number] = own_of(client.answers) + handed + (client.waits == 2 ? 1 : 0);
    result.sent[number] = static_cast<std::uint32_t>(client.sent.size());
    result.coming[number] = own_of(client.coming);
  }
  return result;
}

std::string ServiceModel::text_of(const Operation& operation) const {
  using Kind = Operation::Kind;
  const auto [kind, number, run, caller, pushes_out] = operation;
  std::string of = shape_.askers.size() > 1 ? " of client " + std::to_string(number + 1) : "";
  if (number < shape_.askers.size() && run < shape_.askers[number] && shape_.askers[number] > 1) {
    of += ", run " + std::to_string(run + 1);
  }
  std::string by = shape_.servers > 1 ? ", run " + std::to_string(run + 1) : "";
  if (shape_.callers > 1) by += ", by caller " + std::to_string(caller + 1);
  const std::string out =
      pushes_out ? ", pushes out " + std::to_string(*pushes_out) : std::string();
  switch (kind) {
    case Kind::serve: return "serve";
    case Kind::take_request: return "!request";
    case Kind::serve_at_once: return "serve -> request" + by;
    case Kind::answer: return "answer" + by + out;
    case Kind::answer_due: return "an answer is due";
    case Kind::own_answer_due: return "an answer is due" + of;
    case Kind::send: return "send" + of + out;
    case Kind::receive: return "receive" + of;
    case Kind::take_answer: return "!answer" + of;
    case Kind::receive_at_once: return "receive -> answer" + of;
    case Kind::time_out: return "requests are overdue" + of;
    case Kind::hand_over: return "an answer is handed over" + of;
    case Kind::take_own: return "an answer is taken" + of;
    case Kind::take_others: return "answers to others are thrown away" + of;
    case Kind::wait: return "wait -> answer" + of;
    case Kind::end_run: return "end" + of;
    case Kind::send_in_vain: return "send" + of + ", in vain";
    case Kind::withdraw: return "is withdrawn";
    case Kind::die:
      return std::string(caller != 0 ? "the server dies" : "") +
             (run != 0 ? " clients " + std::to_string(run) + " die" : "");
    case Kind::begin_anew:
      return std::string(caller != 0 ? "the server begins anew" : "") +
             (run != 0 ? " clients " + std::to_string(run) + " begin anew" : "");
    case Kind::server_is_dead: return "its server is dead";
    case Kind::request_arrives: return "a request arrives" + of;
    case Kind::request_lost: return "a request is lost" + of;
    case Kind::answer_arrives: return "an answer arrives" + of;
    case Kind::answer_lost: return "an answer is lost" + of;
    case Kind::answer_returns: return "an answer arrives, and the call returns" + of + by;
    case Kind::loss_returns: return "an answer is lost, and the call returns" + of + by;
  }
  return "";
}

ModelUse ServiceModel::use(ModelActions& actions, std::uint32_t model, const Operation& operation) {
  return actions.action(
      model, text_of(operation),
      ModelActions::StepsOfState([this, &actions, model, operation](StateId at) {
        if (is_elsewhere(at)) return std::vector<ModelStep>{{at, true}};
        std::vector<ModelStep> steps;
        for (const State& next : all_after(unpack(contents(at)), operation)) {
          if (next.is_beyond) {
            steps.push_back({at, true});
          } else {
            steps.push_back({state_of(actions.automaton(model), pack(next)), false});
          }
        }
        return steps;
      }));
}

}  // namespace maide
