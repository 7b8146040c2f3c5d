// Results as they come back from the messages that they were sent in.
#include "services/evaluation/result/result_messages.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

StepResult example_result() {
  StepResult result;
  result.channel = "dau/acceleration_z";
  result.step = 3;
  result.repetition = 2;
  result.frequency_text_hz = "12.5";
  result.frequency_hz = 12.5;
  result.level_m_s2 = 10.0;
  result.excited_axis = "z";
  result.valid = true;
  result.magnitude = 0.95;
  result.u_magnitude = 1e-4;
  result.phase_rad = -0.5;
  result.u_phase_rad = 2e-4;
  result.unit = R"(\one)";
  analysis::ChannelFit fit{.channel = "acs/sync",
                           .frequency = analysis::Frequency::from_hz(12.500001),
                           .u_frequency_hz = 1e-7,
                           .phase_origin_ns = 1'500'000'000'123'456'789,
                           .fit = {}};
  fit.fit.sine = 1.1;
  fit.fit.cosine = -0.3;
  fit.fit.covariance = {1e-6, 0.0, 0.0, 3e-6, 0.0, 7e-9};
  fit.fit.samples = 3010;
  result.fits = {fit};
  result.budget = {{.kind = analysis::ContributionKind::reference, .u_phase_rad = 1e-4}};
  result.samples = {{.source = "dau",
                     .used = 100,
                     .lost = 1,
                     .unusable = 2,
                     .overflowed = 3,
                     .not_trusted = 4,
                     .not_measured = 5,
                     .first_stamp_ns = 6,
                     .last_stamp_ns = 7,
                     .cut_out = 8}};
  result.signals = {{"acs/sync", 1e-3, 1e-5, 2e-3, 1.02}};
  result.provisional = true;
  result.lost = 6;
  result.flags = {flag_of_source(ResultFlag::samples_lost, "dau")};
  result.data_sha256 = "abc";
  result.series = SeriesFinding{1003.0, 0.1, "with the trigger", 1e-6};
  return result;
}

TEST(ResultMessage, CarriesWhatReadersNeedOfAResult) {
  Recipe recipe;
  recipe.bench = "acc-1";
  recipe.run = "r1";
  recipe.sha256 = "def";
  const wire::CalibrationResult message = to_message(recipe, example_result());
  EXPECT_EQ(message.bench().to_string(), "acc-1");
  EXPECT_EQ(message.run().to_string(), "r1");
  EXPECT_EQ(message.recipe_sha256(), "def");
  EXPECT_EQ(message.flags(), std::vector<std::string>{"dau: samples lost"});
  const StepResult read = from_message(message);
  EXPECT_TRUE(to_message(recipe, read) == message);
  ASSERT_EQ(read.fits.size(), 1U);
  EXPECT_EQ(read.fits[0].channel, "acs/sync");
  EXPECT_EQ(read.fits[0].frequency.hz(), 12.500001);
  EXPECT_EQ(read.samples.at(0).all_lost(), 6U);
  EXPECT_EQ(read.flags.at(0).sentence, "dau: samples lost");
  EXPECT_EQ(read.series.value().start, "with the trigger");
  EXPECT_TRUE(read.provisional);
  EXPECT_EQ(read.excited_axis, "z");
  ASSERT_EQ(read.signals.size(), 1U);
  EXPECT_EQ(read.signals[0].channel, "acs/sync");
  EXPECT_EQ(read.signals[0].thd, 1e-3);
  EXPECT_EQ(read.signals[0].u_thd, 1e-5);
  EXPECT_EQ(read.signals[0].residual, 2e-3);
  EXPECT_EQ(read.signals[0].over_noise, 1.02);
}

TEST(ResultMessage, AResultWithoutAValueHasNoNumbers) {
  StepResult result;
  result.problem = "no steady sine";
  const StepResult read = from_message(to_message({}, result));
  EXPECT_FALSE(read.valid);
  EXPECT_TRUE(std::isnan(read.magnitude));
  EXPECT_EQ(read.problem, "no steady sine");
  EXPECT_FALSE(read.series);
  EXPECT_FALSE(read.monte_carlo);
}

TEST(TransferFunctionMessage, CarriesPointsAndGroupDelay) {
  TransferFunction function;
  function.channel = "dau/acceleration_z";
  function.method = EvaluationMethod::absolute_time;
  function.excited_axis = "z";
  FrequencyPoint point;
  point.frequency_text_hz = "10";
  point.frequency_hz = 10.0;
  point.mean.magnitude = 1.0;
  point.mean.u_magnitude = 1e-3;
  point.mean.repetitions = 3;
  point.unwrapped_phase_rad = -7.0;
  function.points = {point};
  function.group_delay.emplace();
  function.group_delay->delay_s = 8e-3;
  function.group_delay->of_delay = {1e-6, 4.0, 2.87};
  function.group_delay->of_intercept = {1e-3, 9.0, 2.32};
  function.group_delay->phase_covariance = {1e-6};
  const wire::TransferFunction message = to_message({}, function);
  const TransferFunction read = from_message(message);
  EXPECT_TRUE(to_message({}, read) == message);
  EXPECT_EQ(read.method, EvaluationMethod::absolute_time);
  EXPECT_EQ(read.excited_axis, "z");
  EXPECT_EQ(read.points.at(0).mean.repetitions, 3U);
  EXPECT_DOUBLE_EQ(read.group_delay.value().delay_s, 8e-3);
  EXPECT_EQ(read.group_delay->of_delay.u, 1e-6);
  EXPECT_EQ(read.group_delay->of_delay.degrees_of_freedom, 4.0);
  EXPECT_EQ(read.group_delay->of_intercept.k, 2.32);
  EXPECT_DOUBLE_EQ(message.u_group_delay_s(), 1.435e-6);
  function.group_delay.reset();
  function.group_delay_problem = "one frequency";
  EXPECT_FALSE(from_message(to_message({}, function)).group_delay);
}

// Writers of before had half of U alone.
TEST(TransferFunctionMessage, OfAnOlderWriterHasTheFactorTwo) {
  wire::TransferFunction message;
  message.group_delay_valid(true);
  message.u_group_delay_s(3e-6);
  message.u_intercept_rad(2e-3);
  const analysis::GroupDelay delay = from_message(message).group_delay.value();
  EXPECT_EQ(delay.of_delay.u, 3e-6);
  EXPECT_EQ(delay.of_delay.k, 2.0);
  EXPECT_EQ(delay.of_delay.degrees_of_freedom, analysis::infinite_degrees_of_freedom);
  EXPECT_EQ(delay.u_intercept_rad(), 2e-3);
}

TEST(ClockReportMessage, CarriesNumbersListsAndFlags) {
  ClockReport report{.source = "dau", .clock = {}};
  report.clock.intervals = 1000;
  report.clock.median_s = 1e-3;
  report.clock.quantile_50_s = 1e-3;
  report.clock.histogram = {{107671, 996953.7, 12}};
  report.clock.over_time = {{1.0, 2.0, 3.0, 4.0}};
  report.clock.over_temperature = {{25.0, 996953.7, 12.0, 4}};
  report.clock.allan = {{1.0, 1e-6}};
  report.clock.lost = 5;
  report.clock.u_mean_interval_s = 1e-9;
  report.clock.degrees_of_freedom_mean_interval = 6.0;
  report.clock.k_mean_interval = 2.52;
  report.flags = {make_flag(ResultFlag::clock_uncertainty_unknown),
                  make_flag(ResultFlag::samples_lost)};
  const wire::SampleClockReport message = to_message({}, report);
  const ClockReport read = from_message(message);
  EXPECT_TRUE(to_message({}, read) == message);
  EXPECT_EQ(read.clock.intervals, 1000U);
  EXPECT_EQ(read.clock.histogram.at(0).count, 12U);
  EXPECT_DOUBLE_EQ(read.clock.quantile_50_s, 1e-3);
  EXPECT_EQ(read.clock.lost, 5U);
  EXPECT_DOUBLE_EQ(read.clock.of_mean_interval().expanded(), 2.52e-9);
  EXPECT_EQ(read.clock.degrees_of_freedom_mean_interval, 6.0);
  EXPECT_EQ(read.flags, report.flags);
}

// Writers of before had no flags.
TEST(ClockReportMessage, OfAnOlderWriterIsFlaggedByItsUncertainty) {
  wire::SampleClockReport message;
  message.u_mean_interval_s(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(from_message(message).flags,
            std::vector{make_flag(ResultFlag::clock_uncertainty_unknown)});
  message.u_mean_interval_s(1e-9);
  EXPECT_TRUE(from_message(message).flags.empty());
  EXPECT_EQ(from_message(message).clock.of_mean_interval().expanded(), 2e-9);
}

} // namespace
} // namespace dyncal::inline evaluation
