#include "fastdds_wrapper.hpp"

#include <fastrtps/config.h>

#include <string>

#include "dds/dds_connection.hpp"
#include "dds/wrapper_table.hpp"
#include "endpoints.hpp"

namespace maide::fastdds {

FastDdsWrapper::FastDdsWrapper() {
  description_.name = "fastdds";
  description_.summary = "eProsima Fast DDS: writers and readers of one topic, in one process";
  description_.versions = {{"fastdds", FASTRTPS_VERSION_STR}, {"wrapper", "1"}};
  description_.options = dds::option_table();
  description_.options.push_back(
      OptionSpec::choice("transport", "none", {"none", "udp"},
                         "the way of a sample: within the process, or over UDP on the loopback"));
  description_.options.push_back(ProtocolTimers::option());
}

SystemSetup FastDdsWrapper::configure(const OptionValues& options) {
  policies_ = dds::Policies::from(options, {.writer_is_transient_local = true});
  counts_ = dds::end_counts(options);
  const Transport transport = options.is("transport", "udp") ? Transport::udp : Transport::none;
  timers_ = ProtocolTimers::from(options, transport);
  participants_ = std::make_unique<Participants>(transport);
  SystemSetup setup = dds::make_setup(policies_, options);
  setup.floor = timers_.floor(policies_);
  return setup;
}

std::unique_ptr<SystemInstance> FastDdsWrapper::reset(EventSink& sink) {
  return std::make_unique<dds::DdsConnection>(
      std::make_shared<Endpoints>(*participants_, "maide_" + std::to_string(++words_), policies_,
                                  timers_, counts_),
      counts_, sink);
}

}  // namespace maide::fastdds
