#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/records/exchange/export_recording.hpp"
#include "services/records/exchange/opened_recording.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/records/exchange/recorded_bench.hpp"

namespace dyncal::inline records {
namespace {

using testing::HasSubstr;

class Hdf5Export : public testing::Test {
protected:
  void SetUp() override {
    write_recorded_bench(recording_);
    const auto exported =
        export_recording({recording_, exported_, ExportFormat::hdf5, {}},
                         [](double share) { return share >= 0.0 && share <= 1.0; });
    if (!exported && exported.error().message.find("has no HDF5") != std::string::npos) {
      GTEST_SKIP() << "SKIPPED: " << exported.error().message;
    }
    ASSERT_TRUE(exported) << exported.error().message;
    figures_ = *exported;
  }

  tests::TemporaryFolder folder_;
  std::filesystem::path recording_ = folder_.path() / "recording.mcap";
  std::filesystem::path exported_ = folder_.path() / "exported.h5";
  ExportedFigures figures_;
};

TEST_F(Hdf5Export, CountsWhatEachSourceHas) {
  std::vector<std::string> lines;
  for (const auto& one : figures_.sources) {
    lines.push_back(one.name + " " + std::to_string(one.channels) + " " +
                    std::to_string(one.sessions) + " " + std::to_string(one.samples) + " " +
                    std::to_string(one.lost) + " " + std::to_string(one.left_out));
  }
  EXPECT_THAT(lines, testing::ElementsAre("acs 1 1 6 0 0", "dau 2 2 11 4 1", "dau_2 3 1 3 0 0",
                                          "dso 1 1 8 0 0"));
}

TEST_F(Hdf5Export, ReplacesNothingAndLeavesNothingWhenItIsStopped) {
  const auto again = export_recording({recording_, exported_, ExportFormat::hdf5, {}},
                                      [](double) { return true; });
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().message, HasSubstr("is there already"));
  const auto other = folder_.path() / "other.h5";
  const auto stopped = export_recording({recording_, other, ExportFormat::hdf5, {}},
                                        [](double share) { return share < 0.5; });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::interrupted);
  EXPECT_FALSE(std::filesystem::exists(other));
  EXPECT_FALSE(std::filesystem::exists(other.string() + ".part"));
}

TEST_F(Hdf5Export, RefusesChannelsAlone) {
  const auto part =
      export_recording({recording_, folder_.path() / "part.h5", ExportFormat::hdf5, {"dau"}},
                       [](double) { return true; });
  ASSERT_FALSE(part);
  EXPECT_EQ(part.error().code, ErrorCode::bad_argument);
}

TEST_F(Hdf5Export, StopsWhileItReads) {
  std::stop_source stop;
  stop.request_stop();
  const auto run = folder_.path() / "run";
  std::filesystem::create_directory(run);
  std::filesystem::copy_file(recording_, run / "recording.mcap");
  std::filesystem::copy_file(recording_, run / "recording-2.mcap");
  ASSERT_TRUE(open_recording(run));
  const auto joined = open_recording(run, nullptr, stop.get_token());
  ASSERT_FALSE(joined);
  EXPECT_EQ(joined.error().code, ErrorCode::interrupted);
  const auto other = folder_.path() / "other.h5";
  const auto exported = export_recording({.recording = recording_,
                                          .to = other,
                                          .format = ExportFormat::hdf5,
                                          .channels = {},
                                          .stop = stop.get_token()},
                                         [](double) { return true; });
  ASSERT_FALSE(exported);
  EXPECT_EQ(exported.error().code, ErrorCode::interrupted);
  EXPECT_FALSE(std::filesystem::exists(other));
}

} // namespace
} // namespace dyncal::inline records
