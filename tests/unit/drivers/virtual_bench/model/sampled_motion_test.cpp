#include "drivers/virtual_bench/model/sampled_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "drivers/virtual_bench/model/random.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double interval_s = 2e-6 * (1.0 + 3e-7);

struct Samples {
  std::vector<double> displacement_m;
  std::vector<double> sync_v;
};

void sample_until(SampledMotion& motion, std::uint64_t to, const Excitation& excitation,
                  Samples& samples) {
  SampledMotion::Block displacement_m{};
  SampledMotion::Block sync_v{};
  for (std::uint64_t from = samples.sync_v.size(); from < to;) {
    const std::uint64_t place = from % SampledMotion::block_samples;
    const std::uint64_t end = std::min(to, from - place + SampledMotion::block_samples);
    motion.sample(from, end, excitation, displacement_m, sync_v);
    for (std::uint64_t k = place; k < place + end - from; ++k) {
      samples.displacement_m.push_back(displacement_m[k]);
      samples.sync_v.push_back(sync_v[k]);
    }
    from = end;
  }
}

Drive multisine() {
  return {.on = true, .lines = {{10.1, 0.05, 0.3}, {33.1, 0.2, 1.1}, {79.9, 0.4, -2.0}}};
}

ExciterModel exciter_of(Random& random) {
  ExciterModel exciter;
  exciter.second_phase_rad = random.uniform(0.0, 6.0);
  exciter.third_phase_rad = random.uniform(0.0, 6.0);
  return exciter;
}

// Every sample of a bench that is switched now and then must be what the excitation says of its
// instant alone.
TEST(SampledMotion, IsTheExcitationAtEveryInstant) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed, "sampled motion");
    Excitation excitation(exciter_of(random));
    const double delay_s = seed == 1 ? 0.0 : random.uniform(0.0, 1e-7);
    SampledMotion motion(interval_s, delay_s, 1.0, {.amplitude_v = 9.75});
    Samples samples;
    const std::vector<Drive> drives{{20.0, 0.1, true}, {20.0, 0.0, false}, {250.0, 2.0, true},
                                    {80.0, 2.0, true}, multisine(),        {160.0, 1.0, false}};
    for (const Drive& drive : drives) {
      const double change_s = static_cast<double>(samples.sync_v.size()) * interval_s;
      const std::size_t first = samples.sync_v.size();
      excitation.change(change_s, drive);
      sample_until(motion, first + 7'000 + static_cast<std::uint64_t>(random.uniform(0.0, 900.0)),
                   excitation, samples);
      // Samples whose light left before the change are a matter of the delay.
      for (std::size_t i = first + 1; i < samples.sync_v.size(); i += 97) {
        const double at_s = static_cast<double>(i) * interval_s;
        double displacement_m = 0.0;
        double sync_v = 0.0;
        for (std::size_t line = 0; line < excitation.lines(); ++line) {
          const Motion one = excitation.motion(at_s, line);
          displacement_m += excitation.displacement(at_s - delay_s, line);
          sync_v += one.sync_on ? 9.75 * one.sync_part * one.sine : 0.0;
        }
        ASSERT_NEAR(samples.displacement_m[i], displacement_m, 1e-14) << seed << ", sample " << i;
        ASSERT_NEAR(samples.sync_v[i], sync_v, 1e-9) << seed << ", sample " << i;
      }
    }
    EXPECT_GT(*std::ranges::max_element(samples.displacement_m), 1e-4);
  }
}

// The second derivative of what an interferometer sees is what an accelerometer feels, once the
// suspension has come to rest.
TEST(SampledMotion, IsTheDoubleIntegralOfTheAcceleration) {
  Random random(7, "integral");
  for (const double frequency_hz : {10.0, 80.0, 160.0, 1000.0}) {
    Excitation excitation(exciter_of(random));
    excitation.change(0.01, {frequency_hz, 0.5, true});
    const double step_s = 0.002 / frequency_hz;
    for (double at_s = 0.6; at_s < 0.6 + 1.0 / frequency_hz; at_s += 0.037 / frequency_hz) {
      const double second_m = excitation.displacement(at_s + step_s) -
                              2.0 * excitation.displacement(at_s) +
                              excitation.displacement(at_s - step_s);
      const double felt_m_s2 = excitation.acceleration(excitation.motion(at_s), {});
      EXPECT_NEAR(second_m / (step_s * step_s), felt_m_s2, 25.0 * 5e-5)
          << frequency_hz << " Hz at " << at_s;
    }
  }
}

TEST(SampledMotion, NeitherJumpsNorKicksAtAChange) {
  Excitation excitation{ExciterModel{}};
  constexpr double changes_s[] = {0.1, 0.7, 0.7, 1.3, 1.35};
  const Drive drives[] = {{20.0, 0.1, true},
                          {20.0, 0.0, false},
                          {25.0, 0.0, false},
                          {25.0, 0.2, true},
                          {25.0, 0.0, false}};
  for (int i = 0; i < 5; ++i) {
    const double at_s = changes_s[i];
    const double before_m = excitation.displacement(at_s);
    const double velocity_m_s = (before_m - excitation.displacement(at_s - 1e-5)) / 1e-5;
    excitation.change(at_s, drives[i]);
    EXPECT_NEAR(excitation.displacement(at_s), before_m, 1e-12);
    EXPECT_NEAR((excitation.displacement(at_s + 1e-5) - before_m) / 1e-5, velocity_m_s, 1e-3);
  }
  EXPECT_LT(std::abs(excitation.displacement(2.5)), 1e-12); // at rest again
}

TEST(SampledMotion, HasTheFirstOutputAsSyncWhereThatIsAskedFor) {
  Excitation excitation{ExciterModel{}};
  SampledMotion motion(interval_s, 0.0, 1.0, {.amplitude_v = 9.75, .is_first_output = true});
  excitation.change(0.0, {100.0, 0.4, true});
  Samples samples;
  sample_until(motion, 10'000, excitation, samples);
  EXPECT_NEAR(*std::ranges::max_element(samples.sync_v), 0.4, 1e-3);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
