#include "services/views/figures/drift.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/views/figures/well_formed.hpp"

namespace dyncal::inline views::figures {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

DriftData drift(std::size_t frequencies) {
  DriftData data{.title = "Drift of mpu-7", .unit = "1"};
  for (std::size_t i = 1; i <= frequencies; ++i) {
    DriftLine& line = data.lines.emplace_back();
    line.frequency_hz = 10.0 * static_cast<double>(i);
    line.label = std::to_string(10 * i) + " Hz";
    line.level_m_s2 = 2.5;
    line.excited_axis = "z";
    for (const double days : {0.0, 365.0}) {
      line.values.push_back({.run = "r",
                             .began_utc = "2026-11-22T10:00:00Z",
                             .days = days,
                             .magnitude = 1.0 + 1e-5 * days,
                             .expanded_magnitude = 0.002,
                             .deviation_magnitude_rel = 1e-5 * days,
                             .phase_rad = -0.5,
                             .expanded_phase_rad = 0.01,
                             .deviation_phase_rad = 0.0});
    }
  }
  return data;
}

TEST(DriftFigure, ShowsEveryCalibrationOfAFewFrequencies) {
  const Figure figure = drift_figure(drift(20), "drift");
  EXPECT_EQ(problem_of(figure.svg()), "");
  const auto texts = texts_of(figure.svg());
  EXPECT_THAT(texts, Contains("days since the first calibration"));
  EXPECT_THAT(texts, Contains("10 Hz"));
  EXPECT_THAT(texts, Contains("200 Hz"));
  EXPECT_THAT(texts, Not(Contains("20 Hz"))); // six of the twenty
}

TEST(DriftFigure, WritesEveryNumber) {
  const Figure figure = drift_figure(drift(20), "drift");
  EXPECT_THAT(figure.csv, HasSubstr("\n20,r,2026-11-22T10:00:00Z,365,1.0036499999999999,0.002"));
  EXPECT_THAT(figure.csv, HasSubstr("deviation_phase_rad,level_m_s2,excited_axis\n"));
  EXPECT_THAT(figure.csv, HasSubstr(",0,2.5,z\n"));
}

TEST(DriftFigure, SaysSoWithoutPoints) {
  const Figure figure = drift_figure({.title = "nothing"}, "drift");
  EXPECT_EQ(problem_of(figure.svg()), "");
  EXPECT_THAT(texts_of(figure.svg()), Contains("no data"));
}

} // namespace
} // namespace dyncal::inline views::figures
