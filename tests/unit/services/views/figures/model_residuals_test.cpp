#include "services/views/figures/model_residuals.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/views/figures/well_formed.hpp"

namespace dyncal::inline views::figures {
namespace {

using testing::Contains;
using testing::HasSubstr;

ModelResidualData residuals() {
  ModelResidualData data;
  data.title = "dau/acceleration: second order";
  data.comments = {"gain = 1.02, u = 0.01"};
  for (const double f : {10.0, 50.0, 200.0}) {
    data.residuals.push_back({.frequency_hz = f,
                              .magnitude_rel = 1e-3,
                              .u_magnitude_rel = 2e-3,
                              .u_own_magnitude_rel = 1e-3,
                              .own_magnitude_rel = 5e-4,
                              .phase_rad = -1e-3,
                              .u_phase_rad = 2e-3,
                              .u_own_phase_rad = 1e-3,
                              .own_phase_rad = 2e-2});
  }
  return data;
}

TEST(ModelResidualFigure, ShowsEveryPointInItsUnitAndInU) {
  const Figure figure = model_residual_figure(residuals(), "residuals");
  EXPECT_EQ(problem_of(figure.svg()), "");
  EXPECT_EQ(count_elements(figure.svg(), "circle"), 2U * 3 + 1); // two panels and the legend
  const auto texts = texts_of(figure.svg());
  EXPECT_THAT(texts, Contains(HasSubstr("magnitude: residual in %")));
  EXPECT_THAT(texts, Contains(HasSubstr("phase: residual in degrees")));
  EXPECT_THAT(texts, Contains("residual in u").Times(2));
  EXPECT_THAT(texts, Contains("20")); // 2e-2 / 1e-3: the axis reaches what lies outside +-3
}

TEST(ModelResidualFigure, WritesEveryNumber) {
  const Figure figure = model_residual_figure(residuals(), "residuals");
  EXPECT_THAT(figure.csv, HasSubstr("# gain = 1.02, u = 0.01\n"));
  EXPECT_THAT(figure.csv, HasSubstr("\n10,0.001,0.002,0.001,0.00050000000000000001,-0.001,0.002,"
                                    "0.001,0.02\n"));
}

TEST(ModelResidualFigure, SaysSoWithoutPoints) {
  const Figure figure = model_residual_figure({.title = "nothing"}, "residuals");
  EXPECT_EQ(problem_of(figure.svg()), "");
  EXPECT_THAT(texts_of(figure.svg()), Contains("no data"));
}

} // namespace
} // namespace dyncal::inline views::figures
