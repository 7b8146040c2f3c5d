// The datagrams of the SmartUp Unit, written byte by byte (proto2 wire format, no schema needed).
//
// A datagram is the keyword DATA or DSCP, then messages, each after its length as varint. DATA is
// sent when it holds 873 bytes or more, so it never exceeds 1000; DSCP carries one description.
// `with_ticks` adds field 22 (raw counter), which units have since 2021-07. One thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/virtual_bench/model/unit_sample.hpp"

namespace dyncal::drivers::virtual_bench {

class SmartUpPacker {
public:
  SmartUpPacker(std::uint32_t sensor_id, std::string sensor_name, bool with_ticks)
      : sensor_id_(sensor_id), sensor_name_(std::move(sensor_name)), with_ticks_(with_ticks) {}

  // The datagram that this sample completes.
  [[nodiscard]] std::optional<std::string> append(const UnitSample& sample);

  // The burst that describes the sensor, one datagram a kind of description.
  [[nodiscard]] std::vector<std::string>
  descriptions(const std::vector<UnitChannel>& channels) const;

private:
  [[nodiscard]] std::string text_description(int type,
                                             const std::vector<UnitChannel>& channels) const;
  [[nodiscard]] std::string number_description(int type,
                                               const std::vector<UnitChannel>& channels) const;
  [[nodiscard]] std::string description_head(int type) const;

  std::uint32_t sensor_id_;
  std::string sensor_name_;
  bool with_ticks_;
  std::string datagram_;
};

} // namespace dyncal::drivers::virtual_bench
