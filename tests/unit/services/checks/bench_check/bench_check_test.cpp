#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/checks/bench_check/checks.hpp"
#include "services/checks/bench_check/report.hpp"
#include "tests/unit/services/checks/bench_check/checked_bench.hpp"

namespace dyncal::inline checks::bench_check {
namespace {

using testing::HasSubstr;

std::string all_of(const Findings& findings) {
  return as_text(findings);
}

// The text has one finding of this severity at this line and key, and no other that is as grave.
void expect_one(const Findings& findings, Severity severity, std::size_t line,
                const std::string& key, const std::string& part) {
  std::vector<Finding> grave;
  for (const Finding& finding : findings) {
    if (finding.severity >= severity) {
      grave.push_back(finding);
    }
  }
  ASSERT_EQ(grave.size(), 1U) << all_of(findings);
  EXPECT_EQ(grave[0].severity, severity);
  EXPECT_EQ(grave[0].line, line) << all_of(findings);
  EXPECT_EQ(grave[0].subject, key);
  EXPECT_THAT(grave[0].sentence, HasSubstr(part));
}

TEST(BenchCheck, GoodBenchHasNotesAlone) {
  const Findings findings = check_text(smartup_bench);
  EXPECT_EQ(of(findings, Severity::note).size(), findings.size()) << all_of(findings);
  EXPECT_LT(worst(findings), Severity::error);
  EXPECT_THAT(all_of(findings),
              HasSubstr("has 6 steps (3 frequencies, 2 repetitions), about 36 s"));
  EXPECT_THAT(all_of(findings), HasSubstr("10 m/s^2 at the most (amplitude, 1 V of the generator); "
                                          "the longest stroke is 2.53 mm (amplitude) at 10 Hz"));
}

TEST(BenchCheck, ExampleBenchesPass) {
  std::size_t benches = 0;
  std::vector<BenchView> views;
  const std::filesystem::path folder = std::filesystem::path(DYNCAL_SOURCE) / "deploy/example-lab";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".toml") {
      views.push_back(look_at_bench(entry.path()));
      ++benches;
    }
  }
  EXPECT_GE(benches, 4U);
  const Findings findings = check_benches(views); // together: as one laboratory
  EXPECT_EQ(of(findings, Severity::error).size(), 0U) << all_of(findings);
  EXPECT_GE(of(findings, Severity::note).size(), 2 * benches) << all_of(findings);
}

TEST(BenchCheck, FileWithFiveFaultsTellsFive) {
  std::string text = with(smartup_bench, "level = 10.0", "levl = 10.0\nlevel = 60.0");
  text = with(text, "\"250\"]", "\"600\"]");
  text = with(text, "reference = \"acs/reference\"", "reference = \"asc/reference\"");
  text = with(text, "sensor = \"0xbccb0100\"", "sensor = \"0xzz\"");
  text = with(text, "address = \"192.0.2.12:5026\"", "address = \"192.0.2.12\"");
  const auto errors = of(check_text(with(text, "level = 60.0", "level = 15.0")), Severity::error);
  std::vector<std::string> keys;
  for (const Finding& error : errors) {
    keys.push_back(error.subject);
  }
  EXPECT_THAT(keys,
              testing::ElementsAre("excitation.frequencies_hz", "excitation.levl",
                                   "sources.dau.sensor", "sources.acs.address", "method.reference"))
      << all_of(errors);
}

TEST(BenchCheck, StrokeAndVelocityOfTheExciterAreLimits) {
  const std::string limits = "level_per_volt = 10.0\nmaximum_displacement_mm = 2.0\n"
                             "maximum_velocity_m_s = 0.1";
  const auto errors =
      of(check_text(with(smartup_bench, "level_per_volt = 10.0", limits)), Severity::error);
  ASSERT_EQ(errors.size(), 2U) << all_of(errors); // at 10 Hz, where both are largest
  EXPECT_THAT(all_of(errors), HasSubstr("of 10 m/s^2 at 10 Hz needs 2.533 mm, above "
                                        "generator.maximum_displacement_mm = 2"));
  EXPECT_THAT(all_of(errors), HasSubstr("of 10 m/s^2 at 10 Hz needs 0.1592 m/s, above "
                                        "generator.maximum_velocity_m_s = 0.1"));
  const std::string within =
      with(with(smartup_bench, "level_per_volt = 10.0", limits), "level = 10.0",
           "level = 10.0\nlevel_displacement_mm = 1.5\n"
           "level_velocity_m_s = 0.1");
  EXPECT_EQ(of(check_text(within), Severity::error).size(), 0U) << all_of(check_text(within));
}

TEST(BenchCheck, EveryWrongEntryOfAListIsTold) {
  const auto errors = of(check_text(with(smartup_bench, "[\"10\", \"80\", \"250\"]",
                                         "[\n\"ten\",\n\"80\",\n\"-5\"\n]")),
                         Severity::error);
  ASSERT_EQ(errors.size(), 2U) << all_of(errors);
  EXPECT_EQ(errors[0].line, 4U);
  EXPECT_EQ(errors[1].line, 6U);
}

TEST(BenchCheck, MisspeltKeyExplainsTheMissingOne) {
  expect_one(check_text(with(smartup_bench, "sensor = \"0x", "sensr = \"0x")), Severity::error, 16,
             "sources.dau.sensr", "did you mean 'sensor'?");
}

TEST(BenchCheck, NotToml) {
  expect_one(check_text("bench = \"a\nlevel = 3\n"), Severity::error, 1, "", "not valid TOML");
  EXPECT_EQ(worst(check_text("")), Severity::error);
}

TEST(BenchCheck, FilesThatAreNoBenchFiles) {
  const tests::TemporaryFolder folder;
  const auto large = folder.write("large.csv", std::string((std::size_t{4} << 20U) + 1, '1'));
  const std::vector<BenchView> views{look_at_bench(folder.path() / "gone.toml"),
                                     look_at_bench(folder.path()), look_at_bench(large)};
  const Findings findings = check_benches(views);
  ASSERT_EQ(findings.size(), 3U) << all_of(findings);
  EXPECT_THAT(findings[0].sentence, HasSubstr("cannot read this bench file"));
  EXPECT_THAT(findings[1].sentence, HasSubstr("is a folder"));
  EXPECT_THAT(findings[2].sentence, HasSubstr("more than 4 MiB"));
  EXPECT_THAT(all_of(findings), HasSubstr("gone.toml: error: cannot read"));
}

TEST(BenchCheck, LineEndsAndMarkOfOtherSystems) {
  std::string text = "\xef\xbb\xbf" + smartup_bench;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) {
    text.insert(at, "\r");
  }
  EXPECT_EQ(of(check_text(text), Severity::error).size(), 0U) << all_of(check_text(text));
  expect_one(check_text(with(text, "level = 10.0", "level = -1")), Severity::error, 4,
             "excitation.level", "must be positive");
}

TEST(BenchCheck, FrequenciesAboveHalfTheSampleRate) {
  const Findings findings =
      check_text(with(smartup_bench, "nominal_rate_hz = 1000.0", "nominal_rate_hz = 500.0"));
  expect_one(findings, Severity::error, 3, "excitation.frequencies_hz",
             "holds \"250\", but source 'dau' takes 500 samples a second (by its nominal_rate_hz), "
             "which show frequencies below 250 Hz only");
}

TEST(BenchCheck, UnknownRateIsANote) {
  const Findings findings = check_text(with(smartup_bench, "nominal_rate_hz = 1000.0\n", ""));
  EXPECT_THAT(all_of(findings), HasSubstr("key 'sources.dau' does not state a sample rate"));
  EXPECT_LT(worst(findings), Severity::error);
}

TEST(BenchCheck, StepsOfFewPeriods) {
  expect_one(check_text(with(smartup_bench, "duration_s = 3.0", "duration_s = 0.2")),
             Severity::warning, 3, "excitation.frequencies_hz", "evaluates 2 periods");
  expect_one(check_text(with(smartup_bench, "duration_s = 3.0", "duration_s = 0.05")),
             Severity::error, 3, "excitation.frequencies_hz", "less than one: at least 0.3 s");
}

TEST(BenchCheck, LevelsAboveTheLimits) {
  EXPECT_EQ(of(check_text(with(smartup_bench, "level = 10.0", "level = [10.0, 30.0, 10.0]")),
               Severity::error)
                .size(),
            1U);
  const auto errors =
      of(check_text(with(smartup_bench, "level_per_volt = 10.0", "level_per_volt = 1.0")),
         Severity::error);
  ASSERT_EQ(errors.size(), 1U) << all_of(errors);
  EXPECT_THAT(errors[0].sentence, HasSubstr("needs 10 V, above generator.maximum_voltage_v = 5"));
}

TEST(BenchCheck, WhatTheLinesOfAMultisineComeToTogether) {
  const std::string lines =
      with(with(with(smartup_bench, "[excitation]", "[excitation]\nkind = \"multisine\""),
                "[\"10\", \"80\", \"250\"]", "[\"10.1\", \"80.3\", \"248.3\"]"),
           "duration_s = 3.0", "duration_s = 10.0");
  const std::string multisine =
      with(lines, "maximum_level_m_s2 = 20.0", "maximum_level_m_s2 = 30.0");
  const Findings within = check_text(multisine);
  EXPECT_EQ(of(within, Severity::error).size(), 0U) << all_of(within);
  EXPECT_THAT(all_of(within), HasSubstr("has 2 multi-sines of 3 lines"));
  EXPECT_THAT(all_of(within), HasSubstr("the peak of all together is "));
  // 10 m/s^2 is 1 V of each line, and more than 1.5 V of all.
  const auto errors =
      of(check_text(with(multisine, "maximum_voltage_v = 5.0", "maximum_voltage_v = 1.5")),
         Severity::error);
  ASSERT_EQ(errors.size(), 1U) << all_of(errors);
  EXPECT_THAT(errors[0].sentence, HasSubstr("the 3 lines of the multi-sine together come to"));
}

TEST(BenchCheck, GeneratorWithoutLimits) {
  expect_one(check_text(with(smartup_bench, "maximum_voltage_v = 5.0\n", "")), Severity::warning, 7,
             "generator", "has no maximum_voltage_v");
}

TEST(BenchCheck, LevelPerVoltIsNeverGuessed) {
  expect_one(check_text(with(smartup_bench, "level_per_volt = 10.0\n", "")), Severity::error, 7,
             "generator.level_per_volt", "is missing");
}

TEST(BenchCheck, UncertaintyThatIsMissingOrZero) {
  expect_one(check_text(with(smartup_bench, "reference_magnitude_rel = 1e-3\n", "")),
             Severity::warning, 28, "uncertainty.reference_magnitude_rel", "is missing or zero");
  expect_one(
      check_text(with(smartup_bench, "reference_phase_rad = 1e-3", "reference_phase_rad = 0.0")),
      Severity::warning, 30, "uncertainty.reference_phase_rad", "is missing or zero");
  expect_one(check_text(with(smartup_bench, "adc_delay_s = 1e-6\n", "")), Severity::warning, 28,
             "uncertainty.adc_delay_s", "sync ADC");
  expect_one(check_text(with(smartup_bench, "acs_delay_s = 1e-7\n", "")), Severity::warning, 28,
             "uncertainty.acs_delay_s", "between the channels of the ACS");
  expect_one(check_text(with(smartup_bench, "reference_magnitude_rel = 1e-3",
                             "reference_magnitude_rel = 50.0")),
             Severity::error, 29, "uncertainty.reference_magnitude_rel", "in per cent?");
}

TEST(BenchCheck, UncertaintyOfTheReferenceThatIsDoubtful) {
  expect_one(check_text(with(smartup_bench, "reference_magnitude_rel = 1e-3",
                             "reference_magnitude_rel = 0.2")),
             Severity::warning, 29, "uncertainty.reference_magnitude_rel", "in per cent");
  expect_one(
      check_text(with(smartup_bench, "reference_phase_rad = 1e-3", "reference_phase_rad = 0.5")),
      Severity::warning, 30, "uncertainty.reference_phase_rad", "in degrees");
}

TEST(BenchCheck, UncertaintyThatIsMisspelt) {
  expect_one(check_text(with(smartup_bench, "reference_phase_rad", "reference_phase_deg")),
             Severity::error, 30, "uncertainty.reference_phase_deg",
             "did you mean 'reference_phase_rad'?");
}

TEST(BenchCheck, InstrumentsAndPortsThatTwoWant) {
  expect_one(check_text(with(smartup_bench, "192.0.2.12:5026", "192.0.2.11:5025")), Severity::error,
             20, "sources.acs.address", "which the generator of bench 'acc-1' has already");
  expect_one(check_text(with(smartup_bench, "[sources.acs]",
                             "[sources.dau2]\ndriver = \"smartup\"\nsensor = \"0xbccb0100\"\n"
                             "[sources.acs]")),
             Severity::error, 20, "sources.dau2.sensor", "a sensor has one bench");
  expect_one(check_text(with(smartup_bench, "nominal_rate_hz = 1000.0",
                             "sync_sensor = \"0xbccb0100\"\nnominal_rate_hz = 1000.0")),
             Severity::error, 17, "sources.dau.sync_sensor", "the same as sensor");
}

TEST(BenchCheck, PortOfAllAddressesAndOfOne) {
  expect_one(check_text(with(smartup_bench, "[sources.acs]",
                             "[sources.dau2]\ndriver = \"smartup\"\nsensor = \"0xbccb0200\"\n"
                             "listen = \"127.0.0.1:7654\"\n[sources.acs]")),
             Severity::error, 21, "sources.dau2.listen", "listens at 0.0.0.0:7654");
}

TEST(BenchCheck, NamesThatDifferInCapitalsAlone) {
  expect_one(check_text(with(smartup_bench, "[sources.acs]",
                             "[sources.DAU]\ndriver = \"smartup\"\nsensor = \"0xbccb0200\"\n"
                             "[sources.acs]")),
             Severity::warning, 13, "sources.dau", "capital letters alone");
}

TEST(BenchCheck, TwoBenchesOfOneName) {
  const std::vector<BenchView> views{look_at_bench_text(smartup_bench, "a.toml"),
                                     look_at_bench_text(smartup_bench, "b.toml")};
  const auto errors = of(check_benches(views), Severity::error);
  std::vector<std::string> keys;
  for (const Finding& error : errors) {
    EXPECT_EQ(error.file, "b.toml");
    keys.push_back(error.subject);
  }
  EXPECT_THAT(keys, testing::ElementsAre("bench", "generator.address", "sources.dau.sensor",
                                         "sources.acs.address"))
      << all_of(errors);
}

// The keys of b.toml that are errors beside a.toml, where the generators have these addresses.
std::vector<std::string> errors_of_two(const std::string& first, const std::string& second) {
  std::string other = with(smartup_bench, "acc-1", "acc-2");
  other = with(other, "192.0.2.11:5025", second);
  other = with(other, "192.0.2.12", "198.51.100.12");
  other = with(other, "0xbccb0100", "0xbccb0200");
  const std::vector<BenchView> views{
      look_at_bench_text(with(smartup_bench, "192.0.2.11:5025", first), "a.toml"),
      look_at_bench_text(other, "b.toml")};
  std::vector<std::string> keys;
  for (const Finding& error : of(check_benches(views), Severity::error)) {
    EXPECT_EQ(error.file, "b.toml");
    keys.push_back(error.subject);
  }
  return keys;
}

TEST(BenchCheck, TwoBenchesOfOneGeneratorHoweverItIsSpelt) {
  using testing::ElementsAre;
  EXPECT_THAT(errors_of_two("192.0.2.11:5025", "192.0.2.11:5025"),
              ElementsAre("generator.address"));
  EXPECT_THAT(errors_of_two("localhost:5025", "127.0.0.1:5025"), ElementsAre("generator.address"));
  EXPECT_THAT(errors_of_two("Shaker.lab:5025", "shaker.LAB:5025"),
              ElementsAre("generator.address"));
  EXPECT_THAT(errors_of_two("localhost:5025", "127.0.0.1:5026"), ElementsAre());
  EXPECT_THAT(errors_of_two("192.0.2.11:5025", "192.0.2.13:5025"), ElementsAre());
}

TEST(BenchCheck, TwoBenchesAtOnePort) {
  std::string other = with(smartup_bench, "acc-1", "acc-2");
  other = with(other, "192.0.2.11", "198.51.100.11");
  other = with(other, "192.0.2.12", "198.51.100.12");
  other = with(other, "0xbccb0100", "0xbccb0200");
  const std::vector<BenchView> views{look_at_bench_text(smartup_bench, "a.toml"),
                                     look_at_bench_text(other, "b.toml")};
  expect_one(check_benches(views), Severity::warning, 15, "sources.dau.listen",
             "as in bench 'acc-1'");
}

class BenchCheckFiles : public testing::Test {
protected:
  BenchCheckFiles() {
    std::string acs = "t_ns,reference,sync\n";
    std::string dau = "t_ns,acceleration_z,sync\n";
    for (int i = 0; i < 200; ++i) {
      acs += std::to_string(i * 100'000) + ",1,2\n";
      dau += std::to_string(i * 1'000'000) + ",1,2\n";
    }
    folder.write("acs.csv", acs);
    folder.write("dau.csv", dau);
  }

  Findings check(const std::string& text) const {
    return check_text(text, (folder.path() / "bench.toml").string());
  }

  tests::TemporaryFolder folder;
  const std::string bench = R"(bench = "files"
[excitation]
frequencies_hz = ["10", "80"]
level = 10.0
[sources.dau]
driver = "file"
path = "dau.csv"
units = { acceleration_z = "m/s^2", sync = "V" }
[sources.acs]
driver = "file"
path = "acs.csv"
units = { reference = "m/s^2", sync = "V" }
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_z"]
[uncertainty]
reference_magnitude_rel = 1e-3
reference_phase_rad = 1e-3
adc_delay_s = 1e-6
acs_delay_s = 1e-7
)";
};

TEST_F(BenchCheckFiles, AreNamedWithTheirHash) {
  const Findings findings = check(bench);
  EXPECT_EQ(of(findings, Severity::note).size(), findings.size()) << all_of(findings);
  EXPECT_THAT(all_of(findings),
              testing::ContainsRegex("key 'sources.dau.path' names dau.csv, SHA-256 [0-9a-f]{64}"));
}

TEST_F(BenchCheckFiles, ThatDoNotExist) {
  const auto errors = of(check(with(bench, "acs.csv", "gone.csv")), Severity::error);
  ASSERT_EQ(errors.size(), 1U) << all_of(errors);
  EXPECT_EQ(errors[0].line, 11U);
  EXPECT_THAT(errors[0].sentence, HasSubstr("gone.csv"));
}

TEST_F(BenchCheckFiles, ThatAreMalformedOrEmpty) {
  folder.write("acs.csv", "t_ns,reference,sync\n0,a,b\n");
  EXPECT_THAT(all_of(of(check(bench), Severity::error)), HasSubstr("acs.csv:2"));
  folder.write("acs.csv", "t_ns,reference,sync\n");
  EXPECT_EQ(of(check(bench), Severity::error).size(), 1U);
}

TEST_F(BenchCheckFiles, RatesFollowFromTheirSamples) {
  expect_one(check(with(bench, "\"80\"", "\"500\"")), Severity::error, 3,
             "excitation.frequencies_hz", "1000 samples a second (as its first samples show)");
}

TEST_F(BenchCheckFiles, ChannelsThatTheyDoNotHave) {
  expect_one(check(with(bench, "\"acs/reference\"", "\"acs/refrence\"")), Severity::error, 15,
             "method.reference",
             "names channel 'refrence', which source 'acs' does not have; did you mean "
             "'reference'?");
  expect_one(check(with(bench, "units = { reference", "units = { refrence = \"V\", reference")),
             Severity::error, 11, "sources.acs.path",
             "no channel 'refrence'; the file has: reference, sync");
}

TEST_F(BenchCheckFiles, UnitsThatAreMissingOrOfAnotherQuantity) {
  expect_one(check(with(bench, "acceleration_z = \"m/s^2\", ", "")), Severity::warning, 5,
             "sources.dau", "results will be in \"1\"");
  expect_one(check(with(bench, "reference = \"m/s^2\"", "reference = \"m/s\"")), Severity::warning,
             15, "method.reference", "is in m/s, but excitation.level is planned in m/s^2");
  expect_one(
      check(with(bench, "acceleration_z = \"m/s^2\", sync = \"V\"", "acceleration_z = \"m/s^2\"")),
      Severity::warning, 5, "sources.dau",
      "gives no unit for channel 'sync': nothing shows whether sync_dau names the right "
      "channel; write units = { sync = \"V\" }");
}

TEST_F(BenchCheckFiles, RolesOfAnotherQuantity) {
  expect_one(check(with(bench, "reference = \"m/s^2\"", "reference = \"V\"")), Severity::error, 15,
             "method.reference",
             "names \"acs/reference\", in V: a voltage, where the quantity of the level is "
             "expected, an acceleration");
  const std::string swapped =
      with(with(bench, "reference = \"acs/reference\"", "reference = \"acs/sync\""),
           "sync_acs = \"acs/sync\"", "sync_acs = \"acs/reference\"");
  const auto errors = of(check(swapped), Severity::error);
  ASSERT_EQ(errors.size(), 2U) << all_of(errors);
  EXPECT_EQ(errors[0].subject, "method.reference");
  EXPECT_THAT(errors[0].sentence, HasSubstr("exchange reference and sync_acs (\"acs/reference\")"));
  EXPECT_EQ(errors[1].subject, "method.sync_acs");
  EXPECT_THAT(errors[1].sentence, HasSubstr("in m/s^2: an acceleration, where the voltage of the "
                                            "sync signal is expected"));
}

TEST_F(BenchCheckFiles, TheUnitOfTheFileStandsAgainstThatOfTheBenchFile) {
  std::string acs = "t_ns,reference [\\volt],sync [\\metre\\second\\tothe{-2}]\n";
  for (int i = 0; i < 30; ++i) {
    acs += std::to_string(i * 1'000'000) + ",1,2\n";
  }
  folder.write("acs.csv", acs);
  const auto errors = of(check(bench), Severity::error);
  ASSERT_EQ(errors.size(), 2U) << all_of(errors);
  EXPECT_THAT(
      errors[0].sentence,
      HasSubstr("in m/s^2 by the bench file, but of which its source says \"V\": a voltage"));
}

TEST_F(BenchCheckFiles, WhatARunRefuses) {
  const auto errors_in = [&](const std::string& text) {
    return find_errors_before_run(
        look_at_bench_text(text, (folder.path() / "bench.toml").string()));
  };
  EXPECT_TRUE(errors_in(bench).empty()) << all_of(errors_in(bench));
  const Findings errors = errors_in(
      with(with(bench, "\"80\"", "\"500\""), "reference = \"m/s^2\"", "reference = \"V\""));
  ASSERT_EQ(errors.size(), 2U) << all_of(errors);
  EXPECT_EQ(errors[0].subject, "excitation.frequencies_hz");
  EXPECT_EQ(errors[1].subject, "method.reference");
}

TEST(BenchCheck, UnitsOfInstrumentsAsTheBenchFileGivesThem) {
  const std::string text = with(smartup_bench, "address = \"192.0.2.12:5026\"",
                                "address = \"192.0.2.12:5026\"\nunits = { sync = \"m/s\" }");
  const auto errors = of(check_text(text), Severity::error);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0].subject, "method.sync_acs");
}

TEST_F(BenchCheckFiles, CorrectionsThatDoNotCoverTheExcitation) {
  folder.write("reference.csv", "frequency_hz,magnitude,phase_rad,u_magnitude_rel,u_phase_rad\n"
                                "20,1,0,1e-3,1e-3\n100,1,0,1e-3,1e-3\n");
  std::string text = bench + "[corrections]\nreference = \"reference.csv\"\n";
  expect_one(check(text), Severity::error, 3, "excitation.frequencies_hz",
             "holds \"10\", which corrections.reference does not cover: the reference was "
             "calibrated from");
  text = with(text, "\"10\"", "\"20\"");
  text = with(text, "reference_magnitude_rel = 1e-3\nreference_phase_rad = 1e-3\n", "");
  const Findings findings = check(text); // the certificate states both uncertainties
  EXPECT_EQ(of(findings, Severity::note).size(), findings.size()) << all_of(findings);
  EXPECT_THAT(all_of(findings),
              HasSubstr("key 'corrections.reference' names reference.csv, SHA-256"));
}

TEST_F(BenchCheckFiles, PhasesThatLookLikeDegrees) {
  const std::string text = bench + "[corrections]\nreference = \"reference.csv\"\n";
  const auto write_phase = [this](const std::string& column, const std::string& phase) {
    folder.write("reference.csv", "frequency_hz,magnitude," + column +
                                      ",u_magnitude_rel,u_phase_rad\n10,1," + phase +
                                      ",1e-3,1e-3\n100,1," + phase + ",1e-3,1e-3\n");
  };
  write_phase("phase_rad", "-0.46");
  EXPECT_THAT(all_of(of(check(text), Severity::warning)), HasSubstr("is it given in degrees?"));
  for (const auto& [column, phase] : {std::pair("phase_rad", "-0.05"),    // of a filter
                                      std::pair("phase_rad", "3.12"),     // inverted
                                      std::pair("phase_deg", "-26.0")}) { // stated so
    write_phase(column, phase);
    EXPECT_THAT(all_of(of(check(text), Severity::warning)),
                testing::Not(HasSubstr("is it given in degrees?")))
        << column << phase;
  }
}

TEST_F(BenchCheckFiles, TransverseMotionThatDoesNotCoverTheExcitation) {
  const auto with_motion = [this](const std::string& ratio) {
    return with(bench, "[excitation]\n",
                "[excitation]\naxis = \"z\"\ntransverse_motion = { " + ratio +
                    ", source = \"E-1\" }\n");
  };
  EXPECT_THAT(all_of(check(with_motion("ratio = [0.01, 0.02], frequencies_hz = [20, 100]"))),
              HasSubstr("holds \"10\", which excitation.transverse_motion does not cover"));
  for (const char* const covering :
       {"ratio = 0.02", "ratio = [0.01, 0.02], frequencies_hz = [5, 1000]"}) {
    EXPECT_THAT(all_of(check(with_motion(covering))),
                testing::Not(HasSubstr("transverse_motion does not cover")));
  }
}

TEST_F(BenchCheckFiles, AbsoluteTimeNeedsStampsOfUtc) {
  std::string text = with(bench, "kind = \"sample-timestamping\"", "kind = \"absolute-time\"");
  text = with(text, "sync_acs = \"acs/sync\"\nsync_dau = \"dau/sync\"\n", "");
  text = with(text, "adc_delay_s = 1e-6\n", "");
  const auto errors = of(check(text), Severity::error);
  ASSERT_EQ(errors.size(), 2U) << all_of(errors);
  EXPECT_EQ(errors[0].subject, "sources.dau.time_base");
  EXPECT_EQ(errors[0].line, 5U);
  text = with(text, "path = \"dau.csv\"", "path = \"dau.csv\"\ntime_base = \"utc\"");
  expect_one(check(text), Severity::error, 10, "sources.acs.time_base", "compares stamps of UTC");
}

TEST_F(BenchCheckFiles, CorrectionsThatCannotBeUsed) {
  folder.write("adc.json", "{}");
  const auto errors =
      of(check(bench + "[corrections]\nadc = { file = \"adc.json\", channel = \"ADC1\" }\n"),
         Severity::error);
  ASSERT_FALSE(errors.empty());
  EXPECT_THAT(all_of(errors), HasSubstr("adc.json"));
}

constexpr const char* can_source = R"([sources.NAME]
driver = "can"
interface = "can0"
dbc = "sensor.dbc"
nominal_rate_hz = 1000.0
latency_s = 1e-5
)";

TEST_F(BenchCheckFiles, CanMessagesBelongToOneSource) {
  folder.write("sensor.dbc", "BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (0.01,0) [0|0] \"m/s^2\" S\n");
  std::string text = R"(bench = "can-1"
[excitation]
frequencies_hz = ["10"]
level = 10.0
)" + with(can_source, "NAME", "one") +
                     with(with(can_source, "NAME", "two"), "1e-5\n", "1e-5\nu_latency_s = 1e-6\n") +
                     R"([sources.acs]
driver = "file"
path = "acs.csv"
units = { reference = "m/s^2", sync = "V" }
time_base = "utc"
[method]
kind = "absolute-time"
reference = "acs/reference"
dut = ["one/x"]
[uncertainty]
reference_magnitude_rel = 1e-3
reference_phase_rad = 1e-3
acs_delay_s = 1e-6
)";
  const Findings findings = check(text);
  expect_one(findings, Severity::error, 14, "sources.two.dbc",
             "message 0x123 (Sample) on can0, which source 'one' of bench 'can-1' has already");
  EXPECT_THAT(all_of(findings), HasSubstr("key 'sources.one.latency_s' has no u_latency_s"));
  const std::string rates = with(with(text, "1e-5\n", "1e-5\nbit_rate_per_s = 500000\n"), "1e-6\n[",
                                 "1e-6\nbit_rate_per_s = 1000000\n[");
  EXPECT_THAT(all_of(check(rates)), HasSubstr("a bus has one rate"));
  EXPECT_THAT(all_of(check(with(text, "nominal_rate_hz = 1000.0", "nominal_rate_hz = 15.0"))),
              HasSubstr("source 'one' takes 15 samples a second (by its nominal_rate_hz)"));
  folder.write("sensor.dbc", "BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (0.01,0 [0|0] \"m/s^2\" S\n");
  EXPECT_THAT(all_of(check(text)), HasSubstr("sensor.dbc:2: "));
  folder.write("sensor.dbc", "BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (0.01,0) [0|0] \"m/s^2\" S\n"
                             "CM_ \"no end\"\nBA_ \"Kind\" 1;\n");
  EXPECT_THAT(all_of(of(check(text), Severity::warning)),
              AllOf(HasSubstr("sources.two.dbc"),
                    HasSubstr("sensor.dbc:3: the statement 'CM_' does not end with ';'")));
}

} // namespace
} // namespace dyncal::inline checks::bench_check
