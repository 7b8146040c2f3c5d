#include "services/views/figures/stamp_deviation.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "tests/unit/services/views/figures/well_formed.hpp"

namespace dyncal::inline views::figures {
namespace {

using testing::Contains;
using testing::HasSubstr;

StampDeviationData data_of(std::size_t seconds) {
  StampDeviationData data;
  data.title = "deviation";
  data.comments = {"positive: too late"};
  data.tick_s = 9.26e-9;
  for (std::size_t s = 0; s < seconds; ++s) {
    data.deviations.push_back(
        {s / 100, static_cast<double>(s), 50e-9 * std::sin(0.1 * static_cast<double>(s))});
  }
  data.allan = {{1.0, 1e-8}, {2.0, 5e-9}};
  return data;
}

TEST(StampDeviationFigure, IsWellFormedAndHoldsEveryDeviation) {
  const Figure figure = stamp_deviation_figure(data_of(300), "time");
  EXPECT_EQ(problem_of(figure.svg()), "");
  EXPECT_THAT(texts_of(figure.svg()), Contains(HasSubstr("Allan deviation")));
  EXPECT_THAT(figure.csv, HasSubstr("# positive: too late\nsession,time_s,deviation_s\n1,0,0\n"));
  EXPECT_EQ(std::count(figure.csv.begin(), figure.csv.end(), '\n'), 3 + 300);
}

TEST(StampDeviationFigure, TakesRecordsOfDaysAndOnesWithoutAnything) {
  EXPECT_THAT(texts_of(stamp_deviation_figure(data_of(20000), "time").svg()),
              Contains("time in h"));
  StampDeviationData nothing;
  EXPECT_EQ(problem_of(stamp_deviation_figure(nothing, "time").svg()), "");
  nothing.deviations = {{0, 1.0, 0.0}};
  EXPECT_EQ(problem_of(stamp_deviation_figure(nothing, "time").svg()), "");
}

} // namespace
} // namespace dyncal::inline views::figures
