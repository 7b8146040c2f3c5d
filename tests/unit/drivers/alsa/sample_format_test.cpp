#include "drivers/alsa/sample_format.hpp"

#include <cstdint>
#include <cstring>

#include <gtest/gtest.h>

namespace dyncal::drivers::alsa {
namespace {

std::vector<std::byte> bytes(std::initializer_list<unsigned> numbers) {
  std::vector<std::byte> all;
  for (const unsigned number : numbers) {
    all.push_back(static_cast<std::byte>(number));
  }
  return all;
}

TEST(SampleFormat, GivesPartsOfFullScale) {
  const std::vector<double> one{1.0};
  EXPECT_EQ(values_of(bytes({0x00, 0x80, 0xFF, 0x7F, 0xFF, 0xFF}), SampleFormat::s16, one),
            (std::vector<double>{-1.0, 32767.0 / 32768.0, -1.0 / 32768.0}));
  EXPECT_EQ(values_of(bytes({0x00, 0x00, 0x80, 0xFF, 0xFF, 0x7F}), SampleFormat::s24_3le, one),
            (std::vector<double>{-1.0, 8388607.0 / 8388608.0}));
  // The fourth byte may be anything.
  EXPECT_EQ(
      values_of(bytes({0xFF, 0xFF, 0xFF, 0x00, 0x01, 0x00, 0x00, 0xFF}), SampleFormat::s24, one),
      (std::vector<double>{-1.0 / 8388608.0, 1.0 / 8388608.0}));
  EXPECT_EQ(
      values_of(bytes({0x00, 0x00, 0x00, 0x80, 0x00, 0x00, 0x00, 0x40}), SampleFormat::s32, one),
      (std::vector<double>{-1.0, 0.5}));
  EXPECT_EQ(values_of(bytes({0x00, 0x00, 0x20, 0x40}), SampleFormat::float32, one),
            std::vector<double>{2.5});
}

TEST(SampleFormat, PutsChannelsOneAfterTheOther) {
  const std::vector<double> scale{2.0, -10.0};
  EXPECT_EQ(
      values_of(bytes({0x00, 0x40, 0x00, 0x20, 0x00, 0xC0, 0x00, 0xE0}), SampleFormat::s16, scale),
      (std::vector<double>{1.0, -1.0, -2.5, 2.5}));
}

TEST(SampleFormat, KnowsItsSteps) {
  EXPECT_EQ(resolution_of(SampleFormat::s16), 1.0 / 32768.0);
  EXPECT_EQ(resolution_of(SampleFormat::s24), resolution_of(SampleFormat::s24_3le));
  EXPECT_EQ(resolution_of(SampleFormat::float32), 0.0);
  EXPECT_EQ(bytes_of(SampleFormat::s24_3le), 3U);
  EXPECT_EQ(bytes_of(SampleFormat::s24), 4U);
}

} // namespace
} // namespace dyncal::drivers::alsa
