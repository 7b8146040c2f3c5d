// A message type of the contract as Fast DDS wants it.
//
// Takes the place of the PubSubType that fastddsgen generates: it announces no type information
// (Cyclone DDS would refuse the endpoint), lets no exception through, and reads messages of older
// programs.
#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>
#include <memory>

#include "services/bus/malformed_messages.hpp"
#include "services/bus/type_support.hpp"

namespace dyncal::bus {

class FastDdsType : public eprosima::fastdds::dds::TopicDataType {
public:
  // `type` must live as long as this.
  FastDdsType(const TypeSupport& type, std::shared_ptr<MalformedMessages> malformed);

  bool serialize(void* sample, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* sample) override;
  std::function<uint32_t()> getSerializedSizeProvider(void* sample) override;
  void* createData() override { return type_.create(); }
  void deleteData(void* sample) override { type_.destroy(sample); }
  bool getKey(void* sample, eprosima::fastrtps::rtps::InstanceHandle_t* handle,
              bool force_md5) override;

private:
  const TypeSupport& type_;
  std::shared_ptr<MalformedMessages> malformed_;
};

} // namespace dyncal::bus
