#include "services/records/mcap/chunk_codec.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline records::recording {
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

// 200 times 'a', as the program lz4 writes it, with the sum of the content.
TEST(ChunkCodec, ReadsFramesOfLz4) {
  if (!knows_compression("lz4")) {
    GTEST_SKIP() << "this build has no LZ4";
  }
  const std::string frame = std::string("\x04"
                                        "\x22"
                                        "\x4d"
                                        "\x18"
                                        "\x64"
                                        "\x40"
                                        "\xa7"
                                        "\x0b"
                                        "\x00"
                                        "\x00"
                                        "\x00"
                                        "\x1f"
                                        "\x61"
                                        "\x01"
                                        "\x00"
                                        "\xaf"
                                        "\x50"
                                        "\x61"
                                        "\x61"
                                        "\x61"
                                        "\x61"
                                        "\x61"
                                        "\x00"
                                        "\x00"
                                        "\x00"
                                        "\x00"
                                        "\x47"
                                        "\x6f"
                                        "\x28"
                                        "\x78",
                                        30);
  EXPECT_EQ(uncompress(frame, "lz4", 200), std::string(200, 'a'));
  EXPECT_FALSE(uncompress(frame, "lz4", 199));
  EXPECT_FALSE(uncompress(frame, "lz4", 201));
  for (std::size_t i = 0; i < frame.size(); ++i) {
    EXPECT_FALSE(uncompress(frame.substr(0, i), "lz4", 200)) << i;
  }
  std::string flipped = frame;
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 0x40);
  EXPECT_FALSE(uncompress(flipped, "lz4", 200));
}

TEST(ChunkCodec, NamesACompressionThatItDoesNotKnow) {
  const auto records = uncompress("x", "brotli", 1);
  ASSERT_FALSE(records);
  EXPECT_NE(records.error().message.find("'brotli'"), std::string::npos);
  EXPECT_FALSE(knows_compression("brotli"));
  EXPECT_TRUE(knows_compression(""));
  EXPECT_FALSE(parse_compression("gzip"));
}

} // namespace
} // namespace dyncal::inline records::recording
