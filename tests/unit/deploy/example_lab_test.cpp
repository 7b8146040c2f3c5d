#include <filesystem>
#include <set>

#include <gtest/gtest.h>

#include "services/bench/file/bench_file.hpp"

namespace dyncal {
namespace {

TEST(ExampleLab, HasBenchFilesThatAreAcceptedAndCanRunTogether) {
  std::set<std::string> benches;
  std::set<std::string> ports;
  for (const auto& entry : std::filesystem::directory_iterator(EXAMPLE_LAB)) {
    if (entry.path().extension() != ".toml") {
      continue;
    }
    const auto file = read_bench_file(entry.path());
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_TRUE(benches.insert(file->bench).second) << file->bench << " is there twice";
    for (const auto& source : file->sources) {
      if (const auto* smartup = source.as<SmartupSourceSettings>()) {
        EXPECT_TRUE(ports.insert(smartup->listen).second) << smartup->listen << " is there twice";
      }
    }
  }
  EXPECT_EQ(benches, (std::set<std::string>{"acc-1", "acc-2", "can-1", "tss-1"}));
}

} // namespace
} // namespace dyncal
