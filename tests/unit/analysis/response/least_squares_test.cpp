// The judge from outside: nonlinear problems of the NIST Statistical Reference Datasets (StRD) of
// the sine and exponential kind, from both of their starting points, to nine digits. It is the
// solver of `dyncal model`; tests/system/reference_datasets_test.cpp judges `dyncal fit` by a
// problem of the same collection.
#include "analysis/response/least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/reference_datasets.hpp"

namespace dyncal::analysis {
namespace {

using Model = std::function<double(double x, std::span<const double> b, std::span<double> slopes)>;

struct NistProblem {
  Model model;
  std::vector<double> x, y;
  std::vector<std::vector<double>> starts;
  std::vector<double> certified, certified_u;
  double certified_rss;
  bool exchangeable_terms = false; // pairs (b1, b2), (b3, b4) ... that may come in any order
};

// Places of the parameters when exchangeable pairs are put in the order of their second.
std::vector<std::size_t> order_of(const NistProblem& nist, const std::vector<double>& parameters) {
  std::vector<std::size_t> pairs(parameters.size() / 2), order;
  std::iota(pairs.begin(), pairs.end(), 0);
  if (nist.exchangeable_terms) {
    std::sort(pairs.begin(), pairs.end(), [&](std::size_t a, std::size_t b) {
      return parameters[2 * a + 1] < parameters[2 * b + 1];
    });
  }
  for (const std::size_t pair : pairs) {
    order.push_back(2 * pair);
    order.push_back(2 * pair + 1);
  }
  if (order.size() < parameters.size()) {
    order.push_back(order.size());
  }
  return order;
}

void expect_nine_digits(const NistProblem& nist) {
  for (const std::vector<double>& start : nist.starts) {
    LeastSquaresProblem problem;
    problem.residuals = nist.x.size();
    problem.start = start;
    problem.variance = ResidualVariance::estimated;
    problem.evaluate = [&](std::span<const double> b, std::span<double> residuals,
                           std::span<double> jacobian) {
      std::vector<double> slopes(b.size());
      for (std::size_t i = 0; i < nist.x.size(); ++i) {
        residuals[i] = nist.model(nist.x[i], b, slopes) - nist.y[i];
        for (std::size_t k = 0; k < b.size() && !jacobian.empty(); ++k) {
          jacobian[i * b.size() + k] = slopes[k];
        }
      }
      return true;
    };
    const auto solution = solve_least_squares(problem);
    ASSERT_TRUE(solution.has_value()) << solution.error().message;
    const std::vector<std::size_t> order = order_of(nist, solution->parameters);
    for (std::size_t k = 0; k < nist.certified.size(); ++k) {
      EXPECT_NEAR(solution->parameters[order[k]] / nist.certified[k], 1.0, 1e-9) << k;
      EXPECT_NEAR(solution->u(order[k]) / nist.certified_u[k], 1.0, 1e-8) << k;
    }
    EXPECT_NEAR(solution->rss / nist.certified_rss, 1.0, 1e-9);
  }
}

double rise(double x, std::span<const double> b, std::span<double> slopes) { // b1 (1 - exp(-b2 x))
  const double decay = std::exp(-b[1] * x);
  slopes[0] = 1.0 - decay;
  slopes[1] = b[0] * x * decay;
  return b[0] * (1.0 - decay);
}

TEST(LeastSquares, MeetsMisra1a) {
  expect_nine_digits({rise,
                      {77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8,
                       593.1, 689.1, 760.0},
                      {10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01,
                       66.40, 75.47, 81.78},
                      {{500.0, 1e-4}, {250.0, 5e-4}},
                      {2.3894212918E+02, 5.5015643181E-04},
                      {2.7070075241E+00, 7.2668688436E-06},
                      1.2455138894E-01,
                      false});
}

TEST(LeastSquares, MeetsBoxBod) {
  expect_nine_digits({rise,
                      {1, 2, 3, 5, 7, 10},
                      {109, 149, 149, 191, 213, 224},
                      {{1.0, 1.0}, {100.0, 0.75}},
                      {2.1380940889E+02, 5.4723748542E-01},
                      {1.2354515176E+01, 1.0455993237E-01},
                      1.1680088766E+03,
                      false});
}

TEST(LeastSquares, MeetsLanczos3) {
  NistProblem nist;
  nist.y = {2.5134, 2.0443, 1.6684, 1.3664, 1.1232, 0.9269, 0.7679, 0.6389,
            0.5338, 0.4479, 0.3776, 0.3197, 0.2720, 0.2325, 0.1997, 0.1723,
            0.1493, 0.1301, 0.1138, 0.1000, 0.0883, 0.0783, 0.0698, 0.0624};
  for (std::size_t i = 0; i < nist.y.size(); ++i) {
    nist.x.push_back(static_cast<double>(i) / 20.0);
  }
  nist.model = [](double x, std::span<const double> b, std::span<double> slopes) {
    double sum = 0.0;
    for (std::size_t k = 0; k < 6; k += 2) {
      slopes[k] = std::exp(-b[k + 1] * x);
      slopes[k + 1] = -b[k] * x * slopes[k];
      sum += b[k] * slopes[k];
    }
    return sum;
  };
  nist.starts = {{1.2, 0.3, 5.6, 5.5, 6.5, 7.6}, {0.5, 0.7, 3.6, 4.2, 4.0, 6.3}};
  nist.certified = {8.6816414977E-02, 9.5498101505E-01, 8.4400777463E-01,
                    2.9515951832E+00, 1.5825685901E+00, 4.9863565084E+00};
  nist.certified_u = {1.7197908859E-02, 9.7041624475E-02, 4.1488663282E-02,
                      1.0766312506E-01, 5.8371576281E-02, 3.4436403035E-02};
  nist.certified_rss = 1.6117193594E-08;
  nist.exchangeable_terms = true;
  expect_nine_digits(nist);
}

TEST(LeastSquares, MeetsMgh17) {
  NistProblem nist;
  nist.y = {0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.850, 0.818, 0.784, 0.751,
            0.718, 0.685, 0.658, 0.628, 0.603, 0.580, 0.558, 0.538, 0.522, 0.506, 0.490,
            0.478, 0.467, 0.457, 0.448, 0.438, 0.431, 0.424, 0.420, 0.414, 0.411, 0.406};
  for (std::size_t i = 0; i < nist.y.size(); ++i) {
    nist.x.push_back(10.0 * static_cast<double>(i));
  }
  nist.model = [](double x, std::span<const double> b, std::span<double> slopes) {
    const double first = std::exp(-x * b[3]), second = std::exp(-x * b[4]);
    slopes[0] = 1.0;
    slopes[1] = first;
    slopes[2] = second;
    slopes[3] = -x * b[1] * first;
    slopes[4] = -x * b[2] * second;
    return b[0] + b[1] * first + b[2] * second;
  };
  nist.starts = {{0.5, 1.5, -1.0, 0.01, 0.02}};
  nist.certified = {3.7541005211E-01, 1.9358469127E+00, -1.4646871366E+00, 1.2867534640E-02,
                    2.2122699662E-02};
  nist.certified_u = {2.0723153551E-03, 2.2031669222E-01, 2.2175707739E-01, 4.4861358114E-04,
                      8.9471996575E-04};
  nist.certified_rss = 5.4648946975E-05;
  expect_nine_digits(nist);
}

TEST(LeastSquares, MeetsEnsoOfThreeSines) {
  NistProblem nist;
  nist.y = tests::enso_pressure;
  ASSERT_EQ(nist.y.size(), 168u);
  for (std::size_t i = 0; i < nist.y.size(); ++i) {
    nist.x.push_back(static_cast<double>(i + 1));
  }
  nist.model = [](double x, std::span<const double> b, std::span<double> slopes) {
    const double turn = 2.0 * std::numbers::pi * x;
    slopes[0] = 1.0;
    slopes[1] = std::cos(turn / 12.0);
    slopes[2] = std::sin(turn / 12.0);
    double sum = b[0] + b[1] * slopes[1] + b[2] * slopes[2];
    for (std::size_t k = 3; k < 9; k += 3) {
      slopes[k + 1] = std::cos(turn / b[k]);
      slopes[k + 2] = std::sin(turn / b[k]);
      slopes[k] = (b[k + 1] * slopes[k + 2] - b[k + 2] * slopes[k + 1]) * turn / (b[k] * b[k]);
      sum += b[k + 1] * slopes[k + 1] + b[k + 2] * slopes[k + 2];
    }
    return sum;
  };
  nist.starts = {{11.0, 3.0, 0.5, 40.0, -0.7, -1.3, 25.0, -0.3, 1.4},
                 {10.0, 3.0, 0.5, 44.0, -1.5, 0.5, 26.0, -0.1, 1.5}};
  nist.certified = tests::enso_parameters;
  nist.certified_u = {1.7488832467E-01, 2.4310052139E-01, 2.4354686618E-01,
                      9.4408025976E-01, 2.8078369611E-01, 4.8073701119E-01,
                      4.1612939130E-01, 5.1460022911E-01, 2.5434468893E-01};
  nist.certified_rss = tests::enso_rss;
  expect_nine_digits(nist);
}

LeastSquaresProblem line_through(const std::vector<double>& y, Loss loss) {
  LeastSquaresProblem problem;
  problem.residuals = y.size();
  problem.start = {0.0, 0.0};
  problem.loss = loss;
  problem.evaluate = [y](std::span<const double> b, std::span<double> residuals,
                         std::span<double> jacobian) {
    for (std::size_t i = 0; i < y.size(); ++i) {
      residuals[i] = y[i] - b[0] - b[1] * static_cast<double>(i);
      if (!jacobian.empty()) {
        jacobian[2 * i] = -1.0;
        jacobian[2 * i + 1] = -static_cast<double>(i);
      }
    }
    return true;
  };
  return problem;
}

TEST(LeastSquares, ARobustLossDisregardsAnOutlier) {
  std::vector<double> y;
  for (int i = 0; i < 20; ++i) {
    y.push_back(3.0 + 2.0 * i + (i % 2 == 0 ? 0.5 : -0.5));
  }
  y[7] += 1000.0;
  const auto plain = solve_least_squares(line_through(y, Loss::none));
  const auto huber = solve_least_squares(line_through(y, Loss::huber));
  ASSERT_TRUE(plain && huber);
  EXPECT_GT(std::abs(plain->parameters[0] - 3.0), 30.0);
  EXPECT_NEAR(huber->parameters[0], 3.0, 0.5);
  EXPECT_NEAR(huber->parameters[1], 2.0, 0.05);
}

TEST(LeastSquares, SaysWhatItCannotDetermine) {
  LeastSquaresProblem twice = line_through({1.0, 2.0, 3.0}, Loss::none);
  twice.evaluate = [](std::span<const double> b, std::span<double> residuals,
                      std::span<double> jacobian) {
    for (std::size_t i = 0; i < 3; ++i) {
      residuals[i] = 1.0 - b[0] - b[1];
      if (!jacobian.empty()) {
        jacobian[2 * i] = jacobian[2 * i + 1] = -1.0;
      }
    }
    return true;
  };
  EXPECT_EQ(solve_least_squares(twice).error().code, ErrorCode::ill_conditioned);
  EXPECT_EQ(solve_least_squares(line_through({1.0}, Loss::none)).error().code,
            ErrorCode::too_few_samples);
  EXPECT_EQ(solve_least_squares(line_through({1.0, std::nan(""), 2.0}, Loss::none)).error().code,
            ErrorCode::not_finite);
}

} // namespace
} // namespace dyncal::analysis
