#include "drivers/interferometer/pair_recording.hpp"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
#include "tests/unit/drivers/interferometer/simulated_device.hpp"

namespace dyncal::tests {
namespace {

using drivers::interferometer::PairRecording;

class PairRecordingTest : public testing::Test {
protected:
  void record(const drivers::SourceDescription& description,
              const std::vector<drivers::SampleBlock>& blocks) {
    PairRecording recording(folder, description.channels[0], description.channels[1], 500e3);
    for (const drivers::SampleBlock& block : blocks) {
      const auto added = recording.add(block, column_of(block, 0), column_of(block, 1));
      ASSERT_TRUE(added) << added.error().message;
    }
  }

  [[nodiscard]] std::vector<std::string> files(const std::string& extension) const {
    std::vector<std::string> texts;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == extension) {
        std::ifstream file(entry.path(), std::ios::binary);
        texts.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
      }
    }
    return texts;
  }

  TemporaryFolder folder_;
  const std::filesystem::path folder = folder_.path() / "pairs"; // is made
};

TEST_F(PairRecordingTest, KeepsCounts) {
  DeviceSettings device;
  device.seconds = 0.01;
  const drivers::SampleBlock block = record_of(device);
  record(description_of(device), {part_of(block, 0, 2000), part_of(block, 2000, 3000)});
  const auto arrays = files(".npy");
  ASSERT_EQ(arrays.size(), 1U);
  EXPECT_NE(arrays[0].find("'<i2', 'fortran_order': False, 'shape': (5000, 2)"), std::string::npos);
  ASSERT_EQ(arrays[0].size(), 128U + 5000U * 4U);
  std::vector<std::int16_t> counts(10'000);
  std::memcpy(counts.data(), arrays[0].data() + 128, 20'000);
  for (std::size_t i = 0; i < 5000; ++i) {
    ASSERT_NEAR(counts[2 * i] * 2.0 / 16384.0, block.values[i], 1e-9);
    ASSERT_NEAR(counts[2 * i + 1] * 2.0 / 16384.0, block.values[block.samples + i], 1e-9);
  }
  EXPECT_NE(files(".toml").at(0).find("rate_hz = 500000"), std::string::npos);
}

TEST_F(PairRecordingTest, BeginsAnewBehindAGap) {
  DeviceSettings device;
  device.seconds = 0.01;
  drivers::SourceDescription description = description_of(device);
  description.channels[0].resolution = 0.0;
  const drivers::SampleBlock block = record_of(device);
  record(description, {part_of(block, 0, 2000), part_of(block, 2500, 500)});
  const auto arrays = files(".npy");
  ASSERT_EQ(arrays.size(), 2U);
  EXPECT_NE(arrays[0].find("'<f4'"), std::string::npos);
}

TEST_F(PairRecordingTest, EndsWhereNothingCanBeWritten) {
  const DeviceSettings device{.seconds = 0.01};
  const drivers::SampleBlock block = record_of(device);
  PairRecording recording("/proc/none", description_of(device).channels[0],
                          description_of(device).channels[1], 500e3);
  EXPECT_FALSE(recording.add(block, column_of(block, 0), column_of(block, 1)));
  EXPECT_TRUE(recording.add(block, column_of(block, 0), column_of(block, 1))); // said once
}

} // namespace
} // namespace dyncal::tests
