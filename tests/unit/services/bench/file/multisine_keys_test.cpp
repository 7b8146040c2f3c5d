#include "services/bench/file/multisine_keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline bench {
namespace {

using ::testing::HasSubstr;

constexpr const char* lines = R"(frequencies_hz = ["10.1", "12.3", "16.1"]
)";

Expected<BenchFile> bench_with(const std::string& excitation, const std::string& method = "") {
  return parse_bench_file("bench = \"acc-1\"\n[excitation]\nlevel = 2.0\n" + excitation + R"(
[sources.dau]
driver = "smartup"
sensor = "0xbccb0100"
[sources.acs]
driver = "socket"
address = "127.0.0.1:2"
[method]
)" +
                              (method.empty() ? R"(kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
)"
                                              : method),
                          "bench.toml");
}

std::string refusal(const std::string& excitation, const std::string& method = "") {
  const auto bench = bench_with(excitation, method);
  return bench ? std::string() : bench.error().message;
}

TEST(MultisineKeys, GiveSettlingAndDurationInPeriods) {
  const auto usual = bench_with(std::string("kind = \"multisine\"\n") + lines);
  ASSERT_TRUE(usual) << usual.error().message;
  ASSERT_TRUE(usual->excitation.multisine);
  EXPECT_EQ(usual->excitation.multisine->period_s, 10.0);
  EXPECT_EQ(usual->excitation.settling_s, 10.0);
  EXPECT_EQ(usual->excitation.duration_s, 10.0);

  const auto own = bench_with(R"(kind = "multisine"
frequencies_hz = ["10.2", "12.6", "16.2"]
period_s = 5.0
dropped_periods = 0.5
duration_s = 20.0
)");
  ASSERT_TRUE(own) << own.error().message;
  EXPECT_EQ(own->excitation.settling_s, 2.5);
  EXPECT_EQ(own->excitation.duration_s, 20.0);

  const auto one_by_one = bench_with(std::string("kind = \"sine\"\n") + lines);
  ASSERT_TRUE(one_by_one) << one_by_one.error().message;
  EXPECT_FALSE(one_by_one->excitation.multisine);
}

TEST(MultisineKeys, AreRefusedWhereTheyMeanNothing) {
  const std::string multisine = std::string("kind = \"multisine\"\n") + lines;
  EXPECT_THAT(refusal(std::string("period_s = 10.0\n") + lines), HasSubstr("is for a multi-sine"));
  EXPECT_THAT(refusal(multisine + "settling_s = 1.0\n"), HasSubstr("dropped_periods"));
  EXPECT_THAT(refusal(multisine + "settling = \"from-data\"\n"), HasSubstr("dropped_periods"));
  EXPECT_THAT(refusal(multisine + "repeat_first = true\n"), HasSubstr("leave it out"));
  EXPECT_THAT(refusal(multisine + "duration_s = 5.0\n"), HasSubstr("must be a period"));
  EXPECT_THAT(refusal(multisine + "dropped_periods = -1\n"), HasSubstr("between 0 and 10"));
  EXPECT_THAT(refusal(multisine, R"(kind = "analogue"
reference = "acs/reference"
dut = ["acs/sensor"]
)"),
              HasSubstr("can be \"multisine\" with method.kind"));
}

TEST(MultisineKeys, NeedAnInstrumentThatTakesAWaveformOrNone) {
  const std::string multisine = std::string("kind = \"multisine\"\n") + lines;
  EXPECT_THAT(refusal(multisine + "[generator]\ndriver = \"by-hand\"\nlevel_per_volt = 50.0\n"),
              HasSubstr("cannot excite a multi-sine"));
  EXPECT_EQ(refusal(multisine + "[generator]\ndriver = \"scpi\"\naddress = \"127.0.0.1:9\"\n"
                                "level_per_volt = 50.0\nlevel_tolerance_rel = 0.02\n"),
            "");
  EXPECT_EQ(refusal(multisine + "[generator]\ndriver = \"none\"\n"), "");
  EXPECT_EQ(refusal(std::string(lines) +
                    "duration_s = 2.0\n[generator]\ndriver = \"by-hand\"\nlevel_per_volt = 50.0\n"),
            "");
}

TEST(MultisineKeys, NameTheLinesThatCollide) {
  const std::string text = refusal(R"(kind = "multisine"
frequencies_hz = ["10.1", "12.3", "20.2", "30.3", "22.4"]
)");
  EXPECT_THAT(text, HasSubstr("bench.toml:5: key 'excitation.frequencies_hz'"));
  EXPECT_THAT(text, HasSubstr("2 times 10.1 Hz = 20.2 Hz"));
  EXPECT_THAT(text, HasSubstr("3 times 10.1 Hz = 30.3 Hz"));
  EXPECT_THAT(text, HasSubstr("10.1 Hz + 12.3 Hz = 22.4 Hz"));
  EXPECT_THAT(text, HasSubstr("new-bench --multisine"));
}

// Of the bench's own mains alone.
TEST(MultisineKeys, KeepTheMainsAwayThatTheMethodNames) {
  const std::string excitation = R"(kind = "multisine"
frequencies_hz = ["10.1", "59.9"]
)";
  EXPECT_THAT(refusal(excitation), HasSubstr("59.9 Hz is beside the mains at 60 Hz"));
  EXPECT_EQ(refusal(excitation, R"(kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
mains_hz = 50.0
)"),
            "");
}

} // namespace
} // namespace dyncal::inline bench
