#include "services/programs/command/draft_options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bench/draft/bench_text.hpp"

namespace dyncal::inline programs {
namespace {

using bench_draft::BenchDraft;
using bench_draft::SensorKind;

TEST(DraftOptions, NamesTheOptionOfAKey) {
  const BenchDraft draft;
  EXPECT_EQ(option_of(draft, "bench"), "--name");
  EXPECT_EQ(option_of(draft, "excitation.level"), "--level");
  EXPECT_EQ(option_of(draft, "generator.address"), "--generator-address");
  EXPECT_EQ(option_of(draft, "sources.acs.address"), "--acs-address");
  EXPECT_EQ(option_of(draft, "sources.dau.listen"), "--listen");
  EXPECT_EQ(option_of(draft, "excitation.settling_s"), std::nullopt);
  EXPECT_EQ(option_of(draft, "uncertainty.adc_delay_s"), std::nullopt);
}

TEST(DraftOptions, DependsOnTheKindOfTheSensor) {
  BenchDraft draft;
  draft.sensor = SensorKind::can;
  EXPECT_EQ(option_of(draft, "method.dut"), "--dbc");
  EXPECT_EQ(option_of(draft, "sources.dau.listen"), std::nullopt);
  draft.sensor = SensorKind::file;
  draft.sensor_sync = "s y";
  EXPECT_EQ(option_of(draft, "method.dut"), "--channel");
  EXPECT_EQ(option_of(draft, "sources.dau.units.s y"), "--sensor-sync");
  EXPECT_EQ(option_of(draft, "sources.dau.path"), "--sensor-file");
  draft.sensor = SensorKind::series;
  EXPECT_EQ(option_of(draft, "sources.dso.address"), "--dso-address");
}

TEST(DraftOptions, NamesOptionsWithinTheSentence) {
  const BenchDraft draft;
  EXPECT_EQ(sentence_with_options(draft, "excitation.level",
                                  "needs 10 V, above generator.maximum_voltage_v = 5"),
            "--level (excitation.level) needs 10 V, above --maximum-voltage "
            "(generator.maximum_voltage_v) = 5");
  EXPECT_EQ(sentence_with_options(draft, "excitation.frequencies_hz",
                                  "of which duration_s = 0.1 evaluates one period"),
            "--frequencies (excitation.frequencies_hz) of which --duration (duration_s) = 0.1 "
            "evaluates one period");
  EXPECT_EQ(sentence_with_options(draft, "excitation.settling_s", "must not be negative"),
            "key 'excitation.settling_s' must not be negative");
  EXPECT_EQ(sentence_with_options(draft, "bench", "my.generator.address and excitation.levels"),
            "--name (bench) my.generator.address and excitation.levels");
}

TEST(DraftOptions, NamesTheOptionOfAChannelThatAFileLacks) {
  BenchDraft draft;
  draft.sensor = SensorKind::file;
  draft.sensor_channel = "z";
  EXPECT_EQ(sentence_with_options(draft, "sources.dau.path", "a.csv: no channel 'z'; it has: x"),
            "--sensor-file (sources.dau.path) a.csv: no channel 'z' (--channel); it has: x");
  EXPECT_EQ(sentence_with_options(draft, "sources.acs.path", "no channel 'sync'"),
            "--acs-file (sources.acs.path) no channel 'sync' (--sync)");
}

// Keys that the text of a bench file does not have are mistakes of the table.
TEST(DraftOptions, KnowsKeysOfTheFilesThatAreDrafted) {
  const BenchDraft draft;
  const std::string text = bench_text(draft, "");
  for (const std::string key : {"listen", "sensor", "address", "level", "frequencies_hz",
                                "repetitions", "duration_s", "level_per_volt", "maximum_voltage_v",
                                "maximum_level_m_s2", "reference", "sync_acs", "dut"}) {
    EXPECT_THAT(text, testing::HasSubstr("\n" + key + " = "));
  }
}

} // namespace
} // namespace dyncal::inline programs
