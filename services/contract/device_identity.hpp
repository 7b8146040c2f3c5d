// What a laboratory states of an instrument, for its certificates and of the ranges and units of
// its channels: in place of what the instrument or the file says of itself, which may be nothing,
// or wrong. Plain data, any thread.
//
// Whoever takes the description of an instrument by with_identity() takes its values by
// unit_factors(): where a unit is a conversion (channel_unit.hpp), stated here or, as "g", by a
// file itself, the description has the D-SI unit, and its quantity ends in what was written.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "drivers/sample_block.hpp"
#include "services/contract/channel_unit.hpp"

namespace dyncal::inline contract {

struct StatedRange { // minimum == maximum: the channel has none
  double minimum = 0.0;
  double maximum = 0.0;

  friend bool operator==(const StatedRange&, const StatedRange&) = default;
};

struct DeviceIdentity { // empty: what the instrument says
  std::string device;
  std::string serial;
  std::string firmware;
  std::map<std::string, StatedRange> ranges{}; // by channel, in D-SI
  std::map<std::string, ChannelUnit> units{};  // by channel; conversions alone
};

[[nodiscard]] drivers::SourceDescription with_identity(drivers::SourceDescription description,
                                                       const DeviceIdentity& identity);

// What values of the described channels, in this order, are multiplied by; empty: none is changed.
[[nodiscard]] std::vector<double> unit_factors(const drivers::SourceDescription& described,
                                               const DeviceIdentity& identity);
// `values` channel after channel, as in a block.
void convert(const std::vector<double>& factors, std::size_t samples, std::vector<double>& values);

// Sentences on units that are stated here although the instrument says another one of itself.
[[nodiscard]] std::vector<std::string> unit_doubts(const drivers::SourceDescription& described,
                                                   const DeviceIdentity& identity);
// Fails (bad_argument) where a conversion is of no channel of the source.
[[nodiscard]] Expected<void> check_units(const drivers::SourceDescription& described,
                                         const DeviceIdentity& identity);

} // namespace dyncal::inline contract
