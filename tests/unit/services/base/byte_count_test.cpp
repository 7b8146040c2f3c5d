#include "services/base/byte_count.hpp"

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline base {
namespace {

TEST(ByteCount, CountsMegabytesAndReachesTheTotal) {
  const auto count = std::make_shared<WorkCount>("opening");
  ByteCount bytes(count, "reading", 3'999'999);
  EXPECT_EQ(count->state().what, "reading");
  EXPECT_EQ(count->state().unit, "MB");
  EXPECT_EQ(count->state().total, 3U);
  bytes.add_done(999'999);
  EXPECT_EQ(count->state().done, 0U);
  bytes.add_done(1);
  EXPECT_EQ(count->state().done, 1U);
  bytes.set_share_done(1.0);
  EXPECT_EQ(count->state().done, 3U);
}

TEST(ByteCount, NeverGoesBackwardsNorBeyondTheTotal) {
  const auto count = std::make_shared<WorkCount>("opening");
  ByteCount bytes(count, "reading", 10'000'000);
  bytes.set_done(5'000'000);
  bytes.set_done(2'000'000);
  EXPECT_EQ(count->state().done, 5U);
  bytes.set_share_done(0.1);
  EXPECT_EQ(bytes.done(), 5'000'000U);
  bytes.add_done(6'000'000); // the file grew meanwhile
  EXPECT_EQ(count->state().done, 10U);
}

TEST(ByteCount, OfNobodyCountsAllTheSame) {
  ByteCount bytes(nullptr, "reading", 2'000'000);
  bytes.add_done(1'500'000);
  EXPECT_EQ(bytes.done(), 1'500'000U);
  ByteCount().add_done(5);
}

TEST(ByteCount, AFileThatIsNotThereHasNoBytes) {
  const tests::TemporaryFolder folder;
  folder.write("a", "12345");
  folder.write("b", "123");
  const std::vector<std::filesystem::path> files{folder.path() / "a", folder.path() / "none", "",
                                                 folder.path() / "b"};
  EXPECT_EQ(bytes_of_file(files[0]), 5U);
  EXPECT_EQ(bytes_of_file(files[1]), 0U);
  EXPECT_EQ(bytes_of_files(files), 8U);
}

} // namespace
} // namespace dyncal::inline base
