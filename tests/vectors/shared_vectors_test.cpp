// The shared check vectors: CSV data and the exact least-squares answer computed with 60 digits.
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {
namespace {

using Json = nlohmann::json;

const std::filesystem::path folder = DYNCAL_SHARED_VECTORS;

struct Table {
  std::vector<std::int64_t> stamps_ns;
  std::map<std::string, std::vector<double>> columns;
};

Table read_csv(const std::string& name) {
  std::ifstream file(folder / name);
  std::string line;
  std::getline(file, line);
  std::vector<std::string> names;
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
    end = line.find(',', begin);
    names.push_back(line.substr(begin, end - begin));
  }
  Table table;
  while (std::getline(file, line)) {
    const char* at = line.data();
    const char* const end = at + line.size();
    std::int64_t stamp = 0;
    at = std::from_chars(at, end, stamp).ptr;
    table.stamps_ns.push_back(stamp);
    for (std::size_t i = 1; i < names.size(); ++i) {
      double value = 0.0;
      at = std::from_chars(at + 1, end, value).ptr;
      table.columns[names[i]].push_back(value);
    }
  }
  return table;
}

Json read_json(const std::string& name) {
  return Json::parse(std::ifstream(folder / name));
}

SineFit fit(const Table& table, const std::string& column, const std::string& frequency_hz,
            std::int64_t reference_ns) {
  const std::span<const double> channels[] = {table.columns.at(column)};
  const auto result =
      fit_sine(*Frequency::parse(frequency_hz), reference_ns, table.stamps_ns, channels);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().message);
  return result ? result->front() : SineFit{};
}

double number(const Json& value) {
  return value.at("value").get<double>();
}

struct Limits {
  double value = 1e-13;
  double uncertainty = 1e-9;
};

void expect_answer(const SineFit& fit, const Json& answer, Limits limits = {}) {
  const double amplitude = number(answer["amplitude"]);
  EXPECT_NEAR(fit.sine, number(answer["A_sin"]), limits.value * amplitude);
  EXPECT_NEAR(fit.cosine, number(answer["B_cos"]), limits.value * amplitude);
  EXPECT_NEAR(fit.offset, number(answer["C"]),
              limits.value * std::max(amplitude, std::abs(number(answer["C"]))));
  EXPECT_NEAR(fit.amplitude(), amplitude, limits.value * amplitude);
  EXPECT_NEAR(fit.phase_rad(), number(answer["theta_rad"]), limits.value);
  EXPECT_NEAR(fit.rss / number(answer["rss"]), 1.0, limits.uncertainty);
  EXPECT_NEAR(fit.residual_sd() / number(answer["s"]), 1.0, limits.uncertainty);
  EXPECT_EQ(fit.degrees_of_freedom, answer["dof"].get<double>());
  EXPECT_NEAR(fit.u_amplitude() / number(answer["u_amplitude"]), 1.0, limits.uncertainty);
  EXPECT_NEAR(fit.u_phase_rad() / number(answer["u_theta"]), 1.0, limits.uncertainty);
  EXPECT_NEAR(std::sqrt(fit.covariance[5]) / number(answer["u_C"]), 1.0, limits.uncertainty);
}

class SharedVectors : public testing::Test {
protected:
  void SetUp() override {
    if (!std::filesystem::exists(folder / "01_pure_sine_nonequidistant.json")) {
      GTEST_SKIP() << "no shared check vectors in " << folder;
    }
  }
};

TEST_F(SharedVectors, PureSineOnUnevenStamps) {
  const Json json = read_json("01_pure_sine_nonequidistant.json");
  const SineFit result =
      fit(read_csv("01_pure_sine_nonequidistant.csv"), "y", json["frequency_hz"], json["t_ref_ns"]);
  const Json& answer = json["ls3"];
  EXPECT_NEAR(result.amplitude() / number(answer["amplitude"]), 1.0, 1e-15);
  EXPECT_NEAR(result.phase_rad(), number(answer["theta_rad"]), 1e-15);
  EXPECT_NEAR(result.offset, number(answer["C"]), 1e-15);
  EXPECT_LT(result.rss, 1e-27);
}

TEST_F(SharedVectors, FewerThanTwoCyclesWithOffsetAndNoise) {
  const Json json = read_json("03_low_cycles.json");
  for (const Json& one : json["cases"]) {
    SCOPED_TRACE(one["file"].get<std::string>());
    expect_answer(fit(read_csv(one["file"]), "y", one["frequency_hz"], one["t_ref_ns"]),
                  one["ls3"]);
  }
}

TEST_F(SharedVectors, FourSeriesOfTheSyncLink) {
  const Json json = read_json("07_sync_link.json");
  const Table acs = read_csv("07_sync_link_acs.csv");
  const Table dau = read_csv("07_sync_link_dau.csv");
  const auto evaluate = [&](const Table& table, const char* column, const char* system,
                            const char* answer) {
    SCOPED_TRACE(answer);
    expect_answer(fit(table, column, json["frequency_hz"], json["t_ref_ns"][system]),
                  json["ls3"][answer]);
  };
  evaluate(acs, "ref", "acs", "ref_acs");
  evaluate(acs, "sync", "acs", "sync_acs");
  evaluate(dau, "dos", "dau", "dos_dau");
  evaluate(dau, "sync_adc", "dau", "sync_dau");
}

} // namespace
} // namespace dyncal::analysis
