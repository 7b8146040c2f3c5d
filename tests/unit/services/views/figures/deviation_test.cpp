#include "services/views/figures/deviation.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/views/figures/well_formed.hpp"

namespace dyncal::inline views::figures {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// Three frequencies, one at another level; the second repetition is 1 % and 2 mrad off.
TransferFunctionData two_repetitions() {
  TransferFunctionData data;
  data.title = "acc-1: dau/acceleration_z";
  data.mean = {{10, 1, {2.0, 0.01, -7.0, 0.001}, "", 0.02, 0.003},
               {20, 1, {4.0, 0.01, -9.0, 0.001}, "", 0.02, 0.003},
               {40, 5, {8.0, 0.01, -9.5, 0.001}, "", 0.02, 0.003}};
  for (const ValueOverFrequency& mean : data.mean) {
    for (const std::uint32_t repetition : {1U, 2U}) {
      ValueOverFrequency point = mean;
      point.value.magnitude *= repetition == 2 ? 1.01 : 1.0;
      point.value.phase_rad = std::remainder(
          point.value.phase_rad + (repetition == 2 ? 0.002 : 0.0), 2 * std::numbers::pi);
      data.repetitions.push_back({repetition, point});
    }
  }
  return data;
}

TEST(DeviationFigure, HoldsEachRepetitionAgainstTheMeanOfItsFrequencyAndLevel) {
  const Picture picture = deviation_figure(two_repetitions(), "deviation").picture;
  ASSERT_EQ(picture.panels.size(), 2U);
  ASSERT_EQ(picture.panels[0].series.size(), 2U);
  for (const Panel& panel : picture.panels) {
    ASSERT_EQ(panel.series[1].points.size(), 3U);
    for (const Point& point : panel.series[0].points) {
      EXPECT_NEAR(point.y, 0.0, 1e-12);
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(picture.panels[0].series[1].points[i].y, 1.0, 1e-9);
    EXPECT_NEAR(picture.panels[1].series[1].points[i].y, 0.002 * 180 / std::numbers::pi, 1e-9);
  }
  EXPECT_NEAR(picture.panels[0].series[0].points[0].half_bar, 0.5, 1e-12);   // 0.01 of 2
  EXPECT_NEAR(picture.panels[0].series[0].points[2].half_bar, 0.125, 1e-12); // 0.01 of 8
}

TEST(DeviationFigure, ShowsTheUncertaintyOfTheMeanAsABand) {
  TransferFunctionData data = two_repetitions();
  const Panel standard = deviation_figure(data, "deviation").picture.panels[0];
  data.error_bars = ErrorBars::expanded;
  const Panel expanded = deviation_figure(data, "deviation").picture.panels[0];
  EXPECT_EQ(standard.band_label, "± u of the mean");
  EXPECT_EQ(expanded.band_label, "± U of the mean");
  ASSERT_EQ(standard.band.size(), 3U);
  EXPECT_DOUBLE_EQ(standard.band[0].high, 0.5);
  EXPECT_DOUBLE_EQ(expanded.band[0].high, 1.0);
  EXPECT_DOUBLE_EQ(expanded.band[0].low, -1.0);
}

TEST(DeviationFigure, ShowsTheResidualOfTheFitWhereItIsKnown) {
  TransferFunctionData data = two_repetitions();
  data.repetitions[3].residual_rel = 0.02;
  const Figure figure = deviation_figure(data, "deviation");
  ASSERT_EQ(figure.picture.panels.size(), 3U);
  EXPECT_DOUBLE_EQ(figure.picture.panels[2].series[1].points[1].y, 2.0);
  const auto texts = texts_of(figure.svg());
  EXPECT_EQ(problem_of(figure.svg()), "");
  for (const char* text :
       {"acc-1: dau/acceleration_z: repetitions less their mean", "magnitude in %",
        "phase in degrees", "residual of the fit in %", "frequency in Hz", "#1 ± u", "#2 ± u"}) {
    EXPECT_THAT(texts, Contains(text));
  }
}

TEST(DeviationFigure, LeavesOutWhatHasNoMean) {
  TransferFunctionData data = two_repetitions();
  data.mean.erase(data.mean.begin() + 1);
  EXPECT_EQ(deviation_figure(data, "").picture.panels[0].series[0].points.size(), 2U);
  data.mean.clear();
  const Figure figure = deviation_figure(data, "");
  EXPECT_EQ(problem_of(figure.svg()), "");
  EXPECT_THAT(texts_of(figure.svg()), Contains("no data"));
}

TEST(DeviationCsv, NamesColumnsAndHasEveryRepetition) {
  const std::string csv = deviation_figure(two_repetitions(), "").csv;
  EXPECT_THAT(
      csv,
      HasSubstr(
          "\nrepetition,frequency_hz,deviation_magnitude_rel,u_magnitude_rel,"
          "deviation_phase_rad,u_phase_rad,residual_rel,flags,level_m_s2,excited_axis,attempt\n"));
  EXPECT_THAT(csv, HasSubstr(",nan,,5,,1\n"));
  EXPECT_THAT(csv, HasSubstr("\n1,10,0,0.0050000000000000001,"));
  EXPECT_THAT(csv, HasSubstr("\n2,20,0.010000000000000"));
  EXPECT_THAT(csv, Not(HasSubstr("inf")));
}

TEST(DeviationFigure, ShowsALevelInAColourWhereAFrequencyHasSeveral) {
  TransferFunctionData data = two_repetitions();
  for (auto* value : {&data.mean[2], &data.repetitions[4].point, &data.repetitions[5].point}) {
    value->frequency_hz = 20;
  }
  data.mean[2].value.u_magnitude = 0.08; // 1 % of 8, where that of 4 is 0.25 %
  const Panel panel = deviation_figure(data, "deviation").picture.panels[0];
  ASSERT_EQ(panel.series.size(), 2U);
  EXPECT_EQ(panel.series[0].label, "1 m/s² ± u");
  EXPECT_EQ(panel.series[0].points.size(), 4U);
  EXPECT_EQ(panel.series[1].label, "5 m/s² ± u");
  ASSERT_EQ(panel.series[1].points.size(), 2U);
  EXPECT_NEAR(panel.series[1].points[1].y, 1.0, 1e-9);
  EXPECT_EQ(panel.band_label, "± u of the mean, the largest of all levels");
  ASSERT_EQ(panel.band.size(), 2U);
  EXPECT_DOUBLE_EQ(panel.band[1].high, 1.0);
}

TEST(DeviationFigure, HasNeitherBarsNorBandWithoutErrorBars) {
  TransferFunctionData data = two_repetitions();
  data.error_bars = ErrorBars::none;
  const Panel panel = deviation_figure(data, "deviation").picture.panels[0];
  EXPECT_TRUE(panel.band.empty());
  EXPECT_EQ(panel.series[0].label, "#1");
  EXPECT_EQ(panel.series[0].points[0].half_bar, 0.0);
}

TEST(DeviationFigure, GivesTheBarsOfTheDataToRepetitionsWhileMeansArePlain) {
  TransferFunctionData data = two_repetitions();
  data.error_bars = ErrorBars::expanded;
  data.means_are_plain = true;
  data.repetitions[0].step = 5;
  const Panel panel = deviation_figure(data, "deviation").picture.panels[0];
  EXPECT_TRUE(panel.band.empty());
  EXPECT_EQ(panel.series[0].label, "#1 ± U");
  EXPECT_NEAR(panel.series[0].points[0].half_bar, 1.0, 1e-12); // 0.02 of 2
  EXPECT_EQ(panel.series[0].points[0].step, 5U);
}

} // namespace
} // namespace dyncal::inline views::figures
