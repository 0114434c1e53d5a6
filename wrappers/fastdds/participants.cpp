#include "participants.hpp"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/attributes/LibrarySettingsAttributes.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>

#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <stdexcept>

#include "loopback.hpp"
#include "sample_type.hpp"

#if defined(__SANITIZE_ADDRESS__)
// Fast DDS deletes its readers with another size than it allocated (2.9.1, within the library).
extern "C" const char* __asan_default_options() { return "new_delete_type_mismatch=0"; }
#endif

namespace maide::fastdds {
namespace {

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

// Neither the user's profiles nor a discovery server may change what is learned.
void ignore_environment() {
  ::setenv("SKIP_DEFAULT_XML", "1", 1);
  for (const char* name : {"FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE",
                           "FASTDDS_ENVIRONMENT_FILE", "ROS_DISCOVERY_SERVER"}) {
    ::unsetenv(name);
  }
}

void set_intraprocess_delivery(bool on) {
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery =
      on ? eprosima::fastrtps::INTRAPROCESS_FULL : eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
}

// What both ways have in common: nothing is sent to other hosts or to a multicast group, no timer
// runs once everything is known, and participants of other processes are not listened to. `port`
// is where discovery listens, if it has to.
fast::DomainParticipantQos make_qos(std::uint16_t port) {
  fast::DomainParticipantQos qos;
  auto transport = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  transport->interfaceWhiteList = {loopback};
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports = {transport};
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.leaseDuration = eprosima::fastrtps::c_TimeInfinite;
  discovery.leaseDuration_announcementperiod = {24 * 3600, 0};
  discovery.ignoreParticipantFlags = static_cast<rtps::ParticipantFilteringFlags>(
      rtps::FILTER_DIFFERENT_HOST | rtps::FILTER_DIFFERENT_PROCESS);
  qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(loopback_locator(port));
  return qos;
}

// Listens at `own` for discovery, finds the participant that listens at `peer`.
fast::DomainParticipantQos make_udp_qos(std::uint16_t own, std::uint16_t peer) {
  fast::DomainParticipantQos qos = make_qos(own);
  auto& wire = qos.wire_protocol();
  wire.builtin.initialPeersList.push_back(loopback_locator(peer));
  wire.default_unicast_locator_list.push_back(loopback_locator(free_udp_port()));
  return qos;
}

fast::DomainParticipant* make_participant(const fast::DomainParticipantQos& qos) {
  fast::DomainParticipant* const participant =
      fast::DomainParticipantFactory::get_instance()->create_participant(0, qos);
  if (participant == nullptr) throw std::runtime_error("create_participant fails");
  if (fast::TypeSupport(new SampleType).register_type(participant) !=
      eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
    throw std::runtime_error("register_type fails");
  }
  return participant;
}

}  // namespace

Participants::Participants(Transport transport) {
  ignore_environment();
  // What fails says so by its return code, and standard output is not the log's.
  fast::Log::ClearConsumers();
  set_intraprocess_delivery(transport == Transport::none);
  if (transport == Transport::none) {
    writer_.reset(make_participant(make_qos(free_udp_port())));
  } else {
    const std::uint16_t first = free_udp_port(), second = free_udp_port();
    writer_.reset(make_participant(make_udp_qos(first, second)));
    reader_.reset(make_participant(make_udp_qos(second, first)));
  }
  publisher_ = of_writer().create_publisher(fast::PUBLISHER_QOS_DEFAULT);
  subscriber_ = of_reader().create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT);
  if (publisher_ == nullptr || subscriber_ == nullptr) {
    throw std::runtime_error("create_publisher or create_subscriber fails");
  }
}

Participants::~Participants() = default;

void Participants::Deleter::operator()(fast::DomainParticipant* participant) const {
  participant->delete_contained_entities();
  fast::DomainParticipantFactory::get_instance()->delete_participant(participant);
}

}  // namespace maide::fastdds
