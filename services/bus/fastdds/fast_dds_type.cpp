#include "services/bus/fastdds/fast_dds_type.hpp"

#include <algorithm>
#include <cstring>
#include <fastrtps/utils/md5.h>

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
  const std::string& bytes = *static_cast<const FastDdsSample*>(sample)->encoded;
  if (bytes.size() > payload->max_size) {
    return false;
  }
  std::memcpy(payload->data, bytes.data(), bytes.size());
  payload->length = static_cast<std::uint32_t>(bytes.size());
  payload->encapsulation = CDR_LE;
  return true;
}

bool FastDdsType::deserialize(rtps::SerializedPayload_t* payload, void* sample) {
  auto& to = *static_cast<FastDdsSample*>(sample);
  const char* bytes = reinterpret_cast<const char*>(payload->data);
  auto key = read_key(type_.key, bytes, payload->length);
  if (!key || (to.message != nullptr && !type_.deserialize(to.message, bytes, payload->length))) {
    malformed_->add(type_.name);
    return false;
  }
  to.key = std::move(*key);
  if (to.message != nullptr) {
    to.bytes.assign(bytes, payload->length);
  }
  return true;
}

std::function<uint32_t()> FastDdsType::getSerializedSizeProvider(void* sample) {
  return [sample] {
    return static_cast<std::uint32_t>(static_cast<const FastDdsSample*>(sample)->encoded->size());
  };
}

// Every key of the contract can be longer than 16 bytes, so the handle is always the MD5.
bool FastDdsType::getKey(void* sample, rtps::InstanceHandle_t* handle, bool /*force_md5*/) {
  const auto& from = *static_cast<const FastDdsSample*>(sample);
  const KeyHash hash =
      from.instance != nullptr ? from.instance->hash : fast_dds_key_hash(canonical_key(from.key));
  for (std::size_t i = 0; i < hash.size(); ++i) {
    handle->value[static_cast<std::uint16_t>(i)] = hash[i];
  }
  return true;
}

KeyHash fast_dds_key_hash(const std::string& canonical_key) {
  MD5 md5;
  md5.init();
  md5.update(canonical_key.data(), static_cast<MD5::size_type>(canonical_key.size()));
  md5.finalize();
  KeyHash hash;
  std::ranges::copy(md5.digest, hash.begin());
  return hash;
}

} // namespace dyncal::bus
