// Plays a file through FileSource and says how that ended, for tests.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/files/file_source.hpp"
#include "tests/unit/drivers/collecting_sink.hpp"
#include "tests/unit/drivers/files/temporary_file.hpp"

namespace dyncal::drivers::files {

using tests::CollectingSink;

inline FileSettings settings_for(const TemporaryFile& file) {
  FileSettings settings;
  settings.path = file.path();
  return settings;
}

// How much of the file was read, at every block and at the end.
inline std::vector<double> shares_of(const FileSettings& settings) {
  FileSource source(settings);
  CollectingSink sink;
  std::vector<double> shares;
  EXPECT_EQ(source.share_read(), 0.0);
  EXPECT_TRUE(source.describe());
  sink.after_block = [&] { shares.push_back(source.share_read()); };
  EXPECT_TRUE(source.run(sink));
  shares.push_back(source.share_read());
  return shares;
}

inline void expect_rising_to_one(const std::vector<double>& shares) {
  ASSERT_GE(shares.size(), 2U);
  EXPECT_GE(shares.front(), 0.0);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1.0);
}

// The message of the error that describing or playing ends with; empty when there was none.
inline std::string problem_of(const FileSettings& settings) {
  FileSource source(settings);
  CollectingSink sink;
  const auto described = source.describe();
  if (!described) {
    return described.error().message;
  }
  const auto played = source.run(sink);
  return played ? "" : played.error().message;
}

} // namespace dyncal::drivers::files
