// What Fast DDS 2.9 (Debian 12) and 3 (Debian 13) call the same things. Differences of more than a
// name stand where they are, behind DYNCAL_FAST_DDS_3.
#pragma once

#include <chrono>
#include <cstdint>

#if __has_include(<fastdds/LibrarySettings.hpp>)
#define DYNCAL_FAST_DDS_3

#include <fastdds/dds/core/ReturnCode.hpp>
#include <fastdds/dds/core/Time_t.hpp>
#include <fastdds/rtps/attributes/ReaderAttributes.hpp>
#include <fastdds/rtps/attributes/WriterAttributes.hpp>
#include <fastdds/rtps/common/Guid.hpp>
#include <fastdds/rtps/common/InstanceHandle.hpp>
#include <fastdds/rtps/common/SerializedPayload.hpp>

namespace dyncal::bus::fast_dds {

namespace rtps = eprosima::fastdds::rtps;
using Duration = eprosima::fastdds::dds::Duration_t;
using ReturnCode = eprosima::fastdds::dds::ReturnCode_t;
inline constexpr ReturnCode ok = eprosima::fastdds::dds::RETCODE_OK;
inline constexpr ReturnCode timed_out = eprosima::fastdds::dds::RETCODE_TIMEOUT;
inline const Duration infinite = eprosima::fastdds::dds::c_TimeInfinite;
inline Duration& heartbeat_period(rtps::WriterTimes& times) {
  return times.heartbeat_period;
}
inline Duration& nack_response_delay(rtps::WriterTimes& times) {
  return times.nack_response_delay;
}
inline Duration& heartbeat_response_delay(rtps::ReaderTimes& times) {
  return times.heartbeat_response_delay;
}

} // namespace dyncal::bus::fast_dds

#else

#include <fastdds/rtps/attributes/ReaderAttributes.h>
#include <fastdds/rtps/attributes/WriterAttributes.h>
#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/common/InstanceHandle.h>
#include <fastdds/rtps/common/SerializedPayload.h>
#include <fastdds/rtps/common/Time_t.h>
#include <fastrtps/types/TypesBase.h>

namespace dyncal::bus::fast_dds {

namespace rtps = eprosima::fastrtps::rtps;
using Duration = eprosima::fastrtps::Duration_t;
using ReturnCode = eprosima::fastrtps::types::ReturnCode_t;
inline constexpr auto ok = ReturnCode::RETCODE_OK;
inline constexpr auto timed_out = ReturnCode::RETCODE_TIMEOUT;
inline const Duration infinite = eprosima::fastrtps::c_TimeInfinite;
inline Duration& heartbeat_period(rtps::WriterTimes& times) {
  return times.heartbeatPeriod;
}
inline Duration& nack_response_delay(rtps::WriterTimes& times) {
  return times.nackResponseDelay;
}
inline Duration& heartbeat_response_delay(rtps::ReaderTimes& times) {
  return times.heartbeatResponseDelay;
}

} // namespace dyncal::bus::fast_dds

#endif

namespace dyncal::bus::fast_dds {

template <class Rep, class Period>
Duration duration(std::chrono::duration<Rep, Period> time) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  const auto rest = std::chrono::duration_cast<std::chrono::nanoseconds>(time - seconds);
  return {static_cast<std::int32_t>(seconds.count()), static_cast<std::uint32_t>(rest.count())};
}

} // namespace dyncal::bus::fast_dds
