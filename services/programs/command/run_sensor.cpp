#include "services/programs/command/run_sensor.hpp"

#include <utility>

#include <fmt/core.h>

#include "services/programs/command/judged_run.hpp"
#include "services/programs/command/named_sensor.hpp"
#include "services/records/store/store.hpp"
#include "services/views/conformity/conformity_table.hpp"

namespace dyncal::inline programs {
namespace {

std::string place_of(const std::string& serial, const KeepOptions& keep) {
  return serial.empty() || !keep.folder ? "" : store_place(keep.store, *keep.folder);
}

} // namespace

Expected<void> require_sensor(const std::string& serial, const KeepOptions& keep) {
  if (const std::string place = place_of(serial, keep); !place.empty()) {
    DYNCAL_TRY(sensor_named(serial, place));
  }
  return {};
}

Expected<void> show_conformity(const std::string& serial, const KeepOptions& keep,
                               const std::filesystem::path& folder) {
  const std::string place = place_of(serial, keep);
  if (place.empty()) {
    return {};
  }
  DYNCAL_TRY(const auto sensor, sensor_named(serial, place));
  if (sensor.tolerances) {
    DYNCAL_TRY(auto result, read_values(folder));
    DYNCAL_TRY(const auto judged, judge_run(std::move(result), {}, {}, sensor.tolerances));
    fmt::print("\n{}", conformity_table(judged.report));
    DYNCAL_TRY(keep_conformity(folder, judged));
  }
  return {};
}

} // namespace dyncal::inline programs
