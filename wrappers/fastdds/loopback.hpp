// Where participants meet that talk over UDP within this host.
#pragma once

#include <fastdds/rtps/common/Locator.h>

#include <cstdint>

namespace maide::fastdds {

constexpr const char* loopback = "127.0.0.1";

// A UDP port of the loopback interface that nobody has; free again as it returns. Throws
// std::system_error.
std::uint16_t free_udp_port();

eprosima::fastrtps::rtps::Locator_t loopback_locator(std::uint16_t port);

}  // namespace maide::fastdds
