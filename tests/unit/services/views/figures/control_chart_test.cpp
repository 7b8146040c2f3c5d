#include "services/views/figures/control_chart.hpp"

#include <gmock/gmock.h>

#include "tests/unit/services/views/figures/well_formed.hpp"

namespace dyncal::inline views::figures {
namespace {

using testing::Contains;
using testing::HasSubstr;

ControlData example() {
  ControlTrace trace{
      .label = "80 Hz", .quantity = "magnitude_rel", .warning = 1e-3, .action = 2e-3, .points = {}};
  for (const double day : {0.0, 1.0, 2.0}) {
    trace.points.push_back({.run = "r",
                            .began_utc = "2026-11-22T10:00:00Z",
                            .days = day,
                            .deviation = 1e-3 * day,
                            .state = "in control"});
  }
  return {.title = "Check of b", .subtitle = "limits", .magnitudes = {trace}, .phases = {trace}};
}

TEST(ControlChartFigure, ShowsLinesAndLimits) {
  const Figure figure = control_figure(example(), "check");
  EXPECT_EQ(problem_of(figure.svg()), "");
  const auto texts = texts_of(figure.svg());
  for (const char* text : {"Check of b", "80 Hz", "action", "warning"}) {
    EXPECT_THAT(texts, Contains(text));
  }
  const Panel& panel = figure.picture.panels.front();
  ASSERT_EQ(panel.series.size(), 5U); // the line, and two limits on either side
  EXPECT_EQ(panel.series[0].points.back().y, 1.0);
  EXPECT_EQ(panel.series[1].points.front().y, 1.0);
  EXPECT_EQ(panel.series[2].points.front().y, 0.5);
}

TEST(ControlChartFigure, WritesEveryNumber) {
  EXPECT_THAT(control_figure(example(), "check").csv,
              HasSubstr("\n\"80 Hz\",magnitude_rel,r,2026-11-22T10:00:00Z,2,0.002,0.001,0.002,in "
                        "control\n"));
}

TEST(ControlChartFigure, SaysSoWithoutPoints) {
  const Figure figure = control_figure({.title = "nothing"}, "check");
  EXPECT_EQ(problem_of(figure.svg()), "");
  EXPECT_THAT(texts_of(figure.svg()), Contains("no data"));
}

} // namespace
} // namespace dyncal::inline views::figures
