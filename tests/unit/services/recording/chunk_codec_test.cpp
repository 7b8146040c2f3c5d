#include "services/recording/chunk_codec.hpp"

#include <gtest/gtest.h>

namespace dyncal::recording {
namespace {

TEST(ChunkCodec, GivesBackWhatItCompressed) {
  if (!parse_compression("zstd")) {
    GTEST_SKIP() << "this build has no zstd";
  }
  const std::string records(100'000, 'a');
  const std::string smaller = compress(records, Compression::zstd);
  ASSERT_FALSE(smaller.empty());
  EXPECT_LT(smaller.size(), records.size() / 10);
  EXPECT_EQ(uncompress(smaller, "zstd", records.size()), records);
}

TEST(ChunkCodec, TakesNoMemoryForASizeThatIsClaimed) {
  EXPECT_FALSE(uncompress("x", "zstd", std::uint64_t{1} << 60U));
  EXPECT_FALSE(uncompress("x", "", std::uint64_t{1} << 60U));
  EXPECT_FALSE(uncompress("x", "", 2));
  EXPECT_FALSE(uncompress("not a frame", "zstd", 11));
}

TEST(ChunkCodec, NamesACompressionThatItDoesNotKnow) {
  const auto records = uncompress("x", "lz4", 1);
  ASSERT_FALSE(records);
  EXPECT_NE(records.error().message.find("'lz4'"), std::string::npos);
  EXPECT_FALSE(parse_compression("gzip"));
}

} // namespace
} // namespace dyncal::recording
