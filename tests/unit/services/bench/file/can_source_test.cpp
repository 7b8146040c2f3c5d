#include "services/bench/file/driver_tables.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bench/file/bench_file.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline bench {
namespace {

using testing::HasSubstr;

class CanKeys : public testing::Test {
protected:
  CanKeys() {
    std::ofstream(folder / "sensor.dbc") << "BO_ 291 Sample: 8 S\n";
    std::ofstream(folder / "drive.log") << "(1.000000) can0 123#00\n";
  }

  [[nodiscard]] Expected<BenchFile> bench(const std::string& keys) const {
    return parse_bench_file(
        "bench = \"acc-1\"\n[excitation]\nfrequencies_hz = [\"10\"]\nlevel = "
        "10.0\n[generator]\ndriver = \"none\"\n"
        "[sources.acs]\ndriver = \"socket\"\naddress = \"127.0.0.1:5026\"\ntime_base = \"utc\"\n"
        "[method]\nkind = \"absolute-time\"\nreference = \"acs/reference\"\ndut = [\"sensor/x\"]\n"
        "[sources.sensor]\ndriver = \"can\"\n" +
            keys,
        folder / "bench.toml");
  }
  [[nodiscard]] std::string problem(const std::string& keys) const {
    const auto file = bench(keys);
    return file ? "accepted" : file.error().message;
  }

  const tests::TemporaryFolder own;
  const std::filesystem::path& folder = own.path();
};

TEST_F(CanKeys, StateRangesOrNone) {
  const auto file = bench("interface = \"can0\"\ndbc = \"sensor.dbc\"\n"
                          "ranges = { x = \"none\", y = \"-20 to 2.5e1\" }\n");
  ASSERT_TRUE(file) << file.error().message;
  const auto& ranges = file->source("sensor")->identity.ranges;
  EXPECT_EQ(ranges.at("x"), StatedRange{});
  EXPECT_EQ(ranges.at("y"), (StatedRange{-20.0, 25.0}));
  for (const char* wrong : {"wide", "20 to -20", "-20", "a to b", "1 to 1", "-inf to inf"}) {
    EXPECT_THAT(
        problem(std::string("interface = \"can0\"\ndbc = \"sensor.dbc\"\nranges = { x = \"") +
                wrong + "\" }\n"),
        HasSubstr("ranges' gives channel 'x' the range"))
        << wrong;
  }
}

TEST_F(CanKeys, ReachTheDriverAsTheyStand) {
  const auto file = bench(R"(interface = "can0"
dbc = "sensor.dbc"
messages = ["Sample"]
channels = { X = "x" }
units = { x = "m/s^2" }
time_source = "counter"
counter = "SampleCounter"
nominal_rate_hz = 1000
bit_rate_per_s = 500000
data_bit_rate_per_s = 2e6
hardware_stamp_point = "start-of-frame"
hardware_tick_s = 25e-9
latency_s = 8e-6
u_latency_s = 2e-6
u_utc_s = 1e-7
frame_duration_correction = false
bus_is_shared = false
sync_id = 129
restart_after_bus_off_s = 0.2
)");
  ASSERT_TRUE(file) << file.error().message;
  const SourceSettings& source = *file->source("sensor");
  ASSERT_TRUE(source.is<CanSourceSettings>());
  const auto& sensor = *source.as<CanSourceSettings>();
  EXPECT_EQ(sensor.interface_name, "can0");
  EXPECT_EQ(sensor.dbc, folder / "sensor.dbc");
  EXPECT_EQ(sensor.restart_after_bus_off_s, 0.2);
  EXPECT_EQ(sensor.messages, std::vector<std::string>{"Sample"});
  EXPECT_EQ(source.channels.at("X"), "x");
  EXPECT_EQ(source.units.at("x"), R"(\metre\second\tothe{-2})");
  EXPECT_EQ(sensor.time_source, drivers::can::TimeSource::counter);
  EXPECT_EQ(sensor.counter, "SampleCounter");
  EXPECT_DOUBLE_EQ(sensor.nominal_rate_hz, 1000.0);
  EXPECT_DOUBLE_EQ(sensor.bit_rates.nominal_per_s, 500e3);
  EXPECT_DOUBLE_EQ(sensor.bit_rates.data_per_s, 2e6);
  EXPECT_EQ(sensor.hardware_stamp_point, drivers::can::StampPoint::start_of_frame);
  EXPECT_EQ(sensor.hardware_tick_s, 25e-9);
  EXPECT_DOUBLE_EQ(sensor.latency_s, 8e-6);
  EXPECT_EQ(sensor.u_latency_s, 2e-6);
  EXPECT_EQ(sensor.u_utc_s, 1e-7);
  EXPECT_FALSE(sensor.correct_frame_duration);
  EXPECT_FALSE(sensor.bus_is_shared);
  EXPECT_EQ(sensor.sync_id, 129U);
  EXPECT_EQ(source.time_base, drivers::TimeBase::utc);
}

TEST_F(CanKeys, LeaveWhatIsNotSaidToTheDriver) {
  const auto file = bench("interface = \"can0\"\ndbc = \"sensor.dbc\"\ntime_base = \"local\"\n");
  ASSERT_TRUE(file) << file.error().message;
  const SourceSettings& source = *file->source("sensor");
  ASSERT_TRUE(source.is<CanSourceSettings>());
  const auto& sensor = *source.as<CanSourceSettings>();
  EXPECT_FALSE(sensor.time_source);
  EXPECT_FALSE(sensor.u_latency_s);
  EXPECT_FALSE(sensor.u_utc_s);
  EXPECT_TRUE(sensor.correct_frame_duration);
  EXPECT_EQ(sensor.hardware_stamp_point, drivers::can::StampPoint::unknown);
  EXPECT_EQ(sensor.sync_id, 0x80U);
  EXPECT_EQ(source.time_base, drivers::TimeBase::local);
}

TEST_F(CanKeys, TakeALogInPlaceOfAnInterface) {
  const auto file = bench("log = \"drive.log\"\nplay = 10.0\ndbc = \"sensor.dbc\"\n");
  ASSERT_TRUE(file) << file.error().message;
  const auto* can = file->source("sensor")->as<CanSourceSettings>();
  ASSERT_NE(can, nullptr);
  EXPECT_EQ(can->log, folder / "drive.log");
  EXPECT_EQ(can->interface_name, "");
  EXPECT_DOUBLE_EQ(can->play_speed, 10.0);
}

TEST_F(CanKeys, AreRefusedWithFileLineAndKey) {
  EXPECT_THAT(problem("dbc = \"sensor.dbc\"\n"),
              HasSubstr("key 'sources.sensor.interface' is missing"));
  EXPECT_THAT(problem("interface = \"can0\"\n"), HasSubstr("key 'sources.sensor.dbc' is missing"));
  EXPECT_THAT(problem("interface = \"can0\"\ndbc = \"other.dbc\"\n"),
              HasSubstr("bench.toml:18: key 'sources.sensor.dbc' names "));
  EXPECT_THAT(problem("log = \"other.log\"\ndbc = \"sensor.dbc\"\n"),
              HasSubstr("other.log, which does not exist"));
  EXPECT_THAT(problem("interface = \"can0\"\ndbc = \"sensor.dbc\"\nbitrate = 1\n"),
              HasSubstr("key 'sources.sensor.bitrate' is not known"));
  EXPECT_THAT(problem("interface = \"can0\"\ndbc = \"sensor.dbc\"\nplay = 1\n"),
              HasSubstr("key 'sources.sensor.play' is not known"));
  EXPECT_THAT(problem("interface = \"can0\"\ndbc = \"sensor.dbc\"\ntime_source = \"gps\"\n"),
              HasSubstr("time_source"));
  EXPECT_THAT(problem("interface = \"can0\"\ndbc = \"sensor.dbc\"\nbit_rate_per_s = -1\n"),
              HasSubstr("must be positive, in bit/s"));
  EXPECT_THAT(problem("interface = \"can0\"\ndbc = \"sensor.dbc\"\nu_utc_s = -1e-6\n"),
              HasSubstr("must not be negative"));
}

} // namespace
} // namespace dyncal::inline bench
