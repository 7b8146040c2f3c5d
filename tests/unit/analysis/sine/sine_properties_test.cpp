// What must hold of every sine approximation, tried on records that nobody thought of: bits that do
// not change, phases that only turn.
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::int64_t epoch_ns = 1'700'000'000'123'456'789;

struct DrawnRecord {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  Frequency frequency = Frequency::from_hz(1.0);
};

DrawnRecord drawn_record() {
  DrawnRecord record;
  const auto samples = *rc::gen::inRange<int>(20, 1500);
  const auto interval_ns = *rc::gen::inRange<std::int64_t>(1'000, 5'000'000);
  const std::int64_t jitter_ns = *rc::gen::element(std::int64_t{0}, interval_ns / 10'000,
                                                   interval_ns / 100, interval_ns / 2 - 1);
  const auto steps = *rc::gen::container<std::vector<std::int64_t>>(
      static_cast<std::size_t>(samples),
      rc::gen::inRange<std::int64_t>(interval_ns - jitter_ns, interval_ns + jitter_ns + 1));
  const double turns_per_interval = 1e-3 * *rc::gen::inRange<int>(5, 200);
  record.frequency =
      Frequency::from_hz(turns_per_interval * 1e9 / static_cast<double>(interval_ns));
  std::int64_t stamp_ns = epoch_ns;
  for (const std::int64_t step : steps) {
    const double angle =
        2.0 * std::numbers::pi * record.frequency.reduced_turns(stamp_ns - epoch_ns);
    const double noise = 1e-3 * *rc::gen::inRange<int>(-50, 51);
    record.stamps_ns.push_back(stamp_ns);
    record.values.push_back(3.0 * std::sin(angle + 0.4) + 0.5 + noise);
    stamp_ns += step;
  }
  return record;
}

SineFit fitted(const DrawnRecord& record, std::int64_t phase_origin_ns = epoch_ns) {
  const std::vector<std::span<const double>> channels{record.values};
  auto fit = fit_sine(record.frequency, phase_origin_ns, record.stamps_ns, channels);
  RC_ASSERT(fit.has_value());
  return fit->front();
}

bool same_bits(const SineFit& a, const SineFit& b) {
  return a.sine == b.sine && a.cosine == b.cosine && a.offset == b.offset && a.rss == b.rss &&
         a.covariance == b.covariance;
}

RC_GTEST_PROP(SineProperties, LaterByAnyTimeGivesTheSameBits, ()) {
  DrawnRecord record = drawn_record();
  const SineFit before = fitted(record);
  const auto later_ns =
      *rc::gen::inRange<std::int64_t>(-1'000'000'000'000'000'000, 1'000'000'000'000'000'000);
  for (std::int64_t& stamp : record.stamps_ns) {
    stamp += later_ns;
  }
  RC_ASSERT(same_bits(fitted(record, epoch_ns + later_ns), before));
}

RC_GTEST_PROP(SineProperties, ValuesTwiceAsLargeGiveTwiceTheCoefficients, ()) {
  DrawnRecord record = drawn_record();
  const SineFit before = fitted(record);
  const double factor = std::ldexp(1.0, *rc::gen::inRange<int>(-30, 30));
  for (double& value : record.values) {
    value *= -factor;
  }
  const SineFit after = fitted(record);
  RC_ASSERT(after.sine == -factor * before.sine);
  RC_ASSERT(after.cosine == -factor * before.cosine);
  RC_ASSERT(after.offset == -factor * before.offset);
  RC_ASSERT(after.rss == factor * factor * before.rss);
}

RC_GTEST_PROP(SineProperties, AnotherReferenceInstantOnlyTurnsThePhasor, ()) {
  const DrawnRecord record = drawn_record();
  const auto later_ns =
      *rc::gen::inRange<std::int64_t>(0, record.stamps_ns.back() - record.stamps_ns.front());
  const SineFit here = fitted(record);
  const SineFit there = fitted(record, epoch_ns + later_ns);
  const double turned =
      here.phase_rad() + 2.0 * std::numbers::pi * record.frequency.reduced_turns(later_ns);
  RC_ASSERT(std::abs(std::remainder(there.phase_rad() - turned, 2.0 * std::numbers::pi)) < 1e-11);
  RC_ASSERT(std::abs(there.amplitude() / here.amplitude() - 1.0) < 1e-11);
  RC_ASSERT(std::abs(there.u_phase_rad() / here.u_phase_rad() - 1.0) < 1e-7);
}

} // namespace
} // namespace dyncal::analysis
