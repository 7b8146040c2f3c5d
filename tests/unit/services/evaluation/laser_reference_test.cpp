// A reference that is the displacement of a laser interferometer: what comes out of it, what is
// flagged, and what is not.
#include <algorithm>
#include <cmath>
#include <complex>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/level_watch.hpp"
#include "services/evaluation/record/source_record.hpp"
#include "services/evaluation/result/result_flag.hpp"
#include "tests/unit/services/evaluation/laser_run.hpp"

namespace dyncal::inline evaluation {
namespace {

using analysis::ContributionKind;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::array of_interferometer{
    ContributionKind::interferometer_ellipse, ContributionKind::periodic_error,
    ContributionKind::wavelength, ContributionKind::detector_bandwidth,
    ContributionKind::detector_skew};

const analysis::Contribution* row_of(const StepResult& result, ContributionKind kind) {
  const auto found = std::ranges::find(result.budget, kind, &analysis::Contribution::kind);
  return found == result.budget.end() ? nullptr : &*found;
}

std::complex<double> ratio(const StepResult& result, const tests::LaserRun& run) {
  return std::polar(result.magnitude, result.phase_rad) / run.truth();
}

// Steps from 10 Hz to 10 kHz, each on a table that drifts by thousands of times the highest step's
// amplitude, and hums.
tests::LaserRun sound_run(std::uint64_t seed) {
  tests::LaserRun run{.seed = seed};
  run.steps = {{"10", 1.0},    {"20", 5.0},    {"63", 10.0},    {"160", 10.0},
               {"1000", 20.0}, {"2500", 50.0}, {"10000", 200.0}};
  return run;
}

TEST(LaserReference, GivesTheResponsePerAcceleration) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const tests::LaserRun run = sound_run(seed);
    const auto results = evaluate(run);
    ASSERT_EQ(results.size(), run.steps.size());
    for (std::size_t i = 0; i < results.size(); ++i) {
      const StepResult& result = results[i];
      ASSERT_TRUE(result.valid) << result.problem;
      EXPECT_EQ(result.unit, "(V)/(m/s^2)");
      const std::complex<double> off = ratio(result, run);
      EXPECT_LT(std::abs(std::abs(off) - 1.0), 4.0 * result.u_magnitude / result.magnitude)
          << result.frequency_text_hz << " Hz, seed " << seed;
      EXPECT_LT(std::abs(std::arg(off)), 4.0 * result.u_phase_rad)
          << result.frequency_text_hz << " Hz, seed " << seed;
      EXPECT_LT(result.u_magnitude / result.magnitude, 2e-2) << result.frequency_text_hz;
      for (const ContributionKind kind : of_interferometer) {
        EXPECT_NE(row_of(result, kind), nullptr);
      }
      EXPECT_NEAR(result.fits.front().fit.amplitude(), run.steps[i].level_m_s2,
                  0.02 * run.steps[i].level_m_s2);
    }
  }
}

TEST(LaserReference, IsNotFlaggedWhereItIsSound) {
  for (std::uint64_t seed = 11; seed <= 14; ++seed) {
    for (const StepResult& result : evaluate(sound_run(seed))) {
      for (const Flag& flag : result.flags) {
        EXPECT_THAT(flag.sentence, testing::Not(HasSubstr("displacement")))
            << result.frequency_text_hz << " Hz, seed " << seed;
      }
      const auto* structure = row_of(result, ContributionKind::structure);
      if (structure != nullptr) {
        EXPECT_LT(structure->u_magnitude_rel, result.u_magnitude / result.magnitude)
            << result.frequency_text_hz << " Hz, seed " << seed;
      }
    }
  }
}

TEST(LaserReference, IsFlaggedWhereSamplesAreBesideTheSine) {
  for (std::uint64_t seed = 21; seed <= 25; ++seed) {
    tests::LaserRun run{.seed = seed};
    std::mt19937_64 random(seed);
    const std::size_t every = 80 + random() % 40;
    run.fault = [every](std::size_t i, double& displacement, double&) {
      if (i % every == 0) {
        displacement += 316e-9; // a turn, in one sample
      }
    };
    const auto results = evaluate(run);
    ASSERT_EQ(results.size(), 1U);
    EXPECT_THAT(sentences_of(results.front().flags), testing::Contains(HasSubstr("displacement")));
  }
}

TEST(LaserReference, IsFlaggedWhereItIsClippedOrHeld) {
  tests::LaserRun held{.seed = 31};
  held.fault = [last = 0.0](std::size_t i, double& displacement, double&) mutable {
    if (i % 10 != 0) {
      displacement = last;
    }
    last = displacement;
  };
  EXPECT_THAT(sentences_of(evaluate(held).front().flags),
              testing::Contains(HasSubstr("displacement")));
}

TEST(LaserReference, IsRefusedWithoutTheKnowledgeOfItsErrors) {
  const tests::LaserRun run{.seed = 41};
  drivers::QuadratureSignals signals = run.description().quadrature_signals.front();
  signals.periodic_error_rad.clear();
  const auto short_arc = evaluate(run, 0.0, {signals});
  ASSERT_EQ(short_arc.size(), 1U);
  EXPECT_FALSE(short_arc.front().valid);
  EXPECT_THAT(short_arc.front().problem, HasSubstr("has not seen a whole turn"));
  signals.u_ellipse_rad.clear();
  signals.radius_u1 = 0.0;
  EXPECT_THAT(evaluate(run, 0.0, {signals}).front().problem, HasSubstr("ellipse"));
}

// A better ellipse is in the budget of the steps behind it.
TEST(LaserReference, TakesTheErrorsThatAreDescribedLast) {
  tests::LaserRun run{.seed = 51};
  run.steps = {{"160"}, {"160"}};
  drivers::QuadratureSignals signals = run.description().quadrature_signals.front();
  signals.u_wavelength_rel = 7e-4;
  const auto results = evaluate(run, 0.55, {signals});
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(row_of(results[0], ContributionKind::wavelength)->u_magnitude_rel, 2e-6);
  EXPECT_EQ(row_of(results[1], ContributionKind::wavelength)->u_magnitude_rel, 7e-4);
}

TEST(LaserReference, IsADisplacementWhereNobodyKnowsMore) {
  tests::LaserRun run{.seed = 61};
  run.is_known = false;
  run.drift_m_s = run.hum_m = run.table_m_s2_sd = 0.0;
  const auto results = evaluate(run);
  ASSERT_EQ(results.size(), 1U);
  ASSERT_TRUE(results.front().valid) << results.front().problem;
  EXPECT_EQ(results.front().unit, "(V)/(m)");
  for (const ContributionKind kind : of_interferometer) {
    EXPECT_EQ(row_of(results.front(), kind), nullptr);
  }
}

TEST(LaserReference, IsHeldAgainstThePlannedLevel) {
  tests::LaserRun run{.seed = 71};
  EXPECT_THAT(sentences_of(evaluate(run).front().flags),
              testing::Not(testing::Contains(HasSubstr("in place of"))));
  run.level_factor = 1.2;
  EXPECT_THAT(sentences_of(evaluate(run).front().flags),
              testing::Contains(HasSubstr("12 m/s^2 in place of 10 m/s^2")));
}

std::vector<std::string> alarms(const tests::LaserRun& run) {
  const Recipe recipe = run.recipe();
  LevelWatch watch(recipe);
  SourceRecord record("acs");
  record.describe(run.description());
  std::vector<std::string> sentences;
  std::uint64_t number = 0;
  for (const drivers::SampleBlock& block : run.blocks()) {
    contract::SourceBlock view = contract::view_block(block, 1, ++number);
    view.channels = 3;
    record.add(view);
    if (auto sentence = watch.look(record, recipe.steps.front())) {
      sentences.push_back(std::move(*sentence));
    }
  }
  return sentences;
}

TEST(LaserReference, IsWatchedForItsLevel) {
  tests::LaserRun run{.seed = 81};
  EXPECT_THAT(alarms(run), IsEmpty());
  run.level_factor = 5.0;
  const auto sentences = alarms(run);
  ASSERT_FALSE(sentences.empty());
  EXPECT_THAT(sentences, testing::Contains(HasSubstr("acs/displacement shows 50 m/s^2 where 10")));
}

} // namespace
} // namespace dyncal::inline evaluation
