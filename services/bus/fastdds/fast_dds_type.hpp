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
  // `type` must live as long as this.
  FastDdsType(const TypeSupport& type, std::shared_ptr<MalformedMessages> malformed);

  bool serialize(void* sample, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* sample) override;
  std::function<uint32_t()> getSerializedSizeProvider(void* sample) override;
  void* createData() override { return new FastDdsSample(); }
  void deleteData(void* sample) override { delete static_cast<FastDdsSample*>(sample); }
  bool getKey(void* sample, eprosima::fastrtps::rtps::InstanceHandle_t* handle,
              bool force_md5) override;

private:
  const TypeSupport& type_;
  std::shared_ptr<MalformedMessages> malformed_;
};

} // namespace dyncal::bus
