#include "services/bench/file/reference_file.hpp"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline bench {
namespace {

using testing::HasSubstr;

std::string problem_of(const std::string& text) {
  const auto points = parse_reference_file(text, "ref.csv");
  EXPECT_FALSE(points) << text;
  return points ? "" : points.error().message;
}

TEST(ReferenceFile, GivesWhatTheFileSays) {
  const auto points = parse_reference_file(
      "# certificate 4711\n"
      "frequency_hz, level_m_s2, magnitude, phase_rad, u_magnitude_rel, u_phase_rad, "
      "transverse motion.u_magnitude_rel, transverse motion.u_phase_rad, "
      "transverse motion.degrees_of_freedom\r\n"
      "10, 50, 1.002, -0.01, 5e-4, 1e-3, 3e-4, 0, 7\r\n"
      "\n"
      "20, 50, 1.004, -0.02, 5e-4, 1e-3, 4e-4, 0, infinite\n",
      "ref.csv");
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 2U);
  const analysis::ReferenceCalibrationPoint& first = points->front();
  EXPECT_EQ(first.frequency_hz, 10.0);
  EXPECT_EQ(first.level_m_s2, 50.0);
  EXPECT_EQ(first.magnitude, 1.002);
  EXPECT_EQ(first.phase_rad, -0.01);
  ASSERT_EQ(first.contributions.size(), 2U);
  EXPECT_EQ(first.contributions[0].name, "transverse motion");
  EXPECT_EQ(first.contributions[0].u_magnitude_rel, 3e-4);
  EXPECT_EQ(first.contributions[0].degrees_of_freedom, 7.0);
  EXPECT_EQ(first.contributions[1].name, ""); // what is left of 5e-4
  EXPECT_NEAR(first.contributions[1].u_magnitude_rel, 4e-4, 1e-12);
  EXPECT_EQ(first.contributions[1].u_phase_rad, 1e-3);
  EXPECT_TRUE(std::isinf(points->back().contributions[0].degrees_of_freedom));
}

TEST(ReferenceFile, WithoutTheWholeItIsMadeOfItsContributions) {
  const auto points = parse_reference_file(
      "frequency_hz,magnitude,phase_rad,drift.u_magnitude_rel\n10,1,0,1e-3\n", "ref.csv");
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->front().contributions.size(), 1U);
  EXPECT_EQ(points->front().contributions.front().name, "drift");
}

TEST(ReferenceFile, TakesWhatExcelSaves) {
  const auto plain = parse_reference_file("frequency_hz,magnitude,phase_rad,u_magnitude_rel\n"
                                          "10,1.001,-0.002,0.001\n80,0.999,-0.01,0.002\n",
                                          "reference.csv");
  const auto excel = parse_reference_file("\xEF\xBB\xBF"
                                          "frequency_hz;magnitude;phase_rad;u_magnitude_rel\r\n"
                                          "10;1,001;-0,002;0,001\r\n80;0,999;-0,01;0,002\r\n",
                                          "reference.csv");
  ASSERT_TRUE(plain);
  ASSERT_TRUE(excel) << excel.error().message;
  ASSERT_EQ(excel->size(), 2U);
  EXPECT_EQ((*excel)[1].magnitude, (*plain)[1].magnitude);
  EXPECT_EQ((*excel)[1].phase_rad, -0.01);
  EXPECT_EQ((*excel)[0].contributions.at(0).u_magnitude_rel, 0.001);
}

TEST(ReferenceFile, SaysFileLineAndColumnOfWhatIsNotValid) {
  const std::string head = "frequency_hz,magnitude,phase_rad,u_magnitude_rel\n";
  EXPECT_THAT(problem_of("frequency_hz,magnitud,phase_rad\n"),
              HasSubstr("ref.csv:1:14: column 'magnitud' is not known"));
  EXPECT_THAT(problem_of("frequency_hz,magnitude\n10,1\n"),
              HasSubstr("ref.csv:1:1: column 'phase_rad' is missing"));
  EXPECT_THAT(problem_of("frequency_hz,magnitude,magnitude\n"),
              HasSubstr("ref.csv:1:24: column 'magnitude' is there twice"));
  EXPECT_THAT(problem_of("frequency_hz,magnitude,phase_rad,drift.phase_rad\n"),
              HasSubstr("ref.csv:1:34: column 'drift.phase_rad' is not known"));
  EXPECT_THAT(problem_of(head + "10, 1, x, 1e-3\n"), HasSubstr("ref.csv:2:8: 'x' is not a number"));
  EXPECT_THAT(problem_of(head + "10,1,0\n"), HasSubstr("3 fields, but the header names 4"));
  EXPECT_THAT(problem_of(head + "10,1,0,1e-3\n10,1,0,1e-3\n"), HasSubstr("10 Hz twice"));
  EXPECT_THAT(problem_of(head), HasSubstr("no points"));
}

TEST(ReferenceFile, RefusesWhatIsNotPlausible) {
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

TEST(ReferenceFile, SaysThatItCannotBeRead) {
  const auto points = read_reference_file("/nowhere/reference.csv");
  ASSERT_FALSE(points);
  EXPECT_THAT(points.error().message, HasSubstr("/nowhere/reference.csv: cannot be read"));
}

} // namespace
} // namespace dyncal::inline bench
