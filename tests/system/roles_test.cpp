// Channels in roles of another quantity, and frequencies that a source cannot show: refused by
// `check`, `run` and `analyse`, and nothing is excited for them.
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

LiveBenchSettings settings_with(const std::string& frequencies, const std::string& source_dau) {
  return {.bench_arguments = {"--speed", "max", "--seed", "12"},
          .excitation = "frequencies_hz = [" + frequencies +
                        "]\nlevel = 20.0\nsettling_s = 0.4\nduration_s = 1.5\n",
          .source_dau = source_dau,
          .rest = "adc_delay_s = 1e-6\n"};
}

// The bench file with the ACS's channels exchanged.
std::filesystem::path exchanged(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::filesystem::path path = file.parent_path() / "exchanged.toml";
  std::ofstream out(path);
  for (std::string line; std::getline(in, line);) {
    if (line == "reference = \"acs/reference\"") {
      line = "reference = \"acs/sync\"";
    } else if (line == "sync_acs = \"acs/sync\"") {
      line = "sync_acs = \"acs/reference\"";
    }
    out << line << '\n';
  }
  return path;
}

TEST(Roles, ExchangedOfInstrumentsAreRefusedBeforeTheFirstStep) {
  const auto folder = fresh_folder("roles-live");
  LiveBench bench(folder, settings_with("\"40\"", ""));
  bench.tell_generator(":SOURce1:FREQuency 333");
  ProgramRun& run = bench.start({"run", exchanged(bench.bench_file())});
  ASSERT_EQ(run.wait(patience), 1) << run.errors();
  EXPECT_THAT(run.errors(),
              AllOf(HasSubstr("reference names \"acs/sync\", in V: a voltage, where the quantity "
                              "of the level is expected, an acceleration"),
                    HasSubstr("exchange reference and sync_acs (\"acs/reference\")")));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");
  EXPECT_EQ(std::stod(bench.ask_generator(":SOURce1:FREQuency?")), 333.0) << "it was not set";
  ProgramRun& right = bench.start({"run", bench.bench_file()});
  EXPECT_EQ(right.wait(patience), 0) << right.errors();
}

TEST(Roles, ExchangedOfFilesAreRefusedByEveryCommand) {
  const auto folder = fresh_folder("roles-files");
  const auto right = recorded_bench(folder, "roles", "3");
  const auto wrong = exchanged(right);
  for (const auto& [command, status] :
       std::map<std::string, int>{{"check", 3}, {"analyse", 1}, {"run", 1}}) {
    ProgramRun refused("dyncal", {command, wrong}, folder);
    EXPECT_EQ(refused.wait(patience), status) << command;
    EXPECT_THAT(refused.output() + refused.errors(),
                AllOf(HasSubstr("names \"acs/sync\", in V: a voltage"),
                      HasSubstr("exchange reference and sync_acs")))
        << command;
  }
  ProgramRun checked("dyncal", {"check", right}, folder);
  EXPECT_EQ(checked.wait(patience), 0) << checked.output();
}

TEST(Roles, WhatCheckCallsAnErrorIsNotExcited) {
  const auto folder = fresh_folder("roles-check");
  LiveBench bench(folder, settings_with("\"40\", \"600\"", "nominal_rate_hz = 1000.0"));
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  ASSERT_EQ(run.wait(patience), 1) << run.errors();
  EXPECT_THAT(run.errors(),
              AllOf(HasSubstr("bench.toml:3: key 'excitation.frequencies_hz' holds \"600\", but "
                              "source 'dau' takes 1000 samples a second"),
                    Not(HasSubstr("step 1"))));
}

TEST(Roles, AStepThatTheSourceCannotShowIsNotRepeated) {
  const auto folder = fresh_folder("roles-rate");
  LiveBench bench(folder, settings_with("\"40\", \"600\"", ""));
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  ASSERT_EQ(run.wait(patience), 1) << run.errors();
  EXPECT_THAT(run.output() + run.errors(),
              AllOf(HasSubstr("step 2 has 600 Hz, but the samples of source 'dau' come at "),
                    Not(HasSubstr("xcited again"))));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");
}

TEST(Roles, ARateThatTheBenchFileStatesWrongIsNoticed) {
  const auto folder = fresh_folder("roles-nominal");
  LiveBench bench(folder, settings_with("\"40\"", ""));
  const auto wrong = bench.changed_bench_file("wrong.toml", "driver = \"socket\"",
                                              "driver = \"socket\"\nnominal_rate_hz = 5000.0");
  ProgramRun& run = bench.start({"run", wrong});
  EXPECT_EQ(run.wait(patience), 0) << run.errors();
  EXPECT_THAT(run.errors(), HasSubstr("samples a second, but its nominal_rate_hz in the bench "
                                      "file is 5000"));
}

} // namespace
} // namespace dyncal::tests
