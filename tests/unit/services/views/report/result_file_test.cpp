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
  ByteCount bytes;
  const auto points = read_result_file(path, bytes);
  ASSERT_TRUE(points) << points.error().message;
  const ResultPoint& point = points->at({"dau/acceleration_z", 10.0});
  EXPECT_DOUBLE_EQ(point.value.u_magnitude, 3e-3);
  EXPECT_DOUBLE_EQ(point.value.u_phase_rad, 2e-3);
  EXPECT_EQ(point.unit, R"(\one)");
}

TEST(ResultFile, CountsTheBytesThatItReads) {
  const tests::TemporaryFolder folder;
  const auto path = folder.path() / "result.json";
  ASSERT_TRUE(write_json(path, result_json(tests::example_outcome())));
  const auto wrong = folder.write("wrong.json", "{" + std::string(50'000, ' '));
  ByteCount bytes(nullptr, "reading", bytes_of_file(path) + bytes_of_file(wrong));
  const auto counted = read_result_file(path, bytes);
  ASSERT_TRUE(counted) << counted.error().message;
  EXPECT_EQ(bytes.done(), bytes_of_file(path));
  EXPECT_EQ(counted->size(), 4U);
  EXPECT_FALSE(read_result_file(wrong, bytes));
  EXPECT_EQ(bytes.done(), bytes.total());
}

} // namespace
} // namespace dyncal::inline views
