// Series made by recipe and their least-squares answers, computed with 60 digits by
// make_sine_vectors.py.
#include <cmath>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>

#include "analysis/sine/extended_sine_fit.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "tests/vectors/recipe_series.hpp"

namespace dyncal::analysis {
namespace {

struct Limits {
  double value;
  double uncertainty;
};

void expect_answer(const SineFit& fit, const Json& answer, Limits limits) {
  const double amplitude = number(answer["amplitude"]);
  EXPECT_NEAR(fit.sine, number(answer["A_sin"]), limits.value * amplitude);
  EXPECT_NEAR(fit.cosine, number(answer["B_cos"]), limits.value * amplitude);
  EXPECT_NEAR(fit.offset, number(answer["C"]),
              limits.value * std::max(amplitude, std::abs(number(answer["C"]))));
  EXPECT_NEAR(fit.amplitude(), amplitude, limits.value * amplitude);
  EXPECT_NEAR(fit.phase_rad(), number(answer["theta_rad"]), limits.value);
  EXPECT_NEAR(fit.rss / number(answer["rss"]), 1.0, limits.uncertainty);
  EXPECT_NEAR(fit.degrees_of_freedom, number(answer["dof"]), 1e-9);
  EXPECT_NEAR(fit.u_amplitude() / number(answer["u_amplitude"]), 1.0, limits.uncertainty);
  EXPECT_NEAR(fit.u_phase_rad() / number(answer["u_theta"]), 1.0, limits.uncertainty);
  EXPECT_NEAR(std::sqrt(fit.covariance[5]) / number(answer["u_C"]), 1.0, limits.uncertainty);
}

class SineVectors : public testing::TestWithParam<std::string> {
protected:
  static const Json& all() {
    static const Json json = Json::parse(std::ifstream(DYNCAL_SINE_VECTORS));
    return json;
  }

  void SetUp() override {
    stamps_ = stamps_of(recipe_);
    for (const Json& channel : recipe_["channels"]) {
      values_.push_back(values_of(recipe_, channel, stamps_));
    }
    channels_.assign(values_.begin(), values_.end());
  }

  const Json& case_ = all()[GetParam()];
  const Json& recipe_ = case_["recipe"];
  const Json& answer_ = case_["answer"];
  const std::int64_t reference_ns_ = recipe_["t_ref_ns"];
  std::vector<std::int64_t> stamps_;
  std::vector<std::vector<double>> values_;
  std::vector<std::span<const double>> channels_;
};

using ThreeParameters = SineVectors;
TEST_P(ThreeParameters, MeetTheExactAnswer) {
  const auto fits = fit_sine(*Frequency::parse(recipe_["frequency_hz"].get<std::string>()),
                             reference_ns_, stamps_, channels_);
  ASSERT_TRUE(fits) << fits.error().message;
  for (std::size_t j = 0; j < fits->size(); ++j) {
    expect_answer((*fits)[j], answer_["channels"][j], {1e-13, 1e-9});
  }
}
INSTANTIATE_TEST_SUITE_P(All, ThreeParameters,
                         testing::Values("six_hours", "six_hours_reference_elsewhere",
                                         "three_axes_in_lsb", "third_of_a_cycle", "gap"),
                         [](const auto& instance) { return instance.param; });

using ExtendedModels = SineVectors;
TEST_P(ExtendedModels, MeetTheExactAnswer) {
  ExtendedBasis basis;
  const Json& wanted = recipe_["basis"];
  basis.drift_order = wanted.value("drift_order", 0);
  basis.max_harmonic = wanted.value("highest_harmonic", 1);
  if (wanted.contains("lines_hz")) {
    for (const Json& line : wanted["lines_hz"]) {
      basis.lines.push_back(*Frequency::parse(line.get<std::string>()));
    }
  }
  const auto fits = fit_sine_extended(*Frequency::parse(recipe_["frequency_hz"].get<std::string>()),
                                      basis, Weighting::none, reference_ns_, stamps_, channels_);
  ASSERT_TRUE(fits) << fits.error().message;
  for (std::size_t j = 0; j < fits->size(); ++j) {
    expect_answer((*fits)[j].fundamental, answer_["channels"][j], {1e-13, 1e-9});
  }
}
INSTANTIATE_TEST_SUITE_P(All, ExtendedModels, testing::Values("drift", "harmonics_and_hum"),
                         [](const auto& instance) { return instance.param; });

using FourParameters = SineVectors;
TEST_P(FourParameters, MeetTheExactAnswer) {
  const auto fit = fit_sine_and_frequency(*Frequency::parse(recipe_["start_hz"].get<std::string>()),
                                          recipe_["search_rel"].get<double>(), reference_ns_,
                                          stamps_, channels_);
  ASSERT_TRUE(fit) << fit.error().message;
  const double span_s = static_cast<double>(stamps_.back() - stamps_.front()) * 1e-9;
  const double span_to_reference_s =
      static_cast<double>(std::max(std::abs(stamps_.back() - reference_ns_),
                                   std::abs(stamps_.front() - reference_ns_))) *
      1e-9;
  EXPECT_NEAR(fit->frequency.hz(), number(answer_["frequency_hz"]),
              1e-10 / (2.0 * std::numbers::pi * span_s));
  EXPECT_NEAR(fit->u_frequency_hz / number(answer_["u_frequency_hz"]), 1.0, 1e-9);
  // Away from the record the phase carries the error of the frequency.
  const double lever = std::max(1.0, span_to_reference_s / span_s);
  for (std::size_t j = 0; j < channels_.size(); ++j) {
    expect_answer(fit->channels[j], answer_["channels"][j], {1e-11 * lever, 1e-9});
  }
}
INSTANTIATE_TEST_SUITE_P(All, FourParameters,
                         testing::Values("four_300_ppm", "four_3040_ppm", "four_below_two_cycles",
                                         "four_shared_by_axes", "four_with_gap",
                                         "four_reference_far_away"),
                         [](const auto& instance) { return instance.param; });

} // namespace
} // namespace dyncal::analysis
