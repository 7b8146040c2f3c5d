#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bench/file/bench_file.hpp"

namespace dyncal::inline bench {
namespace {

using testing::HasSubstr;

Expected<BenchFile> bench(const std::string& keys) {
  return parse_bench_file("bench = \"acc-1\"\n[excitation]\nfrequencies_hz = [\"10\"]\n"
                          "level = 10.0\n[generator]\ndriver = \"none\"\n"
                          "[method]\nkind = \"analogue\"\nreference = \"acs/reference\"\n"
                          "dut = [\"acs/sensor\"]\n[sources.acs]\ndriver = \"alsa\"\n" +
                              keys,
                          "/lab/bench.toml");
}

std::string problem(const std::string& keys) {
  const auto file = bench(keys);
  return file ? "accepted" : file.error().message;
}

TEST(AlsaKeys, SayWhichDeviceIsOpenedAndHow) {
  const auto file = bench("address = \"hw:CARD=Device,DEV=0\"\nsample_rate_hz = 96000\n"
                          "format = \"s24-3le\"\nchannel_count = 4\n"
                          "channels = { channel_1 = \"reference\" }\n"
                          "scale = { reference = 98.1 }\nunits = { reference = \"m/s^2\" }\n");
  ASSERT_TRUE(file) << file.error().message;
  const SourceSettings& source = *file->source("acs");
  const auto& alsa = *source.as<AlsaSourceSettings>();
  EXPECT_EQ(alsa.device, "hw:CARD=Device,DEV=0");
  EXPECT_EQ(alsa.rate_hz, 96000U);
  EXPECT_EQ(alsa.format, drivers::alsa::SampleFormat::s24_3le);
  EXPECT_EQ(alsa.channels, 4U);
  EXPECT_EQ(alsa.scale.at("reference"), 98.1);
  EXPECT_EQ(source.nominal_rate_hz, 96000.0); // frequencies are held against half of it
  EXPECT_EQ(source.time_base, drivers::TimeBase::local);
}

TEST(AlsaKeys, AreRefusedWithTheirReason) {
  const std::string device = "address = \"hw:0\"\n";
  EXPECT_THAT(problem("sample_rate_hz = 48000\n"), HasSubstr("address"));
  EXPECT_THAT(problem(device), HasSubstr("'sources.acs.sample_rate_hz' is missing"));
  EXPECT_THAT(problem(device + "sample_rate_hz = 0\n"), HasSubstr("sample_rate_hz"));
  EXPECT_THAT(problem(device + "sample_rate_hz = 48000\nformat = \"s20\"\n"), HasSubstr("format"));
  EXPECT_THAT(problem(device + "sample_rate_hz = 48000\nscale = { x = 0 }\n"),
              HasSubstr("the factor 0"));
  EXPECT_EQ(problem(device + "sample_rate_hz = 48000\n"), "accepted");
}

} // namespace
} // namespace dyncal::inline bench
