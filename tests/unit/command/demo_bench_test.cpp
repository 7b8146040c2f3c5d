#include "services/command/demo_bench.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "services/bench/bench_file.hpp"

namespace dyncal::services {
namespace {

TEST(DemoBench, BenchFileOfEveryPresetIsOneThatAUserMayStartFrom) {
  const std::filesystem::path folder = testing::TempDir();
  std::ofstream(folder / "adc.json") << "{}";
  for (const DemoPreset& preset : demo_presets()) {
    const auto file = parse_bench_file(
        demo_bench_file(preset, "demo-1", {"127.0.0.1:7654", "127.0.0.1:5026", "127.0.0.1:5025"}, {1e-3, 2e-3}), folder / "bench.toml");
    ASSERT_TRUE(file) << preset.name << ": " << file.error().message;
    EXPECT_EQ(file->bench, "demo-1");
    EXPECT_EQ(file->excitation.frequencies_hz, preset.frequencies_hz);
    EXPECT_EQ(file->excitation.levels_m_s2, preset.levels_m_s2);
    EXPECT_EQ(file->excitation.repetitions, 3);
    EXPECT_EQ(file->source("dau")->listen, "127.0.0.1:7654");
    EXPECT_DOUBLE_EQ(file->uncertainty.reference_phase_rad, 2e-3);
  }
}

} // namespace
} // namespace dyncal::services
