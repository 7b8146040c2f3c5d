#include "services/records/replay/series_file.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline records {
namespace {

std::filesystem::path write_csv(const tests::TemporaryFolder& folder, std::size_t rows,
                                const std::string& end) {
  auto path = folder.path() / "series.csv";
  std::ofstream file(path);
  file << "t_ns,sensor\n";
  for (std::size_t i = 0; i < rows; ++i) {
    file << i * 1'000'000 << ',' << 0.125 * static_cast<double>(i % 17) << '\n';
  }
  file << end;
  return path;
}

TEST(SeriesFile, CountsItsMegabytes) {
  const tests::TemporaryFolder folder;
  const auto path = write_csv(folder, 200'000, "");
  const std::size_t megabytes = std::filesystem::file_size(path) / 1'000'000;
  ASSERT_GE(megabytes, 3U);
  const auto count = std::make_shared<WorkCount>("opening");
  const auto counted = read_series_file(path, count);
  ASSERT_TRUE(counted) << counted.error().message;
  EXPECT_EQ(count->state().what, "reading");
  EXPECT_EQ(count->state().unit, "MB");
  EXPECT_EQ(count->state().total, megabytes);
  EXPECT_EQ(count->state().done, megabytes);
  const auto plain = read_series_file(path);
  EXPECT_EQ(counted->columns, plain->columns);
  EXPECT_EQ(counted->stamps_ns, plain->stamps_ns);
}

TEST(SeriesFile, OfADamagedFileCountsWhatIsBeforeTheDamage) {
  const tests::TemporaryFolder folder;
  const auto path = write_csv(folder, 400'000, "what\n");
  const auto count = std::make_shared<WorkCount>("opening");
  EXPECT_FALSE(read_series_file(path, count));
  EXPECT_GE(count->state().done, 2U);
  EXPECT_LT(count->state().done, count->state().total);
}

} // namespace
} // namespace dyncal::inline records
