#include "services/programs/demo/demo_bench.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "services/bench/file/bench_file.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline programs {
namespace {

TEST(DemoBench, BenchFileOfEveryPresetIsOneThatAUserMayStartFrom) {
  const tests::TemporaryFolder folder;
  folder.write("adc.json", "{}");
  folder.write("dso-delay.json", R"({"value_s": 236e-9, "u_s": 1e-9})");
  folder.write("sensor.dbc", "VERSION \"\"\n");
  const DemoAddresses addresses{.dau_listen = "127.0.0.1:7654",
                                .acs = "127.0.0.1:5026",
                                .generator = "127.0.0.1:5025",
                                .oscilloscope = "127.0.0.1:5555",
                                .sensor = "127.0.0.1:5027",
                                .can_interface = "can0",
                                .can_bus = "fd-5M"};
  for (const DemoPreset& preset : demo_presets()) {
    const auto file =
        parse_bench_file(demo_bench_file(preset, "demo-1", addresses, {1e-3, 2e-3, 3e-7}),
                         folder.path() / "bench.toml");
    ASSERT_TRUE(file) << preset.name << ": " << file.error().message;
    EXPECT_EQ(file->bench, "demo-1");
    EXPECT_EQ(file->excitation.frequencies_hz, preset.frequencies_hz);
    EXPECT_EQ(file->excitation.levels_m_s2, preset.levels_m_s2);
    EXPECT_EQ(file->excitation.repetitions, preset.repetitions);
    if (preset.triggered) {
      EXPECT_EQ(file->source("dso")->as<OscilloscopeSourceSettings>()->address, "127.0.0.1:5555");
      EXPECT_EQ(file->source("tss")->as<SeriesSourceSettings>()->address, "127.0.0.1:5027");
      EXPECT_DOUBLE_EQ(file->corrections.dso_delay_s, 236e-9);
      EXPECT_DOUBLE_EQ(file->corrections.u_dso_delay_s, 1e-9);
    } else if (preset.can == DemoPreset::CanLink::none) {
      EXPECT_EQ(file->source("dau")->as<SmartupSourceSettings>()->listen, "127.0.0.1:7654");
    } else {
      ASSERT_TRUE(file->source("can")->is<CanSourceSettings>());
      EXPECT_EQ(file->source("can")->as<CanSourceSettings>()->interface_name, "can0");
      EXPECT_EQ(file->source("dau") == nullptr, preset.can == DemoPreset::CanLink::absolute_time);
    }
    EXPECT_DOUBLE_EQ(file->uncertainty.reference_phase_rad, 2e-3);
  }
}

TEST(DemoBench, ExcitesWhereTheResponseIsKnown) {
  DemoPreset preset;
  preset.frequencies_hz = {"10", "20", "80", "160"};
  preset.levels_m_s2 = {1, 2, 8, 16};
  EXPECT_EQ(keep_frequencies(preset, 20.0, 80.0), (std::vector<std::string>{"10", "160"}));
  EXPECT_EQ(preset.frequencies_hz, (std::vector<std::string>{"20", "80"}));
  EXPECT_EQ(preset.levels_m_s2, (std::vector<double>{2, 8}));
}

} // namespace
} // namespace dyncal::inline programs
