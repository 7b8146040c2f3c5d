// ALSA's plugin `file`, which plays a file as what was captured, over its device `null`: every bit
// of drawn frames, in each format.
#include "drivers/alsa/alsa_device.hpp"

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/alsa/capture_source.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/drivers/collecting_sink.hpp"

namespace dyncal::drivers::alsa {
namespace {

using testing::HasSubstr;

constexpr std::size_t channels = 2;
constexpr std::size_t drawn_frames = 20'000;

class AlsaDeviceTest : public testing::Test {
protected:
  // Of the whole program, as ALSA reads it once.
  static void SetUpTestSuite() {
    folder = new tests::TemporaryFolder;
    std::ofstream(folder->path() / "asound.conf")
        << "pcm.!null { type null }\nctl.!null { type null }\npcm.drawn { type file file "
           "\"/dev/null\" format \"raw\" infile \""
        << (folder->path() / "frames.raw").string() << "\" slave.pcm \"null\" }\n";
    ::setenv("ALSA_CONFIG_PATH", (folder->path() / "asound.conf").c_str(), 1);
  }
  static void TearDownTestSuite() { delete folder; }

  [[nodiscard]] static CaptureSettings settings(SampleFormat format) {
    CaptureSettings settings;
    settings.device = {
        .device = "drawn", .rate_hz = 48'000, .format = format, .channels = channels};
    return settings;
  }

  static void put_into_device(const std::vector<std::byte>& frames) {
    std::ofstream(folder->path() / "frames.raw", std::ios::binary)
        .write(reinterpret_cast<const char*>(frames.data()),
               static_cast<std::streamsize>(frames.size()));
  }
  static void expect_every_bit(SampleFormat format);

  static tests::TemporaryFolder* folder;
};

tests::TemporaryFolder* AlsaDeviceTest::folder = nullptr;

// Integers of every size; floating-point numbers that are no NaN.
std::vector<std::byte> draw(SampleFormat format) {
  std::mt19937_64 random(7);
  std::vector<std::byte> bytes(drawn_frames * channels * bytes_of(format));
  for (std::byte& byte : bytes) {
    byte = static_cast<std::byte>(random());
  }
  for (std::size_t i = 3; format == SampleFormat::float32 && i < bytes.size(); i += 4) {
    bytes[i] &= std::byte{0x3F};
  }
  return bytes;
}

void AlsaDeviceTest::expect_every_bit(SampleFormat format) {
  const std::vector<std::byte> drawn = draw(format);
  put_into_device(drawn);
  CaptureSource source(settings(format), make_alsa_device);
  const auto described = source.describe();
  ASSERT_TRUE(described) << described.error().message;
  EXPECT_EQ(described->channels.size(), channels);
  tests::CollectingSink sink;
  sink.after_block = [&] {
    if (sink.numbers.size() >= drawn_frames) {
      source.stop();
    }
  };
  const auto done = source.run(sink);
  ASSERT_TRUE(done) << done.error().message;
  ASSERT_GE(sink.numbers.size(), drawn_frames);
  const std::vector<double> scale(channels, 1.0);
  const std::vector<double> expected = values_of(drawn, format, scale);
  for (std::size_t channel = 0; channel < channels; ++channel) {
    const std::vector<double> values = sink.channel(channel);
    for (std::size_t i = 0; i < drawn_frames; ++i) {
      ASSERT_EQ(values[i], expected[channel * drawn_frames + i]) << channel << ", " << i;
    }
  }
  EXPECT_EQ(sink.counts.lost_in_device, 0U);
}

TEST_F(AlsaDeviceTest, GivesEveryBitOf16) {
  expect_every_bit(SampleFormat::s16);
}

TEST_F(AlsaDeviceTest, GivesEveryBitOf24InFourBytes) {
  expect_every_bit(SampleFormat::s24);
}

TEST_F(AlsaDeviceTest, GivesEveryBitOf24InThreeBytes) {
  expect_every_bit(SampleFormat::s24_3le);
}

TEST_F(AlsaDeviceTest, GivesEveryBitOf32) {
  expect_every_bit(SampleFormat::s32);
}

TEST_F(AlsaDeviceTest, GivesEveryBitOfFloatingPointNumbers) {
  expect_every_bit(SampleFormat::float32);
}

TEST_F(AlsaDeviceTest, IsRefusedByTheNameOfTheDevice) {
  CaptureSettings absent = settings(SampleFormat::s16);
  absent.device.device = "hw:CARD=Absent";
  CaptureSource source(absent, make_alsa_device);
  const auto described = source.describe();
  ASSERT_FALSE(described);
  EXPECT_EQ(described.error().code, ErrorCode::not_found);
  EXPECT_THAT(described.error().message, HasSubstr("hw:CARD=Absent: cannot be opened for capture"));
}

TEST_F(AlsaDeviceTest, EndsWhereItWaitsWhenItIsStopped) {
  put_into_device(draw(SampleFormat::s16));
  CaptureSource source(settings(SampleFormat::s16), make_alsa_device);
  ASSERT_TRUE(source.describe());
  source.stop();
  tests::CollectingSink sink;
  EXPECT_TRUE(source.run(sink));
  EXPECT_TRUE(sink.blocks.empty());
}

} // namespace
} // namespace dyncal::drivers::alsa
