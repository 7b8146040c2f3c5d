#include "drivers/interferometer/interferometer_source.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/base/frequency.hpp"
#include "analysis/interferometer/quadrature_phase.hpp"
#include "analysis/interferometer/reference_motion.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "tests/unit/drivers/collecting_sink.hpp"
#include "tests/unit/drivers/interferometer/simulated_device.hpp"

namespace dyncal::tests {
namespace {

using drivers::SampleBlock;
using drivers::interferometer::InterferometerSettings;
using drivers::interferometer::InterferometerSource;
using drivers::interferometer::StatedEllipse;
using testing::HasSubstr;

InterferometerSettings settings_of(const DeviceSettings& device) {
  InterferometerSettings settings;
  settings.u1 = "u1";
  settings.u2 = "u2";
  settings.displacement_per_turn_m = analysis::displacement_per_turn_m(device.wavelength_m, 1);
  settings.u_wavelength_rel = 2e-6;
  return settings;
}

CollectingSink run(const InterferometerSettings& settings, const DeviceSettings& device,
                   SimulatedDevice::Sessions sessions) {
  InterferometerSource source(
      settings, std::make_unique<SimulatedDevice>(description_of(device), std::move(sessions)));
  CollectingSink sink;
  const auto described = source.describe();
  EXPECT_TRUE(described) << (described ? "" : described.error().message);
  if (described) {
    EXPECT_TRUE(source.run(sink));
  }
  return sink;
}

CollectingSink run(const DeviceSettings& device) {
  return run(settings_of(device), device, {cut(record_of(device), 3)});
}

std::size_t not_measured(const std::vector<double>& values) {
  return static_cast<std::size_t>(
      std::ranges::count_if(values, [](double value) { return std::isnan(value); }));
}

// The sine of a step, about time 0 of the device, by the stamps that went out.
std::complex<double> phasor(const DeviceSettings& device, std::vector<std::int64_t> stamps_ns,
                            const std::vector<double>& values) {
  std::vector<std::int64_t> stamps;
  std::vector<double> measured;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) {
      stamps.push_back(stamps_ns[i] - 1000);
      measured.push_back(values[i]);
    }
  }
  const auto frequency =
      *analysis::Frequency::parse(std::to_string(std::lround(device.motion.frequency_hz)));
  const auto motion =
      analysis::motion_of_step(analysis::MotionQuantity::displacement, frequency, stamps, measured);
  if (!motion) {
    ADD_FAILURE() << motion.error().message;
    return {};
  }
  const std::span<const double> fitted[] = {motion->values};
  const auto fit = analysis::fit_sine(frequency, 0, motion->stamps_ns, fitted);
  return fit ? std::complex<double>(fit->front().sine, fit->front().cosine) : 0.0;
}

std::complex<double> truth(const DeviceSettings& device) {
  return std::polar(device.motion.displacement_m, 0.4);
}

TEST(InterferometerSource, MakesTheDisplacementOfTheMirror) {
  for (const double frequency_hz : {20.0, 160.0, 1000.0, 10000.0}) {
    DeviceSettings device;
    device.motion.frequency_hz = frequency_hz;
    device.motion.displacement_m = frequency_hz < 1000.0 ? 5e-6 : 5e-7;
    device.seed = static_cast<std::uint64_t>(frequency_hz);
    const CollectingSink sink = run(device);
    const auto measured = phasor(device, sink.stamps_ns, sink.channel(1));
    EXPECT_LT(std::abs(measured / truth(device) - 1.0), 1e-4) << frequency_hz << " Hz";
    EXPECT_TRUE(sink.warnings.empty()) << sink.warnings.front();
    ASSERT_FALSE(sink.descriptions.empty());
    const auto& last = sink.descriptions.back();
    EXPECT_EQ(last.nominal_rate_hz, 100e3);
    ASSERT_EQ(last.channels.size(), 2U);
    EXPECT_EQ(last.channels[0].name, "sync");
    EXPECT_EQ(last.channels[1].name, "displacement");
    EXPECT_EQ(last.channels[1].unit, R"(\metre)");
    ASSERT_EQ(last.quadrature_signals.size(), 1U);
    const auto& signals = last.quadrature_signals.front();
    EXPECT_NEAR(signals.centre_u1, device.ellipse.p, 2e-3);
    EXPECT_NEAR(signals.radius_ratio, device.ellipse.r, 2e-3);
    EXPECT_NEAR(signals.quadrature_error_rad, device.ellipse.alpha_rad, 2e-3);
    EXPECT_EQ(signals.u_ellipse_rad.size(), 2U);
    EXPECT_EQ(signals.periodic_error_rad.size(), 4U);
  }
}

TEST(InterferometerSource, KeepsTheInstantsOfSync) {
  DeviceSettings device;
  device.motion.frequency_hz = 1000.0;
  const CollectingSink sink = run(device);
  const std::vector<double> sync = sink.channel(0);
  ASSERT_GT(sync.size(), 40'000U);
  double largest = 0.0;
  for (std::size_t i = 0; i < sync.size(); ++i) {
    const double t = 1e-9 * static_cast<double>(sink.stamps_ns[i] - 1000);
    largest =
        std::max(largest, std::abs(sync[i] - std::sin(2.0 * std::numbers::pi * 1000.0 * t + 0.9)));
    ASSERT_EQ(sink.stamps_ns[i], 1000 + static_cast<std::int64_t>(sink.numbers[i]) * 10'000);
  }
  EXPECT_LT(largest, 1e-6);
  EXPECT_TRUE(std::ranges::all_of(
      sink.blocks, [](const SampleBlock& block) { return block.clock.has_value(); }));
  EXPECT_EQ(sink.counts.received, sync.size());
}

TEST(InterferometerSource, LetsSyncFlowBeforeAnEllipseIsKnown) {
  DeviceSettings device;
  device.motion = {.frequency_hz = 1000.0, .displacement_m = 1e-9, .drift_m_s = 0.0};
  device.seconds = 6.0;
  device.rate_hz = 100e3;
  const CollectingSink sink = run(device);
  const std::vector<double> displacement = sink.channel(1);
  ASSERT_GT(displacement.size(), 500'000U);
  EXPECT_EQ(not_measured(displacement), displacement.size());
  EXPECT_EQ(not_measured(sink.channel(0)), 0U);
  ASSERT_EQ(sink.warnings.size(), 1U);
  EXPECT_THAT(sink.warnings.front(), HasSubstr("is not known yet"));
  EXPECT_EQ(sink.descriptions.back().quadrature_signals.front().radius_u1, 0.0);
}

// 10 kHz, 50 nm: a third of a turn, too short for an ellipse that could be trusted.
TEST(InterferometerSource, KeepsTheEllipseOfALongerArc) {
  DeviceSettings longer;
  longer.motion.drift_m_s = 0.0;
  longer.seconds = 0.5;
  DeviceSettings shorter = longer;
  shorter.motion = {.frequency_hz = 10000.0, .displacement_m = 5e-8, .drift_m_s = 0.0};
  shorter.seconds = 1.0;
  shorter.seed = 2;
  SampleBlock second = record_of(shorter);
  std::vector<SampleBlock> blocks = cut(record_of(longer), 5);
  const std::size_t offset = 250'000;
  for (SampleBlock& block : cut(second, 6)) {
    block.first_sample += offset;
    blocks.push_back(std::move(block));
  }
  const CollectingSink sink = run(settings_of(longer), longer, {std::move(blocks)});
  std::vector<std::int64_t> stamps;
  std::vector<double> values;
  const std::vector<double> all = sink.channel(1);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (sink.numbers[i] > offset / 5 + 100) {
      stamps.push_back(sink.stamps_ns[i] - 500'000'000);
      values.push_back(all[i]);
    }
  }
  EXPECT_LT(std::abs(phasor(shorter, stamps, values) / truth(shorter) - 1.0), 5e-4);
  EXPECT_GT(sink.descriptions.back().quadrature_signals.front().turns_covered, 1.0);
}

TEST(InterferometerSource, CutsWhereTurnsMayBeLost) {
  std::mt19937_64 random(11);
  for (int draw = 0; draw < 5; ++draw) {
    DeviceSettings device;
    device.seed = random();
    SampleBlock record = record_of(device);
    const std::size_t at = 100'000 + random() % 100'000;
    for (std::size_t i = at; i < at + 3; ++i) { // a knock of half a turn and back
      record.values[i] = 2.0 * device.ellipse.p - record.values[i];
      record.values[record.samples + i] =
          2.0 * device.ellipse.q - record.values[record.samples + i];
    }
    const CollectingSink sink = run(settings_of(device), device, {cut(record, random())});
    const std::vector<double> displacement = sink.channel(1);
    std::size_t near = 0;
    std::size_t elsewhere = 0;
    for (std::size_t i = 0; i < displacement.size(); ++i) {
      const auto distance =
          std::abs(static_cast<double>(sink.numbers[i]) - static_cast<double>(at) / 5.0);
      if (std::isnan(displacement[i]) && sink.numbers[i] * 5 > 60'000) {
        ++(distance < 12.0 ? near : elsewhere);
      }
    }
    EXPECT_GE(near, 20U);
    EXPECT_EQ(elsewhere, 0U);
    ASSERT_EQ(sink.warnings.size(), 1U);
    EXPECT_THAT(sink.warnings.front(), HasSubstr("quarter of a turn"));
    ASSERT_FALSE(sink.counts.causes.empty());
    EXPECT_EQ(sink.counts.causes.front().name, "pairs of doubtful phase");
    EXPECT_LT(std::abs(phasor(device, sink.stamps_ns, displacement) / truth(device) - 1.0), 1e-4);
  }
}

TEST(InterferometerSource, MakesAGapOfLostSamples) {
  DeviceSettings device;
  const SampleBlock record = record_of(device);
  std::mt19937_64 random(12);
  const std::size_t first = 120'000 + random() % 1000;
  const std::size_t lost = 1 + random() % 999;
  const std::size_t rest = record.samples - first - lost;
  const CollectingSink sink =
      run(settings_of(device), device,
          {{part_of(record, 0, first), part_of(record, first + lost, rest)}});
  std::size_t gaps = 0;
  for (std::size_t i = 1; i < sink.numbers.size(); ++i) {
    gaps += sink.numbers[i] != sink.numbers[i - 1] + 1 ? 1 : 0;
    ASSERT_EQ(sink.stamps_ns[i], 1000 + static_cast<std::int64_t>(sink.numbers[i]) * 10'000);
  }
  EXPECT_EQ(gaps, 1U);
  EXPECT_GE(sink.counts.lost_in_device, 20U);
  EXPECT_LE(sink.counts.lost_in_device, 22U + lost / 5);
  EXPECT_LT(std::abs(phasor(device, sink.stamps_ns, sink.channel(1)) / truth(device) - 1.0), 1e-4);
}

TEST(InterferometerSource, KeepsTheEllipseOfASessionBefore) {
  DeviceSettings device;
  const SampleBlock record = record_of(device);
  const CollectingSink sink = run(settings_of(device), device, {cut(record, 1), cut(record, 2)});
  ASSERT_EQ(sink.sessions_begun_at.size(), 2U);
  std::size_t missing = 0;
  for (std::size_t i = sink.sessions_begun_at[1]; i < sink.blocks.size(); ++i) {
    missing += not_measured(column_of(sink.blocks[i], 1));
  }
  EXPECT_EQ(missing, 0U);
}

TEST(InterferometerSource, SaysWhatIsWrongWithTheSignals) {
  DeviceSettings device;
  device.seconds = 1.5;
  SampleBlock interrupted = record_of(device);
  for (std::size_t i = 300'000; i < 350'000; ++i) {
    interrupted.values[i] = device.ellipse.p;
    interrupted.values[interrupted.samples + i] = device.ellipse.q;
  }
  const CollectingSink dark = run(settings_of(device), device, {cut(interrupted, 4)});
  ASSERT_EQ(dark.warnings.size(), 1U);
  EXPECT_THAT(dark.warnings.front(), HasSubstr("fifth of the radius"));
  std::size_t in_the_dark = 0;
  const std::vector<double> displacement = dark.channel(1);
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    in_the_dark += std::isnan(displacement[i]) && dark.numbers[i] > 50'000 ? 1 : 0;
  }
  EXPECT_GE(in_the_dark, 10'000U);
  EXPECT_LE(in_the_dark, 10'022U);

  DeviceSettings narrow = device;
  narrow.range_v = 0.6;
  SampleBlock clipped = record_of(narrow);
  for (double& value : std::span(clipped.values).first(2 * clipped.samples)) {
    value = std::clamp(value, -0.6, 0.6);
  }
  InterferometerSettings known = settings_of(narrow);
  known.ellipse = StatedEllipse{.ellipse = narrow.ellipse, .from = "a test"};
  const CollectingSink full = run(known, narrow, {cut(clipped, 5)});
  ASSERT_GE(full.warnings.size(), 1U);
  EXPECT_THAT(full.warnings.front(), HasSubstr("end of the range"));
  EXPECT_GT(not_measured(full.channel(1)), 1000U);
}

TEST(InterferometerSource, RefusesWhatCannotBe) {
  const DeviceSettings device;
  const auto refusal = [&](auto change) {
    InterferometerSettings settings = settings_of(device);
    drivers::SourceDescription description = description_of(device);
    change(settings, description);
    InterferometerSource source(
        settings, std::make_unique<SimulatedDevice>(description, SimulatedDevice::Sessions{}));
    const auto described = source.describe();
    return described ? std::string("accepted") : described.error().message;
  };
  EXPECT_THAT(refusal([](auto& settings, auto&) { settings.u2 = "u3"; }),
              HasSubstr("no such channel; it has: u1, u2, sync"));
  EXPECT_THAT(refusal([](auto& settings, auto&) { settings.channel = "sync"; }),
              HasSubstr("has one of that name"));
  EXPECT_THAT(refusal([](auto& settings, auto&) { settings.output_rate_hz = 70'000.0; }),
              HasSubstr("output_rate_hz = 70000"));
  EXPECT_THAT(refusal([](auto&, auto& description) { description.nominal_rate_hz = 0.0; }),
              HasSubstr("constant sample rate"));
  EXPECT_THAT(refusal([](auto&, auto& description) { description.channels[1].unit = "\\one"; }),
              HasSubstr("two units"));
  EXPECT_EQ(refusal([](auto& settings, auto&) { settings.output_rate_hz = 50'000.0; }), "accepted");
}

} // namespace
} // namespace dyncal::tests
