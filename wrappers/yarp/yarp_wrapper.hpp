// The wrapper for YARP: `maide learn yarp kind=strict size=6`. A port that writes and one that
// reads, connected, in one process; yarp::os::Port (kind=port), or BufferedPort with and without
// strict reading. The actors `writer` and `reader` write and read; `writer_control`,
// `reader_control` and `network` are the other threads that a program has for interrupting, closing
// and connecting.
//
// By default YARP's local mode: the table of names is the process's own, and nothing is started.
// With a name server (server=own, server=HOST:PORT) the names are the server's. Each word has a
// fresh pair of ports under fresh names.
#pragma once

#include <memory>

#include "maide/wire/wrapper/system_wrapper.hpp"
#include "name_server.hpp"
#include "pair_store.hpp"

namespace maide::yarp_ports {

class YarpWrapper : public SystemWrapper {
 public:
  YarpWrapper();
  const WrapperDescription& description() const override { return description_; }
  SystemSetup configure(const OptionValues& options) override;
  std::unique_ptr<SystemInstance> reset(EventSink& sink) override;

 private:
  WrapperDescription description_;
  std::unique_ptr<NameServer> server_;
  std::unique_ptr<PairStore> pairs_;
};

}  // namespace maide::yarp_ports
