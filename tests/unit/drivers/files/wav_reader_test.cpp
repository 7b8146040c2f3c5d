#include "drivers/files/wav_reader.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sndfile.h>

#include "tests/unit/drivers/files/file_playing.hpp"

namespace dyncal::drivers::files {
namespace {

constexpr int frames = 10'000;

double left(int frame) {
  return 0.5 * std::sin(0.01 * frame);
}
double right(int frame) {
  return -0.25 * std::cos(0.02 * frame);
}

void write_wav(const std::filesystem::path& path, int subtype) {
  SF_INFO info{};
  info.samplerate = 48000;
  info.channels = 2;
  info.format = SF_FORMAT_WAV | subtype;
  SNDFILE* file = sf_open(path.c_str(), SFM_WRITE, &info);
  ASSERT_NE(file, nullptr) << sf_strerror(nullptr);
  for (int i = 0; i < frames; ++i) {
    const double frame[2] = {left(i), right(i)};
    sf_writef_double(file, frame, 1);
  }
  sf_close(file);
}

void expect_played(int subtype, double resolution) {
  const TemporaryFile file("tone.wav");
  write_wav(file.path(), subtype);
  FileSettings settings;
  settings.path = file.path();
  settings.channels = {{"channel_1", "reference"}, {"channel_2", "sync"}};
  FileSource source(settings);
  const auto description = source.describe();
  ASSERT_TRUE(description) << description.error().message;
  EXPECT_EQ(description->nominal_rate_hz, 48000.0);
  EXPECT_EQ(description->channels[1].name, "sync");
  EXPECT_EQ(description->channels[1].resolution, resolution);
  EXPECT_EQ(description->channels[1].maximum, subtype == SF_FORMAT_FLOAT ? 0.0 : 1.0);
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  ASSERT_EQ(sink.numbers.size(), static_cast<std::size_t>(frames));
  EXPECT_EQ(sink.stamps_ns[4800], 100'000'000);
  const std::vector<double> first = sink.channel(0);
  const std::vector<double> second = sink.channel(1);
  for (int i = 0; i < frames; ++i) {
    ASSERT_NEAR(first[static_cast<std::size_t>(i)], left(i), resolution + 1e-7);
    ASSERT_NEAR(second[static_cast<std::size_t>(i)], right(i), resolution + 1e-7);
  }
}

TEST(WavReader, Plays16Bit) {
  expect_played(SF_FORMAT_PCM_16, std::ldexp(1.0, -15));
}
TEST(WavReader, Plays24Bit) {
  expect_played(SF_FORMAT_PCM_24, std::ldexp(1.0, -23));
}
TEST(WavReader, PlaysFloat) {
  expect_played(SF_FORMAT_FLOAT, 0.0);
}

TEST(WavReader, RefusesWhatACodecHasMadeOfTheValues) {
  for (const int subtype : {SF_FORMAT_ULAW, SF_FORMAT_ALAW, SF_FORMAT_IMA_ADPCM, SF_FORMAT_MS_ADPCM,
                            SF_FORMAT_GSM610}) {
    const TemporaryFile file("coded.wav");
    SF_INFO info{};
    info.samplerate = 8000;
    info.channels = 1;
    info.format = SF_FORMAT_WAV | subtype;
    SNDFILE* writer = sf_open(file.path().c_str(), SFM_WRITE, &info);
    ASSERT_NE(writer, nullptr) << sf_strerror(nullptr);
    const std::vector<double> values(8000, 0.25);
    sf_writef_double(writer, values.data(), 8000);
    sf_close(writer);
    const auto description = FileSource(settings_for(file)).describe();
    ASSERT_FALSE(description) << subtype;
    EXPECT_THAT(description.error().message, testing::HasSubstr("does not keep every value"));
  }
}

TEST(WavReader, SaysThatAFileIsNotWav) {
  const TemporaryFile file("text.wav", "t_ns,a\n0,1\n");
  FileSettings settings;
  settings.path = file.path();
  FileSource source(settings);
  const auto description = source.describe();
  ASSERT_FALSE(description);
  EXPECT_THAT(description.error().message, testing::HasSubstr("cannot be read as WAV"));
}

TEST(WavReader, TellsHowMuchIsRead) {
  const TemporaryFile file("share.wav");
  write_wav(file.path(), SF_FORMAT_PCM_16);
  const std::vector<double> shares = shares_of(settings_for(file));
  expect_rising_to_one(shares);
  EXPECT_DOUBLE_EQ(shares[1], (2.0 + 4096.0) / frames);
}

} // namespace
} // namespace dyncal::drivers::files
