#include "services/views/figures/transfer_function.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/views/figures/well_formed.hpp"

namespace dyncal::inline views::figures {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr double delay_s = 8.1e-3;

// A low-pass with a delay; the phases of the repetitions are wrapped.
TransferFunctionData low_pass(std::size_t frequencies) {
  TransferFunctionData data;
  data.title = "acc-1: dau/acceleration_z";
  for (std::size_t i = 0; i < frequencies; ++i) {
    const double frequency_hz = 10 * std::pow(10.0, 0.1 * static_cast<double>(i));
    const ValueOverFrequency mean{frequency_hz,
                                  1.0,
                                  {1 / std::hypot(1.0, frequency_hz / 180), 1e-3,
                                   -2 * std::numbers::pi * frequency_hz * delay_s, 2e-3}};
    data.mean.push_back(mean);
    for (std::uint32_t repetition = 1; repetition <= 3; ++repetition) {
      auto point = mean;
      point.value.phase_rad = std::remainder(mean.value.phase_rad, 2 * std::numbers::pi);
      data.repetitions.push_back({repetition, point});
    }
  }
  return data;
}

analysis::GroupDelay line_of(double value_s, double intercept_rad) {
  analysis::GroupDelay line;
  line.delay_s = value_s;
  line.of_delay.u = 1e-6;
  line.intercept_rad = intercept_rad;
  return line;
}

std::size_t lines_without_comments(const std::string& csv) {
  std::istringstream stream(csv);
  std::size_t count = 0;
  for (std::string line; std::getline(stream, line);) {
    count += line.starts_with("#") ? 0 : 1;
  }
  return count;
}

TEST(TransferFunctionFigure, ShowsEveryPointOfEveryRepetitionInBothPanels) {
  const auto svg =
      transfer_function_figure(low_pass(4), "tf").svg(); // too few low frequencies for an inset
  EXPECT_EQ(problem_of(svg), "");
  // #1 are circles: one for each point and panel, and one in the legend.
  EXPECT_EQ(count_elements(svg, "circle"), 2U * 4 + 1);
}

TEST(TransferFunctionFigure, EnlargesLowFrequenciesWhereThereIsRoom) {
  const std::size_t frequencies = 14;
  const auto svg = transfer_function_figure(low_pass(frequencies), "tf").svg();
  EXPECT_EQ(problem_of(svg), "");
  EXPECT_EQ(count_elements(svg, "circle"), 2 * frequencies + 2 * (frequencies / 2) + 1);
}

TEST(TransferFunctionFigure, DrawsWrappedRepetitionsInTheTurnOfTheMean) {
  const auto data = low_pass(14);
  auto unwrapped = data;
  for (std::size_t i = 0; i < data.repetitions.size(); ++i) {
    unwrapped.repetitions[i].point.value.phase_rad = data.mean[i / 3].value.phase_rad;
  }
  EXPECT_EQ(transfer_function_figure(data, "tf").svg(),
            transfer_function_figure(unwrapped, "tf").svg());
}

TEST(TransferFunctionFigure, NamesAxesUnitsRepetitionsAndGroupDelay) {
  auto data = low_pass(14);
  data.unit = "(rad/s)/(m/s²)";
  data.group_delay = line_of(delay_s, 0.0);
  const auto texts = texts_of(transfer_function_figure(data, "tf").svg());
  for (const auto* text : {"acc-1: dau/acceleration_z", "frequency in Hz",
                           "magnitude in (rad/s)/(m/s²)", "phase (lead) in rad", "#1", "#2", "#3",
                           "group delay 8.1 ms", "10", "12.59", "15.85", "199.5"}) {
    EXPECT_THAT(texts, Contains(text));
  }
}

TEST(TransferFunctionFigure, DrawsWhatTheDelayLeavesOfThePhase) {
  auto data = low_pass(14);
  data.unit = "1";
  data.group_delay = line_of(delay_s, 0.25);
  for (ValueOverFrequency& mean : data.mean) {
    mean.value.phase_rad += 0.25;
  }
  data.removes_delay = true;
  const Figure figure = transfer_function_figure(data, "tf");
  const Panel& panel = figure.picture.panels[1];
  EXPECT_EQ(panel.y_label, "phase without delay in rad");
  EXPECT_EQ(figure.picture.panels[0].y_label, "magnitude");
  ASSERT_EQ(panel.series.size(), 4U); // no line of the delay
  ASSERT_EQ(panel.series[0].points.size(), 14U);
  for (const Point& point : panel.series[0].points) {
    EXPECT_NEAR(point.y, 0.25, 1e-9);
    EXPECT_EQ(point.half_bar, 2e-3);
  }
  data.removes_delay = false;
  EXPECT_EQ(figure.csv, transfer_function_figure(data, "tf").csv);
}

TEST(TransferFunctionFigure, DrawsALineAndMarkersForEachLevelWhereAFrequencyHasSeveral) {
  auto data = low_pass(3);
  data.excited_axis = "z";
  for (const double level : {2.0, 4.0}) {
    ValueOverFrequency mean = data.mean[1];
    mean.level_m_s2 = level;
    mean.value.magnitude = level;
    data.mean.push_back(mean);
    data.repetitions.push_back({.repetition = 1, .point = mean, .step = 7, .attempt = 2});
  }
  const Figure figure = transfer_function_figure(data, "tf");
  EXPECT_EQ(problem_of(figure.svg()), "");
  const auto& series = figure.picture.panels[0].series;
  ASSERT_EQ(series.size(), 6U);
  const char* const labels[] = {"1 m/s²: mean ± u", "2 m/s²: mean ± u", "4 m/s²: mean ± u",
                                "1 m/s²",           "2 m/s²",           "4 m/s²"};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(series[i].label, labels[i]);
    EXPECT_EQ(series[i].points.size(), i == 0 ? 3U : i == 3 ? 9U : 1U) << i;
    EXPECT_EQ(series[i].colour, series[i % 3].colour);
    EXPECT_EQ(series[i].joined, i < 3);
  }
  EXPECT_EQ(series[2].points[0].y, 4.0);
  EXPECT_EQ(series[5].points[0].step, 7U);
  EXPECT_THAT(figure.csv, HasSubstr(",level_m_s2,excited_axis,attempt\n"));
  EXPECT_THAT(figure.csv, HasSubstr(",4,z,2\n")); // the repetition
  EXPECT_THAT(figure.csv, HasSubstr(",4,z,\n"));  // the mean
}

TEST(TransferFunctionFigure, KeepsOneLineWhereEveryFrequencyHasALevelOfItsOwn) {
  auto data = low_pass(3);
  data.mean[0].level_m_s2 = 0.5;
  for (std::size_t i = 0; i < 3; ++i) {
    data.repetitions[i].point.level_m_s2 = 0.5;
  }
  const auto series = transfer_function_figure(data, "tf").picture.panels[0].series;
  ASSERT_EQ(series.size(), 4U);
  EXPECT_EQ(series[0].label, "mean ± u");
  EXPECT_EQ(series[1].label, "#1");
}

TEST(TransferFunctionFigure, IsDrawnWithoutData) {
  const auto figure = transfer_function_figure({}, "tf");
  EXPECT_EQ(problem_of(figure.svg()), "");
  EXPECT_THAT(texts_of(figure.svg()), Contains("no data"));
  EXPECT_EQ(lines_without_comments(figure.csv), 1U);
}

TEST(TransferFunctionFigure, IsDrawnForOnePoint) {
  const auto figure = transfer_function_figure(low_pass(1), "tf");
  EXPECT_EQ(problem_of(figure.svg()), "");
  EXPECT_THAT(texts_of(figure.svg()), Not(Contains("no data")));
}

TEST(TransferFunctionFigure, LeavesOutPointsThatAreNoNumbers) {
  auto data = low_pass(4);
  data.mean[2].value.magnitude = std::numeric_limits<double>::quiet_NaN();
  data.repetitions[6].point.value.magnitude = std::numeric_limits<double>::quiet_NaN();
  data.repetitions[3].point.value.phase_rad = std::numeric_limits<double>::infinity();
  const auto figure = transfer_function_figure(data, "tf");
  EXPECT_EQ(problem_of(figure.svg()), "");
  EXPECT_EQ(count_elements(figure.svg(), "circle"), 2U * 4 + 1 - 2);
  EXPECT_THAT(figure.csv, HasSubstr("nan"));
}

TEST(TransferFunctionFigure, ShowsTheExpandedUncertaintyWhereThatIsChosen) {
  TransferFunctionData data = low_pass(4);
  for (ValueOverFrequency& mean : data.mean) {
    mean.expanded_magnitude = 2.5 * mean.value.u_magnitude;
    mean.expanded_phase_rad = 3 * mean.value.u_phase_rad;
  }
  const Picture standard = transfer_function_figure(data, "tf").picture;
  data.error_bars = ErrorBars::expanded;
  const Picture expanded = transfer_function_figure(data, "tf").picture;
  EXPECT_EQ(standard.panels[0].series[0].label, "mean ± u");
  EXPECT_EQ(expanded.panels[0].series[0].label, "mean ± U");
  for (std::size_t i = 0; i < data.mean.size(); ++i) {
    EXPECT_EQ(standard.panels[0].series[0].points.at(i).half_bar, 1e-3);
    EXPECT_EQ(expanded.panels[0].series[0].points.at(i).half_bar, 2.5e-3);
    EXPECT_EQ(expanded.panels[1].series[0].points.at(i).half_bar, 6e-3);
  }
}

TEST(TransferFunctionCsv, SaysUnitsAndPhaseConvention) {
  auto data = low_pass(2);
  data.group_delay = line_of(delay_s, 0.25);
  const auto csv = transfer_function_figure(data, "tf").csv;
  EXPECT_THAT(csv, HasSubstr("phase: lead, rad"));
  EXPECT_THAT(
      csv,
      HasSubstr("\nrepetition,frequency_hz,magnitude,u_magnitude,phase_rad,u_phase_rad,flags,"
                "U_magnitude,U_phase_rad,magnitude_text,uncertainty_magnitude_text,phase_rad_text,"
                "uncertainty_phase_rad_text,level_m_s2,excited_axis,attempt\n"));
  EXPECT_THAT(csv, HasSubstr("intercept 0.25 rad"));
  EXPECT_THAT(csv, HasSubstr("\nmean,10,"));
  EXPECT_EQ(lines_without_comments(csv), 1U + 2 * 3 + 2);
}

TEST(TransferFunctionFigure, RingsMeansWithAFlagAndExplainsThemBelowThePanels) {
  auto data = low_pass(4);
  const auto without = transfer_function_figure(data, "tf");
  EXPECT_THAT(texts_of(without.svg()), Not(Contains("flagged, see below")));
  data.mean[1].flags = "samples_lost";
  data.repetitions[4].point.flags = "samples_lost";
  data.flag_sentences = {"samples_lost (dau: samples lost): " + std::string(200, 'a') +
                         " and more"};
  const auto figure = transfer_function_figure(data, "tf");
  EXPECT_EQ(problem_of(figure.svg()), "");
  EXPECT_THAT(texts_of(figure.svg()), Contains("flagged, see below"));
  EXPECT_THAT(texts_of(figure.svg()), Contains("samples_lost (dau: samples lost):"));
  EXPECT_THAT(texts_of(figure.svg()), Contains("and more"));
  // Two panels, and the sample in the legend.
  EXPECT_EQ(count_elements(figure.svg(), "circle"), count_elements(without.svg(), "circle") + 3);
  EXPECT_THAT(figure.csv, HasSubstr("# flag samples_lost (dau: samples lost): aaa"));
  EXPECT_THAT(figure.csv, HasSubstr(",samples_lost,,,0.9976,0.0010,-0.6407,0.0020,1,,1\n3,"));
}

TEST(TransferFunctionFigure, HasBarsByChoice) {
  auto data = low_pass(4);
  data.mean[1].expanded_magnitude = 2.3e-3;
  const auto mean = [&](ErrorBars bars) {
    data.error_bars = bars;
    return transfer_function_figure(data, "tf").picture.panels.at(0).series.at(0);
  };
  EXPECT_EQ(mean(ErrorBars::standard).label, "mean ± u");
  EXPECT_EQ(mean(ErrorBars::standard).points.at(1).half_bar, 1e-3);
  EXPECT_EQ(mean(ErrorBars::expanded).label, "mean ± U");
  EXPECT_EQ(mean(ErrorBars::expanded).points.at(1).half_bar, 2.3e-3);
  EXPECT_EQ(mean(ErrorBars::none).label, "mean");
  EXPECT_EQ(mean(ErrorBars::none).points.at(1).half_bar, 0.0);
}

TEST(TransferFunctionFigure, GivesBarsToRepetitionsWhileMeansArePlain) {
  auto data = low_pass(4);
  data.repetitions[0].step = 7;
  const auto series = [&] {
    return transfer_function_figure(data, "tf").picture.panels.at(0).series;
  };
  EXPECT_EQ(series().at(1).label, "#1");
  EXPECT_EQ(series().at(1).points.at(0).half_bar, 0.0);
  EXPECT_EQ(series().at(1).points.at(0).step, 7U);
  EXPECT_EQ(series().at(0).points.at(0).step, 0U);
  data.means_are_plain = true;
  EXPECT_EQ(series().at(0).label, "mean so far");
  EXPECT_EQ(series().at(0).points.at(0).half_bar, 0.0);
  EXPECT_EQ(series().at(1).label, "#1 ± u");
  EXPECT_EQ(series().at(1).points.at(0).half_bar, 1e-3);
}

} // namespace
} // namespace dyncal::inline views::figures
