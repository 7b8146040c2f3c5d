#include "services/bus/fastdds/fast_dds_type.hpp"

#include <algorithm>
#include <array>
#include <fastrtps/utils/md5.h>

#include "services/bus/cdr_key.hpp"

namespace dyncal::bus {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

// Fast DDS sets this much aside for a message before it knows how long it will be; it grows as
// needed.
constexpr std::uint32_t first_guess_of_size_bytes = 1024;

} // namespace

FastDdsType::FastDdsType(const TypeSupport& type, std::shared_ptr<MalformedMessages> malformed)
    : type_(type), malformed_(std::move(malformed)) {
  setName(type.name.c_str());
  m_typeSize = first_guess_of_size_bytes;
  m_isGetKeyDefined = true;
  auto_fill_type_object(false);
  auto_fill_type_information(false);
}

bool FastDdsType::serialize(void* sample, rtps::SerializedPayload_t* payload) {
  const std::size_t bytes =
      type_.serialize(sample, reinterpret_cast<char*>(payload->data), payload->max_size);
  payload->length = static_cast<std::uint32_t>(bytes);
  payload->encapsulation = CDR_LE;
  return bytes > 0;
}

bool FastDdsType::deserialize(rtps::SerializedPayload_t* payload, void* sample) {
  const char* bytes = reinterpret_cast<const char*>(payload->data);
  const bool read = read_key(type_.key, bytes, payload->length) &&
                    type_.deserialize(sample, bytes, payload->length);
  if (!read) {
    malformed_->add(type_.name);
  }
  return read;
}

std::function<uint32_t()> FastDdsType::getSerializedSizeProvider(void* sample) {
  return [this, sample] { return static_cast<std::uint32_t>(type_.serialized_size(sample)); };
}

// Every key of the contract can be longer than 16 bytes, so the handle is always the MD5.
bool FastDdsType::getKey(void* sample, rtps::InstanceHandle_t* handle, bool /*force_md5*/) {
  std::array<char, max_key_payload_bytes> bytes{};
  const std::size_t count = type_.canonical_key(sample, bytes.data(), bytes.size());
  if (count == 0) {
    return false;
  }
  MD5 md5;
  md5.init();
  md5.update(bytes.data(), static_cast<MD5::size_type>(count));
  md5.finalize();
  for (std::size_t i = 0; i < sizeof md5.digest; ++i) {
    handle->value[static_cast<std::uint16_t>(i)] = md5.digest[i];
  }
  return true;
}

} // namespace dyncal::bus
