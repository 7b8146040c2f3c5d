#include "analysis/method/record_fit.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double frequency_hz = 79.98;
constexpr std::int64_t begin_ns = 1'700'000'000'000'000'000;

struct Series {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
};

// 2.5 sin(w (t - begin) + 0.4) + 1, with noise; the stamps are off by `stamp_sd_s` from where the
// samples were taken.
Series series(unsigned seed, double stamp_sd_s = 0.0) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Series drawn;
  for (int i = 0; i < 5000; ++i) {
    const double t_s = 1e-3 * i;
    drawn.stamps_ns.push_back(begin_ns + std::llround(1e9 * (t_s + stamp_sd_s * normal(random))));
    drawn.values.push_back(2.5 * std::sin(2.0 * std::numbers::pi * frequency_hz * t_s + 0.4) + 1.0 +
                           1e-3 * normal(random));
  }
  return drawn;
}

Expected<RecordFit> fit(const Series& record, const RecordFitSettings& settings,
                        const RecordFitStages& begin = {}) {
  const std::vector<std::span<const double>> columns{record.values};
  return fit_record(settings, record.stamps_ns, columns, begin);
}

RecordFitSettings known_frequency() {
  RecordFitSettings settings;
  settings.frequency = *Frequency::parse("79.98");
  settings.phase_origin_ns = begin_ns;
  return settings;
}

TEST(RecordFit, AnEvenRecordIsFittedAsBySineFit) {
  const Series record = series(1);
  const auto found = fit(record, known_frequency());
  ASSERT_TRUE(found) << found.error().message;
  const std::vector<std::span<const double>> columns{record.values};
  const auto plain =
      fit_sine(*Frequency::parse("79.98"), begin_ns, record.stamps_ns, columns).value();
  EXPECT_EQ(found->fits[0].sine, plain[0].sine);
  EXPECT_EQ(found->fits[0].rss, plain[0].rss);
  EXPECT_EQ(found->shortening_rel, std::vector{0.0});
  EXPECT_FALSE(found->u_frequency_hz);
  EXPECT_NEAR(found->fits[0].phase_rad(), 0.4, 1e-4);
}

TEST(RecordFit, AFrequencyThatIsNotGivenIsFoundAndSaid) {
  std::vector<std::string> stages;
  const auto found = fit(series(2), {}, [&](std::string_view stage) -> Progress {
    stages.emplace_back(stage);
    return {};
  });
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->u_frequency_hz);
  EXPECT_NEAR(found->frequency.hz(), frequency_hz, 5.0 * *found->u_frequency_hz);
  EXPECT_EQ(stages,
            (std::vector<std::string>{"estimating the frequency", "fitting the frequency"}));
}

TEST(RecordFit, WhatScatterOfStampsTakesOffIsPutBack) {
  const auto found = fit(series(3, 1e-4), known_frequency());
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_GT(found->shortening_rel[0], 5e-4);
  EXPECT_NEAR(found->fits[0].amplitude(), 2.5, 4.0 * found->fits[0].u_amplitude());
}

TEST(RecordFit, FailsWithoutSamplesAndWithoutASine) {
  EXPECT_EQ(fit({}, {}).error().code, ErrorCode::too_few_samples);
  Series record = series(4);
  record.values.assign(record.values.size(), 1.0);
  EXPECT_EQ(fit(record, {}).error().code, ErrorCode::no_excitation);
}

} // namespace
} // namespace dyncal::analysis
