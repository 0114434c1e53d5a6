// What one word is played on: a pair of ports, and the calls that the inputs stand for.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string_view>

#include "maide/wire/wrapper/system_wrapper.hpp"
#include "pair_store.hpp"

namespace maide::yarp_ports {

class YarpConnection : public SystemInstance {
 public:
  // Takes a pair from the store, and gives it back in the end. `server_polls`: there is a name
  // server that is watched, and whose timed sleeps mean nothing.
  YarpConnection(PairStore& store, bool server_polls, EventSink& sink);
  ~YarpConnection() override;

  void call(std::string_view input) override;
  void shutdown() override;
  bool polls_in_vain() const override;

 private:
  void write(std::string_view input);
  void read(bool waits);
  void read_2();
  void call_writer_control(std::string_view input);
  void call_reader_control(std::string_view input);
  void call_network(std::string_view input);

  PairStore& store_;
  const bool server_polls_;
  std::unique_ptr<PortPair> pair_;
  EventSink& sink_;
  std::atomic<std::int64_t> written_ = 0;
  std::atomic<int> writing_ = 0;         // writes that have not returned
  std::atomic<int> reading_ = 0;         // reads that have not returned
  std::atomic<int> closing_ = 0;         // calls that close the writer's port
  std::atomic<bool> destroyed_ = false;  // the writer's port is no more
  std::atomic<bool> shut_down_ = false;
};

}  // namespace maide::yarp_ports
