// dyncal model from end to end: records of a sensor whose response is known, `dyncal analyse`,
// and what `dyncal model` makes of the result.
#include <cmath>
#include <complex>
#include <iostream>
#include <map>
#include <numbers>
#include <random>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

constexpr double pi = std::numbers::pi;
constexpr std::int64_t epoch_ns = 1'700'000'000'000'000'000;
constexpr double step_s = 2.4, excited_s = 2.0;

struct Truth {
  double gain = 1.02;
  double delay_s = 0.9e-3;
  double resonance_hz = 320.0;
  double damping = 0.75;

  [[nodiscard]] std::complex<double> at(double f) const {
    const double ratio = f / resonance_hz;
    return gain * std::polar(1.0, -2.0 * pi * f * delay_s) /
           std::complex<double>(1.0 - ratio * ratio, 2.0 * damping * ratio);
  }
};

const std::vector<double> frequencies{10, 16, 25, 40, 63, 80, 100, 125, 160, 200, 250};

// The steady sine of the step at this instant, 0 in the rests between.
std::complex<double> excitation(double t_s, double& frequency_hz) {
  const auto step = static_cast<std::size_t>(t_s / step_s);
  const double within = t_s - static_cast<double>(step) * step_s;
  if (step >= frequencies.size() || within > excited_s) {
    frequency_hz = frequencies.back();
    return 0.0;
  }
  frequency_hz = frequencies[step];
  return std::polar(1.0, 2.0 * pi * frequency_hz * t_s);
}

void write_records(const std::filesystem::path& folder, const Truth& truth) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise;
  const double length_s = step_s * static_cast<double>(frequencies.size());
  std::ofstream acs(folder / "acs.csv"), dau(folder / "dau.csv");
  acs << "t_ns,reference,sync\n";
  dau << "t_ns,acceleration,sync\n";
  double f = 0.0;
  for (int n = 0; n < length_s * 5000.0; ++n) {
    const std::int64_t t_ns = std::int64_t{200'000} * n;
    const std::complex<double> e = excitation(static_cast<double>(t_ns) * 1e-9, f);
    acs << fmt::format("{},{:.9g},{:.9g}\n", epoch_ns + t_ns,
                       10.0 * e.imag() + 1e-3 * noise(random), e.imag() + 1e-4 * noise(random));
  }
  for (int n = 0; n < length_s * 1003.0; ++n) {
    const std::int64_t t_ns = std::int64_t{997'009} * n;
    const std::complex<double> e = excitation(static_cast<double>(t_ns) * 1e-9, f);
    dau << fmt::format("{},{:.9g},{:.9g}\n", epoch_ns + t_ns,
                       9.81 + 10.0 * (e * truth.at(f)).imag() + 0.02 * noise(random),
                       e.imag() + 1e-4 * noise(random));
  }
}

void write_bench(const std::filesystem::path& folder) {
  std::vector<std::string> texts;
  for (const double frequency : frequencies) {
    texts.push_back(fmt::format("\"{:g}\"", frequency));
  }
  std::ofstream(folder / "bench.toml") << fmt::format(R"(bench = "model"
[excitation]
frequencies_hz = [{}]
level = 10.0
repetitions = 1
settling_s = 0.2
duration_s = 1.6
[sources.dau]
driver = "file"
path = "dau.csv"
units = {{ acceleration = "m/s^2", sync = "V" }}
[sources.acs]
driver = "file"
path = "acs.csv"
units = {{ reference = "m/s^2", sync = "V" }}
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration"]
[uncertainty]
reference_magnitude_rel = 5e-4
reference_phase_rad = 5e-4
adc_delay_s = 1e-7
acs_delay_s = 1e-8
)",
                                                      fmt::join(texts, ", "));
}

class Model : public testing::Test {
protected:
  std::filesystem::path folder = fresh_folder(
      std::string("model-") + testing::UnitTest::GetInstance()->current_test_info()->name());

  // The result of `dyncal analyse`.
  std::filesystem::path analysed() {
    write_records(folder, {});
    write_bench(folder);
    ProgramRun run("dyncal", {"analyse", folder / "bench.toml", "--output", folder / "result.json"},
                   folder);
    EXPECT_EQ(run.wait(patience), 0) << run.errors();
    return folder / "result.json";
  }
  std::string output_of(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "model");
    ProgramRun run("dyncal", arguments, folder);
    EXPECT_EQ(run.wait(patience), 0) << run.errors();
    EXPECT_EQ(run.errors(), "");
    return run.output();
  }
  // Of a Python script; 77: a module that it needs is not installed.
  void expect_status(int expected, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "-B");
    ProgramRun script(DYNCAL_PYTHON, arguments, folder);
    const auto status = script.wait(patience);
    if (status == 77) {
      std::cerr << script.output();
    } else {
      EXPECT_EQ(status, expected) << script.output() << script.errors();
    }
  }
  std::string error_of(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "model");
    ProgramRun run("dyncal", arguments, folder);
    EXPECT_NE(run.wait(patience).value_or(0), 0);
    return run.errors();
  }
};

void expect_truth(const nlohmann::json& model) {
  const Truth truth;
  const std::map<std::string, double> expected{{"gain", truth.gain},
                                               {"delay_s", truth.delay_s},
                                               {"resonance_hz", truth.resonance_hz},
                                               {"damping", truth.damping}};
  ASSERT_EQ(model["parameters"].size(), expected.size());
  for (const auto& parameter : model["parameters"]) {
    const double u = parameter["u"];
    EXPECT_NEAR(parameter["value"], expected.at(parameter["name"]), 4.0 * u) << parameter["name"];
    EXPECT_GT(u, 0.0);
    EXPECT_LT(u, 0.03 * expected.at(parameter["name"]));
  }
}

TEST_F(Model, FindsTheSensorInAnAnalysedRecordAndUndoesIt) {
  const std::string text = output_of({analysed(), "--output", folder / "model.json", "--figures",
                                      folder / "figures", "--filter", "fir", "--cutoff-hz", "200"});
  EXPECT_THAT(text, HasSubstr("> second order with delay"));
  EXPECT_THAT(text, HasSubstr("resonance frequency f0 / Hz"));
  const auto json = read_json(folder / "model.json");
  EXPECT_EQ(json["schema"]["name"], "dyncal-model");
  ASSERT_EQ(json["models"].size(), 1U);
  const auto& model = json["models"][0];
  EXPECT_EQ(model["channel"], "dau/acceleration");
  EXPECT_EQ(model["kind"], "second_order_with_delay");
  EXPECT_TRUE(model["fits"]);
  EXPECT_EQ(model["points"].size(), frequencies.size());
  EXPECT_EQ(model["candidates"].size(), 7U);
  EXPECT_NEAR(model["common"]["u_gain_rel"], 5e-4, 1e-12);
  EXPECT_NEAR(model["common"]["u_phase_rad"], 5e-4, 1e-12);
  EXPECT_GE(model["common"]["u_delay_s"], 1e-7 * (1.0 - 1e-9));
  expect_truth(model);

  const auto& filter = model["filter"];
  EXPECT_NEAR(filter["rate_hz"], 1003.0, 0.1);
  EXPECT_LT(filter["ripple"], 1e-3);
  EXPECT_EQ(filter["Ub"].size(), filter["b"].size());
  for (const auto& point : filter["compensated"]) {
    if (point["frequency_hz"] <= 200.0) {
      EXPECT_NEAR(point["measured_magnitude_error"], 0.0, 5e-3);
      EXPECT_NEAR(point["measured_phase_error_rad"], 0.0, 5e-3);
      EXPECT_GT(point["U_magnitude_error"], 1e-3); // twice the reference
    }
  }
  for (const char* ending : {".svg", ".csv"}) {
    EXPECT_TRUE(std::filesystem::exists(
        folder / "figures" / (std::string("model-residuals-dau-acceleration") + ending)));
  }
  expect_status(0, {DYNCAL_MODEL_CHECK, folder / "model.json"});
}

// The schema holds every file that these tests write (program_run.cpp); here, what it refuses.
TEST_F(Model, TheSchemaOfItsFileRefusesOtherKeys) {
  output_of({analysed(), "--output", folder / "model.json", "--filter", "fir"});
  const auto json = read_json(folder / "model.json");
  const auto expect_refused = [&](const auto& change) {
    auto changed = json;
    change(changed);
    std::ofstream(folder / "changed.json") << changed;
    expect_status(1, {DYNCAL_CHECK_RESULT, DYNCAL_MODEL_SCHEMA, folder / "changed.json"});
  };
  expect_status(0, {DYNCAL_CHECK_RESULT, DYNCAL_MODEL_SCHEMA, folder / "model.json"});
  expect_refused([](auto& file) { file["schema"]["version"] = 2; });
  expect_refused([](auto& file) { file["models"][0]["chi_square"] = 1.0; });
  expect_refused([](auto& file) { file["models"][0].erase("covariance"); });
  expect_refused([](auto& file) { file["models"][0]["filter"].erase("Ub"); });
  expect_refused([](auto& file) { file["models"][0]["parameters"][0]["u"] = "nan"; });
}

TEST_F(Model, JoinsResultsAndDesignsAnIirFilter) {
  const auto result = analysed();
  auto json = read_json(result);
  json["transfer_function"].erase(0); // the other file has one value less
  std::ofstream(folder / "second.json") << json;
  output_of({result, folder / "second.json", "--output", folder / "model.json", "--filter", "iir",
             "--kind", "second_order_with_delay"});
  const auto model = read_json(folder / "model.json")["models"][0];
  EXPECT_EQ(model["points"].size(), 2 * frequencies.size() - 1);
  const auto& filter = model["filter"];
  EXPECT_EQ(filter["a"].size(), 5U);
  EXPECT_EQ(filter["Uab"].size(), filter["b"].size() + 4);
  EXPECT_EQ(filter["Uab"][0][5], 0.0); // a is chosen
  EXPECT_EQ(filter["Uab"][4][4], filter["Ub"][0][0]);
}

TEST_F(Model, SaysInOneLineWhatIsWrong) {
  const auto result = analysed();
  const auto changed = [&](const auto& change) {
    auto json = read_json(result);
    change(json);
    std::ofstream(folder / "changed.json") << json;
    return (folder / "changed.json").string();
  };
  EXPECT_THAT(error_of({folder / "none.json"}), HasSubstr("none.json: cannot be read"));
  EXPECT_THAT(error_of({folder / "bench.toml"}), HasSubstr("not JSON"));
  EXPECT_THAT(error_of({result, folder / "." / "result.json"}),
              HasSubstr("result.json: this result is given twice"));
  EXPECT_THAT(error_of({result, "--channel", "dau/other"}),
              HasSubstr("there is no channel 'dau/other'; the channels are: dau/acceleration"));
  EXPECT_THAT(error_of({result, "--rate-hz", "100"}), HasSubstr("--rate-hz requires --filter"));
  EXPECT_THAT(error_of({result, "--filter", "fir", "--rate-hz", "300"}),
              HasSubstr("below half the sample rate (rate 300 Hz, --cutoff-hz 250)"));
  EXPECT_THAT(error_of({changed([](auto& json) { json["schema"]["name"] = "other"; })}),
              HasSubstr("its schema is \"other\""));
  EXPECT_THAT(error_of({changed([](auto& json) { json.erase("schema"); })}),
              HasSubstr("there is no 'schema' in it"));
  EXPECT_THAT(
      error_of({changed([](auto& json) { json["transfer_function"][3].erase("U_phase_rad"); })}),
      HasSubstr("transfer_function[3].U_phase_rad is missing"));
  EXPECT_THAT(
      error_of({changed([](auto& json) { json["transfer_function"][2]["U_magnitude"] = 0.0; })}),
      HasSubstr("dau/acceleration at 25 Hz has U_magnitude = 0"));
  EXPECT_THAT(error_of({changed(
                  [](auto& json) { json["transfer_function"][2]["U_phase_rad"] = nullptr; })}),
              HasSubstr("dau/acceleration at 25 Hz has U_phase_rad = null"));
  EXPECT_THAT(error_of({result, changed([](auto& json) {
                          for (auto& value : json["transfer_function"]) {
                            value["unit"] = "\\volt";
                          }
                        })}),
              HasSubstr("is in '\\volt' but in '\\one' in"));
  EXPECT_THAT(error_of({changed([](auto& json) {
                          json["transfer_function"].erase(json["transfer_function"].begin() + 1,
                                                          json["transfer_function"].end());
                        }),
                        "--kind", "second_order"}),
              HasSubstr("a model of 3 parameters needs more frequencies than 1"));
}

TEST_F(Model, LeavesOutWhatIsFlaggedOrNullAndSaysSo) {
  auto json = read_json(analysed());
  json["transfer_function"][1]["magnitude"] = nullptr;
  json["transfer_function"][4]["flag_names"].push_back("over_range");
  json["transfer_function"][5]["flag_names"].push_back("a_flag_of_tomorrow");
  json["transfer_function"][6]["flag_names"].push_back("samples_lost");
  std::ofstream(folder / "flagged.json") << json;
  const std::string text = output_of({folder / "flagged.json", "--output", folder / "model.json"});
  EXPECT_THAT(text, HasSubstr("left out, flag over_range: 63 Hz"));
  EXPECT_THAT(text, HasSubstr("left out, flag a_flag_of_tomorrow: 80 Hz"));
  EXPECT_THAT(text, HasSubstr("left out, it has no value: 16 Hz"));
  EXPECT_EQ(read_json(folder / "model.json")["models"][0]["points"].size(), frequencies.size() - 3);
  const std::string all = output_of({folder / "flagged.json", "--include-flagged"});
  EXPECT_THAT(all, HasSubstr("a_flag_of_tomorrow, over_range"));
  EXPECT_THAT(all, testing::Not(HasSubstr("left out, flag")));
}

} // namespace
} // namespace dyncal::tests
