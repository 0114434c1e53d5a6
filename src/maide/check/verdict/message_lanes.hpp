// Where messages lie in a system, each place a lane with its oldest message first: a wire, the
// queue of a model, and of a service each client's requests and the answers to it. How many lie in
// a lane is read off the state of its model.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "maide/check/system/system.hpp"

namespace maide {

struct MessageLane {
  enum class Kind : std::uint8_t { wire, queue, requests, answers };
  Kind kind = Kind::wire;
  std::uint32_t model = 0;
  std::uint32_t client = 0;             // of requests and answers: its number at the service
  std::vector<std::uint32_t> held{};    // by state of the model
  std::vector<std::uint32_t> on_way{};  // those of them that have not arrived: all of a wire
  std::vector<std::uint32_t> served{};  // of requests: taken and not answered
  std::uint32_t most = 0;               // held in any state
  std::set<std::uint32_t> writers{};    // programs; of a queue none are said

  // Of what is no wire: what a person calls it, and who takes from it.
  std::string name{};                  // "map", "the answer of lookup"
  std::string topic{};                 // that it is of; may be empty
  std::string reader{};                // "robot": a program or a node
  std::set<std::uint32_t> takers{};    // programs
  std::set<std::string> processes{};   // theirs
  std::vector<std::uint32_t> wires{};  // lanes that lead here

  bool is_wire() const { return kind == Kind::wire; }
};

class MessageLanes {
 public:
  explicit MessageLanes(const System& system);

  const std::vector<MessageLane>& all() const { return lanes_; }
  const std::vector<std::uint32_t>& of_model(std::uint32_t model) const { return of_model_[model]; }
  // The lane of the queue; none: it is no queue whose messages can be counted.
  std::optional<std::uint32_t> queue_of(std::uint32_t model) const;
  // Some model hands messages on, and it is not known how many it holds, or they are too many.
  bool has_unknown() const { return has_unknown_; }
  // Giving this input to the model may add a message.
  bool is_message(std::uint32_t model, Symbol input) const;
  // What the program may put messages into, in whatever state: the lane where they begin, and the
  // one where they are taken.
  struct Way {
    std::uint32_t from = 0, to = 0;
    auto operator<=>(const Way&) const = default;
  };
  const std::set<Way>& ways_of(std::uint32_t program) const { return ways_[program]; }
  // Several programs use the model, and what one does with it tells it what others did with it
  // before: a mutex, a variable, an executor.
  bool is_shared(std::uint32_t model) const { return is_shared_[model]; }

  static constexpr std::uint32_t most_held = 64;  // in a lane; one with more is not known

 private:
  void add_wires(const System& system);
  void add_queue(const System& system, std::uint32_t model);
  void add_service(const System& system, const ServiceInstance& service);
  bool add(MessageLane lane);
  void name_queue(const System& system, MessageLane& lane) const;
  void join_wires(const System& system);
  std::set<Way> find_ways(const System& system, std::uint32_t program) const;

  std::vector<MessageLane> lanes_;
  std::vector<std::vector<std::uint32_t>> of_model_;
  std::vector<std::vector<bool>> is_message_;  // by model, by input
  std::vector<bool> is_shared_;                // by model
  std::vector<std::set<Way>> ways_;            // by program
  bool has_unknown_ = false;
};

}  // namespace maide
