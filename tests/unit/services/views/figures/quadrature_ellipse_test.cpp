#include "services/views/figures/quadrature_ellipse.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <gmock/gmock.h>

#include "analysis/interferometer/quadrature_phase.hpp"
#include "tests/unit/services/views/figures/well_formed.hpp"

namespace dyncal::inline views::figures {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

QuadratureEllipseData data() {
  return {.title = {"Interferometer of acs/displacement", "bench acc-1"},
          .ellipse = {0.021, -0.018, 1.046, 0.087, 0.64},
          .displacement_per_turn_m = -316.4e-9,
          .u_ellipse_rad = {3e-4, 4e-4},
          .periodic_error_rad = {1e-3, 2e-3, 5e-4, 5.3e-3},
          .radius_deviation_rel = {1e-3, -2e-3, 3e-3, 0.0},
          .below = "Ellipse: of this record, 3.2 turns of phase."};
}

// Columns of the CSV.
std::vector<std::vector<double>> rows_of(const std::string& csv) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#') || line.starts_with("phase")) {
      continue;
    }
    std::istringstream cells(line);
    std::vector<double>& row = rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) {
      row.push_back(std::stod(cell));
    }
  }
  return rows;
}

TEST(QuadratureEllipseFigure, DrawsBothCurvesAndEveryOrder) {
  const Figure figure = quadrature_ellipse_figure(data(), "ellipse-acs-displacement");
  EXPECT_EQ(problem_of(figure.svg()), "");
  const auto texts = texts_of(figure.svg());
  for (const char* text : {"Interferometer of acs/displacement", "as recorded", "corrected",
                           "phase in degrees", "± u of the ellipse"}) {
    EXPECT_THAT(texts, Contains(HasSubstr(text)));
  }
  EXPECT_THAT(texts, Contains("order 4: 0.27 nm")); // 5.3e-3 of a turn of 316.4 nm, over 2 pi
  EXPECT_THAT(texts, Contains(HasSubstr("3.2 turns of phase")));
  EXPECT_THAT(texts, Contains("radius, measured"));
  ASSERT_EQ(figure.picture.panels.size(), 2U);
  const auto& dots = figure.picture.panels[1].series.back().points;
  ASSERT_EQ(dots.size(), 4U);
  EXPECT_EQ(dots[1].x, 135.0);
  EXPECT_NEAR(dots[1].y, -316.4 * 2e-3 / 6.2831853, 1e-6);
  EXPECT_NEAR(figure.picture.panels[1].band.at(0).high, 316.4 * 5e-4 / 6.2831853, 1e-6);
}

// What is drawn as recorded must become what is drawn as corrected by the correction that the
// programs use.
TEST(QuadratureEllipseFigure, IsCorrectedAsTheProgramsDo) {
  const auto rows = rows_of(quadrature_ellipse_figure(data(), "ellipse").csv);
  ASSERT_EQ(rows.size(), 181U);
  std::vector<double> u1;
  std::vector<double> u2;
  double largest_nm = 0.0;
  for (const auto& row : rows) {
    ASSERT_EQ(row.size(), 10U);
    u1.push_back(row[1]);
    u2.push_back(row[2]);
    EXPECT_NEAR(std::hypot(row[3], row[4]), 0.64, 1e-12);
    largest_nm = std::max(largest_nm, 1e9 * std::abs(row[8]));
  }
  EXPECT_NEAR(largest_nm, 0.267, 0.001);
  EXPECT_NEAR(1e9 * rows[44][9], 316.4 * 1e-3 / 6.2831853, 1e-6); // 88 degrees: the first quarter
  EXPECT_NEAR(1e9 * rows[46][9], -316.4 * 2e-3 / 6.2831853, 1e-6);
  analysis::QuadraturePhase phase(data().ellipse);
  std::vector<double> turns(u1.size());
  ASSERT_TRUE(phase.push(u1, u2, turns));
  for (std::size_t i = 0; i < turns.size(); ++i) {
    EXPECT_NEAR(6.283185307179586 * turns[i], rows[i][0], 1e-9);
  }
}

TEST(QuadratureEllipseFigure, LeavesOutWhatIsNotStated) {
  QuadratureEllipseData bare = data();
  bare.u_ellipse_rad.clear();
  bare.periodic_error_rad.clear();
  bare.radius_deviation_rel.clear();
  bare.below.clear();
  const Figure figure = quadrature_ellipse_figure(bare, "ellipse");
  EXPECT_EQ(problem_of(figure.svg()), "");
  const auto texts = texts_of(figure.svg());
  EXPECT_THAT(texts, Contains("no data"));
  EXPECT_THAT(texts, Not(Contains(HasSubstr("order"))));
}

} // namespace
} // namespace dyncal::inline views::figures
