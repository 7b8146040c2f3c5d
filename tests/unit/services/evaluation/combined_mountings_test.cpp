#include "services/evaluation/combined_mountings.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

constexpr double u_reference = 1e-3; // the same in all mountings
constexpr double u_noise = 3e-4;     // of one repetition
constexpr int frequencies = 5;
constexpr int repetitions = 3;

StepResult result_of(int frequency, int repetition, double magnitude, double phase_rad) {
  StepResult result;
  result.channel = "dau/acceleration_z";
  result.step = static_cast<std::uint32_t>(frequency + 1);
  result.repetition = static_cast<std::uint32_t>(repetition + 1);
  result.frequency_text_hz = std::to_string(10 * (frequency + 1));
  result.frequency_hz = 10.0 * (frequency + 1);
  result.level_m_s2 = 10.0;
  result.valid = true;
  result.magnitude = magnitude;
  result.phase_rad = phase_rad;
  result.unit = R"(\one)";
  analysis::Contribution reference{.kind = analysis::ContributionKind::reference};
  reference.u_magnitude_rel = reference.u_phase_rad = u_reference;
  analysis::Contribution noise{.kind = analysis::ContributionKind::fit_noise,
                               .subject = "the sensor"};
  noise.u_magnitude_rel = noise.u_phase_rad = u_noise;
  result.budget = {reference, noise};
  result.u_magnitude = magnitude * std::hypot(u_reference, u_noise);
  result.u_phase_rad = std::hypot(u_reference, u_noise);
  return result;
}

// A laboratory with its reference, a sensor that is mounted again and again; the truth is 1.
class Laboratory {
public:
  explicit Laboratory(unsigned seed)
      : generator_(seed), reference_(1.0 + u_reference * normal_(generator_)) {}

  std::vector<StepResult> run(double u_mounting) {
    const double mounting = 1.0 + u_mounting * normal_(generator_);
    std::vector<StepResult> results;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
      for (int frequency = 0; frequency < frequencies; ++frequency) {
        results.push_back(result_of(frequency, repetition,
                                    reference_ * mounting * (1.0 + u_noise * normal_(generator_)),
                                    u_noise * normal_(generator_)));
      }
    }
    return results;
  }

private:
  std::mt19937 generator_;
  std::normal_distribution<double> normal_;
  double reference_;
};

TransferFunction combined(const std::vector<std::vector<StepResult>>& runs) {
  std::vector<StepResult> all;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (const StepResult& one : mounting_results(runs[i], static_cast<std::uint32_t>(i + 1))) {
      all.push_back(one);
    }
  }
  const auto functions = combined_functions(all, static_cast<std::uint32_t>(runs.size()));
  return functions.empty() ? TransferFunction() : functions.front();
}

TEST(CombinedMountings, MakeOneResultOfTheRepetitionsOfEach) {
  Laboratory laboratory(1);
  const auto results = mounting_results(laboratory.run(0.0), 2);
  ASSERT_EQ(results.size(), static_cast<std::size_t>(frequencies));
  EXPECT_EQ(results.front().repetition, 2U);
  ASSERT_EQ(results.front().budget.size(), 2U);
  EXPECT_EQ(results.front().budget[0].u_magnitude_rel, u_reference);
  EXPECT_EQ(results.front().budget[0].repeats, analysis::Repeats::common);
  EXPECT_EQ(results.front().budget[1].repeats, analysis::Repeats::anew);
  EXPECT_LT(results.front().budget[1].u_magnitude_rel, u_noise); // of a mean
  EXPECT_GT(results.front().budget[1].u_magnitude_rel, 0.3 * u_noise);
}

// The reference does not average, whatever is mounted how often.
TEST(CombinedMountings, KeepWhatAllHaveInCommon) {
  Laboratory laboratory(2);
  std::vector<std::vector<StepResult>> runs;
  for (int i = 0; i < 8; ++i) {
    runs.push_back(laboratory.run(0.0));
  }
  const TransferFunction function = combined(runs);
  ASSERT_EQ(function.points.size(), static_cast<std::size_t>(frequencies));
  EXPECT_EQ(function.points[0].mean.repetitions, 8U);
  EXPECT_GT(function.points[0].mean.u_magnitude, 0.99 * u_reference);
  EXPECT_LT(function.points[0].mean.u_magnitude, 1.2 * u_reference);
}

TEST(CombinedMountings, LeaveOutWhatOneOfThemLacks) {
  Laboratory laboratory(3);
  std::vector<std::vector<StepResult>> runs{laboratory.run(0.0), laboratory.run(0.0)};
  std::erase_if(runs[1], [](const StepResult& one) { return one.frequency_hz == 20.0; });
  for (StepResult& one : runs[0]) {
    one.valid = one.frequency_hz != 30.0;
  }
  const TransferFunction function = combined(runs);
  ASSERT_EQ(function.points.size(), static_cast<std::size_t>(frequencies - 2));
  EXPECT_EQ(function.points[1].frequency_hz, 40.0);
}

// U covers the truth in 200 draws as often as it says, with mountings that differ by more than
// anything else, by as much, and not at all; and it is no wider than what they differ by explains.
TEST(CombinedMountings, CoverTheTruth) {
  constexpr int draws = 200;
  constexpr int least = 180; // of 200 at 95.45 %: less has a chance below 1e-3
  for (const double u_mounting : {3e-3, 1e-3, 0.0}) {
    int covered = 0;
    std::vector<double> expanded;
    for (unsigned draw = 0; draw < draws; ++draw) {
      Laboratory laboratory(1000 + draw);
      const TransferFunction function =
          combined({laboratory.run(u_mounting), laboratory.run(u_mounting),
                    laboratory.run(u_mounting), laboratory.run(u_mounting)});
      ASSERT_EQ(function.points.size(), static_cast<std::size_t>(frequencies));
      const analysis::RepetitionMean& mean = function.points[draw % frequencies].mean;
      const double of_mean = 2.0 * mean.u_magnitude;
      covered += std::abs(mean.magnitude - 1.0) <= of_mean ? 1 : 0;
      expanded.push_back(of_mean);
    }
    EXPECT_GE(covered, least) << u_mounting;
    std::nth_element(expanded.begin(), expanded.begin() + draws / 2, expanded.end());
    const double sigma = std::hypot(u_reference, 0.5 * u_mounting, 0.3 * u_noise);
    EXPECT_LT(expanded[draws / 2], 2.0 * 1.7 * sigma) << u_mounting; // k of 3 degrees of freedom
    EXPECT_GT(expanded[draws / 2], 2.0 * 0.8 * sigma) << u_mounting;
  }
}

} // namespace
} // namespace dyncal::inline evaluation
