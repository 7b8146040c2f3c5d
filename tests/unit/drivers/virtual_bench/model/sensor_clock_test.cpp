#include "drivers/virtual_bench/model/sensor_clock.hpp"

#include <gtest/gtest.h>

#include "drivers/virtual_bench/model/dau_clock.hpp"
#include "tests/unit/drivers/virtual_bench/model/interval_statistics.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

struct Record {
  std::vector<double> intervals_ns; // between stamps of the DAU
  std::vector<double> temperatures_degc;
};

Record record(SensorKind kind, double thermal_cycle_s, std::size_t samples) {
  const auto sensor = make_sensor_clock(kind, 7, thermal_cycle_s);
  DauClock dau(7, 1'600'000'000'300'000'000);
  Record result;
  std::int64_t previous_ns = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    const SensorEdge edge = sensor->next();
    const std::int64_t stamp_ns = dau.stamp(edge.time_s).utc_ns;
    if (i > 0) {
      result.intervals_ns.push_back(static_cast<double>(stamp_ns - previous_ns));
      result.temperatures_degc.push_back(edge.temperature_degc);
    }
    previous_ns = stamp_ns;
  }
  return result;
}

TEST(SensorClock, Mpu9250ShowsTheIntervalsOfThePaperOver8000Seconds) {
  const IntervalStatistics found =
      statistics_of(record(SensorKind::mpu9250, 8000.0, 8'020'000).intervals_ns);
  EXPECT_NEAR(found.mean, 996959.9, 0.5);
  EXPECT_NEAR(found.sd, 21.06, 0.05 * 21.06);
  EXPECT_NEAR(found.spread, 334.0, 0.12 * 334.0); // two rare late edges decide it
}

TEST(SensorClock, Mpu9250ShowsTheSamePictureInAShortCycle) {
  const IntervalStatistics found =
      statistics_of(record(SensorKind::mpu9250, 100.0, 100'000).intervals_ns);
  EXPECT_NEAR(found.mean, 996960.0, 2.0);
  EXPECT_NEAR(found.sd, 21.06, 0.07 * 21.06);
  EXPECT_NEAR(found.spread, 334.0, 0.15 * 334.0);
}

TEST(SensorClock, Mpu9250IntervalRisesWithTemperature) {
  const Record found = record(SensorKind::mpu9250, 1000.0, 1'000'000);
  const IntervalStatistics interval = statistics_of(found.intervals_ns);
  const IntervalStatistics temperature = statistics_of(found.temperatures_degc);
  double correlation = 0.0;
  for (std::size_t i = 0; i < found.intervals_ns.size(); ++i) {
    correlation +=
        (found.intervals_ns[i] - interval.mean) * (found.temperatures_degc[i] - temperature.mean);
  }
  correlation /= static_cast<double>(found.intervals_ns.size()) * interval.sd * temperature.sd;
  EXPECT_NEAR(correlation, 0.64, 0.05);
}

TEST(SensorClock, Bma280HasALateAndAnEarlySampleEvery2200Samples) {
  const Record found = record(SensorKind::bma280, 100.0, 440'000);
  const IntervalStatistics interval = statistics_of(found.intervals_ns);
  EXPECT_NEAR(interval.mean, 485000.0, 1.0);
  EXPECT_NEAR(interval.sd, 127.0, 0.05 * 127.0);
  std::vector<double> centre;
  std::size_t late = 0;
  std::size_t early = 0;
  for (std::size_t i = 0; i < found.intervals_ns.size(); ++i) {
    const double deviation = found.intervals_ns[i] - 485000.0;
    if (std::abs(deviation) < 1000.0) {
      centre.push_back(deviation);
    }
    if (deviation > 2000.0) {
      ++late;
      ASSERT_LT(i + 1, found.intervals_ns.size());
      EXPECT_LT(found.intervals_ns[i + 1], 483000.0);
    }
    early += deviation < -2000.0 ? 1 : 0;
  }
  EXPECT_EQ(late, early);
  EXPECT_NEAR(static_cast<double>(found.intervals_ns.size() - late - early) /
                  static_cast<double>(late),
              2191.0, 0.05 * 2191.0);
  EXPECT_NEAR(statistics_of(centre).sd, std::hypot(12.0, 3.78),
              0.05 * 12.6); // noise and the quantum of two stamps
}

TEST(DauClock, ErrorOfItsStampsIsThatOfTheModel) {
  DauClock clock(3, 1'600'000'000'000'000'000);
  std::vector<double> errors_ns;
  for (double time_s = 0.0; time_s < 20'000.0; time_s += 0.1) {
    const std::int64_t true_ns = std::llround(time_s * 1e9);
    errors_ns.push_back(
        static_cast<double>(clock.stamp(time_s).utc_ns - clock.start_ns() - true_ns));
  }
  const IntervalStatistics error = statistics_of(errors_ns);
  EXPECT_NEAR(error.mean, 0.0, 5.0);
  EXPECT_NEAR(error.sd, 18.5, 0.05 * 18.5);
  EXPECT_LT(error.spread, 200.0);
}

TEST(DauClock, StampsLieOnTheLatticeOfTheCounter) {
  DauClock clock(5, 1'600'000'000'000'000'000);
  const DauStamp first = clock.stamp(0.1);
  for (double time_s = 0.1; time_s < 0.9; time_s += 0.000997) {
    const DauStamp stamp = clock.stamp(time_s);
    const double ticks = static_cast<double>(stamp.ticks - first.ticks);
    EXPECT_NEAR(static_cast<double>(stamp.utc_ns - first.utc_ns),
                ticks / (DauClock::nominal_hz * (1.0 + clock.crystal_error())) * 1e9, 40.0);
    EXPECT_GT(stamp.uncertainty_ns, 0U);
  }
}

TEST(DauClock, BenchTimeZeroIsItsStartTime) {
  DauClock clock(11, 1'600'000'000'750'000'000);
  EXPECT_NEAR(static_cast<double>(clock.stamp(0.0).utc_ns - 1'600'000'000'750'000'000), 0.0, 100.0);
  EXPECT_NEAR(static_cast<double>(clock.stamp(10.0).utc_ns - 1'600'000'010'750'000'000), 0.0,
              100.0);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
