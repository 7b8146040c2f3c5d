#include "services/views/report/common_part.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/uncertainty/common_contributions.hpp"

namespace dyncal::inline views {
namespace {

std::string instruments_of(const StoredResult& result, const std::string& sensor_source) {
  std::string text = result.bench;
  for (const RunSource& source : result.sources) {
    const bool is_sensor = source.source == sensor_source; // its serial number is the sensor's
    text += fmt::format("|{}/{}/{}", source.source, is_sensor ? "" : source.description.device,
                        is_sensor ? "" : source.description.serial);
  }
  if (result.roles) {
    text += fmt::format("|{}|{}", result.roles->reference, result.roles->sync_acs);
  }
  return text;
}

// As they were applied at the point.
std::string corrections_at(const StoredResult& result, const PointIdentity& point) {
  const auto step = std::ranges::find_if(result.steps, [&](const StoredStep& one) {
    return one.frequency_hz == point.frequency_hz && one.level_m_s2 == point.level_m_s2;
  });
  std::string text;
  if (step != result.steps.end()) {
    for (const StoredCorrection& one : step->corrections) {
      text += fmt::format("|{} {} {} {} {}", one.name, one.phase_rad, one.u_phase_rad,
                          one.magnitude_factor.value_or(1.0), one.u_magnitude_rel.value_or(0.0));
    }
  }
  return text;
}

// Root of the mean square over the repetitions.
void add_rows(const std::vector<const StoredPoint*>& repetitions, CommonPart& part) {
  std::map<std::string, CommonRow> rows;
  for (const StoredPoint* point : repetitions) {
    for (const analysis::Contribution& row : point->budget) {
      if (analysis::is_common_to_results(row.kind)) {
        CommonRow& sum = rows[row.name()];
        sum.may_depend_on_level =
            row.kind == analysis::ContributionKind::reference && !row.subject.empty();
        sum.u_magnitude_rel += row.u_magnitude_rel * row.u_magnitude_rel;
        sum.u_phase_rad += row.u_phase_rad * row.u_phase_rad;
      }
    }
  }
  const auto count = static_cast<double>(repetitions.size());
  for (const auto& [name, sum] : rows) {
    part.rows.push_back({name, std::sqrt(sum.u_magnitude_rel / count),
                         std::sqrt(sum.u_phase_rad / count), sum.may_depend_on_level});
  }
}

// What both have of one row; nothing where it is not the same row.
double shared_square(double one, double other) {
  constexpr double same_rel = 0.01;
  return std::abs(one - other) <= same_rel * std::max(one, other) ? one * other : 0.0;
}

analysis::SharedUncertainty shared(const CommonPart& one, const CommonPart& other,
                                   bool of_one_level) {
  double magnitude = 0.0;
  double phase = 0.0;
  if (one.origin == other.origin) {
    for (const CommonRow& row : one.rows) {
      const auto same = std::ranges::find(other.rows, row.name, &CommonRow::name);
      if (same != other.rows.end() && (of_one_level || !row.may_depend_on_level)) {
        magnitude += shared_square(row.u_magnitude_rel, same->u_magnitude_rel);
        phase += shared_square(row.u_phase_rad, same->u_phase_rad);
      }
    }
  }
  return {.magnitude_rel = std::sqrt(magnitude), .phase_rad = std::sqrt(phase)};
}

} // namespace

CommonParts common_parts_of(const StoredResult& result, const std::string& source) {
  std::map<PointIdentity, std::vector<const StoredPoint*>> repetitions;
  for (const StoredPoint& point : result.points) {
    if (point.valid && point.channel.starts_with(source + "/")) {
      repetitions[mean_identity_of(point)].push_back(&point);
    }
  }
  const std::string instruments = instruments_of(result, source);
  CommonParts parts;
  for (const auto& [point, of_point] : repetitions) {
    CommonPart& part = parts[point];
    part.origin = instruments + corrections_at(result, point);
    add_rows(of_point, part);
  }
  return parts;
}

analysis::SharedUncertainty shared_by(const CommonPart& one, const CommonPart& other) {
  return shared(one, other, true);
}

analysis::SharedUncertainty shared_between_levels(const CommonPart& one, const CommonPart& other) {
  return shared(one, other, false);
}

} // namespace dyncal::inline views
