// Raw signals of a laser interferometer in a file, evaluated as `dyncal analyse` does.
#include <cmath>
#include <complex>
#include <fstream>
#include <map>
#include <numbers>
#include <random>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "services/bench/file/bench_file.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "services/records/replay/file_input.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline records {
namespace {

constexpr double rate_hz = 200'000.0;
constexpr double wavelength_m = 632.8211e-9;
constexpr double turn = 2.0 * std::numbers::pi;
constexpr std::complex<double> response{0.03, -0.01}; // V/(m/s^2)

struct Step {
  double frequency_hz;
  double level_m_s2;
};
// The last one moves the mirror by 50 nm, a third of a turn.
constexpr std::array steps{Step{160.0, 10.0}, Step{1000.0, 10.0}, Step{10000.0, 197.0}};

constexpr const char* bench = R"(bench = "laser"
[excitation]
frequencies_hz = ["160", "1000", "10000"]
level = [10.0, 10.0, 197.0]
settling_s = 0.3
duration_s = 0.8
[generator]
driver = "none"
[sources.acs]
driver = "file"
path = "acs.npy"
sample_rate_hz = 200000
units = { sync = "V", dut = "V" }
[sources.acs.interferometer]
u1 = "u1"
u2 = "u2"
wavelength_nm = 632.8211
u_wavelength_rel = 1e-7
[method]
kind = "analogue"
reference = "acs/displacement"
sync_acs = "acs/sync"
dut = ["acs/dut"]
)";

// Columns u1, u2, sync, dut of 14 bits and noise, beside drift of the table and hum.
class Recorder {
public:
  explicit Recorder(std::uint64_t seed) : random_(seed) {}

  void add(double seconds, const Step& step) {
    const double angular = turn * step.frequency_hz;
    const double phase = phase_(random_);
    for (std::size_t i = 0; i < static_cast<std::size_t>(seconds * rate_hz); ++i) {
      const double angle = angular * static_cast<double>(i) / rate_hz + phase;
      const std::complex<double> a = std::polar(step.level_m_s2, angle);
      sample(-a.imag() / (angular * angular), (a * response).imag(),
             step.level_m_s2 > 0.0 ? std::sin(angle + 0.5) : 0.0);
    }
  }

  void write(const std::filesystem::path& path) const {
    std::string header =
        "{'descr': [('u1', '<f8'), ('u2', '<f8'), ('sync', '<f8'), ('dut', '<f8')], "
        "'fortran_order': False, 'shape': (" +
        std::to_string(rows_.size() / 4) + ",), }";
    header.resize(245, ' ');
    std::ofstream file(path, std::ios::binary);
    file.write("\x93NUMPY\x01\x00\xf6\x00", 10);
    file << header << '\n';
    file.write(reinterpret_cast<const char*>(rows_.data()),
               static_cast<std::streamsize>(rows_.size() * sizeof(double)));
  }

private:
  void sample(double motion_m, double dut, double sync) {
    const double t = static_cast<double>(rows_.size() / 4) / rate_hz;
    const double s = motion_m + 1.5e-7 * t + 2e-9 * std::sin(turn * 50.02 * t);
    const double phi = 2.0 * turn * s / wavelength_m + 0.3;
    const auto counts = [](double volt) { return std::round(8192.0 * volt) / 8192.0; };
    rows_.push_back(counts(0.02 + 0.64 * (std::cos(phi) + 2e-3 * normal_(random_))));
    rows_.push_back(counts(-0.019 + 0.61 * (std::sin(phi - 0.0873) + 2e-3 * normal_(random_))));
    rows_.push_back(sync + 1e-4 * normal_(random_));
    rows_.push_back(dut + 1e-4 * normal_(random_));
  }

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> phase_{-3.0, 3.0};
  std::vector<double> rows_;
};

Recipe recipe() {
  Recipe recipe;
  recipe.bench = "laser";
  recipe.run = "r1";
  recipe.roles.method = EvaluationMethod::analogue;
  recipe.roles.reference = {"acs", "displacement"};
  recipe.roles.sync_acs = {"acs", "sync"};
  recipe.roles.dut = {{"acs", "dut"}};
  recipe.systematic.reference_magnitude_rel = 1e-6;
  recipe.systematic.reference_phase_rad = 1e-6;
  recipe.systematic.acs_delay_s = 1e-10;
  std::uint32_t number = 0;
  for (const Step& step : steps) {
    const std::string text = fmt::format("{:g}", step.frequency_hz);
    recipe.steps.push_back({.step = ++number,
                            .repetition = 1,
                            .frequency_text_hz = text,
                            .frequency = *analysis::Frequency::parse(text),
                            .level_m_s2 = step.level_m_s2,
                            .settling_s = 0.3,
                            .duration_s = 0.8});
  }
  return recipe;
}

std::map<std::uint32_t, StepResult> evaluate(FileInput& input) {
  RunEvaluator evaluator(recipe());
  std::map<std::uint32_t, StepResult> results;
  const auto collect = [&] {
    EvaluationOutput output = evaluator.take_output();
    for (auto* some : {&output.results, &output.settled}) {
      for (StepResult& result : *some) {
        results.insert_or_assign(result.step, std::move(result));
      }
    }
  };
  EXPECT_TRUE(evaluator.describe("acs", input.description()));
  for (bool ended = false; !ended;) {
    const auto block = input.next();
    if (!block) {
      ADD_FAILURE() << block.error().message;
      break;
    }
    if (block->description) {
      evaluator.describe_signals("acs", block->description->quadrature_signals);
    }
    evaluator.add("acs", input.view(*block));
    ended = block->end_of_stream;
    collect();
  }
  evaluator.end_of_excitation(false);
  evaluator.finish_now();
  collect();
  return results;
}

TEST(InterferometerFile, GivesTheResponseFromRawSignals) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const tests::TemporaryFolder folder;
    Recorder recorder(seed);
    recorder.add(0.3, {1000.0, 0.0});
    for (const Step& step : steps) {
      recorder.add(1.3, step);
      recorder.add(0.3, {1000.0, 0.0});
    }
    recorder.write(folder.path() / "acs.npy");
    const auto file = parse_bench_file(bench, folder.path() / "bench.toml");
    ASSERT_TRUE(file) << file.error().message;
    const auto input = FileInput::open(*file->source("acs"));
    ASSERT_TRUE(input) << input.error().message;
    const auto results = evaluate(**input);
    ASSERT_EQ(results.size(), steps.size());
    for (const auto& [number, result] : results) {
      ASSERT_TRUE(result.valid) << result.problem;
      const std::complex<double> off = std::polar(result.magnitude, result.phase_rad) / response;
      const double u_rel = result.u_magnitude / result.magnitude;
      EXPECT_LT(std::abs(std::abs(off) - 1.0), 4.0 * u_rel) << number;
      EXPECT_LT(std::abs(std::arg(off)), 4.0 * result.u_phase_rad) << number;
      EXPECT_LT(u_rel, 5e-3) << number;
      EXPECT_EQ(result.unit, "(V)/(m/s^2)");
    }
    EXPECT_GE((*input)->description().quadrature_signals.front().turns_covered, 1.0);
  }
}

} // namespace
} // namespace dyncal::inline records
