// What one word is played on: a pair of ports, and the calls that the inputs stand for.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string_view>

#include "maide/wire/system_wrapper.hpp"
#include "pair_store.hpp"

namespace maide::yarp_ports {

class Connection : public SystemInstance {
 public:
  // Takes a pair from the store, and gives it back in the end.
  Connection(PairStore& store, EventSink& sink);
  ~Connection() override;

  void call(std::string_view input) override;
  void shutdown() override;
  bool polls_in_vain() const override;

 private:
  void write();
  void read(bool waits);
  void call_writer_control(std::string_view input);
  void call_reader_control(std::string_view input);
  void call_network(std::string_view input);

  PairStore& store_;
  std::unique_ptr<PortPair> pair_;
  EventSink& sink_;
  std::int64_t written_ = 0;             // only the writer's thread writes
  std::atomic<bool> writing_ = false;    // a write has not returned
  std::atomic<bool> reading_ = false;    // a read has not returned
  std::atomic<bool> closing_ = false;    // the writer's port is being closed, by an input
  std::atomic<bool> destroyed_ = false;  // the writer's port is no more
  std::atomic<bool> shut_down_ = false;
};

}  // namespace maide::yarp_ports
