#include "services/bench/file/sensitivity_keys.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline bench {
namespace {

using testing::HasSubstr;

class SensitivityKeys : public testing::Test {
protected:
  SensitivityKeys() {
    std::ofstream(folder / "one.csv") << "t_ns,x,y\n";
    std::ofstream(folder / "gain.csv") << "frequency_hz,magnitude,delay_s,u_magnitude_rel\n"
                                          "10,1.01,1e-5,1e-3\n100,0.99,1e-5,1e-3\n";
    std::ofstream(folder / "laser.toml")
        << "[reference]\nname = \"vibrometer\"\n[response]\nunit = \"mV/(m/s^2)\"\n"
           "rows = \"\"\"\nfrequency_hz,magnitude,phase_deg\n10,10.1,-1\n100,10.3,-2\n\"\"\"\n"
           "[channel]\nunit = \"mV/(m/s^2)\"\nsensitivity = 10.2\n";
  }

  [[nodiscard]] Expected<BenchFile> bench(const std::string& keys,
                                          const std::string& corrections = "") const {
    return parse_bench_file("bench = \"acc-1\"\n[excitation]\nfrequencies_hz = [\"10\"]\n"
                            "level = 10.0\n[generator]\ndriver = \"none\"\n"
                            "[method]\nkind = \"analogue\"\nreference = \"acs/x\"\n"
                            "dut = [\"acs/y\"]\n[sources.acs]\ndriver = \"file\"\n"
                            "path = \"one.csv\"\n" +
                                keys + corrections,
                            folder / "bench.toml");
  }
  [[nodiscard]] std::string problem(const std::string& keys,
                                    const std::string& corrections = "") const {
    const auto file = bench(keys, corrections);
    return file ? "accepted" : file.error().message;
  }

  const tests::TemporaryFolder own;
  const std::filesystem::path& folder = own.path();
};

TEST_F(SensitivityKeys, AreTheResponseOfTheReferenceWithItsScaleFactor) {
  const auto file = bench("sensitivity = { x = \"laser.toml\" }\n");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->corrections.reference.size(), 2U);
  EXPECT_NEAR(file->corrections.reference[1].magnitude, 10.3 / 10.2, 1e-12);
  EXPECT_EQ(file->corrections.reference_standard.devices.at(0).name, "vibrometer");
  EXPECT_TRUE(file->corrections.channel_responses.empty());
  const auto& unit = file->source("acs")->identity.units.at("x");
  EXPECT_EQ(unit.d_si, R"(\metre\second\tothe{-2})");
  EXPECT_NEAR(unit.factor_from(R"(\volt)"), 1000.0 / 10.2, 1e-9);
  EXPECT_EQ(file->named_files.size(), 2U); // a run folder copies both
}

TEST_F(SensitivityKeys, AreThoseOfChannelsUnderCalibration) {
  const auto file = bench("sensitivity = { y = \"gain.csv\" }\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_TRUE(file->corrections.reference.empty());
  ASSERT_EQ(file->corrections.channel_responses.size(), 1U);
  EXPECT_EQ(file->corrections.channel_responses[0].channel.text(), "acs/y");
  EXPECT_EQ(file->corrections.channel_responses[0].points.at(0).magnitude, 1.01);
  EXPECT_TRUE(file->source("acs")->identity.units.empty());
}

TEST_F(SensitivityKeys, AreRefusedWithTheirPlaceAndReason) {
  EXPECT_THAT(problem("sensitivity = { x = \"two.csv\" }\n"), HasSubstr("two.csv"));
  EXPECT_THAT(problem("sensitivity = { z = \"gain.csv\" }\n"),
              HasSubstr("bench.toml:14: key 'sources.acs.sensitivity' is given for acs/z, which is "
                        "neither method.reference nor"));
  EXPECT_THAT(
      problem("sensitivity = { x = \"gain.csv\" }\n", "[corrections]\nreference = \"gain.csv\"\n"),
      HasSubstr("corrections.reference names its response too"));
  EXPECT_THAT(problem("sensitivity = { x = \"laser.toml\" }\nunits = { x = \"100 mV/g\" }\n"),
              HasSubstr("'units' states another unit of it"));
  EXPECT_THAT(problem("sensitivity = { x = \"laser.toml\" }\nunits = { x = \"m/s^2\" }\n"),
              HasSubstr("'units' states another unit of it"));
  EXPECT_EQ(problem("sensitivity = { x = \"laser.toml\" }\nunits = { x = \"V\" }\n"), "accepted");
}

} // namespace
} // namespace dyncal::inline bench
