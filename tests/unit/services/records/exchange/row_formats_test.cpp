#include "services/records/exchange/row_formats.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/records/exchange/export_recording.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/records/exchange/recorded_bench.hpp"

namespace dyncal::inline records {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class RowFormats : public testing::Test {
protected:
  void SetUp() override { write_recorded_bench(recording_); }

  Expected<ExportedFigures> exported(const std::string& to,
                                     const std::vector<std::string>& channels = {}) const {
    const auto path = folder_.path() / to;
    return export_recording({recording_, path, parse_export_format("", path).value(), channels},
                            [](double) { return true; });
  }
  std::vector<std::string> lines(const std::string& name) const {
    std::ifstream file(folder_.path() / name);
    std::vector<std::string> all;
    for (std::string line; std::getline(file, line);) {
      all.push_back(line);
    }
    return all;
  }

  tests::TemporaryFolder folder_;
  std::filesystem::path recording_ = folder_.path() / "recording.mcap";
};

TEST_F(RowFormats, CsvHasEverySampleInOrderWithItsGaps) {
  ASSERT_TRUE(exported("tables"));
  const auto dau = lines("tables/dau.csv");
  ASSERT_EQ(dau.size(), 12U);
  EXPECT_EQ(dau[0], "t_ns,sample_number,session,lost_before,stamp_uncertainty_ns,stamp_flags,"
                    "acceleration_x [\\metre\\second\\tothe{-2}],"
                    "acceleration_y [\\metre\\second\\tothe{-2}]");
  EXPECT_EQ(dau[1], "1700000000123456789,0,1,0,40,0,-0,0.10000000000000002");
  EXPECT_EQ(dau[2], "1700000000124456792,1,1,0,41,16,nan,0.13333333333333333");
  EXPECT_THAT(dau[7], HasSubstr(",10,1,4,")); // 4 samples are missing before number 10
  EXPECT_THAT(dau[10], HasSubstr(",0,2,0,")); // another session
  const auto acs = lines("tables/acs.csv");
  ASSERT_EQ(acs.size(), 7U);
  EXPECT_THAT(acs[3], testing::StartsWith("666666662,2,")); // of its regular clock
  const auto dso = lines("tables/dso.csv");
  ASSERT_EQ(dso.size(), 9U);
  EXPECT_EQ(dso[0], "t_ns,t_s,session,shot,run,step,attempt,sync");
  EXPECT_EQ(dso[1], "1700000000123455289,-1.5e-06,1,1,1,2,1,0.3333333333333333");
  EXPECT_EQ(lines("tables/dau_2.csv").size(), 4U);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "tables.part"));
}

TEST_F(RowFormats, TakeChosenChannelsAndRefuseUnknownOnes) {
  ASSERT_TRUE(exported("some", {"dau/acceleration_y", "acs"}));
  EXPECT_THAT(lines("some/dau.csv").front(), testing::Not(HasSubstr("acceleration_x")));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "some/dso.csv"));
  const auto unknown = exported("none", {"dau/nothing"});
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("unknown channel 'dau/nothing'"));
  EXPECT_THAT(unknown.error().message, HasSubstr("acs/reference, dau/acceleration_x"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "none"));
}

TEST_F(RowFormats, RefuseARecordingWithoutSamplesAndATargetThatIsThere) {
  ASSERT_TRUE(exported("a.npz"));
  const auto again = exported("a.npz");
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().message, HasSubstr("a.npz: is there already"));
  const auto empty = folder_.path() / "empty.mcap";
  EXPECT_TRUE(ExampleRecording(empty).writer.close());
  const auto nothing = export_recording({empty, folder_.path() / "b.npz", ExportFormat::npz, {}},
                                        [](double) { return true; });
  ASSERT_FALSE(nothing);
  EXPECT_THAT(nothing.error().message, HasSubstr("empty.mcap: holds no samples"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "b.npz"));
}

TEST_F(RowFormats, McapRowsHaveAMessageASample) {
  ASSERT_TRUE(exported("rows.mcap"));
  auto reader = recording::RecordingReader::open(folder_.path() / "rows.mcap").value();
  std::map<std::string, std::vector<std::uint64_t>> times;
  std::string schema;
  const auto report = reader.scan({.message = [&](const recording::MessageInFile& one) {
    times[one.channel.topic].push_back(one.message.log_time);
    if (one.channel.topic == "dau") {
      schema = one.schema->data;
      EXPECT_EQ(one.message.data.size(), 4U + 8U * 8U);
    }
  }});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->damage_count, 0U);
  EXPECT_TRUE(report->ended_in_order);
  ASSERT_EQ(times["dau"].size(), 11U);
  EXPECT_EQ(times["dau"][1], 1700000000124456792U);
  ASSERT_EQ(times["acs"].size(), 6U); // shifted to when its block came
  EXPECT_EQ(times["acs"][2], static_cast<std::uint64_t>(example_utc_ns));
  EXPECT_EQ(times["dso"].size(), 8U);
  EXPECT_THAT(schema, testing::StartsWith("float64 stamp_s\nfloat64 sample_number\n"));
  EXPECT_THAT(schema, HasSubstr("float64 acceleration_y  # \\metre"));
}

TEST(ExportFormats, AreToldByTheNameOrRefused) {
  EXPECT_EQ(parse_export_format("", "a.hdf5").value(), ExportFormat::hdf5);
  EXPECT_EQ(parse_export_format("csv", "a.h5").value(), ExportFormat::csv);
  EXPECT_THAT(parse_export_format("", "a.mat").error().message, HasSubstr("tells no format"));
  EXPECT_THAT(parse_export_format("parquet", "a").error().message,
              HasSubstr("unknown format 'parquet'; there are: hdf5, npz"));
}

} // namespace
} // namespace dyncal::inline records
