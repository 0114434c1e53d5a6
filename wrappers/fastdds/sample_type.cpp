#include "sample_type.hpp"

#include <cstring>

namespace maide::fastdds {
namespace {

using eprosima::fastrtps::rtps::SerializedPayload_t;

// What a payload opens with: plain CDR, little endian, no options.
constexpr unsigned char header[] = {0, CDR_LE, 0, 0};
constexpr std::uint32_t size = sizeof(header) + sizeof(Sample);

}  // namespace

SampleType::SampleType() {
  setName("maide::dds::Sample");
  m_typeSize = size;
  m_isGetKeyDefined = false;
  auto_fill_type_object(false);
  auto_fill_type_information(false);
}

bool SampleType::serialize(void* data, SerializedPayload_t* payload) {
  if (payload->max_size < size) return false;
  const std::uint32_t number = static_cast<const Sample*>(data)->number;
  std::memcpy(payload->data, header, sizeof(header));
  for (std::size_t byte = 0; byte < sizeof(number); ++byte) {
    payload->data[sizeof(header) + byte] = static_cast<unsigned char>(number >> (8 * byte));
  }
  payload->encapsulation = CDR_LE;
  payload->length = size;
  return true;
}

bool SampleType::deserialize(SerializedPayload_t* payload, void* data) {
  if (payload->length < size || std::memcmp(payload->data, header, sizeof(header)) != 0) {
    return false;
  }
  std::uint32_t number = 0;
  for (std::size_t byte = 0; byte < sizeof(number); ++byte) {
    number |= std::uint32_t{payload->data[sizeof(header) + byte]} << (8 * byte);
  }
  static_cast<Sample*>(data)->number = number;
  return true;
}

std::function<std::uint32_t()> SampleType::getSerializedSizeProvider(void*) {
  return [] { return size; };
}

}  // namespace maide::fastdds
