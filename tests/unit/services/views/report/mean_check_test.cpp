#include "services/views/report/mean_check.hpp"

#include <cmath>
#include <random>

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/base/version.hpp"
#include "services/evaluation/mean_points.hpp"
#include "services/views/report/result_json.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline views {
namespace {

constexpr double u_single = 1e-3; // relative, and in rad

StepResult single_result(double frequency_hz, std::uint32_t repetition, std::mt19937& draw) {
  std::normal_distribution<double> noise(0.0, u_single);
  StepResult result = tests::example_result(repetition, fmt::format("{}", frequency_hz));
  result.repetition = repetition;
  result.valid = true;
  result.magnitude = 100.0 / frequency_hz * (1.0 + noise(draw));
  result.u_magnitude = u_single * result.magnitude;
  result.phase_rad = -0.01 * frequency_hz + noise(draw);
  result.u_phase_rad = u_single;
  result.budget = {{.kind = analysis::ContributionKind::fit_noise,
                    .subject = "the sensor",
                    .repeats = analysis::Repeats::anew,
                    .u_magnitude_rel = u_single,
                    .u_phase_rad = u_single}};
  return result;
}

// Three frequencies, five repetitions, by an analysis of `software`.
RunOutcome measured_outcome(const std::string& software, std::mt19937& draw) {
  RunOutcome outcome = tests::example_outcome();
  outcome.analysis_software = software;
  outcome.results.clear();
  for (const double frequency_hz : {10.0, 40.0, 160.0}) {
    for (std::uint32_t repetition = 1; repetition <= 5; ++repetition) {
      outcome.results.push_back(single_result(frequency_hz, repetition, draw));
    }
  }
  std::vector<const StepResult*> singles;
  for (const StepResult& result : outcome.results) {
    singles.push_back(&result);
  }
  outcome.transfer_functions.resize(1);
  outcome.transfer_functions.front().group_delay.reset();
  outcome.transfer_functions.front().points = mean_points(singles);
  return outcome;
}

class MeanCheck : public testing::Test {
protected:
  // What check_means() refuses; empty: nothing.
  [[nodiscard]] std::string refusal_of(const RunOutcome& outcome) const {
    const auto path = folder_.path() / "result.json";
    EXPECT_TRUE(write_json(path, result_json(outcome)));
    const auto result = read_result(path);
    EXPECT_TRUE(!result || result->values.size() == 3 || result->values.size() == 2);
    if (!result) {
      return result.error().message;
    }
    const auto checked = check_means(*result);
    return checked ? "" : checked.error().message;
  }
  analysis::RepetitionMean& drawn_mean(RunOutcome& outcome) {
    auto& points = outcome.transfer_functions.front().points;
    return points[std::uniform_int_distribution<std::size_t>(0, points.size() - 1)(draw_)].mean;
  }

  tests::TemporaryFolder folder_;
  std::mt19937 draw_{17};
};

TEST_F(MeanCheck, ReadsWhatThisVersionAndOthersWrite) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(refusal_of(measured_outcome(software_version(), draw_)), "");
    EXPECT_EQ(refusal_of(measured_outcome("dyncal 0.1.9", draw_)), "");
  }
}

TEST_F(MeanCheck, RefusesAMeanThatWasChangedBeyondRounding) {
  std::uniform_real_distribution<double> times_u(0.02, 3.0);
  for (int i = 0; i < 20; ++i) {
    RunOutcome outcome = measured_outcome(software_version(), draw_);
    analysis::RepetitionMean& mean = drawn_mean(outcome);
    switch (i % 4) {
    case 0:
      mean.magnitude += times_u(draw_) * mean.u_magnitude;
      break;
    case 1:
      mean.phase_rad -= times_u(draw_) * mean.u_phase_rad;
      break;
    case 2:
      mean.u_magnitude *= 0.5;
      break;
    default:
      mean.u_phase_rad *= 2.0;
      break;
    }
    EXPECT_NE(refusal_of(outcome).find("a mean is not that of its single results"),
              std::string::npos)
        << i;
  }
}

TEST_F(MeanCheck, RefusesAMeanOfAnotherVersionThatLiesNotAmongItsPoints) {
  std::uniform_real_distribution<double> factor(1.05, 42.0);
  for (int i = 0; i < 20; ++i) {
    RunOutcome outcome = measured_outcome("dyncal 0.1.9", draw_);
    analysis::RepetitionMean& mean = drawn_mean(outcome);
    switch (i % 3) {
    case 0:
      mean.magnitude *= factor(draw_);
      break;
    case 1:
      mean.magnitude /= factor(draw_);
      break;
    default:
      mean.phase_rad += 0.05;
      break;
    }
    EXPECT_NE(refusal_of(outcome).find("a mean is not that of its single results"),
              std::string::npos)
        << i;
  }
}

// Another version may weigh repetitions otherwise.
TEST_F(MeanCheck, ReadsAMeanOfAnotherVersionThatLiesAmongItsPoints) {
  for (int i = 0; i < 20; ++i) {
    RunOutcome outcome = measured_outcome("dyncal 0.1.9", draw_);
    analysis::RepetitionMean& mean = drawn_mean(outcome);
    mean.magnitude *= 1.0 + 0.5 * u_single;
    mean.u_magnitude *= 1.3;
    EXPECT_EQ(refusal_of(outcome), "");
  }
}

} // namespace
} // namespace dyncal::inline views
