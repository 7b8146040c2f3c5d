#include "services/stream/byte_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline stream {
namespace {

constexpr std::uint64_t chunk = ByteLog::chunk_bytes;

// Bytes that differ from those of any other seed at every place.
std::string bytes_of(int seed, std::size_t size) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i) {
    bytes[i] = static_cast<char>(static_cast<std::size_t>(seed) * 31 + i * 7);
  }
  return bytes;
}

ByteLog log_in(const tests::TemporaryFolder& folder, std::uint64_t bytes = 4 * chunk) {
  return ByteLog::create(folder.path(), {.bytes = bytes, .min_free_bytes = 0}).value();
}

TEST(ByteLog, ReadsWhatWasAppendedAcrossChunks) {
  const tests::TemporaryFolder folder;
  ByteLog log = log_in(folder);
  const std::size_t size = chunk / 3 + 7;
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(log.append(bytes_of(i, size)).value(), static_cast<std::uint64_t>(i) * size);
  }
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(log.read(static_cast<std::uint64_t>(i) * size, size).value(), bytes_of(i, size)) << i;
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "the file has no name";
}

TEST(ByteLog, IsNeverLongerThanWhatIsHeldAtOnce) {
  const tests::TemporaryFolder folder;
  ByteLog log = log_in(folder);
  const std::size_t size = chunk / 2 + 1;
  for (int i = 0; i < 100; ++i) {
    const std::uint64_t offset = log.append(bytes_of(i, size)).value();
    EXPECT_EQ(log.read(offset, size).value(), bytes_of(i, size));
    log.drop_before(offset); // the newest one stays
  }
  EXPECT_LE(log.file_bytes(), 3 * chunk);
}

TEST(ByteLog, RefusesMoreThanItsBoundAndKeepsWhatItHas) {
  const tests::TemporaryFolder folder;
  ByteLog log = log_in(folder, 2 * chunk);
  ASSERT_EQ(log.append(bytes_of(1, 2 * chunk)).value(), 0U);
  const auto refused = log.append("x");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("2 MiB"));
  EXPECT_EQ(log.read(0, 2 * chunk).value(), bytes_of(1, 2 * chunk));
  log.drop_before(chunk);
  EXPECT_EQ(log.append("x").value(), 2 * chunk);
  EXPECT_EQ(log.read(2 * chunk, 1).value(), "x");
}

TEST(ByteLog, LeavesRoomOnTheDiskForOthers) {
  const tests::TemporaryFolder folder;
  ByteLog log =
      ByteLog::create(folder.path(), {.bytes = chunk, .min_free_bytes = std::uint64_t{1} << 60U})
          .value();
  const auto refused = log.append("x");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("nearly full"));
}

TEST(ByteLog, SaysWhenThereIsNoFolder) {
  const auto refused = ByteLog::create("/nowhere/at/all", {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::bad_file);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("/nowhere/at/all"));
}

TEST(FolderForKeptMessages, IsThatOfTheServiceWhereThereIsOne) {
  setenv("CACHE_DIRECTORY", "/var/cache/a:/var/cache/b", 1);
  EXPECT_EQ(folder_for_kept_messages(), "/var/cache/a");
  unsetenv("CACHE_DIRECTORY");
  EXPECT_TRUE(std::filesystem::is_directory(folder_for_kept_messages()));
}

} // namespace
} // namespace dyncal::inline stream
