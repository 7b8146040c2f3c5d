#include "services/bus/fastdds/screen/sample_stamps.hpp"

#include <gtest/gtest.h>

namespace dyncal::bus {
namespace {

SampleStamps::Sample sample(std::int64_t sequence, unsigned char writer = 1) {
  return {.participant = {7, 7, 7}, .writer = {writer}, .sequence = sequence};
}

TEST(SampleStamps, KnowWhatBegan) {
  SampleStamps stamps;
  EXPECT_FALSE(stamps.of(sample(1)));
  stamps.begin(sample(1), RtpsStamp{5, 6});
  EXPECT_EQ(stamps.of(sample(1)), (RtpsStamp{5, 6}));
  EXPECT_FALSE(stamps.of(sample(2)));
  EXPECT_FALSE(stamps.of(sample(1, 2)));
  stamps.begin(sample(2), std::nullopt);
  EXPECT_EQ(stamps.of(sample(2)), SampleStamps::invalid);
}

TEST(SampleStamps, ForgetTheOldest) {
  SampleStamps stamps;
  const auto all = static_cast<std::int64_t>(SampleStamps::max_samples);
  for (std::int64_t i = 0; i <= all; ++i) {
    stamps.begin(sample(i), RtpsStamp{1, static_cast<std::uint32_t>(i)});
    stamps.begin(sample(i), RtpsStamp{2, static_cast<std::uint32_t>(i)}); // sent again
  }
  EXPECT_FALSE(stamps.of(sample(0)));
  EXPECT_EQ(stamps.of(sample(1)), (RtpsStamp{2, 1}));
  EXPECT_EQ(stamps.of(sample(all)), (RtpsStamp{2, static_cast<std::uint32_t>(all)}));
}

} // namespace
} // namespace dyncal::bus
