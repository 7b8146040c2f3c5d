#include "services/bench/draft/bench_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/checks/bench_check/checks.hpp"
#include "services/checks/bench_check/report.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline bench::bench_draft {
namespace {

void write_records(const tests::TemporaryFolder& folder) {
  std::string acs = "t_ns,reference,sync,sensor\n";
  std::string dau = "t_ns,acceleration_z,sync\n";
  for (int i = 0; i < 200; ++i) {
    acs += std::to_string(i * 100'000) + ",1,2,3\n";
    dau += std::to_string(i * 1'000'000) + ",1,2\n";
  }
  folder.write("acs.csv", acs);
  folder.write("dau.csv", dau);
}

TEST(BenchText, EveryCombinationPassesTheCheckWithoutWarning) {
  const tests::TemporaryFolder folder;
  write_records(folder);
  folder.write("made.dbc", dbc_text());
  int combinations = 0;
  for (std::size_t sensor = 0; sensor < number_of_enumerators<SensorKind>(); ++sensor) {
    for (std::size_t acs = 0; acs < number_of_enumerators<AcsKind>(); ++acs) {
      for (std::size_t generator = 0; generator < number_of_enumerators<GeneratorKind>();
           ++generator) {
        BenchDraft draft;
        draft.name = "new-1";
        draft.sensor = static_cast<SensorKind>(sensor);
        draft.acs = static_cast<AcsKind>(acs);
        draft.generator = static_cast<GeneratorKind>(generator);
        draft.sensor_file = "dau.csv";
        draft.acs_file = "acs.csv";
        const std::string text = bench_text(draft, "made.dbc");
        const std::vector<bench_check::BenchView> views{
            bench_check::look_at_bench_text(text, folder.path() / "bench.toml")};
        const auto findings = bench_check::check_benches(views);
        // What only the user can know is left to him; nothing else is doubted.
        for (const auto& finding : findings) {
          const bool is_unknown = finding.subject.starts_with("uncertainty.") ||
                                  finding.subject == "corrections.dso_delay";
          EXPECT_EQ(finding.severity, is_unknown ? Severity::warning : Severity::note)
              << bench_check::as_text(findings) << text;
        }
        EXPECT_EQ(views[0].bench.bench, "new-1");
        EXPECT_EQ(views[0].bench.excitation.frequencies_hz, draft.frequencies_hz);
        EXPECT_THAT(text, testing::HasSubstr("# "));
        ++combinations;
      }
    }
  }
  EXPECT_EQ(combinations, 30);
}

TEST(BenchText, ChannelsOfRecordsHaveAnyName) {
  const tests::TemporaryFolder folder;
  folder.write("acs.csv", "t_ns,Kanal 1,sync \"in\"\n0,1,2\n100000,1,2\n200000,1,2\n");
  folder.write("dau.csv", "t_ns,a.z,s\n0,1,2\n1000000,1,2\n2000000,1,2\n");
  BenchDraft draft;
  draft.name = "named";
  draft.sensor = SensorKind::file;
  draft.acs = AcsKind::file;
  draft.sensor_file = "dau.csv";
  draft.acs_file = "acs.csv";
  draft.reference = "Kanal 1";
  draft.sync = "sync \"in\"";
  draft.sensor_channel = "a.z";
  draft.sensor_sync = "s";
  const std::vector<bench_check::BenchView> views{
      bench_check::look_at_bench_text(bench_text(draft, ""), folder.path() / "bench.toml")};
  const auto findings = bench_check::check_benches(views);
  EXPECT_LT(worst(findings), Severity::error) << bench_check::as_text(findings);
  ASSERT_EQ(views[0].bench.method.dut.size(), 1U);
  EXPECT_EQ(views[0].bench.method.dut[0].channel, "a.z");
}

TEST(BenchText, TextsOfTheDraftStayTexts) {
  BenchDraft draft;
  draft.name = "a\"\n[evil]\nx = \"";
  const auto reading = parse_whole_bench_file(bench_text(draft, ""), "bench.toml");
  EXPECT_EQ(reading.file.bench, draft.name);
  ASSERT_EQ(reading.problems.size(), 1U);
  EXPECT_EQ(reading.problems[0].key, "bench");
}

TEST(BenchText, AMultisineHasItsPeriodsInPlaceOfSettling) {
  const tests::TemporaryFolder folder;
  write_records(folder);
  BenchDraft draft;
  draft.name = "new-1";
  draft.sensor = SensorKind::file;
  draft.acs = AcsKind::file;
  draft.generator = GeneratorKind::none;
  draft.sensor_file = "dau.csv";
  draft.acs_file = "acs.csv";
  draft.frequencies_hz = {"10.1", "12.3", "16.1"};
  draft.multisine_period_s = 10.0;
  const auto view =
      bench_check::look_at_bench_text(bench_text(draft, ""), folder.path() / "bench.toml");
  EXPECT_TRUE(view.problems.empty());
  ASSERT_TRUE(view.bench.excitation.multisine);
  EXPECT_EQ(view.bench.excitation.multisine->period_s, 10.0);
  EXPECT_EQ(view.bench.excitation.duration_s, 10.0);
  EXPECT_FALSE(view.bench.excitation.repeat_first);
  const std::string findings = bench_check::as_text(bench_check::check_benches(std::vector{view}));
  EXPECT_THAT(findings, testing::HasSubstr("3 multi-sines of 3 lines"));
}

} // namespace
} // namespace dyncal::inline bench::bench_draft
