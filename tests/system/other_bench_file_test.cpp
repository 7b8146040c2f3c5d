// A run whose bench file is not that of the services: refused where it says otherwise of a source,
// and only there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class OtherBenchFile : public testing::TestWithParam<std::string> {
protected:
  static LiveBenchSettings one_step(const std::string& dds) {
    LiveBenchSettings settings;
    settings.bench_arguments = {"--frequencies", "80", "--levels", "20"};
    settings.excitation = "frequencies_hz = [\"80\"]\nlevel = 20.0\n"
                          "settling_s = 0.5\nduration_s = 1.5\n";
    settings.rest = "adc_delay_s = 1e-6\n";
    settings.dds = dds;
    return settings;
  }
};

TEST_P(OtherBenchFile, RefusesAnotherSensorAndMeasuresOtherSteps) {
  const auto folder = fresh_folder("other_bench_file_" + GetParam());
  LiveBench bench(folder, one_step(GetParam()));
  const auto other_sensor =
      bench.changed_bench_file("sensor.toml", "sensor =", "sensor = \"0xdeadbeef\"");
  ProgramRun& refused = bench.start({"run", other_sensor});
  const auto status = refused.wait(patience);
  ASSERT_TRUE(status);
  EXPECT_EQ(*status, 1);
  EXPECT_THAT(refused.errors(),
              AllOf(HasSubstr("the service of source 'dau' of bench 'live' on "),
                    HasSubstr("key 'sources.dau.sensor' is \"0xbccb0100\" there and "
                              "\"0xdeadbeef\" here; restart the service")));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF") << "nothing was excited";

  const auto other_level =
      bench.changed_bench_file("level.toml", "level =", "level = 10.0 # and a comment");
  ProgramRun& measured = bench.start({"run", other_level});
  const auto measured_status = measured.wait(patience);
  ASSERT_TRUE(measured_status);
  EXPECT_EQ(*measured_status, 0) << measured.errors();
}

INSTANTIATE_TEST_SUITE_P(Vendors, OtherBenchFile, testing::Values("cyclonedds", "fastdds"));

} // namespace
} // namespace dyncal::tests
