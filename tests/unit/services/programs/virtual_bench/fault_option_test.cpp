#include "services/programs/virtual_bench/fault_option.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline programs::virtual_bench {
namespace {

using drivers::virtual_bench::BenchFaults;
using testing::AllOf;
using testing::HasSubstr;

BenchFaults faults_of(const std::vector<std::string>& texts) {
  BenchFaults faults;
  for (const std::string& text : texts) {
    const auto read = read_fault(text, faults);
    EXPECT_TRUE(read) << read.error().message;
  }
  return faults;
}

TEST(FaultOption, EveryFaultReachesItsPlaceInTheDescription) {
  const BenchFaults faults = faults_of({"over-range=30,at=sensor",
                                        "over-range=5,at=reference",
                                        "stuck=50,at=sync_acs,every=0.5",
                                        "hum=0.001,at=sync_dau,frequency=60",
                                        "drift=-0.02,at=reference",
                                        "loss=0.01,at=sensor,counted=no",
                                        "loss=0.05,at=acs",
                                        "soft-ends=9.7,at=sensor",
                                        "soft-ends=9,at=reference,end=lower",
                                        "second-order=0.001,at=sensor",
                                        "held=0.1,at=sensor",
                                        "fifo=8",
                                        "free-running",
                                        "start-jitter=50e-6",
                                        "exciter-gain=50",
                                        "ring-down=0.2",
                                        "generator-offset=-1.5",
                                        "generator-burst",
                                        "generator-no-reset",
                                        "output-stays-on",
                                        "hum=0.002,at=sensor,frequency=16.7,while=driven",
                                        "second-slip=0.001",
                                        "knock=5,at=reference,after=1.5",
                                        "delay-change=1e-3,after=2",
                                        "wandering=0.02,period=0.3"});
  EXPECT_EQ(faults.sensor.range, 30.0);
  EXPECT_EQ(faults.reference.range, 5.0);
  EXPECT_EQ(faults.sensor.soft_upper, 9.7);
  EXPECT_EQ(faults.sensor.soft_lower, 9.7);
  EXPECT_EQ(faults.reference.soft_upper, 0.0);
  EXPECT_EQ(faults.reference.soft_lower, 9.0);
  EXPECT_EQ(faults.sensor.second_order_rel, 0.001);
  EXPECT_EQ(faults.sensor.held_part, 0.1);
  EXPECT_EQ(faults.fifo_samples, 8U);
  EXPECT_EQ(faults.sync_acs.stuck_samples, 50U);
  EXPECT_EQ(faults.sync_acs.stuck_every_s, 0.5);
  EXPECT_EQ(faults.sync_dau.hum_rel, 0.001);
  EXPECT_EQ(faults.sync_dau.hum_hz, 60.0);
  EXPECT_EQ(faults.reference.drift_rel_per_s, -0.02);
  EXPECT_EQ(faults.sensor_loss.probability, 0.01);
  EXPECT_FALSE(faults.sensor_loss.counted);
  EXPECT_EQ(faults.acs_loss.probability, 0.05);
  EXPECT_TRUE(faults.acs_loss.counted);
  EXPECT_TRUE(faults.series_start.free_running);
  EXPECT_EQ(faults.series_start.jitter_s, 50e-6);
  EXPECT_EQ(faults.exciter_gain, 50.0);
  EXPECT_EQ(faults.ring_down_s, 0.2);
  EXPECT_EQ(faults.left_in_generator.offset_v, -1.5);
  EXPECT_TRUE(faults.left_in_generator.in_burst);
  EXPECT_TRUE(faults.left_in_generator.is_kept);
  EXPECT_TRUE(faults.output_stays_on);
  EXPECT_EQ(faults.sensor.hum_hz, 16.7);
  EXPECT_TRUE(faults.sensor.hum_while_driven);
  EXPECT_FALSE(faults.sync_dau.hum_while_driven);
  EXPECT_EQ(faults.reference.knock_rel, 5.0);
  EXPECT_EQ(faults.reference.knock_after_s, 1.5);
  EXPECT_EQ(faults.delay_change.by_s, 1e-3);
  EXPECT_EQ(faults.delay_change.after_s, 2.0);
  EXPECT_EQ(faults.wandering.part, 0.02);
  EXPECT_EQ(faults.wandering.period_s, 0.3);
  EXPECT_EQ(faults.stamps.at("second-slip"), 0.001);
}

TEST(FaultOption, SeveralFaultsOfOneChannelStandTogether) {
  const BenchFaults faults = faults_of({"hum=0.001,at=sensor", "stuck=50,at=sensor"});
  EXPECT_EQ(faults.sensor.hum_rel, 0.001);
  EXPECT_EQ(faults.sensor.hum_hz, 50.0);
  EXPECT_EQ(faults.sensor.stuck_samples, 50U);
  EXPECT_EQ(faults.sensor.stuck_every_s, 1.0);
}

struct Wrong {
  const char* text;
  const char* what;
};

class WrongFault : public testing::TestWithParam<Wrong> {};

TEST_P(WrongFault, IsRefusedWithTheWholeOption) {
  BenchFaults faults;
  const auto read = read_fault(GetParam().text, faults);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::bad_argument);
  EXPECT_THAT(read.error().message, AllOf(HasSubstr(std::string("--fault ") + GetParam().text),
                                          HasSubstr(GetParam().what)));
}

INSTANTIATE_TEST_SUITE_P(
    Texts, WrongFault,
    testing::Values(Wrong{"hom=0.1,at=sensor", "no such fault; there are: over-range="},
                    Wrong{"hum=0.1", "at=CHANNEL; there are sensor, reference"},
                    Wrong{"hum=0.1,at=acs", "at=CHANNEL"},
                    Wrong{"hum=,at=sensor", "hum=PART, a number from 0 to 10"},
                    Wrong{"hum=0.1,at=sensor,frequency=fifty", "frequency=HZ, a number"},
                    Wrong{"hum=0.1,at=sensor,every=1", "has no setting \"every\""},
                    Wrong{"stuck=0,at=sensor", "stuck=SAMPLES"},
                    Wrong{"over-range=-3,at=sensor", "over-range=LIMIT"},
                    Wrong{"loss=2,at=sensor", "loss=PROBABILITY, a number from 0 to 1"},
                    Wrong{"loss=0.1,at=reference", "at=sensor or at=acs"},
                    Wrong{"loss=0.1,at=acs,counted=maybe", "counted=yes or counted=no"},
                    Wrong{"free-running=1", "takes no value"},
                    Wrong{"no-fix=often", "no-fix=PROBABILITY"}));

TEST(FaultOption, HelpNamesEveryFault) {
  EXPECT_THAT(fault_help(), AllOf(HasSubstr("over-range="), HasSubstr("stuck="), HasSubstr("hum="),
                                  HasSubstr("drift="), HasSubstr("loss="),
                                  HasSubstr("free-running"), HasSubstr("start-jitter="),
                                  HasSubstr("exciter-gain="), HasSubstr("second-slip")));
}

} // namespace
} // namespace dyncal::inline programs::virtual_bench
