#include "drivers/pps/pulse_stamps.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/analysis/clock/drawn_pulses.hpp"
#include "tests/unit/drivers/collecting_sink.hpp"

namespace dyncal::drivers::pps {
namespace {

using analysis::DrawnPulses;
using testing::HasSubstr;

constexpr std::int64_t begin_ns = 1'760'000'000'000'000'000; // UTC of sample 0
constexpr double rate_hz = 2000.0;
constexpr std::size_t block_samples = 200;

SourceDescription instrument() {
  SourceDescription description;
  description.driver = "socket";
  description.channels = {{.name = "sync", .quantity = "Voltage", .unit = R"(\volt)"},
                          {.name = "pps", .quantity = "Voltage", .unit = R"(\volt)"}};
  description.nominal_rate_hz = rate_hz;
  description.time_base = TimeBase::local;
  return description;
}

// Pulses of whole seconds of UTC, in an instrument that is 5e-6 fast.
DrawnPulses pulses_of(double late_s = 0.0) {
  DrawnPulses drawn;
  drawn.samples_per_second = rate_hz * (1.0 + 5e-6);
  drawn.first = (1.0 + late_s) * drawn.samples_per_second;
  drawn.noise_v = 1e-4;
  return drawn;
}

class Bench {
public:
  explicit Bench(PulseSettings settings, DrawnPulses drawn = pulses_of())
      : settings_(std::move(settings)), stamps_(settings_, sink), drawn_(std::move(drawn)) {
    stamps_.begin_session();
    stamps_.describe(instrument());
  }

  // Blocks as an instrument sends them, from one second to another.
  void send(double from_s, double to_s, bool with_pulses = true) {
    const std::vector<double> pulses = drawn_.samples(static_cast<std::size_t>(to_s * rate_hz));
    for (auto first = static_cast<std::size_t>(from_s * rate_hz);
         first + block_samples <= pulses.size(); first += block_samples) {
      SampleBlock block;
      block.first_sample = first;
      block.samples = block_samples;
      block.clock = RegularClock{.interval_numerator_ns = 500'000};
      block.values.assign(block_samples, 0.5);
      const auto begin = pulses.begin() + static_cast<std::ptrdiff_t>(first);
      block.values.insert(block.values.end(), begin, begin + block_samples);
      if (!with_pulses) {
        std::fill(block.values.begin() + block_samples, block.values.end(), 0.1);
      }
      // The host gets it a fifth of a second later.
      block.received_utc_ns = utc_ns(first + block_samples) + 200'000'000;
      stamps_.take(std::move(block));
    }
    stamps_.count({});
  }

  [[nodiscard]] std::int64_t utc_ns(std::uint64_t sample) const {
    return begin_ns + std::llround(1e9 * static_cast<double>(sample) / drawn_.samples_per_second);
  }
  [[nodiscard]] double largest_error_s() const {
    double largest = 0.0;
    for (std::size_t i = 0; i < sink.stamps_ns.size(); ++i) {
      const auto error_ns = sink.stamps_ns[i] - utc_ns(sink.numbers[i]);
      largest = std::max(largest, 1e-9 * std::abs(static_cast<double>(error_ns)));
    }
    return largest;
  }
  [[nodiscard]] std::uint64_t cause(const std::string& name) const {
    for (const NamedCount& one : sink.counts.causes) {
      if (one.name == name) {
        return one.value;
      }
    }
    return 0;
  }

  tests::CollectingSink sink;

private:
  PulseSettings settings_;
  PulseStamps stamps_;
  DrawnPulses drawn_;
};

TEST(PulseStamps, AreUtcWithinTheirUncertainty) {
  Bench bench({.channel = "pps", .u_delay_s = 5e-8});
  bench.send(0.0, 20.0);
  ASSERT_GT(bench.sink.stamps_ns.size(), 10U * 2000U);
  const double u_s = 1e-9 * bench.sink.blocks.back().stamp_uncertainty_ns.front();
  EXPECT_GE(u_s, 5e-8);
  EXPECT_LT(u_s, 1e-6);
  EXPECT_LT(bench.largest_error_s(), 3e-6); // right after eight pulses
  EXPECT_EQ(bench.sink.descriptions.back().time_base, TimeBase::utc);
  EXPECT_EQ(bench.sink.blocks.back().clock, std::nullopt);
  EXPECT_TRUE(bench.sink.warnings.empty());
  EXPECT_EQ(bench.cause("before_pulses") + bench.sink.numbers.size(), 40'000U);
}

TEST(PulseStamps, APulseThatIsLateAtTheInputIsSoMuchEarlier) {
  Bench bench({.channel = "pps", .delay_s = 2e-4}, pulses_of(2e-4));
  bench.send(0.0, 20.0);
  ASSERT_FALSE(bench.sink.stamps_ns.empty());
  EXPECT_LT(bench.largest_error_s(), 3e-6);
}

TEST(PulseStamps, WithoutPulsesTimeGoesOnAndIsNotTrustedAfterAMinute) {
  Bench bench({.channel = "pps"});
  bench.send(0.0, 20.0);
  const auto u_before = bench.sink.blocks.back().stamp_uncertainty_ns.front();
  bench.send(20.0, 90.0, false);
  EXPECT_GT(bench.sink.blocks.back().stamp_uncertainty_ns.front(), 3U * u_before);
  EXPECT_THAT(bench.sink.warnings, testing::ElementsAre(HasSubstr("no pulses in channel 'pps'")));
  EXPECT_EQ(bench.sink.blocks.back().flags.front(), stamp_no_uncertainty);
  EXPECT_GT(bench.sink.counts.stamps_not_trusted, 10'000U);
  EXPECT_LT(bench.largest_error_s(), 2e-6);
}

TEST(PulseStamps, LostSamplesLeaveTheTimeOfTheOthers) {
  Bench bench({.channel = "pps"});
  bench.send(0.0, 15.0);
  bench.send(18.3, 30.0);
  EXPECT_GT(bench.sink.numbers.back(), 59'000U);
  EXPECT_LT(bench.largest_error_s(), 3e-6);
  EXPECT_EQ(bench.sink.sessions_begun_at.size(), 1U);
}

TEST(PulseStamps, WithoutAChannelOfPulsesThereIsNoDescription) {
  const auto described = described_in_utc(instrument(), {.channel = "gps"});
  ASSERT_FALSE(described);
  EXPECT_THAT(described.error().message, HasSubstr("no channel 'gps'"));
  EXPECT_EQ(described.error().code, ErrorCode::invalid_setting);
}

TEST(PulseStamps, BeforePulsesNothingIsHandedOn) {
  Bench bench({.channel = "pps"});
  bench.send(0.0, 20.0, false);
  EXPECT_TRUE(bench.sink.blocks.empty());
  EXPECT_EQ(bench.cause("before_pulses"), 40'000U);
}

} // namespace
} // namespace dyncal::drivers::pps
