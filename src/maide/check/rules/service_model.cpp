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

// A request: its client, and whose it is (1 + run, or nobody's).
std::uint32_t item_of(std::uint32_t client, std::uint32_t owner) { return (client << 16) | owner; }
std::uint32_t client_of(std::uint32_t item) { return item >> 16; }
std::uint32_t owner_of(std::uint32_t item) { return item & 0xFFFF; }

}  // namespace

struct ServiceModel::State {
  struct Client {
    std::vector<std::uint32_t> answers;  // owners, or `others`; oldest first, which is its own
    std::uint32_t waits = 0;             // in `receive`: 1, and 2 when the answer is due
    std::vector<std::uint32_t> handed;   // by run: whether its answer was handed over
  };
  std::uint32_t server_waits = 0;       // in `serve`
  std::uint32_t due = none;             // a request that is due to the server
  std::vector<std::uint32_t> requests;  // oldest first
  std::vector<std::uint32_t> served;    // by run of the server: the request served last, or none
  std::vector<Client> clients;
  bool is_beyond = false;  // something was pushed out, or not: the depth would tell

  bool owes_answer() const {
    return std::ranges::any_of(clients, [](const Client& c) { return c.waits == 2; });
  }
};

// Answers to others that are older than all own ones push nothing out: an own one is pushed out by
// `depth` answers behind it. So they count only for who finds them, by their number or at all.
void ServiceModel::tidy(State& state, std::uint32_t client) const {
  if (shape_.is_looked_at[client] && shape_.takes_one_by_one) return;
  auto& answers = state.clients[client].answers;
  const bool is_something_there = !answers.empty();
  answers.erase(answers.begin(),
                std::ranges::find_if(answers, [](auto owner) { return owner != others; }));
  if (is_something_there && answers.empty() && shape_.is_looked_at[client]) {
    answers.push_back(others);
  }
}

ServiceModel::ServiceModel(ServiceShape shape)
    : GrowingModel([&] {
        State state;
        state.served.assign(shape.servers, none);
        for (const std::uint32_t askers : shape.askers) {
          state.clients.push_back({{}, 0, std::vector<std::uint32_t>(askers, 0)});
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
  InterfaceAutomaton automaton(Alphabet(std::span<const std::string>(inputs)),
                               Alphabet(std::span<const std::string>(outputs)), 1);
  automaton.actors = {
      {"server", {inputs.begin(), inputs.begin() + 2}, {outputs.begin(), outputs.begin() + 1}},
      {"client", {inputs.begin() + 2, inputs.end()}, {outputs.begin() + 1, outputs.end()}}};
  automaton.origin["depth"] =
      shape_.is_depth_unknown ? unknown_depth : std::to_string(shape_.depth);
  if (!shape_.rmw.empty()) automaton.origin["rmw"] = shape_.rmw;
  if (!shape_.sul.empty()) automaton.origin["sul"] = shape_.sul;
  return automaton;
}

GrowingModel::Contents ServiceModel::pack(const State& state) {
  Contents contents{state.server_waits, state.due,
                    static_cast<std::uint32_t>(state.requests.size())};
  contents.insert(contents.end(), state.requests.begin(), state.requests.end());
  contents.insert(contents.end(), state.served.begin(), state.served.end());
  for (const State::Client& client : state.clients) {
    contents.push_back(client.waits);
    contents.push_back(static_cast<std::uint32_t>(client.answers.size()));
    contents.insert(contents.end(), client.answers.begin(), client.answers.end());
    contents.insert(contents.end(), client.handed.begin(), client.handed.end());
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
  state.server_waits = *at++;
  state.due = *at++;
  const std::size_t requests = *at++;
  state.requests = read(requests);
  state.served = read(shape_.servers);
  for (const std::uint32_t askers : shape_.askers) {
    State::Client client;
    client.waits = *at++;
    const std::size_t answers = *at++;
    client.answers = read(answers);
    client.handed = read(askers);
    state.clients.push_back(std::move(client));
  }
  return state;
}

void ServiceModel::send(State& state, std::uint32_t item) const {
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

void ServiceModel::answer(State& state, std::uint32_t item) const {
  for (std::uint32_t number = 0; number < state.clients.size(); ++number) {
    State::Client& client = state.clients[number];
    const bool is_own = client_of(item) == number;
    if (client.waits == 1) {  // then its queue is empty, and stays so
      if (is_own) client.waits = 2;
      continue;
    }
    if (client.answers.size() == shape_.depth) {
      // One to others would be thrown away unread, unless each is taken by itself.
      if (client.answers.front() != others ||
          (shape_.is_looked_at[number] && shape_.takes_one_by_one)) {
        state.is_beyond = shape_.is_depth_unknown;
      }
      client.answers.erase(client.answers.begin());
    }
    client.answers.push_back(is_own ? owner_of(item) : others);
    tidy(state, number);
  }
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
  const std::uint32_t own = item_of(client, 1 + run), lost = item_of(client, nobody(client));
  std::replace(state.requests.begin(), state.requests.end(), own, lost);
  std::replace(state.served.begin(), state.served.end(), own, lost);
  if (state.due == own) state.due = lost;
  auto& answers = state.clients[client].answers;
  std::replace(answers.begin(), answers.end(), 1 + run, nobody(client));
  state.clients[client].handed[run] = 0;
}

std::optional<ServiceModel::State> ServiceModel::after(State state,
                                                       const Operation& operation) const {
  using Kind = Operation::Kind;
  const auto [kind, number, run] = operation;
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
        state.server_waits = 1;
      } else {
        state.due = state.requests.front();
        state.requests.erase(state.requests.begin());
      }
      return state;
    case Kind::take_request:
      if (state.due == none) return std::nullopt;
      state.served[run] = std::exchange(state.due, none);
      return state;
    case Kind::serve_at_once:
      if (!serves || state.requests.empty()) return std::nullopt;
      state.served[run] = state.requests.front();
      state.requests.erase(state.requests.begin());
      return state;
    case Kind::answer:
      if (state.served[run] == none || state.owes_answer()) return std::nullopt;
      answer(state, std::exchange(state.served[run], none));
      return state;
    case Kind::answer_due: return when(state.owes_answer());
    case Kind::send:
      if (!takes_requests) return std::nullopt;
      if (run < shape_.askers[number]) {
        forget(state, number, run);
        send(state, item_of(number, 1 + run));
      } else {
        send(state, item_of(number, nobody(number)));
      }
      return state;
    case Kind::receive:
      if (client.waits != 0) return std::nullopt;
      client.waits = take_own(state, number) ? 2 : 1;
      return state;
    case Kind::take_answer:
      if (client.waits != 2) return std::nullopt;
      client.waits = 0;
      return state;
    case Kind::receive_at_once: return when(client.waits == 0 && take_own(state, number));
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
    add(Action::Kind::output, 1 + client, {Kind::take_answer, client, none});
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
  if (is_elsewhere(at)) return result;
  const State state = unpack(contents(at));
  if (state.due != none) result.requests.push_back(client_of(state.due));
  for (const std::uint32_t item : state.requests) result.requests.push_back(client_of(item));
  for (const std::uint32_t item : state.served) {
    if (item != none) result.served.push_back(client_of(item));
  }
  for (std::uint32_t number = 0; number < state.clients.size(); ++number) {
    const State::Client& client = state.clients[number];
    const auto own =
        std::ranges::count_if(client.answers, [](auto owner) { return owner != others; });
    const auto handed = std::ranges::count(client.handed, 1U);
    result.answers[number] = static_cast<std::uint32_t>(own + handed) + (client.waits == 2 ? 1 : 0);
  }
  return result;
}

std::string ServiceModel::text_of(const Operation& operation) const {
  using Kind = Operation::Kind;
  const auto [kind, number, run] = operation;
  std::string of = shape_.askers.size() > 1 ? " of client " + std::to_string(number + 1) : "";
  if (number < shape_.askers.size() && run < shape_.askers[number] && shape_.askers[number] > 1) {
    of += ", run " + std::to_string(run + 1);
  }
  const std::string by = shape_.servers > 1 ? ", run " + std::to_string(run + 1) : "";
  switch (kind) {
    case Kind::serve: return "serve";
    case Kind::take_request: return "!request";
    case Kind::serve_at_once: return "serve -> request" + by;
    case Kind::answer: return "answer" + by;
    case Kind::answer_due: return "an answer is due";
    case Kind::send: return "send" + of;
    case Kind::receive: return "receive" + of;
    case Kind::take_answer: return "!answer" + of;
    case Kind::receive_at_once: return "receive -> answer" + of;
    case Kind::hand_over: return "an answer is handed over" + of;
    case Kind::take_own: return "an answer is taken" + of;
    case Kind::take_others: return "answers to others are thrown away" + of;
    case Kind::wait: return "wait -> answer" + of;
    case Kind::end_run: return "end" + of;
  }
  return "";
}

ModelUse ServiceModel::use(ModelActions& actions, std::uint32_t model, const Operation& operation) {
  return actions.action(
      model, text_of(operation),
      ModelActions::StepsOfState([this, &actions, model, operation](StateId at) {
        if (is_elsewhere(at)) return std::vector<ModelStep>{{at, true}};
        const auto next = after(unpack(contents(at)), operation);
        if (!next) return std::vector<ModelStep>{};
        if (next->is_beyond) return std::vector<ModelStep>{{at, true}};
        return std::vector<ModelStep>{{state_of(actions.automaton(model), pack(*next)), false}};
      }));
}

}  // namespace maide
