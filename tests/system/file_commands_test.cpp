// The commands that look at one file: dyncal fit and dyncal intervals.
#include <cmath>
#include <complex>
#include <numbers>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/result_text.hpp"
#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

constexpr std::int64_t epoch_ns = 1'700'000'000'123'456'789;
constexpr double frequency_hz = 79.8;
constexpr double amplitude = 2.5;
constexpr double phase_rad = 0.7;

// 2000 samples at uneven instants about 1 ms apart, with an offset and, if wanted, a second
// harmonic.
std::filesystem::path sine_file(const std::filesystem::path& folder, double harmonic = 0.0,
                                const std::string& column = "y") {
  const std::filesystem::path path = folder / "sine.csv";
  std::ofstream stream(path);
  stream << "t_ns," << column << ",constant\n";
  for (int i = 0; i < 2000; ++i) {
    const std::int64_t dt_ns = std::int64_t{997'000} * i + (i * 7919) % 5000;
    const double angle = 2.0 * std::numbers::pi * frequency_hz * static_cast<double>(dt_ns) * 1e-9;
    stream << fmt::format(
        "{},{:.17g},{}\n", epoch_ns + dt_ns,
        amplitude * std::sin(angle + phase_rad) + 0.25 + harmonic * std::sin(2.0 * angle), 4);
  }
  return path;
}

class FileCommands : public testing::Test {
protected:
  std::filesystem::path folder = fresh_folder(
      std::string("file-") + testing::UnitTest::GetInstance()->current_test_info()->name());

  nlohmann::json json_of(std::vector<std::string> arguments, int status = 0) {
    ProgramRun run("dyncal", arguments, folder);
    EXPECT_EQ(run.wait(patience), status) << run.errors();
    return nlohmann::json::parse(run.output(), nullptr, false);
  }
  std::string error_of(std::vector<std::string> arguments) {
    ProgramRun run("dyncal", arguments, folder);
    EXPECT_NE(run.wait(patience).value_or(0), 0);
    return run.errors();
  }
};

TEST_F(FileCommands, FitFindsAmplitudePhaseAndOffsetAtAKnownFrequency) {
  const auto json =
      json_of({"fit", sine_file(folder), "--frequency", "79.8", "--column", "y", "--json"});
  ASSERT_FALSE(json.is_discarded());
  EXPECT_FALSE(json.contains("u_frequency_hz"));
  const auto& y = json["columns"]["y"];
  EXPECT_NEAR(y["amplitude"], amplitude, 1e-10);
  EXPECT_NEAR(y["phase_rad"], phase_rad, 1e-10);
  EXPECT_NEAR(y["C"], 0.25, 1e-10);
  EXPECT_NEAR(y["A_sin"], amplitude * std::cos(phase_rad), 1e-10);
  EXPECT_EQ(y["samples"], 2000);
}

TEST_F(FileCommands, FitWithoutAFrequencyEstimatesItAndItsUncertainty) {
  const auto json = json_of({"fit", sine_file(folder), "--column", "y", "--json"});
  EXPECT_NEAR(json["frequency_hz"], frequency_hz, 1e-8);
  EXPECT_TRUE(json.contains("u_frequency_hz"));
}

TEST_F(FileCommands, FitMovesThePhaseToTheReferenceTime) {
  const std::string later = std::to_string(epoch_ns + 1'000'000'000);
  const auto json = json_of({"fit", sine_file(folder), "--frequency", "79.8", "--column", "y",
                             "--reference-time", later, "--json"});
  EXPECT_NEAR(std::remainder(json["columns"]["y"]["phase_rad"].get<double>() - phase_rad -
                                 2.0 * std::numbers::pi * frequency_hz,
                             2.0 * std::numbers::pi),
              0.0, 1e-9);
}

TEST_F(FileCommands, FitTakesHarmonicsOutOfTheResiduals) {
  const auto file = sine_file(folder, 0.1);
  const auto plain = json_of({"fit", file, "--frequency", "79.8", "--column", "y", "--json"});
  const auto extended = json_of({"fit", file, "--frequency", "79.8", "--column", "y", "--harmonics",
                                 "2", "--drift", "1", "--hum", "50", "--json"});
  EXPECT_GT(plain["columns"]["y"]["rss"].get<double>(), 1.0);
  EXPECT_LT(extended["columns"]["y"]["rss"].get<double>(), 1e-12);
  EXPECT_NEAR(extended["columns"]["y"]["amplitude"], amplitude, 1e-9);
}

// A file of a program that writes Latin-1.
// Ticks of 500 us of a sensor of 1010.5 Hz: a saw-tooth of 21 Hz, its third harmonic at 2 f.
TEST_F(FileCommands, FitAllowsForTicksInStepWithTheSine) {
  int drawn = 0;
  double largest = 0.0;
  for (const double begin_s : {0.0, 1.1e-4, 2.7e-4, 4.2e-4}) {
    const std::filesystem::path path = folder / "ticks.csv";
    std::ofstream stream(path);
    stream << "t_ns,y\n";
    for (int i = 0; i < 2000; ++i) {
      const double t_s = begin_s + i / 1010.5;
      const auto ticks = std::int64_t{500'000} * static_cast<std::int64_t>(t_s / 5e-4) + 250'000;
      const double angle = 2.0 * std::numbers::pi * 31.5 * t_s;
      stream << fmt::format("{},{:.17g}\n", ticks, amplitude * std::sin(angle + phase_rad));
    }
    stream.close();
    const auto y = json_of({"fit", path, "--frequency", "31.5", "--json"})["columns"]["y"];
    const double error = y["amplitude"].get<double>() - amplitude;
    EXPECT_LE(std::abs(error), 2.0 * y["u_amplitude"].get<double>()) << begin_s;
    largest = std::max(largest, std::abs(error));
    ++drawn;
  }
  EXPECT_EQ(drawn, 4);
  EXPECT_GT(largest, 2e-3 * amplitude);
}

TEST_F(FileCommands, FitTakesNamesThatAreNotUtf8) {
  const auto json =
      json_of({"fit", sine_file(folder, 0.0, "Verst\xe4rker"), "--frequency", "79.8", "--json"});
  ASSERT_FALSE(json.is_discarded());
  EXPECT_NEAR(json["columns"]["Verst\xef\xbf\xbdrker"]["amplitude"], amplitude, 1e-10);
}

TEST_F(FileCommands, FitSaysWhatIsWrongWithAFileAndWhere) {
  const auto file = sine_file(folder);
  EXPECT_THAT(error_of({"fit", file, "--frequency", "79.8", "--column", "z"}),
              HasSubstr("there is no column 'z'; the columns are: y, constant"));
  EXPECT_THAT(error_of({"fit", file, "--frequency", "79,8"}), HasSubstr("79,8"));
  std::ofstream(folder / "broken.csv") << "t_ns,y\n0,1\n1000,x\n";
  EXPECT_THAT(error_of({"fit", folder / "broken.csv", "--frequency", "10"}),
              HasSubstr("broken.csv:3:"));
  std::ofstream(folder / "short.csv") << "t_ns,y\n0,1\n1000000,2\n";
  EXPECT_NE(error_of({"fit", folder / "short.csv", "--frequency", "10"}), "");
}

TEST_F(FileCommands, IntervalsFindsAGapAndALateEarlyPair) {
  const auto path = folder / "stamps.csv";
  std::ofstream stream(path);
  stream << "t_ns\n";
  std::int64_t t_ns = epoch_ns;
  for (int i = 0; i < 1000; ++i) {
    stream << t_ns << '\n';
    t_ns += 485'000 + (i * 31) % 40 - 20;
    t_ns += i == 300 ? 4200 : i == 301 ? -4200 : i == 700 ? 485'000 : 0;
  }
  stream.close();
  const auto json = json_of({"intervals", path, "--json"});
  EXPECT_EQ(json["count"], 998); // a gap is none of the intervals
  ASSERT_EQ(json["events"].size(), 2U);
  EXPECT_EQ(json["events"][0]["kind"], "pair");
  EXPECT_EQ(json["events"][0]["sample"], 300);
  EXPECT_EQ(json["events"][1]["kind"], "gap");
  EXPECT_EQ(json["events"][1]["missing"], 1);
}

std::filesystem::path result_file(const std::filesystem::path& path, double magnitude, double phase,
                                  const char* unit = R"(\one)") {
  ResultText text("dau/acceleration_z");
  text.add_value("dau/acceleration_z", "80", std::polar(magnitude, phase), 0.003, 0.004, unit);
  return text.write(path);
}

TEST_F(FileCommands, CompareGivesTheNormalisedErrorOfTwoResults) {
  const auto a = result_file(folder / "a.json", 1.01, 3.14);
  const auto b = result_file(folder / "b.json", 1.0, -3.14);
  const auto json = json_of({"compare", a, b, "--json"}, 3); // they disagree
  const auto& point = json["points"][0];
  EXPECT_NEAR(point["en_magnitude"], 0.01 / (2.0 * 0.003 * std::sqrt(2.0)), 1e-12);
  EXPECT_NEAR(point["phase_difference_rad"], 6.28 - 2.0 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(point["en_phase"], (6.28 - 2.0 * std::numbers::pi) / (2.0 * 0.004 * std::sqrt(2.0)),
              1e-12);
  EXPECT_FALSE(point["agrees"]);
  EXPECT_NEAR(point["U_magnitude_difference"], 2.0 * 0.003 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(point["k_magnitude_difference"], 2.0, 1e-12);
  EXPECT_NEAR(point["u_phase_difference_rad"], 0.004 * std::sqrt(2.0), 1e-12);
  const auto shared = json_of({"compare", a, b, "--common-magnitude", "0.002", "--json"}, 3);
  EXPECT_NEAR(shared["points"][0]["en_magnitude"],
              0.01 / (2.0 * std::sqrt(2.0 * 9e-6 - 2.0 * 4e-6 * 1.01)), 1e-12);
}

TEST_F(FileCommands, CompareRefusesWhatCannotBeCompared) {
  const auto a = result_file(folder / "a.json", 1.01, 3.14);
  EXPECT_THAT(error_of({"compare", a, result_file(folder / "b.json", 1.0, 3.1, "V")}),
              HasSubstr("different units"));
  EXPECT_THAT(error_of({"compare", a, a, "--channel", "acs/none"}),
              HasSubstr("no channel and frequency in common"));
  std::ofstream(folder / "c.json") << "[1, 2";
  EXPECT_THAT(error_of({"compare", a, folder / "c.json"}), HasSubstr("c.json: not JSON"));
}

} // namespace
} // namespace dyncal::tests
