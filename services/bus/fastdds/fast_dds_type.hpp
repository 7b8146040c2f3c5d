// A message type of the contract as Fast DDS wants it; its samples are FastDdsSample.
//
// Takes the place of the PubSubType that fastddsgen generates: it announces no type information
// (Cyclone DDS would refuse the endpoint), lets no exception through, and reads messages of older
// programs.
#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>
#include <memory>
#include <string>

#include "services/bus/cdr_key.hpp"
#include "services/bus/fastdds/fast_dds_names.hpp"
#include "services/bus/malformed_messages.hpp"
#include "services/bus/type_support.hpp"

namespace dyncal::bus {

// What Fast DDS hands through as a sample. On its way out it is bytes already; on its way in it is
// read into the struct of the contract, and Fast DDS makes some of its own to learn keys alone.
struct FastDdsSample {
  const std::string* encoded = nullptr; // of a sample on its way out
  const Instance* instance = nullptr;   // the same
  void* message = nullptr;              // of one on its way in; null: only the key is wanted
  std::string bytes;                    // that it came as
  Key key;                              // of one on its way in
};

[[nodiscard]] KeyHash fast_dds_key_hash(const std::string& canonical_key);

class FastDdsType : public eprosima::fastdds::dds::TopicDataType {
public:
  using Payload = fast_dds::rtps::SerializedPayload_t;
  using Handle = fast_dds::rtps::InstanceHandle_t;

  // `type` must live as long as this.
  FastDdsType(const TypeSupport& type, std::shared_ptr<MalformedMessages> malformed);

#ifdef DYNCAL_FAST_DDS_3
  using Representation = eprosima::fastdds::dds::DataRepresentationId_t;

  bool serialize(const void* sample, Payload& payload, Representation /*asked*/) override {
    return write(*static_cast<const FastDdsSample*>(sample), payload);
  }
  bool deserialize(Payload& payload, void* sample) override {
    return read(payload, *static_cast<FastDdsSample*>(sample));
  }
  std::uint32_t calculate_serialized_size(const void* sample, Representation /*asked*/) override {
    return size_of(sample);
  }
  void* create_data() override {
    return new FastDdsSample();
  }
  void delete_data(void* sample) override {
    delete static_cast<FastDdsSample*>(sample);
  }
  bool compute_key(const void* sample, Handle& handle, bool /*force_md5*/) override {
    set_handle(*static_cast<const FastDdsSample*>(sample), handle);
    return true;
  }
  bool compute_key(Payload& payload, Handle& handle, bool /*force_md5*/) override;
#else
  bool serialize(void* sample, Payload* payload) override {
    return write(*static_cast<const FastDdsSample*>(sample), *payload);
  }
  bool deserialize(Payload* payload, void* sample) override {
    return read(*payload, *static_cast<FastDdsSample*>(sample));
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* sample) override {
    return [sample] { return size_of(sample); };
  }
  void* createData() override {
    return new FastDdsSample();
  }
  void deleteData(void* sample) override {
    delete static_cast<FastDdsSample*>(sample);
  }
  bool getKey(void* sample, Handle* handle, bool /*force_md5*/) override {
    set_handle(*static_cast<const FastDdsSample*>(sample), *handle);
    return true;
  }
#endif

private:
  static bool write(const FastDdsSample& sample, Payload& payload);
  bool read(const Payload& payload, FastDdsSample& sample);
  static std::uint32_t size_of(const void* sample) {
    return static_cast<std::uint32_t>(static_cast<const FastDdsSample*>(sample)->encoded->size());
  }
  static void set_handle(const FastDdsSample& sample, Handle& handle);

  const TypeSupport& type_;
  std::shared_ptr<MalformedMessages> malformed_;
};

} // namespace dyncal::bus
