#include "services/views/report/result_file.hpp"

#include <cmath>

#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

analysis::ComparedResult comparable(const StoredValue& value) {
  return {value.magnitude, 0.5 * value.of_magnitude.expanded, value.phase_rad,
          0.5 * value.of_phase.expanded};
}

Expected<ResultPoints> read_result_file(const std::filesystem::path& path, ByteCount& bytes) {
  DYNCAL_TRY(const auto result, read_values(path, bytes));
  ResultPoints points;
  for (const StoredValue& value : result.values) {
    if (!std::isnan(value.magnitude) && !std::isnan(value.phase_rad)) {
      points[{value.channel, value.frequency_hz}] = {value.unit, comparable(value)};
    }
  }
  return points;
}

} // namespace dyncal::inline views
