#include "drivers/virtual_bench/model/response_file.hpp"

#include <cmath>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Expected<ResponseTable> read(const std::string& text) {
  const tests::TemporaryFolder folder;
  return read_response_file(folder.write("response.csv", text));
}

TEST(ResponseFile, HasTheValuesOfItsLinesAndKnowsWhereItEnds) {
  const auto table = read("# a published sensor\nfrequency_hz, magnitude, phase_rad\r\n"
                          "10, 1.02, -0.0947\n\n20,1.01,-0.1898\n80,0.98,-0.76\n");
  ASSERT_TRUE(table) << table.error().message;
  const auto at_20 = table->response.at(20.0);
  EXPECT_NEAR(std::abs(at_20), 1.01, 1e-12);
  EXPECT_NEAR(std::arg(at_20), -0.1898, 1e-12);
  EXPECT_NEAR(table->response.delay_s, 0.76 / (2.0 * M_PI * 80.0), 2e-5);
  EXPECT_EQ(table->largest_magnitude, 1.02);
  EXPECT_TRUE(table->covers(10.0));
  EXPECT_TRUE(table->covers(80.0));
  EXPECT_FALSE(table->covers(9.99));
  EXPECT_FALSE(table->covers(80.01));
}

TEST(ResponseFile, IsTheSameWithWholeTurnsLeftOutOfThePhase) {
  std::string wrapped = "frequency_hz,magnitude,phase_rad\n";
  std::string whole = wrapped;
  for (int frequency_hz = 10; frequency_hz <= 500; frequency_hz += 10) {
    const double phase_rad = -2.0 * M_PI * frequency_hz * 8.1e-3; // four turns at 500 Hz
    const std::string begin = std::to_string(frequency_hz) + ",1,";
    whole += begin + std::to_string(phase_rad) + "\n";
    wrapped += begin + std::to_string(std::remainder(phase_rad, 2.0 * M_PI)) + "\n";
  }
  const auto one = read(whole);
  const auto other = read(wrapped);
  ASSERT_TRUE(one && other);
  EXPECT_NEAR(one->response.delay_s, 8.1e-3, 1e-8);
  for (const double frequency_hz : {10.0, 33.0, 255.0, 499.0}) {
    EXPECT_NEAR(std::abs(one->response.at(frequency_hz) - other->response.at(frequency_hz)), 0.0,
                1e-5);
    EXPECT_NEAR(std::abs(one->response.at(frequency_hz) -
                         std::polar(1.0, -2.0 * M_PI * frequency_hz * 8.1e-3)),
                0.0, 1e-5);
  }
}

TEST(ResponseFile, TakesASensorThatPointsTheOtherWay) {
  const auto table = read("frequency_hz,magnitude,phase_rad\n10,1,3.1\n20,1,3.05\n40,1,2.95\n");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_NEAR(std::arg(table->response.at(20.0)), 3.05, 1e-12);
}

struct Wrong {
  const char* text;
  const char* line;
  const char* what;
};

class WrongResponseFile : public testing::TestWithParam<Wrong> {};

TEST_P(WrongResponseFile, IsRefusedWithFileAndLine) {
  const auto table = read(GetParam().text);
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().code, ErrorCode::malformed);
  EXPECT_THAT(table.error().message, AllOf(HasSubstr("response.csv"), HasSubstr(GetParam().line),
                                           HasSubstr(GetParam().what)));
}

INSTANTIATE_TEST_SUITE_P(
    Faults, WrongResponseFile,
    testing::Values(
        Wrong{"frequency,magnitude,phase\n10,1,0\n", "line 1", "must name the columns"},
        Wrong{"frequency_hz,magnitude,phase_rad\n10,1\n", "line 2", "has 2 values"},
        Wrong{"frequency_hz,magnitude,phase_rad\n10,1,0\n20,1.1x,0\n", "line 3", "not a number"},
        Wrong{"frequency_hz,magnitude,phase_rad\n10,1,nan\n", "line 2", "phase_rad \"nan\""},
        Wrong{"frequency_hz,magnitude,phase_rad\n10,1,0\n10,1,0\n", "line 3", "rise"},
        Wrong{"frequency_hz,magnitude,phase_rad\n10,-1,0\n20,1,0\n", "line 2", "magnitude must"},
        Wrong{"frequency_hz,magnitude,phase_rad\n10,1,0\n", "line 2", "two frequencies"},
        Wrong{"", "line 0", "two frequencies"}));

TEST(ResponseFile, NotThereIsNotFound) {
  const auto table = read_response_file("/nowhere/response.csv");
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().code, ErrorCode::not_found);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
