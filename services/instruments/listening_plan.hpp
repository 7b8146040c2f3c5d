// What dyncal-dau has to listen to: the SmartUp sources of all its bench files, put together by
// address, so that one socket serves every sensor that comes in there, of whatever bench. Plain
// data.
#pragma once

#include <string>
#include <vector>

#include "drivers/smartup/sensor.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/bench_file.hpp"

namespace dyncal::inline instruments {

struct PlannedSource {
  std::string bench;
  std::string source;
  DeviceIdentity identity;
  BenchFileOrigin origin;
  drivers::smartup::SensorSettings settings;
};

struct PlannedEndpoint {
  std::string listen;
  std::vector<PlannedSource> sources;
};

// Fails (bad_file) when no bench has a SmartUp source, or two sources want the same sensor at the
// same address.
[[nodiscard]] Expected<std::vector<PlannedEndpoint>>
plan_listening(const std::vector<BenchFile>& benches);

} // namespace dyncal::inline instruments
