#include "services/instruments/listening_plan.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "drivers/smartup/sensor_id.hpp"

namespace dyncal::inline instruments {

namespace {

PlannedSource planned(const BenchFile& bench, const SourceSettings& source,
                      const SmartupSourceSettings& smartup) {
  PlannedSource planned{.bench = bench.bench,
                        .source = source.name,
                        .identity = source.identity,
                        .origin = source.origin,
                        .settings = {}};
  planned.settings.sensor = smartup.sensor;
  planned.settings.sync_sensor = smartup.sync_sensor;
  planned.settings.naming = {source.channels, source.units};
  planned.settings.time_base = source.time_base;
  return planned;
}

PlannedEndpoint& endpoint_at(std::vector<PlannedEndpoint>& endpoints, const std::string& listen) {
  const auto found = std::ranges::find(endpoints, listen, &PlannedEndpoint::listen);
  return found != endpoints.end()
             ? *found
             : endpoints.emplace_back(PlannedEndpoint{.listen = listen, .sources = {}});
}

// A sensor that is wanted as a source cannot be the sync of another one as well, and none can be
// both wanted twice.
std::vector<std::uint32_t> sensors_of(const drivers::smartup::SensorSettings& settings) {
  std::vector<std::uint32_t> sensors{settings.sensor};
  if (settings.sync_sensor) {
    sensors.push_back(*settings.sync_sensor);
  }
  return sensors;
}

Expected<void> check_unused(const PlannedEndpoint& endpoint, const PlannedSource& added,
                            const std::string& where) {
  for (const PlannedSource& other : endpoint.sources) {
    for (const std::uint32_t sensor : sensors_of(added.settings)) {
      if (std::ranges::count(sensors_of(other.settings), sensor) == 0) {
        continue;
      }
      return fail(
          ErrorCode::bad_file,
          fmt::format("{}: sensor {} at {} already belongs to source '{}' of bench '{}': a sensor "
                      "has one bench",
                      where, drivers::smartup::sensor_text(sensor), endpoint.listen, other.source,
                      other.bench));
    }
  }
  return {};
}

} // namespace

Expected<std::vector<PlannedEndpoint>> plan_listening(const std::vector<BenchFile>& benches) {
  std::vector<PlannedEndpoint> endpoints;
  for (const BenchFile& bench : benches) {
    bool any = false;
    for (const SourceSettings& source : bench.sources) {
      const auto* smartup = source.as<SmartupSourceSettings>();
      if (smartup == nullptr) {
        continue;
      }
      any = true;
      PlannedSource added = planned(bench, source, *smartup);
      PlannedEndpoint& endpoint = endpoint_at(endpoints, smartup->listen);
      if (added.settings.sync_sensor == added.settings.sensor) {
        return fail(ErrorCode::bad_file, source.where + ": sensor and sync_sensor are the same");
      }
      DYNCAL_TRY(check_unused(endpoint, added, source.where));
      endpoint.sources.push_back(std::move(added));
    }
    if (!any) {
      return fail(
          ErrorCode::bad_file,
          fmt::format("{}: no source has driver = \"smartup\", so there is nothing to receive "
                      "for bench '{}'",
                      bench.path.string(), bench.bench));
    }
  }
  return endpoints;
}

} // namespace dyncal::inline instruments
