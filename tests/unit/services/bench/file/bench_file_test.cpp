#include "services/bench/file/bench_file.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

const char* const complete = R"(bench = "acc-1"
[excitation]
frequencies_hz = ["10", "12.5"]
level = 10.0
repetitions = 3
settling_s = 0.5
duration_s = 2
[generator]
driver = "scpi"
address = "127.0.0.1:5025"
level_per_volt = 50.0
[sources.dau]
driver = "smartup"
listen = "0.0.0.0:7654"
sensor = "0xbccb0100"
channels = { Data_11 = "sync" }
[sources.acs]
driver = "socket"
address = "127.0.0.1:5026"
serial = "PTB-4"
firmware = "2.1"
units = { reference = "m/s^2" }
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_z"]
[uncertainty]
reference_magnitude_rel = 1e-3
)";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

std::string problem_of(const std::string& text) {
  const auto file = parse_bench_file(text, "bench.toml");
  EXPECT_FALSE(file) << text;
  return file ? "" : file.error().message;
}

std::string settings_of(const std::string& source, const std::string& text) {
  const auto file = parse_bench_file(text, "bench.toml");
  EXPECT_TRUE(file) << file.error().message;
  const SourceSettings* settings = file ? file->source(source) : nullptr;
  return settings == nullptr ? "" : settings->origin.settings;
}

TEST(BenchFile, GivesTheSettingsOfASourceAsTextThatCanBeCompared) {
  EXPECT_EQ(settings_of("dau", complete), "channels.Data_11 = \"sync\"\n"
                                          "driver = \"smartup\"\n"
                                          "listen = \"0.0.0.0:7654\"\n"
                                          "sensor = \"0xbccb0100\"\n");
  EXPECT_EQ(settings_of("acs", complete), "address = \"127.0.0.1:5026\"\n"
                                          "driver = \"socket\"\n"
                                          "firmware = \"2.1\"\n"
                                          "serial = \"PTB-4\"\n"
                                          "units.reference = \"m/s^2\"\n");
  EXPECT_NE(settings_of("dau", replaced(complete, "0xbccb0100", "0xdeadbeef")),
            settings_of("dau", complete));
}

TEST(BenchFile, DoesNotTakeWhatDoesNotConcernASourceForADifference) {
  const std::string as_it_is = settings_of("dau", complete);
  for (const auto& [what, by] : std::vector<std::pair<std::string, std::string>>{
           {"level = 10.0", "level = 20.0"},
           {"\"12.5\"", "\"16\""},
           {"sensor = ", "# a comment\nsensor   =   "},
           {"channels = { Data_11 = \"sync\" }", "channels.Data_11 = \"sync\""},
           {"127.0.0.1:5026", "127.0.0.1:5027"}, // of another source
           {"reference_magnitude_rel = 1e-3", "reference_magnitude_rel = 2e-3"}}) {
    EXPECT_EQ(settings_of("dau", replaced(complete, what, by)), as_it_is) << by;
  }
}

TEST(BenchFile, ComparesNumbersWhateverTheirNotation) {
  const tests::TemporaryFolder folder;
  const std::string file_source =
      replaced(complete, "driver = \"socket\"\naddress = \"127.0.0.1:5026\"",
               "driver = \"file\"\npath = \"" + folder.write("acs.csv", "") +
                   "\"\nplay = \"real-time\"\nsample_rate_hz = 20000");
  EXPECT_EQ(
      settings_of("acs", file_source),
      settings_of("acs", replaced(replaced(file_source, "20000", "2e4"), "real-time", "at-once")));
}

TEST(BenchFile, GivesWhatTheFileSays) {
  const auto file = parse_bench_file(complete, "bench.toml");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->bench, "acc-1");
  EXPECT_EQ(file->excitation.frequencies_hz, (std::vector<std::string>{"10", "12.5"}));
  EXPECT_EQ(file->excitation.levels_m_s2, (std::vector<double>{10.0, 10.0}));
  EXPECT_EQ(file->excitation.repetitions, 3);
  EXPECT_DOUBLE_EQ(file->excitation.duration_s, 2.0);
  ASSERT_NE(file->source("dau"), nullptr);
  ASSERT_TRUE(file->source("dau")->is<SmartupSourceSettings>());
  EXPECT_EQ(file->source("dau")->as<SmartupSourceSettings>()->sensor, 0xbccb0100U);
  EXPECT_EQ(file->source("dau")->channels.at("Data_11"), "sync");
  EXPECT_EQ(file->source("acs")->units.at("reference"), R"(\metre\second\tothe{-2})");
  EXPECT_EQ(file->source("acs")->identity.device, "");
  EXPECT_EQ(file->source("acs")->identity.serial, "PTB-4");
  EXPECT_EQ(file->source("acs")->identity.firmware, "2.1");
  EXPECT_EQ(file->method.dut.front().text(), "dau/acceleration_z");
  EXPECT_EQ(file->sha256.size(), 64U);
}

TEST(BenchFile, NamesFileLineAndKeyOfAnUnknownKeyAndTheOneThatWasMeant) {
  EXPECT_EQ(problem_of(replaced(complete, "settling_s", "setling_s")),
            "bench.toml:6: key 'excitation.setling_s' is not known; did you mean 'settling_s'?");
}

std::string with_uncertainty(const std::string& line) {
  return replaced(complete, "reference_magnitude_rel = 1e-3", line);
}

TEST(BenchFile, RefusesAnUncertaintyThatIsNotPlausible) {
  EXPECT_THAT(problem_of(with_uncertainty("reference_magnitude_rel = 50")),
              HasSubstr("bench.toml:30: key 'uncertainty.reference_magnitude_rel' = 50 is not "
                        "plausible"));
  EXPECT_THAT(problem_of(with_uncertainty("reference_magnitude_rel = 0.51")),
              HasSubstr("per cent"));
  EXPECT_THAT(problem_of(with_uncertainty("reference_phase_rad = 1.6")), HasSubstr("degrees"));
  EXPECT_THAT(problem_of(with_uncertainty("acs_rate_rel = 5")), HasSubstr("parts per million"));
  EXPECT_THAT(problem_of(with_uncertainty("dso_rate_rel = 25")), HasSubstr("parts per million"));
  EXPECT_THAT(problem_of(with_uncertainty("acs_delay_s = 236")), HasSubstr("nanoseconds"));
  EXPECT_THAT(problem_of(with_uncertainty("adc_delay_s = 0.46e3")), HasSubstr("microseconds"));
  EXPECT_TRUE(parse_bench_file(with_uncertainty("reference_magnitude_rel = 0.5"), "bench.toml"));
}

TEST(BenchFile, TakesTheClockOfAnOscilloscopeFor25PpmOff) {
  EXPECT_NEAR(parse_bench_file(complete, "bench.toml")->uncertainty.dso_rate_rel,
              25e-6 / std::sqrt(3.0), 1e-7);
  const std::string text(complete);
  const auto bare = parse_bench_file(text.substr(0, text.find("[uncertainty]")), "bench.toml");
  ASSERT_TRUE(bare) << bare.error().message;
  EXPECT_GT(bare->uncertainty.dso_rate_rel, 1.4e-5);
  EXPECT_EQ(parse_bench_file(with_uncertainty("dso_rate_rel = 0"), "bench.toml")
                ->uncertainty.dso_rate_rel,
            0.0);
}

TEST(BenchFile, TakesADelayOfTheAdcOnlyWhereItIsNotCalibrated) {
  EXPECT_EQ(parse_bench_file(with_uncertainty("adc_delay_s = 1e-6"), "bench.toml")
                ->uncertainty.adc_delay_s,
            1e-6);
  const tests::TemporaryFolder folder;
  const std::string adc = folder.write("adc.json", "{}");
  const std::string both =
      replaced(with_uncertainty("adc_delay_s = 1e-6"), "[uncertainty]",
               "[corrections]\nadc = { file = \"" + adc + "\", channel = \"a\" }\n[uncertainty]");
  EXPECT_THAT(problem_of(both), HasSubstr("is for a sync ADC without calibration"));
}

TEST(BenchFile, ReadsTheCalibrationOfTheReference) {
  const tests::TemporaryFolder folder;
  const auto table = folder.path() / "reference.csv";
  const auto with_table = [&] {
    return replaced(complete, "[uncertainty]",
                    "[corrections]\nreference = \"" + table.string() + "\"\n[uncertainty]");
  };
  std::ofstream(table) << "frequency_hz,magnitude,phase_rad\n10,1.01,0.1\n";
  const auto file = parse_bench_file(with_table(), "bench.toml");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->corrections.reference.size(), 1U);
  EXPECT_EQ(file->corrections.reference.front().magnitude, 1.01);
  std::ofstream(table) << "frequency_hz,magnitude,phase_rad\n10,1.01,x\n";
  EXPECT_THAT(problem_of(with_table()), HasSubstr("'corrections.reference' names " +
                                                  table.string() + ":2:9: 'x' is not a number"));
}

TEST(BenchFile, RefusesAUnitThatIsNone) {
  EXPECT_THAT(problem_of(replaced(complete, "\"m/s^2\"", "\"furlong\"")),
              HasSubstr("bench.toml:22: key 'sources.acs.units' gives channel 'reference'"));
}

TEST(BenchFile, RefusesAKeyWithTheWrongUnit) {
  EXPECT_THAT(problem_of(replaced(complete, "duration_s", "duration_ms")),
              HasSubstr("did you mean 'duration_s'"));
  EXPECT_THAT(problem_of(replaced(complete, "duration_s = 2", "duration_s = \"2 s\"")),
              HasSubstr("must be a number in seconds"));
}

TEST(BenchFile, RefusesARoleWhoseSourceDoesNotExist) {
  EXPECT_THAT(problem_of(replaced(complete, "acs/reference", "asc/reference")),
              HasSubstr("names source 'asc', which [sources] does not have (it has: acs, dau)"));
  EXPECT_THAT(problem_of(replaced(complete, "acs/reference", "reference")),
              HasSubstr("must be \"source/channel\""));
}

TEST(BenchFile, RefusesFrequenciesThatAreNotPositiveNumbers) {
  EXPECT_THAT(problem_of(replaced(complete, "\"12.5\"", "\"12,5\"")), HasSubstr("holds \"12,5\""));
  EXPECT_THAT(problem_of(replaced(complete, "\"12.5\"", "12.5")), HasSubstr("list of texts"));
  EXPECT_THAT(problem_of(replaced(complete, "level = 10.0", "level = [1.0, 2.0, 3.0]")),
              HasSubstr("lists 3 levels for 2 frequencies"));
}

TEST(BenchFile, TakesPreferredFrequenciesInARange) {
  const auto file = parse_bench_file(
      replaced(complete, "[\"10\", \"12.5\"]", "\"third-octave 10..20\""), "bench.toml");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_THAT(file->excitation.frequencies_hz, ElementsAre("10", "12.5", "16", "20"));
  EXPECT_THAT(file->excitation.levels_m_s2, SizeIs(4));
  for (const char* range : {"third-octave 21..24", "third-octave", "10 20"}) {
    EXPECT_THAT(problem_of(replaced(complete, "[\"10\", \"12.5\"]", fmt::format("\"{}\"", range))),
                HasSubstr("'excitation.frequencies_hz' must be a list, or a range of ISO 266"));
  }
}

TEST(BenchFile, NamesTheExcitedAxisIfItIsStated) {
  EXPECT_EQ(parse_bench_file(complete, "bench.toml")->excitation.axis, "");
  for (const char* axis : {"x", "-z", "radial_2"}) {
    const auto file = parse_bench_file(
        replaced(complete, "level = 10.0", fmt::format("level = 10.0\naxis = \"{}\"", axis)),
        "bench.toml");
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->excitation.axis, axis);
  }
  for (const char* axis : {"", "x, y", "seventeen_letters"}) {
    EXPECT_THAT(problem_of(replaced(complete, "level = 10.0",
                                    fmt::format("level = 10.0\naxis = \"{}\"", axis))),
                HasSubstr("key 'excitation.axis' must be"));
  }
}

TEST(BenchFile, RefusesASourceFileThatDoesNotExist) {
  const std::string text = replaced(complete, "driver = \"socket\"\naddress = \"127.0.0.1:5026\"",
                                    "driver = \"file\"\npath = \"nowhere.csv\"");
  EXPECT_THAT(problem_of(text), HasSubstr("nowhere.csv, which does not exist"));
}

TEST(BenchFile, RefusesMissingTablesAndBrokenToml) {
  EXPECT_THAT(problem_of("bench = \"a\"\n"), HasSubstr("key 'excitation' is missing"));
  EXPECT_THAT(problem_of("bench = \"a\n"), HasSubstr("bench.toml:1: not valid TOML"));
  EXPECT_THAT(read_bench_file("no-such-file.toml").error().message,
              HasSubstr("no-such-file.toml: cannot read"));
}

TEST(BenchFile, EvaluatesWholeRecordsAtAKnownFrequencyWhenToldTo) {
  std::string text = replaced(complete, "[\"10\", \"12.5\"]", "[\"80\"]");
  text = replaced(text, "repetitions = 3\nsettling_s = 0.5\nduration_s = 2\n",
                  "window = \"whole-record\"\n");
  text =
      replaced(text, "[uncertainty]",
               "frequency_search_rel = 0\n[corrections]\nreference_delay_s = 2e-6\n[uncertainty]");
  const auto file = parse_bench_file(text, "bench.toml");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_TRUE(file->excitation.whole_record);
  EXPECT_EQ(file->method.frequency_search_rel, 0.0);
  EXPECT_EQ(file->corrections.reference_delay_s, 2e-6);
}

TEST(BenchFile, ListsTheMainsThatAreLookedFor) {
  EXPECT_TRUE(parse_bench_file(complete, "bench.toml")->method.mains_hz.empty());
  const auto with = [](const std::string& mains_hz) {
    return replaced(complete, "[uncertainty]", "mains_hz = " + mains_hz + "\n[uncertainty]");
  };
  const auto file = parse_bench_file(with("[16.7, 50]"), "bench.toml");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_THAT(file->method.mains_hz, testing::ElementsAre(16.7, 50.0));
  EXPECT_THAT(problem_of(with("[]")), HasSubstr("at least one frequency"));
  EXPECT_THAT(problem_of(with("[50, 0]")), HasSubstr("must be positive"));
}

TEST(BenchFile, RefusesPlansThatNobodyCouldWaitFor) {
  for (const char* repetitions : {"1001", "10000000", "2147483647"}) {
    EXPECT_THAT(problem_of(replaced(complete, "repetitions = 3",
                                    std::string("repetitions = ") + repetitions)),
                HasSubstr("between 1 and 1000"));
  }
  std::string many = "[\"10\"";
  for (int i = 11; i < 70; ++i) {
    many += ", \"" + std::to_string(i) + "\"";
  }
  std::string text = replaced(complete, "[\"10\", \"12.5\"]", many + "]");
  EXPECT_THAT(problem_of(replaced(text, "repetitions = 3", "repetitions = 1000")),
              HasSubstr("60000 steps"));
  for (const char* seconds : {"1e300", "86401", "inf", "nan"}) {
    EXPECT_THAT(
        problem_of(replaced(complete, "duration_s = 2", std::string("duration_s = ") + seconds)),
        HasSubstr("duration_s"));
    EXPECT_THAT(
        problem_of(replaced(complete, "settling_s = 0.5", std::string("settling_s = ") + seconds)),
        HasSubstr("settling_s"));
  }
}

TEST(BenchFile, RefusesWholeRecordsOfSeveralSteps) {
  EXPECT_THAT(problem_of(replaced(complete, "repetitions = 3", "window = \"whole-record\"")),
              HasSubstr("key 'excitation.window' can be \"whole-record\" for one frequency"));
  std::string one = replaced(complete, "[\"10\", \"12.5\"]", "[\"80\"]");
  EXPECT_THAT(problem_of(replaced(one, "repetitions = 3", "window = \"whole-record\"")),
              HasSubstr("has no meaning when window"));
}

TEST(BenchFile, TheAnalogueMethodComparesChannelsOfOneSystem) {
  const std::string text = replaced(complete, "sample-timestamping", "analogue");
  EXPECT_THAT(problem_of(text), HasSubstr("compares channels of one system"));
  const auto file = parse_bench_file(
      replaced(replaced(text, "sync_acs = \"acs/sync\"\nsync_dau = \"dau/sync\"\n", ""),
               "dau/acceleration_z", "acs/sensor"),
      "bench.toml");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->method.kind, EvaluationMethod::analogue);
}

TEST(BenchFile, RefusesASearchThatIsTooWide) {
  EXPECT_THAT(
      problem_of(replaced(complete, "[uncertainty]", "frequency_search_rel = 0.5\n[uncertainty]")),
      HasSubstr("frequency_search_rel"));
}

TEST(BenchFile, RefusesASensorIdThatIsNone) {
  EXPECT_THAT(problem_of(replaced(complete, "0xbccb0100", "bccb")),
              HasSubstr("must be a sensor id such as"));
}

} // namespace
} // namespace dyncal::inline bench
