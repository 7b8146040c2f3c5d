#include "services/bench/file/reference_table.hpp"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline bench {
namespace {

using testing::HasSubstr;

std::string problem_of(const std::string& text) {
  const auto points = parse_reference_table(text, "ref.csv");
  EXPECT_FALSE(points) << text;
  return points ? "" : points.error().message;
}

TEST(ReferenceTable, GivesWhatTheFileSays) {
  const auto points = parse_reference_table(
      "# certificate 4711\n"
      "frequency_hz, level_m_s2, magnitude, phase_rad, u_magnitude_rel, u_phase_rad, "
      "transverse motion.u_magnitude_rel, transverse motion.u_phase_rad, "
      "transverse motion.degrees_of_freedom\r\n"
      "10, 50, 1.002, -0.01, 5e-4, 1e-3, 3e-4, 0, 7\r\n"
      "\n"
      "20, 50, 1.004, -0.02, 5e-4, 1e-3, 4e-4, 0, infinite\n",
      "ref.csv");
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->points.size(), 2U);
  const analysis::ReferenceCalibrationPoint& first = points->points.front();
  EXPECT_EQ(first.frequency_hz, 10.0);
  EXPECT_EQ(first.level_m_s2, 0.0); // no frequency is there twice: one curve
  EXPECT_TRUE(points->phase_in_rad);
  EXPECT_EQ(first.magnitude, 1.002);
  EXPECT_EQ(first.phase_rad, -0.01);
  ASSERT_EQ(first.contributions.size(), 2U);
  EXPECT_EQ(first.contributions[0].name, "transverse motion");
  EXPECT_EQ(first.contributions[0].u_magnitude_rel, 3e-4);
  EXPECT_EQ(first.contributions[0].degrees_of_freedom, 7.0);
  EXPECT_EQ(first.contributions[1].name, ""); // what is left of 5e-4
  EXPECT_NEAR(first.contributions[1].u_magnitude_rel, 4e-4, 1e-12);
  EXPECT_EQ(first.contributions[1].u_phase_rad, 1e-3);
  EXPECT_TRUE(std::isinf(points->points.back().contributions[0].degrees_of_freedom));
}

TEST(ReferenceTable, TakesADelayForAPhase) {
  const auto points = parse_reference_table("frequency_hz,magnitude,delay_s,U_delay_s,k\n"
                                            "100,1,2e-6,2e-7,2\n1000,1,3e-6,4e-7,2\n",
                                            "ref.csv", {.phase_is_lag = true});
  ASSERT_TRUE(points) << points.error().message;
  const double w = 2.0 * std::acos(-1.0) * 1000.0;
  EXPECT_FALSE(points->phase_in_rad);
  EXPECT_NEAR(points->points[1].phase_rad, -w * 3e-6, 1e-15);
  EXPECT_NEAR(points->points[1].contributions[0].u_phase_rad, w * 2e-7, 1e-15);
  EXPECT_THAT(problem_of("frequency_hz,magnitude,delay_s,u_delay_s\n10000,1,0,3e-5\n"),
              HasSubstr("ref.csv:2:11: u_delay_s = 3e-5 is more than a quarter of a period"));
  EXPECT_THAT(problem_of("frequency_hz,magnitude,delay_s,phase_deg\n10,1,0,0\n"),
              HasSubstr("says what 'delay_s' says"));
}

TEST(ReferenceTable, WithoutTheWholeItIsMadeOfItsContributions) {
  const auto points = parse_reference_table(
      "frequency_hz,magnitude,phase_rad,drift.u_magnitude_rel\n10,1,0,1e-3\n", "ref.csv");
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->points.front().contributions.size(), 1U);
  EXPECT_EQ(points->points.front().contributions.front().name, "drift");
}

TEST(ReferenceTable, TakesWhatExcelSaves) {
  const auto plain = parse_reference_table("frequency_hz,magnitude,phase_rad,u_magnitude_rel\n"
                                           "10,1.001,-0.002,0.001\n80,0.999,-0.01,0.002\n",
                                           "reference.csv");
  const auto excel = parse_reference_table("\xEF\xBB\xBF"
                                           "frequency_hz;magnitude;phase_rad;u_magnitude_rel\r\n"
                                           "10;1,001;-0,002;0,001\r\n80;0,999;-0,01;0,002\r\n",
                                           "reference.csv");
  ASSERT_TRUE(plain);
  ASSERT_TRUE(excel) << excel.error().message;
  ASSERT_EQ(excel->points.size(), 2U);
  EXPECT_EQ(excel->points[1].magnitude, plain->points[1].magnitude);
  EXPECT_EQ(excel->points[1].phase_rad, -0.01);
  EXPECT_EQ(excel->points[0].contributions.at(0).u_magnitude_rel, 0.001);
}

TEST(ReferenceTable, SaysFileLineAndColumnOfWhatIsNotValid) {
  const std::string head = "frequency_hz,magnitude,phase_rad,u_magnitude_rel\n";
  EXPECT_THAT(problem_of("frequency_hz,magnitud,phase_rad\n"),
              HasSubstr("ref.csv:1:14: column 'magnitud' is not known"));
  EXPECT_THAT(problem_of("frequency_hz,phase_rad\n10,1\n"),
              HasSubstr("ref.csv:1:1: column 'magnitude' is missing"));
  EXPECT_THAT(problem_of("frequency_hz,magnitude,magnitude\n"),
              HasSubstr("ref.csv:1:24: column 'magnitude' is there twice"));
  EXPECT_THAT(problem_of("frequency_hz,magnitude,phase_rad,drift.phase_rad\n"),
              HasSubstr("ref.csv:1:34: column 'drift.phase_rad' is not known"));
  EXPECT_THAT(problem_of(head + "10, 1, x, 1e-3\n"), HasSubstr("ref.csv:2:8: 'x' is not a number"));
  EXPECT_THAT(problem_of(head + "10,1,0\n"), HasSubstr("3 fields, but the header names 4"));
  EXPECT_THAT(problem_of(head + "10,1,0,1e-3\n10,1,0,1e-3\n"), HasSubstr("10 Hz twice"));
  EXPECT_THAT(problem_of(head), HasSubstr("no points"));
}

TEST(ReferenceTable, RefusesWhatIsNotPlausible) {
  const std::string head =
      "frequency_hz,magnitude,phase_rad,u_magnitude_rel,u_phase_rad,drift.u_magnitude_rel\n";
  EXPECT_THAT(problem_of(head + "10,12.5,0,1e-3,1e-3,0\n"), HasSubstr("not a sensitivity"));
  EXPECT_THAT(problem_of(head + "10,1,-45,1e-3,1e-3,0\n"), HasSubstr("degrees"));
  EXPECT_THAT(problem_of(head + "10,1,0,50,1e-3,0\n"),
              HasSubstr("ref.csv:2:8: u_magnitude_rel = 50 is not plausible"));
  EXPECT_THAT(problem_of(head + "10,1,0,1e-3,2,0\n"), HasSubstr("degrees"));
  EXPECT_THAT(problem_of(head + "10,1,0,1e-3,nan,0\n"), HasSubstr("not a number"));
  EXPECT_THAT(problem_of(head + "10,1,0,1e-3,1e-3,2e-3\n"),
              HasSubstr("larger than the whole uncertainty"));
}

// The same values in the forms that certificates have.
TEST(ReferenceTable, TakesTheFormsOfCertificates) {
  const auto plain = parse_reference_table(
      "frequency_hz,magnitude,phase_rad,u_magnitude_rel,u_phase_rad\n160,0.13,0.1,0.001,0.002\n",
      "ref.csv", {.is_ratio = false});
  const auto per_cent = parse_reference_table(
      "frequency_hz, magnitude, phase_deg, U_magnitude_percent, U_phase_deg, k\n"
      "160, 0.13, 5.729577951308232, 0.2, 0.22918311805232929, 2\n",
      "ref.csv", {.is_ratio = false});
  const auto absolute = parse_reference_table(
      "frequency_hz,magnitude,phase_deg,U_magnitude,U_phase_rad\n160,0.13,-5.729577951308232,"
      "0.00026,0.004\n",
      "ref.csv", {.is_ratio = false, .phase_is_lag = true, .coverage_factor = 2.0});
  ASSERT_TRUE(plain);
  for (const auto* one : {&per_cent, &absolute}) {
    ASSERT_TRUE(*one) << one->error().message;
    const analysis::ReferenceCalibrationPoint& point = (*one)->points.at(0);
    const analysis::ReferenceCalibrationPoint& as = plain->points.at(0);
    EXPECT_EQ(point.magnitude, as.magnitude);
    EXPECT_NEAR(point.phase_rad, as.phase_rad, 1e-15);
    EXPECT_NEAR(point.contributions.at(0).u_magnitude_rel, as.contributions.at(0).u_magnitude_rel,
                1e-15);
    EXPECT_NEAR(point.contributions.at(0).u_phase_rad, as.contributions.at(0).u_phase_rad, 1e-15);
    EXPECT_FALSE((*one)->phase_in_rad);
  }
}

TEST(ReferenceTable, KeepsCurvesOfLevels) {
  const auto read = parse_reference_table(
      "frequency_hz,level_m_s2,magnitude\n10,1,1.001\n20,1,1.002\n10,5,1.003\n20,5,1.004\n",
      "ref.csv");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->points.at(0).level_m_s2, 1.0);
  EXPECT_EQ(read->points.at(3).level_m_s2, 5.0);
}

TEST(ReferenceTable, WantsTheCoverageFactorOfExpandedUncertainties) {
  EXPECT_THAT(problem_of("frequency_hz,magnitude,U_magnitude_percent\n10,1,0.2\n"),
              HasSubstr("name the coverage factor, k"));
  EXPECT_THAT(problem_of("frequency_hz,magnitude,U_magnitude_percent,u_magnitude_rel,k\n"),
              HasSubstr("column 'u_magnitude_rel' says what 'U_magnitude_percent' says"));
  EXPECT_THAT(problem_of("frequency_hz,magnitude,U_magnitude_rel,k\n10,1,0.002,0.2\n"),
              HasSubstr("k = 0.2 is not plausible"));
}

} // namespace
} // namespace dyncal::inline bench
