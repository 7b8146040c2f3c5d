#include "services/views/model/channel_model.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/views/model/model_figure.hpp"
#include "services/views/model/model_json.hpp"
#include "services/views/model/model_table.hpp"

namespace dyncal::inline views {
namespace {

constexpr double u = 1e-3;

MeasuredResponse measured(const analysis::ResponseParameters& truth,
                          const std::vector<double>& frequencies) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, u);
  MeasuredResponse response;
  response.channel = "dau/acceleration";
  response.unit = R"(\one)";
  response.sample_rate_hz = 1000.0;
  for (const double f : frequencies) {
    MeasuredValue value;
    value.file = "r.json";
    value.frequency_text_hz = std::to_string(static_cast<int>(f));
    value.point = {f,
                   analysis::response_at(truth, f) *
                       std::exp(std::complex<double>(noise(random), noise(random))),
                   u, u};
    value.u_magnitude_rel = value.u_phase_rad = u;
    response.values.push_back(value);
  }
  return response;
}

const std::vector<double> band{10, 16, 25, 40, 63, 80, 100, 125, 160, 200, 250};
constexpr analysis::ResponseParameters sensor{
    .gain = -0.5, .delay_s = 2e-3, .corner_hz = 0.0, .resonance_hz = 300.0, .damping = 0.6};

ChannelModel modelled(MeasuredResponse response, const ModelRequest& request = {}) {
  auto model = model_channel(std::move(response), request);
  EXPECT_TRUE(model.has_value()) << model.error().message;
  return std::move(*model);
}

bool warns(const ChannelModel& model, const std::string& text) {
  return std::any_of(model.warnings.begin(), model.warnings.end(), [&](const std::string& warning) {
    return warning.find(text) != std::string::npos;
  });
}

TEST(ChannelModel, HasNoWarningWhereTheModelIsTheSensors) {
  const ChannelModel model =
      modelled(measured(sensor, band), {.filter = FilterRequest{.cutoff_hz = 200.0}});
  EXPECT_EQ(model.fit().kind, analysis::ResponseKind::second_order_with_delay);
  EXPECT_EQ(model.warnings, std::vector<std::string>{});
  EXPECT_EQ(model.filter->rate_hz, 1000.0);
  EXPECT_EQ(model.compensated.size(), band.size());
  EXPECT_NE(reason_of(model.choice).find("chi-squared is lower by"), std::string::npos);
}

TEST(ChannelModel, WarnsWhereNoModelFits) {
  MeasuredResponse response = measured(sensor, band);
  response.values[3].point.h *= 1.02;
  const ChannelModel model = modelled(std::move(response), {.filter = FilterRequest{}});
  EXPECT_FALSE(model.choice.fits);
  EXPECT_TRUE(warns(model, "no model fits: chi-squared"));
  EXPECT_TRUE(warns(model, "the compensated response differs from 1 by more than 3 u at"));
}

TEST(ChannelModel, WarnsOfAKindThatWasWantedAndIsNotTheSensors) {
  const ChannelModel model =
      modelled(measured(sensor, band), {.kind = analysis::ResponseKind::delay});
  EXPECT_EQ(model.fit().kind, analysis::ResponseKind::delay);
  EXPECT_TRUE(warns(model, "this model does not fit: chi-squared"));
  EXPECT_TRUE(warns(model, "second order with delay is better by more than chance"));
}

TEST(ChannelModel, WarnsOfAmbiguousTurns) {
  const ChannelModel model =
      modelled(measured({.gain = 1.0, .delay_s = 3e-3}, {50, 100, 150, 200, 250}));
  EXPECT_NEAR(model.fit().parameters.delay_s, 3e-3, 1e-5);
  EXPECT_TRUE(warns(model, "whole turns of the phase are ambiguous: a delay of -17"));
}

TEST(ChannelModel, WarnsOfWhatUDoesNotHold) {
  MeasuredResponse response = measured(sensor, band);
  response.has_budgets = false;
  response.values[2].flag_names = {"adc_not_calibrated", "over_range"};
  const ChannelModel model = modelled(std::move(response));
  EXPECT_TRUE(warns(model, "u does not hold everything: the values have the flag adc_not_cal"));
  EXPECT_TRUE(warns(model, "wrong beyond their u are included: their flags are over_range"));
  EXPECT_TRUE(warns(model, "the file states no budgets"));
}

TEST(ChannelModel, WarnsOfAPassBandThatWasNotMeasured) {
  const ChannelModel model =
      modelled(measured(sensor, band), {.filter = FilterRequest{.iir = true, .cutoff_hz = 300.0}});
  EXPECT_TRUE(warns(model, "from 250 Hz to 300 Hz the filter relies on the model alone"));
  EXPECT_EQ(model.filter->a.size(), 5U);
}

TEST(ChannelModel, SaysWhatAFilterNeeds) {
  MeasuredResponse response = measured(sensor, band);
  response.sample_rate_hz = 0.0;
  const auto model = model_channel(std::move(response), {.filter = FilterRequest{}});
  ASSERT_FALSE(model.has_value());
  EXPECT_EQ(model.error().message,
            "r.json: the sample rate of dau/acceleration is not in the file; state --rate-hz");
}

TEST(ChannelModel, SaysWhyNoValueCanBeUsed) {
  MeasuredResponse response;
  response.channel = "dau/acceleration";
  response.left_out = {{"r.json", "10", "flag over_range"}};
  const auto model = model_channel(std::move(response), {});
  ASSERT_FALSE(model.has_value());
  EXPECT_EQ(model.error().message,
            "r.json: no value of dau/acceleration can be used: at 10 Hz flag over_range; "
            "--include-flagged keeps values with flags");
}

TEST(ChannelModel, IsShownInLinesOfATerminal) {
  const ChannelModel model =
      modelled(measured(sensor, band), {.filter = FilterRequest{.cutoff_hz = 200.0}});
  const std::string text = model_text(model);
  EXPECT_NE(text.find("dau/acceleration: 11 values from 10 to 250 Hz"), std::string::npos);
  EXPECT_NE(text.find("\n> second order with delay"), std::string::npos);
  EXPECT_NE(text.find("FIR filter of"), std::string::npos);
  EXPECT_EQ(text.find(" nan"), std::string::npos);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    EXPECT_LE(end - at, 100U) << text.substr(at, end - at);
    at = end + 1;
  }
}

TEST(ChannelModel, IsWholeAsJson) {
  const auto json = model_json({"r.json"}, {modelled(measured(sensor, band))});
  EXPECT_EQ(json["schema"]["name"], "dyncal-model");
  EXPECT_EQ(json["schema"]["version"], model_schema_version);
  const auto& model = json["models"][0];
  EXPECT_TRUE(model["filter"].is_null());
  EXPECT_EQ(model["covariance"].size(), 4U);
  EXPECT_EQ(model["points"].size(), band.size());
  double chi_squared = 0.0; // without what is common, the residuals are chi-squared
  for (const auto& point : model["points"]) {
    chi_squared += std::pow(point["residual_magnitude_rel"].get<double>() / u, 2) +
                   std::pow(point["residual_phase_rad"].get<double>() / u, 2);
  }
  EXPECT_NEAR(chi_squared / model["chi_squared"].get<double>(), 1.0, 1e-9);
}

TEST(ChannelModel, HasAFigureOfItsResiduals) {
  const figures::Figure figure = model_figure(modelled(measured(sensor, band)));
  EXPECT_EQ(figure.name, "model-residuals-dau-acceleration");
  EXPECT_NE(figure.svg().find("second order with delay"), std::string::npos);
  EXPECT_NE(figure.csv.find("# resonance_hz = "), std::string::npos);
}

} // namespace
} // namespace dyncal::inline views
