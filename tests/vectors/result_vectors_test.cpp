// Results made from several series or phasors, computed with 60 digits by make_result_vectors.py.
#include <cmath>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>

#include "analysis/clock/allan_deviation.hpp"
#include "analysis/method/sample_stamping.hpp"
#include "analysis/method/series_stamping.hpp"
#include "analysis/response/group_delay.hpp"
#include "analysis/response/triaxial.hpp"
#include "analysis/uncertainty/law_of_propagation.hpp"
#include "tests/vectors/recipe_series.hpp"

namespace dyncal::analysis {
namespace {

const Json& vector_of(const char* name) {
  static const Json json = Json::parse(std::ifstream(DYNCAL_RESULT_VECTORS));
  return json[name];
}

void expect_phase(double phase_rad, const Json& exact, double limit_rad) {
  EXPECT_NEAR(std::remainder(phase_rad - number(exact), 2.0 * std::numbers::pi), 0.0, limit_rad);
}

// The channels of one recorder, made by recipe.
struct Recorder {
  explicit Recorder(const Json& recipe)
      : frequency(*Frequency::parse(recipe["frequency_hz"].get<std::string>())),
        stamps_ns(stamps_of(recipe)) {
    for (const Json& channel : recipe["channels"]) {
      values.push_back(values_of(recipe, channel, stamps_ns));
    }
  }

  Frequency frequency;
  std::vector<std::int64_t> stamps_ns;
  std::vector<std::vector<double>> values;
};

TEST(ResultVectors, SyncLinkAtWrappedPhases) {
  const Json& vector = vector_of("sync_link_at_wrapped_phases");
  const Recorder acs(vector["recipe"]["acs"]);
  const Recorder dau(vector["recipe"]["dau"]);
  SampleStampingInput input{.frequency = acs.frequency,
                            .frequency_search_rel = 0.0,
                            .acs_stamps_ns = acs.stamps_ns,
                            .reference = {"reference", acs.values[0]},
                            .sync_acs = {"sync of the ACS", acs.values[1]},
                            .dau_stamps_ns = dau.stamps_ns,
                            .sync_dau = {"sync of the DAU", dau.values[0]},
                            .dut = {{"sensor", dau.values[1]}}};
  input.adc.phase_lag_rad = number(vector["recipe"]["adc_lag_rad"]);
  input.reference_delay_s = number(vector["recipe"]["reference_delay_s"]);
  const auto result = evaluate_sample_stamping(input);
  ASSERT_TRUE(result) << result.error().message;
  expect_phase(result->points[0].phase_rad, vector["answer"]["phase_rad"], 1e-11);
  EXPECT_NEAR(result->points[0].magnitude / number(vector["answer"]["magnitude"]), 1.0, 1e-12);
}

TEST(ResultVectors, SeriesOfThreeShots) {
  const Json& vector = vector_of("series_of_three_shots");
  const Json& recipe = vector["recipe"];
  const Recorder acs(recipe["acs"]);
  const Recorder series(recipe["series"]);
  std::vector<Recorder> traces(recipe["traces"].begin(), recipe["traces"].end());
  SeriesStampingInput input{.frequency = acs.frequency,
                            .frequency_search_rel = 0.0,
                            .acs_stamps_ns = acs.stamps_ns,
                            .reference = {"reference", acs.values[0]},
                            .sync_acs = {"sync", acs.values[1]},
                            .channels = {"sensor"},
                            .nominal_rate_hz = number(recipe["nominal_rate_hz"])};
  input.dso_delay_s = number(recipe["dso_delay_s"]);
  for (std::size_t j = 0; j < traces.size(); ++j) {
    const Json& trace = recipe["traces"][j];
    input.shots.push_back({trace["first_ns"].get<double>() * 1e-9,
                           trace["interval_ns"].get<double>() * 1e-9,
                           traces[j].values[0],
                           {series.values[j]}});
  }
  const auto result = evaluate_series_stamping(input);
  ASSERT_TRUE(result) << result.error().message;
  const SeriesChannelResult& channel = result->channels[0];
  for (std::size_t j = 0; j < channel.shots.size(); ++j) {
    const Json& exact = vector["answer"]["shots"][j];
    EXPECT_NEAR(std::abs(channel.shots[j].h) / number(exact["magnitude"]), 1.0, 1e-11);
    expect_phase(std::arg(channel.shots[j].h), exact["phase_rad"], 1e-10);
  }
  EXPECT_NEAR(channel.mean.magnitude / number(vector["answer"]["magnitude"]), 1.0, 1e-11);
  expect_phase(channel.mean.phase_rad, vector["answer"]["phase_rad"], 1e-10);
  EXPECT_NEAR(result->rate.real_rate_hz / number(vector["answer"]["real_rate_hz"]), 1.0, 1e-12);
}

Axes axes_of(const Json& texts) {
  Axes axes;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    axes[i] = {number(texts[i][0]), number(texts[i][1])};
  }
  return axes;
}

TEST(ResultVectors, ResponseOfThreeAxes) {
  const Json& vector = vector_of("response_of_three_axes");
  const Json& recipe = vector["recipe"];
  std::vector<TriaxialExcitation> excitations(3);
  for (std::size_t j = 0; j < 3; ++j) {
    excitations[j].reference = axes_of(recipe["reference"][j]);
    excitations[j].sensor = axes_of(recipe["sensor"][j]);
    excitations[j].u_reference.fill(number(recipe["u_reference"]));
    excitations[j].u_sensor.fill(number(recipe["u_sensor"]));
  }
  const auto response = evaluate_triaxial(excitations);
  ASSERT_TRUE(response) << response.error().message;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_NEAR(response->h[i][j].real(), number(vector["answer"]["h"][i][j][0]), 1e-14);
      EXPECT_NEAR(response->h[i][j].imag(), number(vector["answer"]["h"][i][j][1]), 1e-14);
      EXPECT_NEAR(response->u[i][j] / number(vector["answer"]["u"][i][j]), 1.0, 1e-12);
    }
  }
}

TEST(ResultVectors, AllanDeviation) {
  const Json& vector = vector_of("allan_deviation");
  const std::vector<std::int64_t> stamps = stamps_of(vector["recipe"]);
  StreamingAllan stream(stamps.size());
  for (const std::int64_t stamp : stamps) {
    stream.add(stamp);
  }
  const double tau0_s = vector["recipe"]["interval_ns"].get<double>() * 1e-9;
  const auto points = stream.points(tau0_s);
  ASSERT_GE(points.size(), vector["answer"]["deviations"].size());
  for (std::size_t i = 0; i < vector["answer"]["deviations"].size(); ++i) {
    EXPECT_NEAR(points[i].tau_s / (tau0_s * vector["recipe"]["factors"][i].get<double>()), 1.0,
                1e-15);
    EXPECT_NEAR(points[i].deviation / number(vector["answer"]["deviations"][i]), 1.0, 1e-12);
  }
}

TEST(ResultVectors, Budget) {
  const Json& vector = vector_of("budget");
  std::vector<InputQuantity> inputs;
  for (const Json& row : vector["recipe"]["inputs"]) {
    InputQuantity input;
    input.u = number(row["u"]);
    input.sensitivity = number(row["sensitivity"]);
    input.degrees_of_freedom = number(row["degrees_of_freedom"]);
    inputs.push_back(input);
  }
  std::vector<InputCorrelation> correlations;
  for (const Json& row : vector["recipe"]["correlations"]) {
    correlations.push_back({row["first"], row["second"], number(row["coefficient"])});
  }
  const auto combined = propagate_uncertainty(inputs, correlations);
  ASSERT_TRUE(combined) << combined.error().message;
  const Json& answer = vector["answer"];
  EXPECT_NEAR(combined->u / number(answer["u"]), 1.0, 1e-13);
  EXPECT_NEAR(combined->degrees_of_freedom / number(answer["degrees_of_freedom"]), 1.0, 1e-12);
  EXPECT_NEAR(combined->k / number(answer["k"]), 1.0, 1e-9);
  EXPECT_NEAR(combined->expanded / number(answer["expanded"]), 1.0, 1e-9);
}

TEST(ResultVectors, GroupDelayOfWrappedPhases) {
  const Json& vector = vector_of("group_delay_of_wrapped_phases");
  std::vector<PhasePoint> points;
  for (const Json& point : vector["recipe"]["points"]) {
    points.push_back(
        {number(point["frequency_hz"]), number(point["phase_rad"]), number(point["u_phase_rad"])});
  }
  const auto delay = evaluate_group_delay(
      points, {number(vector["recipe"]["u_delay_s"]), number(vector["recipe"]["u_phase_rad"])});
  ASSERT_TRUE(delay) << delay.error().message;
  const Json& answer = vector["answer"];
  EXPECT_NEAR(delay->delay_s, number(answer["delay_s"]), 1e-16);
  EXPECT_NEAR(delay->intercept_rad, number(answer["intercept_rad"]), 1e-12);
  EXPECT_NEAR(delay->u_delay_s() / number(answer["u_delay_s"]), 1.0, 1e-9);
  EXPECT_NEAR(delay->u_intercept_rad() / number(answer["u_intercept_rad"]), 1.0, 1e-9);
  EXPECT_NEAR(delay->chi_squared / number(answer["chi_squared"]), 1.0, 1e-7);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(
        std::lround((delay->unwrapped_rad[i] - points[i].phase_rad) / (2.0 * std::numbers::pi)),
        vector["recipe"]["points"][i]["turns"].get<long>());
  }
}

} // namespace
} // namespace dyncal::analysis
