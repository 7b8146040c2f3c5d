#include "services/bus/fastdds/fast_dds_type.hpp"

#include <algorithm>
#include <cstring>

#ifdef DYNCAL_FAST_DDS_3
#include <fastdds/utils/md5.hpp>
using eprosima::fastdds::MD5;
#else
#include <fastrtps/utils/md5.h>
#endif

namespace dyncal::bus {
namespace {

// Fast DDS sets this much aside for a message before it knows how long it will be; it grows as
// needed.
constexpr std::uint32_t first_guess_of_size_bytes = 1024;

} // namespace

FastDdsType::FastDdsType(const TypeSupport& type, std::shared_ptr<MalformedMessages> malformed)
    : type_(type), malformed_(std::move(malformed)) {
#ifdef DYNCAL_FAST_DDS_3
  set_name(type.name);
  max_serialized_type_size = first_guess_of_size_bytes;
  is_compute_key_provided = true;
#else
  setName(type.name.c_str());
  m_typeSize = first_guess_of_size_bytes;
  m_isGetKeyDefined = true;
  auto_fill_type_object(false);
  auto_fill_type_information(false);
#endif
}

bool FastDdsType::write(const FastDdsSample& sample, Payload& payload) {
  const std::string& bytes = *sample.encoded;
  if (bytes.size() > payload.max_size) {
    return false;
  }
  std::memcpy(payload.data, bytes.data(), bytes.size());
  payload.length = static_cast<std::uint32_t>(bytes.size());
  payload.encapsulation = CDR_LE;
  return true;
}

bool FastDdsType::read(const Payload& payload, FastDdsSample& sample) {
  const char* bytes = reinterpret_cast<const char*>(payload.data);
  auto key = read_key(type_.key, bytes, payload.length);
  if (!key ||
      (sample.message != nullptr && !type_.deserialize(sample.message, bytes, payload.length))) {
    malformed_->add(type_.name);
    return false;
  }
  sample.key = std::move(*key);
  if (sample.message != nullptr) {
    sample.bytes.assign(bytes, payload.length);
  }
  return true;
}

// Every key of the contract can be longer than 16 bytes, so the handle is always the MD5.
void FastDdsType::set_handle(const FastDdsSample& sample, Handle& handle) {
  const KeyHash hash = sample.instance != nullptr ? sample.instance->hash
                                                  : fast_dds_key_hash(canonical_key(sample.key));
  for (std::size_t i = 0; i < hash.size(); ++i) {
    handle.value[static_cast<std::uint16_t>(i)] = hash[i];
  }
}

#ifdef DYNCAL_FAST_DDS_3
bool FastDdsType::compute_key(Payload& payload, Handle& handle, bool /*force_md5*/) {
  FastDdsSample sample;
  if (!read(payload, sample)) {
    return false;
  }
  set_handle(sample, handle);
  return true;
}
#endif

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
