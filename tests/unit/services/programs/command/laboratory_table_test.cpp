#include "services/programs/command/laboratory_table.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/memory/stepped_clock.hpp"
#include "services/programs/command/harmless_text.hpp"
#include "services/programs/command/laboratory_lines.hpp"
#include "tests/unit/services/network/messages.hpp"

namespace dyncal::inline programs {
namespace {

using testing::HasSubstr;

class LaboratoryTable : public testing::Test {
protected:
  void add_bench(const std::string& name) {
    laboratory.take(network::status_of(name, "acs"));
    laboratory.take(network::status_of(name, "dau"));
    laboratory.take(network::measurement_of(name, "r1", wire::MEASUREMENT_RUNNING));
    laboratory.take(network::excitation_of(name, "r1", 1, wire::EXCITATION_STEADY));
    laboratory.take(network::result_of(name, "r1", 1, 0.98765));
    wire::CalibrationResult noise = network::result_of(name, "r1", 1, 1e-4);
    noise.channel("dau/angular_velocity_x");
    laboratory.take(noise);
  }

  [[nodiscard]] std::string table(const TableLayout& layout = {}) const {
    std::string text;
    for (const std::string& line : laboratory_table(laboratory, layout)) {
      text += line + "\n";
    }
    return text;
  }

  bus::SteppedClock clock;
  network::BusState laboratory{clock};
};

TEST_F(LaboratoryTable, OneLineASourceAndAChannelThatResponds) {
  add_bench("acc-1");
  const auto lines = laboratory_table(laboratory, {});
  ASSERT_EQ(lines.size(), 5U) << table();
  EXPECT_EQ(lines[0], "1 bench, 1 with a run, 0 programs; arg in rad");
  EXPECT_THAT(lines[1], HasSubstr("acc-1        running  step 1 of 2, 16 Hz, steady"));
  EXPECT_THAT(lines[2], HasSubstr("acs        running     1000.5 S/s      0 lost"));
  EXPECT_THAT(lines[4], HasSubstr("dau/acceleration_z     16 Hz |H| 0.98765 u 0.00010"));
  EXPECT_THAT(table({.all = true}), HasSubstr("angular_velocity_x"));
}

wire::CalibrationResult flagged(const std::string& bench, const std::string& channel,
                                const std::vector<std::string>& names) {
  wire::CalibrationResult result = network::result_of(bench, "r1", 1, 0.98765);
  result.channel(channel);
  result.flags(names); // sentences
  result.flag_names(names);
  return result;
}

TEST_F(LaboratoryTable, NamesTheFirstFlagWhereThereIsRoom) {
  add_bench("acc-1");
  laboratory.take(flagged("acc-1", "dau/acceleration_z", {"samples_lost"}));
  EXPECT_THAT(table(), HasSubstr("arg -0.10000 samples_lost\n"));
  EXPECT_THAT(table({.columns = 100}), HasSubstr("arg -0.10000 flags 1: samples_lost\n"));
  EXPECT_THAT(table({.columns = 75}), HasSubstr("arg -0.10000 flags 1\n"));
  laboratory.take(flagged("acc-1", "dau/acceleration_z", {"values_stuck", "samples_lost"}));
  EXPECT_THAT(table(), HasSubstr("arg -0.10000 samples_lost+\n"));
  laboratory.take(flagged("acc-1", "dau/acceleration_z", {"reference_uncertainty_not_stated"}));
  EXPECT_THAT(table(), HasSubstr("arg -0.10000 flags 1\n"));
}

TEST_F(LaboratoryTable, FlagsAreListedWithTheirMeaning) {
  add_bench("acc-1");
  laboratory.take(flagged("acc-1", "dau/acceleration_z", {"values_stuck", "samples_lost"}));
  laboratory.take(flagged("acc-1", "dau/acceleration_x", {"samples_lost"}));
  EXPECT_EQ(table().find("check its network"), std::string::npos);
  const std::string text = table({.flags = true});
  EXPECT_THAT(text, HasSubstr("\n    samples_lost 1, values_stuck 1\n"));
  EXPECT_THAT(text, HasSubstr("\nsamples_lost: samples of this source are missing within the step "
                              "and the fit\n  uses the others; check its network,"));
  EXPECT_THAT(text, HasSubstr("\nvalues_stuck: "));
  EXPECT_EQ(text.find("samples_lost: ", text.find("samples_lost: ") + 1), std::string::npos);
  for (const std::size_t columns : {80U, 40U, 20U, 200U}) {
    const auto lines = laboratory_table(laboratory, {.columns = columns, .flags = true});
    EXPECT_LE(lines.size(), 24U);
    for (const std::string& line : lines) {
      EXPECT_LE(columns_of(line), columns) << line;
    }
  }
}

// They take room from sources that are well, not from channels.
TEST_F(LaboratoryTable, MeaningsOfFlagsStayInTheWindow) {
  for (int i = 1; i <= 8; ++i) {
    const std::string bench = fmt::format("bench-{}", i);
    add_bench(bench);
    laboratory.take(flagged(bench, "dau/acceleration_z", {"samples_lost", "over_range"}));
  }
  const auto lines = laboratory_table(laboratory, {.flags = true});
  EXPECT_EQ(lines.size(), 24U);
  const std::string text = table({.flags = true});
  EXPECT_EQ(text.find(" lost  "), std::string::npos);
  EXPECT_THAT(lines.back(), HasSubstr("more lines"));
  for (const std::string& line : lines) {
    EXPECT_LE(columns_of(line), 80U) << line;
  }
}

TEST_F(LaboratoryTable, EightBenchesStayInTheWindow) {
  for (int i = 1; i <= 8; ++i) {
    add_bench(fmt::format("bench-with-a-long-name-{}", i));
  }
  for (const std::size_t columns : {80U, 40U, 200U}) {
    const auto lines = laboratory_table(laboratory, {.columns = columns});
    EXPECT_EQ(lines.size(), 24U);
    for (const std::string& line : lines) {
      EXPECT_LE(columns_of(line), columns) << line;
    }
    EXPECT_THAT(lines.back(), testing::StartsWith("10 more lines"));
  }
  EXPECT_EQ(laboratory_table(laboratory, {.rows = 0}).size(), 33U);
}

TEST_F(LaboratoryTable, WhatIsWrongIsNeverLeftOut) {
  for (int i = 1; i <= 8; ++i) {
    add_bench(fmt::format("bench-{}", i));
  }
  wire::SourceStatus failed = network::status_of("bench-8", "zzz", wire::SOURCE_FAILED);
  failed.message("the instrument is gone");
  laboratory.take(failed);
  EXPECT_THAT(table({.columns = 120}), HasSubstr("the instrument is gone"));
}

TEST_F(LaboratoryTable, TextsFromTheNetworkMoveNoCursor) {
  add_bench("a\x1b[2J\nb");
  wire::SourceStatus failed = network::status_of("a\x1b[2J\nb", "dau", wire::SOURCE_FAILED);
  failed.message(std::string(500, '\x1b'));
  laboratory.take(failed);
  for (const std::string& line : laboratory_table(laboratory, {})) {
    EXPECT_EQ(line.find_first_of("\x1b\n\r"), std::string::npos);
    EXPECT_LE(columns_of(line), 80U);
  }
  for (const auto& [key, line] : laboratory_lines(laboratory)) {
    EXPECT_EQ(line.find_first_of("\x1b\n\r"), std::string::npos);
  }
}

TEST_F(LaboratoryTable, ColoursAreForWhatIsNotWell) {
  add_bench("acc-1");
  EXPECT_EQ(table().find('\x1b'), std::string::npos);
  wire::SourceStatus failed = network::status_of("acc-1", "dau", wire::SOURCE_FAILED);
  failed.message("gone");
  laboratory.take(failed);
  EXPECT_EQ(table().find('\x1b'), std::string::npos);
  EXPECT_THAT(table({.colour = true}), HasSubstr("\x1b[31m"));
}

TEST_F(LaboratoryTable, HostsWhoseClocksAreOffHaveALine) {
  add_bench("acc-1");
  laboratory.set_programs({}, {{"lab-2", {.offset_s = -300.0, .bound_s = 0.0012}},
                               {"lab-3", {.offset_s = 0.02, .bound_s = 0.001}},
                               {"lab-4", {.offset_s = 3600.0, .bound_s = 3599.5}}});
  EXPECT_THAT(table(), HasSubstr("\nclock of lab-2: -300.0000 s from ours (within 0.0012 s)\n"));
  EXPECT_EQ(table().find("lab-3"), std::string::npos) << "not off by as much as a warning needs";
  EXPECT_EQ(table().find("lab-4"), std::string::npos) << "its bound explains it";
  EXPECT_THAT(table({.all = true}), HasSubstr("\nclock of lab-3: +0.0200 s from ours (within "));
  EXPECT_THAT(table({.all = true}), HasSubstr("\nclock of lab-4: +3600 s from ours (within "));
  EXPECT_THAT(table({.colour = true}), HasSubstr("\x1b[33mclock of lab-2"));
}

TEST_F(LaboratoryTable, ClocksOfHostsStayInTheWindow) {
  for (int i = 1; i <= 8; ++i) {
    add_bench(fmt::format("bench-{}", i));
  }
  const std::string host = "\x1b[2J" + std::string(100, 'h');
  laboratory.set_programs({}, {{host, {.offset_s = -300.0, .bound_s = 0.0012}}});
  EXPECT_THAT(table(), HasSubstr("hh..: -300.0000 s from ours (within 0.0012 s)\n"))
      << "what is wrong is not left out, nor is the offset";
  for (const std::size_t columns : {80U, 40U, 20U, 200U}) {
    const auto lines = laboratory_table(laboratory, {.columns = columns, .all = true});
    EXPECT_EQ(lines.size(), 24U);
    for (const std::string& line : lines) {
      EXPECT_LE(columns_of(line), columns) << line;
      EXPECT_EQ(line.find('\x1b'), std::string::npos);
    }
  }
}

TEST_F(LaboratoryTable, NothingYet) {
  EXPECT_THAT(table(), HasSubstr("nothing on this DDS domain yet"));
}

TEST_F(LaboratoryTable, LinesForAPipe) {
  add_bench("acc-1");
  std::string text;
  for (const auto& [key, line] : laboratory_lines(laboratory)) {
    text += line + "\n";
  }
  EXPECT_THAT(text, HasSubstr("acc-1/dau: running, 1000.5 S/s, 12345 received"));
  EXPECT_THAT(text, HasSubstr("acc-1 r1: step 1, 16 Hz, 10 m/s^2, steady"));
  EXPECT_THAT(text, HasSubstr("acc-1 r1: step 1, 16 Hz, #1, dau/acceleration_z: |H| = 0.98765 (u "
                              "0.00010)"));
}

TEST_F(LaboratoryTable, LinesForAPipeTellTheClocksOfAllHosts) {
  add_bench("acc-1");
  laboratory.set_programs({}, {{"lab-2", {.offset_s = -300.0, .bound_s = 0.0012}},
                               {"lab-3", {.offset_s = 0.02, .bound_s = 0.001}}});
  const auto lines = laboratory_lines(laboratory);
  ASSERT_TRUE(lines.contains("0 lab-2")) << "no source is there: a host of a service";
  EXPECT_EQ(lines.at("0 lab-2"), "clock of lab-2: -300.0000 s from ours (within 0.0012 s)");
  ASSERT_TRUE(lines.contains("0 lab-3"));
}

} // namespace
} // namespace dyncal::inline programs
