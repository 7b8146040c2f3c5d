#include "services/views/report/result_file.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/views/report/result_json.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline views {
namespace {

// compare and triaxial apply a factor of 2: that must give U, although u_magnitude is that of k
// = 1.
TEST(ResultFile, TwiceItsUncertaintyIsTheExpandedOne) {
  const tests::TemporaryFolder folder;
  RunOutcome outcome = tests::example_outcome();
  analysis::RepetitionMean& mean = outcome.transfer_functions.front().points.front().mean;
  mean.u_magnitude = 3e-3;
  mean.magnitude_rel.k = 4.0;
  const auto path = folder.path() / "result.json";
  ASSERT_TRUE(write_json(path, result_json(outcome)));
  const auto result = read_values(path);
  ASSERT_TRUE(result) << result.error().message;
  const ResultPoints points = means_of(*result);
  const auto found =
      points.find({.channel = "dau/acceleration_z", .frequency_hz = 10.0, .level_m_s2 = 2.75});
  ASSERT_NE(found, points.end());
  const ResultPoint& point = found->second;
  EXPECT_DOUBLE_EQ(point.value.of_magnitude.expanded(), 6e-3);
  EXPECT_DOUBLE_EQ(point.value.of_phase.expanded(), 4e-3);
  EXPECT_EQ(point.unit, R"(\one)");
}

TEST(ResultFile, CountsTheBytesThatItReads) {
  const tests::TemporaryFolder folder;
  const auto path = folder.path() / "result.json";
  ASSERT_TRUE(write_json(path, result_json(tests::example_outcome())));
  const auto wrong = folder.write("wrong.json", "{" + std::string(50'000, ' '));
  ByteCount bytes(nullptr, "reading", bytes_of_file(path) + bytes_of_file(wrong));
  const auto counted = read_values(path, bytes);
  ASSERT_TRUE(counted) << counted.error().message;
  EXPECT_EQ(bytes.done(), bytes_of_file(path));
  EXPECT_EQ(means_of(*counted).size(), 4U);
  EXPECT_FALSE(read_values(wrong, bytes));
  EXPECT_EQ(bytes.done(), bytes.total());
}

TEST(ResultFile, GivesSingleResultsByTheirRepetitionWhateverTheAttempt) {
  RunOutcome outcome = tests::example_outcome();
  StepResult& single = outcome.results.front();
  single.attempt = 2;
  single.u_magnitude = 1e-3;
  single.excited_axis = "z";
  const tests::TemporaryFolder folder;
  const auto path = folder.path() / "result.json";
  ASSERT_TRUE(write_json(path, result_json(outcome)));
  const auto result = read_values(path);
  ASSERT_TRUE(result) << result.error().message;
  const ResultPoints points = repetitions_of(*result);
  ASSERT_EQ(points.size(), 1U); // the other has no value
  const auto& [identity, point] = *points.begin();
  EXPECT_EQ(to_string(identity), "dau/acceleration_z at 10 Hz, 2.75 m/s^2, axis z, repetition 1");
  EXPECT_EQ(point.attempt, 2U);
  EXPECT_EQ(point.value.magnitude, 1.0);
  EXPECT_GT(point.value.of_magnitude.u, 0.0);
}

} // namespace
} // namespace dyncal::inline views
