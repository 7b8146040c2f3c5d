// The account of the samples of one source, in the same words for every driver.
//
// received, lost_in_device, lost_on_way and rejected hold each sample once. `causes` gives the
// details by name: the same samples by what happened to them, and what concerns no single sample
// (datagrams, frames, the bus). Counts only rise while a driver runs. Plain data.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/sample_block.hpp"

namespace dyncal::drivers {

struct NamedCount {
  std::string name;
  std::uint64_t value = 0;

  friend bool operator==(const NamedCount&, const NamedCount&) = default;
};

struct SampleCounts {
  std::uint64_t received = 0;
  std::uint64_t lost_in_device = 0;
  std::uint64_t lost_on_way = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t rejected = 0;
  std::uint64_t stamps_not_trusted = 0; // samples handed on with at least one flag
  std::vector<NamedCount> causes;       // only those that are not 0
  double clock_uncertainty_s = 0.0;     // of the device's clock now; 0: not known

  void add_cause(std::string name, std::uint64_t value) {
    if (value > 0) {
      causes.push_back({std::move(name), value});
    }
  }

  // A block of a source whose losses show in its sample numbers alone: a gap was lost in the
  // device. `next_sample` is the number that follows the block before, nothing before the first
  // block of a session; it is moved on.
  void add(const SampleBlock& block, std::optional<std::uint64_t>& next_sample) {
    if (next_sample && block.first_sample > *next_sample) {
      lost_in_device += block.first_sample - *next_sample;
    }
    next_sample = block.first_sample + block.samples;
    received += block.samples;
  }
};

} // namespace dyncal::drivers
