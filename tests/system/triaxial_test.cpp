// dyncal triaxial: from results along three directions to the response of three axes.
#include <array>
#include <complex>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/result_text.hpp"
#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;
using Matrix = std::array<std::array<std::complex<double>, 3>, 3>; // [row][column]

constexpr std::array axes{'x', 'y', 'z'};
constexpr double u = 1e-3;

const Matrix response{{{{std::polar(0.98, -0.5), std::polar(0.02, 1.0), {0.001, 0.004}}},
                       {{std::polar(0.015, 2.0), std::polar(1.01, -0.52), {-0.01, 0.002}}},
                       {{std::polar(0.03, -0.4), {0.002, -0.003}, std::polar(0.95, -0.48)}}}};
// Column j: what the base does when excited along j, relative to its motion along j.
const Matrix motion{{{{{1.0, 0.0}, {0.05, 0.01}, {0.02, 0.0}}},
                     {{{0.03, 0.01}, {1.0, 0.0}, {0.0, -0.04}}},
                     {{{-0.02, 0.0}, {0.01, 0.01}, {1.0, 0.0}}}}};

class Triaxial : public testing::Test {
protected:
  std::filesystem::path folder = fresh_folder(
      std::string("triaxial-") + testing::UnitTest::GetInstance()->current_test_info()->name());

  // A result file with one point for each axis but the one that is left out.
  std::filesystem::path file(const std::string& name, const std::string& channels,
                             const std::array<std::complex<double>, 3>& values, int left_out = -1) {
    ResultText text(channels + "z");
    for (int i = 0; i < 3; ++i) {
      if (i == left_out) {
        continue;
      }
      const std::complex<double> value = values[static_cast<std::size_t>(i)];
      text.add_value(channels + axes[static_cast<std::size_t>(i)], "80", value, u,
                     u / std::abs(value));
    }
    return text.write(folder / name);
  }
  static std::array<std::complex<double>, 3> column(const Matrix& matrix, std::size_t j) {
    return {matrix[0][j], matrix[1][j], matrix[2][j]};
  }

  nlohmann::json json_of(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "triaxial");
    arguments.emplace_back("--json");
    ProgramRun run("dyncal", arguments, folder);
    EXPECT_EQ(run.wait(patience), 0) << run.errors();
    return nlohmann::json::parse(run.output(), nullptr, false);
  }
  std::string error_of(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "triaxial");
    ProgramRun run("dyncal", arguments, folder);
    EXPECT_NE(run.wait(patience).value_or(0), 0);
    return run.errors();
  }
};

TEST_F(Triaxial, TakesTheMotionAcrossOutByATriaxialReference) {
  std::vector<std::string> arguments;
  for (std::size_t j = 0; j < 3; ++j) {
    std::array<std::complex<double>, 3> answer{};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        answer[i] += response[i][k] * motion[k][j];
      }
    }
    const std::string axis(1, axes[j]);
    arguments.insert(arguments.end(),
                     {"--" + axis, file("sensor-" + axis + ".json", "dau/acceleration_", answer),
                      "--motion-" + axis,
                      file("motion-" + axis + ".json", "acs/reference_", column(motion, j),
                           static_cast<int>(j))});
  }
  const auto json = json_of(arguments);
  ASSERT_EQ(json["points"].size(), 1U);
  for (std::size_t j = 0; j < 3; ++j) {
    const auto& excitation = json["points"][0]["excitations"][j];
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(excitation["response"][i]["real"], response[i][j].real(), 1e-12);
      EXPECT_NEAR(excitation["response"][i]["imaginary"], response[i][j].imag(), 1e-12);
      EXPECT_NEAR(excitation["response"][i]["ratio"],
                  std::abs(response[i][j]) / std::abs(response[j][j]), 1e-12);
      EXPECT_NEAR(excitation["response"][i]["u_component"], u,
                  1e-3); // and what the reference adds to it
    }
  }
}

TEST_F(Triaxial, BoundsWhatASingleAxisReferenceDoesNotKnow) {
  const auto z = file("z.json", "dau/acceleration_", column(response, 2));
  const auto excitation =
      json_of({"--z", z, "--transverse-motion", "0.05"})["points"][0]["excitations"][0];
  EXPECT_EQ(excitation["along"], "z");
  EXPECT_NEAR(excitation["largest_transverse_ratio"], std::abs(response[1][2]) / 0.95, 1e-12);
  EXPECT_NEAR(excitation["response"][1]["u_ratio"], std::hypot(u / 0.95, 0.05 / std::sqrt(3.0)),
              1e-5);
}

TEST_F(Triaxial, SaysInOneLineWhatIsMissing) {
  const auto z = file("z.json", "dau/acceleration_", column(response, 2));
  EXPECT_THAT(error_of({}), HasSubstr("give the result of at least one direction"));
  EXPECT_THAT(error_of({"--z", z, "--motion-z", z}),
              HasSubstr("needs the results and the motions of all three directions"));
  EXPECT_THAT(error_of({"--z", z, "--channels", "a", "b", "c"}),
              HasSubstr("no frequency and level in common at which a, b and c have values"));
  EXPECT_THAT(error_of({"--z", file("other.json", "dau/field", column(response, 2))}),
              HasSubstr("name them: --channels X Y Z"));
  std::ofstream(folder / "no.json") << "{}";
  EXPECT_THAT(error_of({"--z", folder / "no.json"}),
              HasSubstr("no.json: there is no 'schema' in it"));
}

} // namespace
} // namespace dyncal::tests
