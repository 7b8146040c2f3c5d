// The keys of driver = "table", and the method whose reference it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bench/file/bench_file.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline bench {
namespace {

using testing::HasSubstr;

const std::string keys = "path = \"t.csv\"\nphase = \"sync-minus-reference\"\n";

std::string bench_text(const std::string& keys_of_table, const std::string& method) {
  return "bench = \"b\"\n[sources.acs]\ndriver = \"table\"\n" + keys_of_table +
         "[sources.dau]\ndriver = \"smartup\"\nsensor = \"0xbccb0100\"\n[method]\nkind = "
         "\"sample-timestamping\"\n" +
         method +
         "sync_dau = \"dau/adc_1\"\n[excitation]\nfrequencies_hz = [\"80\"]\nlevel = 10.0\n"
         "duration_s = 5\n";
}

Expected<BenchFile> read(const std::string& keys_of_table,
                         const std::string& method = "reference_table = \"acs\"\n") {
  const tests::TemporaryFolder folder;
  return read_bench_file(folder.write("bench.toml", bench_text(keys_of_table, method)));
}

std::string problem_of(const std::string& keys_of_table,
                       const std::string& method = "reference_table = \"acs\"\n") {
  const auto bench = read(keys_of_table, method);
  return bench ? "none" : bench.error().message;
}

TEST(TableSource, ReadsItsKeys) {
  const auto bench = read(keys + "format = \"spektra-prp\"\namplitude = \"rms\"\ncoverage = 2\n"
                                 "u_amplitude_rel = 1e-3\nu_phase_deg = 0.1\n"
                                 "phase_offset_deg = 180\nfirst_loop = 1\nskip_first_rows = 2\n"
                                 "skip_last_rows = 1\n");
  ASSERT_TRUE(bench.has_value()) << bench.error().message;
  const auto* table = bench->source("acs")->as<TableSourceSettings>();
  ASSERT_NE(table, nullptr);
  ASSERT_EQ(table->paths.size(), 1U);
  EXPECT_EQ(table->paths.front().filename(), "t.csv");
  EXPECT_EQ(table->format, drivers::tables::TableFormat::spektra_prp);
  EXPECT_EQ(table->amplitude, drivers::tables::TableAmplitude::rms);
  EXPECT_EQ(table->phase, drivers::tables::TablePhase::sync_minus_reference);
  EXPECT_EQ(table->coverage, 2.0);
  EXPECT_EQ(table->u_amplitude_rel, 1e-3);
  EXPECT_EQ(table->u_phase_deg, 0.1);
  EXPECT_EQ(table->phase_offset_deg, 180.0);
  EXPECT_EQ(table->first_loop, 1);
  EXPECT_EQ(table->skip_first_rows, 2U);
  EXPECT_EQ(table->skip_last_rows, 1U);
  EXPECT_EQ(bench->method.reference.text(), "acs/reference");
  EXPECT_EQ(bench->method.sync_acs.text(), "acs/sync");
}

TEST(TableSource, HasNoUsualSignOfThePhase) {
  EXPECT_THAT(problem_of("path = \"t.csv\"\n"),
              HasSubstr("key 'sources.acs.phase' is missing: whether the table's phase is"));
  EXPECT_THAT(problem_of("path = \"t.csv\"\nphase = \"lag\"\n"), HasSubstr("sources.acs.phase"));
}

TEST(TableSource, RefusesWhatCannotBe) {
  EXPECT_THAT(problem_of(keys + "coverage = 0\n"), HasSubstr("coverage' must be above 0"));
  EXPECT_THAT(problem_of(keys + "u_phase_deg = -1\n"), HasSubstr("u_phase_deg' must be above 0"));
  EXPECT_THAT(problem_of(keys + "format = \"xlsx\"\n"), HasSubstr("sources.acs.format"));
  EXPECT_THAT(problem_of(keys + "phase_offset_deg = 400\n"), HasSubstr("from -360 to 360"));
}

TEST(TableSource, IsTheReferenceAlone) {
  EXPECT_THAT(problem_of(keys, "reference = \"acs/reference\"\nsync_acs = \"acs/sync\"\n"),
              HasSubstr("whose driver is \"table\": it has no samples, and is named by "
                        "reference_table"));
  EXPECT_THAT(problem_of(keys, "reference_table = \"dau\"\n"),
              HasSubstr("must be a source of [sources] with driver = \"table\""));
  EXPECT_THAT(problem_of(keys, "reference_table = \"acs\"\nreference = \"dau/z\"\n"),
              HasSubstr("reference' must be left out: reference_table takes its place"));
}

TEST(TableSource, SetsNoLevel) {
  const std::string generator = "[generator]\ndriver = \"scpi\"\naddress = \"127.0.0.1:9\"\n"
                                "level_per_volt = 50.0\n";
  EXPECT_EQ(problem_of(keys + generator), "none");
  EXPECT_THAT(problem_of(keys + generator + "level_tolerance_rel = 0.02\n"),
              HasSubstr("source 'acs' is a table; leave it out"));
}

} // namespace
} // namespace dyncal::inline bench
