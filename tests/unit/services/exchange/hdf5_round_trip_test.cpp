#include <algorithm>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/exchange/export_recording.hpp"
#include "services/exchange/hdf5_import.hpp"
#include "services/exchange/opened_recording.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/exchange/recorded_bench.hpp"

namespace dyncal::services {
namespace {

using testing::HasSubstr;

class Hdf5RoundTrip : public testing::Test {
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

  [[nodiscard]] std::string bytes() const {
    std::ifstream file(exported_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::vector<std::string> recorded_messages() const {
    auto reader = recording::RecordingReader::open(recording_).value();
    return messages_of(reader);
  }

  tests::TemporaryFolder folder_;
  std::filesystem::path recording_ = folder_.path() / "recording.mcap";
  std::filesystem::path exported_ = folder_.path() / "exported.h5";
  ExportedFigures figures_;
};

TEST_F(Hdf5RoundTrip, GivesEveryMessageBitForBitInItsOrder) {
  auto imported = import_hdf5(exported_);
  ASSERT_TRUE(imported) << imported.error().message;
  auto expected = recorded_messages();
  auto found = messages_of(imported->reader);
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_EQ(found.size(), 18U);
  EXPECT_TRUE(std::is_permutation(found.begin(), found.end(), expected.begin()));
  const auto is_attachment = [](const std::string& one) { return one.starts_with("recipe.toml"); };
  std::erase_if(expected, is_attachment);
  std::erase_if(found, is_attachment);
  EXPECT_EQ(found, expected);
}

TEST_F(Hdf5RoundTrip, CountsWhatEachSourceHas) {
  std::vector<std::string> lines;
  for (const auto& one : figures_.sources) {
    lines.push_back(one.name + " " + std::to_string(one.channels) + " " +
                    std::to_string(one.sessions) + " " + std::to_string(one.samples) + " " +
                    std::to_string(one.lost) + " " + std::to_string(one.left_out));
  }
  EXPECT_THAT(lines, testing::ElementsAre("acs 1 1 6 0 0", "dau 2 2 11 4 1", "dau_2 3 1 3 0 0",
                                          "dso 1 1 8 0 0"));
}

// Every changed byte is reported with the file, or changes nothing.
TEST_F(Hdf5RoundTrip, NeverGivesAWrongValueOfAFileThatWasChanged) {
  const std::string sound = bytes();
  const auto expected = recorded_messages();
  const auto damaged = folder_.path() / "damaged.h5";
  std::mt19937_64 random(7);
  std::size_t refused = 0;
  for (int i = 0; i < 400; ++i) {
    std::string changed = sound;
    const std::size_t place = random() % changed.size();
    changed[place] = static_cast<char>(changed[place] ^ (1 + random() % 255));
    if (i % 10 == 0) {
      changed.resize(place);
    }
    std::ofstream(damaged, std::ios::binary) << changed;
    auto imported = import_hdf5(damaged);
    if (!imported) {
      EXPECT_THAT(imported.error().message, HasSubstr("damaged.h5"));
      ++refused;
      continue;
    }
    auto found = messages_of(imported->reader);
    EXPECT_EQ(found.size(), expected.size()) << "byte " << place;
    EXPECT_TRUE(std::is_permutation(found.begin(), found.end(), expected.begin())) << place;
  }
  EXPECT_GT(refused, 380U);
}

TEST_F(Hdf5RoundTrip, ReplacesNothingAndLeavesNothingWhenItIsStopped) {
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

TEST_F(Hdf5RoundTrip, RefusesAFileThatIsNotHdf5AndChannelsAlone) {
  std::ofstream(folder_.path() / "none.h5") << "not HDF5 at all";
  const auto none = open_recording(folder_.path() / "none.h5");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("none.h5: is not an HDF5 file"));
  const auto part =
      export_recording({recording_, folder_.path() / "part.h5", ExportFormat::hdf5, {"dau"}},
                       [](double) { return true; });
  ASSERT_FALSE(part);
  EXPECT_EQ(part.error().code, ErrorCode::bad_argument);
}

TEST_F(Hdf5RoundTrip, CountsTheMessagesThatItImports) {
  const auto count = std::make_shared<WorkCount>("reading");
  ASSERT_TRUE(import_hdf5(exported_, count));
  EXPECT_EQ(count->state().what, "importing");
  EXPECT_EQ(count->state().unit, "messages");
  EXPECT_GE(count->state().total, 17U); // and an attachment
  EXPECT_EQ(count->state().done, count->state().total);
}

TEST_F(Hdf5RoundTrip, StopsWhileItReads) {
  std::stop_source stop;
  stop.request_stop();
  const auto imported = import_hdf5(exported_, nullptr, stop.get_token());
  ASSERT_FALSE(imported);
  EXPECT_EQ(imported.error().code, ErrorCode::interrupted);
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
} // namespace dyncal::services
