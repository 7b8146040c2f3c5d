#include "services/views/report/common_part.hpp"

#include <functional>

#include <gtest/gtest.h>

namespace dyncal::inline views {
namespace {

using analysis::ContributionKind;

StoredResult result_of_two_repetitions() {
  StoredResult result;
  result.bench = "b";
  result.roles.emplace();
  result.roles->reference = "acs/reference";
  result.roles->sync_acs = "acs/sync";
  RunSource acs;
  acs.source = "acs";
  acs.description.serial = "ACS-1";
  RunSource dau;
  dau.source = "dau";
  dau.description.serial = "check-1";
  result.sources = {acs, dau};
  StoredStep step;
  step.frequency_hz = 80.0;
  step.level_m_s2 = 10.0;
  step.corrections = {{"reference_response", 0.01, 0.001, 1.002, 0.001}};
  result.steps = {step};
  for (unsigned repetition = 1; repetition <= 2; ++repetition) {
    StoredPoint point;
    point.channel = "dau/z";
    point.frequency_hz = 80.0;
    point.level_m_s2 = 10.0;
    point.repetition = repetition;
    point.valid = true;
    point.budget = {
        {.kind = ContributionKind::reference, .u_magnitude_rel = 1e-3, .u_phase_rad = 2e-3},
        {.kind = ContributionKind::adc_phase, .u_phase_rad = 1e-3},
        {.kind = ContributionKind::fit_noise, .u_magnitude_rel = 5e-4}};
    result.points.push_back(point);
  }
  return result;
}

analysis::SharedUncertainty shared(const StoredResult& one, const StoredResult& other) {
  const PointIdentity point{.channel = "dau/z", .frequency_hz = 80.0, .level_m_s2 = 10.0};
  return shared_by(common_parts_of(one, "dau").at(point), common_parts_of(other, "dau").at(point));
}

TEST(CommonPart, IsTheRowsOfCalibrations) {
  const StoredResult result = result_of_two_repetitions();
  ASSERT_EQ(common_parts_of(result, "dau").size(), 1U);
  const auto both = shared(result, result);
  EXPECT_NEAR(both.magnitude_rel, 1e-3, 1e-12);
  EXPECT_NEAR(both.phase_rad, std::hypot(2e-3, 1e-3), 1e-12);
  EXPECT_TRUE(common_parts_of(result, "acs").empty());
}

TEST(CommonPart, IsNothingAfterANewCalibrationOrWithOtherInstruments) {
  const StoredResult first = result_of_two_repetitions();
  const std::vector<std::function<void(StoredResult&)>> changes{
      [](StoredResult& other) { other.bench = "b2"; },
      [](StoredResult& other) { other.sources[0].description.serial = "ACS-2"; },
      [](StoredResult& other) { other.roles->reference = "acs/other"; },
      [](StoredResult& other) { other.steps[0].corrections[0].magnitude_factor = 1.003; },
      [](StoredResult& other) { other.steps[0].corrections.clear(); }};
  for (const auto& change : changes) {
    StoredResult other = first;
    change(other);
    EXPECT_EQ(shared(first, other).magnitude_rel, 0.0);
    EXPECT_EQ(shared(first, other).phase_rad, 0.0);
  }
  StoredResult other_u = first; // the same corrections, another certificate
  for (StoredPoint& point : other_u.points) {
    point.budget[0].u_magnitude_rel = 1.5e-3;
  }
  EXPECT_EQ(shared(first, other_u).magnitude_rel, 0.0);
  EXPECT_GT(shared(first, other_u).phase_rad, 0.0);
  StoredResult other_sensor = first; // whose serial number is the sensor's own
  other_sensor.sources[1].description.serial = "check-2";
  EXPECT_GT(shared(first, other_sensor).magnitude_rel, 0.0);
}

TEST(CommonPart, IsNotWhatALaterVersionAdds) {
  StoredResult result = result_of_two_repetitions();
  for (StoredPoint& point : result.points) {
    point.budget = {{.kind = ContributionKind::other, .subject = "new", .u_magnitude_rel = 1e-3}};
  }
  EXPECT_EQ(shared(result, result).magnitude_rel, 0.0);
}

} // namespace
} // namespace dyncal::inline views
