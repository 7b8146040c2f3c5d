#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bench/file/bench_file.hpp"

namespace dyncal::inline bench {
namespace {

using testing::HasSubstr;

Expected<BenchFile> bench(const std::string& keys, const std::string& source = "") {
  return parse_bench_file("bench = \"acc-1\"\n[excitation]\nfrequencies_hz = [\"10\"]\n"
                          "level = 10.0\n[generator]\ndriver = \"none\"\n"
                          "[method]\nkind = \"analogue\"\nreference = \"acs/reference\"\n"
                          "dut = [\"acs/sensor\"]\n[sources.acs]\ndriver = \"socket\"\n"
                          "address = \"192.0.2.10:5026\"\n" +
                              source + "[sources.acs.pulses]\n" + keys,
                          "/lab/bench.toml");
}

std::string problem(const std::string& keys, const std::string& source = "") {
  const auto file = bench(keys, source);
  return file ? "accepted" : file.error().message;
}

TEST(PulseKeys, GiveTheInstrumentUtc) {
  const auto file = bench("channel = \"pps\"\nedge = \"falling\"\ndelay_s = 2.5e-7\n"
                          "u_delay_s = 5e-8\n");
  ASSERT_TRUE(file) << file.error().message;
  const SourceSettings& source = *file->source("acs");
  ASSERT_TRUE(source.pulses);
  EXPECT_EQ(source.pulses->channel, "pps");
  EXPECT_EQ(source.pulses->edge, analysis::SampledPulses::Edge::falling);
  EXPECT_EQ(source.pulses->delay_s, 2.5e-7);
  EXPECT_EQ(source.pulses->u_delay_s, 5e-8);
  EXPECT_EQ(source.time_base, drivers::TimeBase::utc);
}

TEST(PulseKeys, AreRefusedWithTheirReason) {
  const std::string channel = "channel = \"pps\"\n";
  const std::string u = "u_delay_s = 5e-8\n";
  EXPECT_EQ(problem(channel + u), "accepted");
  EXPECT_THAT(problem(u), HasSubstr("channel"));
  EXPECT_THAT(problem(channel), HasSubstr("'sources.acs.pulses.u_delay_s' is missing"));
  EXPECT_THAT(problem(channel + "u_delay_s = 0.0\n"), HasSubstr("must be positive"));
  EXPECT_THAT(problem(channel + u + "delay_s = 0.5\n"), HasSubstr("delay_s"));
  EXPECT_THAT(problem(channel + u + "edge = \"both\"\n"), HasSubstr("edge"));
  EXPECT_THAT(problem(channel + u + "width_s = 0.1\n"), HasSubstr("width_s"));
  EXPECT_THAT(problem(channel + u, "time_base = \"local\"\n"), HasSubstr("time_base"));
}

} // namespace
} // namespace dyncal::inline bench
