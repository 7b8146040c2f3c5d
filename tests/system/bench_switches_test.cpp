// Every switch of the virtual bench whose trace is in the shape or in the course of a step, once
// live: what is flagged in the result is named in the table of `dyncal run` and on the page, and
// what is not flagged is covered by its uncertainty.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"
#include "tests/system/truth_deviation.hpp"
#include "tests/system/web_visitor.hpp"

namespace dyncal::tests {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr const char* axis = "acceleration_z";
constexpr std::size_t step_count = 3;
constexpr double max_deviation = 4.0; // standard uncertainties; of 2 x 3 numbers a switch

struct Switch {
  const char* name;
  std::vector<std::string> faults; // of the virtual bench
  const char* flag = "";           // that at least one step has; "": every step is covered
  const char* refusal = "";        // of every step, instead
};

LiveBenchSettings settings_of(const std::filesystem::path& folder, const Switch& which) {
  LiveBenchSettings settings{
      .bench_arguments = {"--speed", "8", "--seed", "31", "--frequencies", "20,40,125", "--levels",
                          "20", "--adc-file", folder / "adc.json"},
      .excitation = "frequencies_hz = [\"20\", \"40\", \"125\"]\nlevel = 20.0\nsettling_s = 0.4\n"
                    "duration_s = 2.0\n",
      .source_dau = "time_base = \"local\"",
      .rest = "[corrections]\nadc = { file = \"adc.json\", channel = \"ADC1\" }\n"};
  for (const std::string& fault : which.faults) {
    settings.bench_arguments.insert(settings.bench_arguments.end(), {"--fault", fault});
  }
  return settings;
}

std::vector<json> points_of_axis(const json& points) {
  std::vector<json> found;
  std::copy_if(points.begin(), points.end(), std::back_inserter(found),
               [](const json& point) { return point["channel"] == std::string("dau/") + axis; });
  return found;
}

// Flags of the point, by name.
std::vector<std::string> names_of(const json& point) {
  return point["flag_names"].get<std::vector<std::string>>();
}

void expect_same_on_page(const json& point, const json& shown) {
  for (const char* key :
       {"step", "valid", "magnitude", "u_magnitude", "phase_rad", "u_phase_rad"}) {
    EXPECT_EQ(shown[key], point[key]) << key;
  }
  EXPECT_EQ(names_of(shown), names_of(point));
  EXPECT_FALSE(shown["provisional"].get<bool>());
}

class BenchSwitch : public testing::TestWithParam<Switch> {
protected:
  // What the page says of the run once it has all that the file has, settled.
  static json on_page(WebVisitor& visitor, std::size_t points) {
    return visitor.ask_until("/api/bench/live/run", [&](const json& run) {
      return run.contains("points") && run["points"].size() == points &&
             std::none_of(run["points"].begin(), run["points"].end(),
                          [](const json& point) { return point["provisional"].get<bool>(); });
    });
  }
};

TEST_P(BenchSwitch, IsSeenInTheTableAndOnThePageOrIsCovered) {
  const Switch& which = GetParam();
  const auto folder = fresh_folder(std::string("bench-switch-") + which.name);
  LiveBench bench(folder, settings_of(folder, which));
  Laboratory laboratory(folder / "page");
  WebVisitor visitor(laboratory.start("dyncal-web", {"--listen", "127.0.0.1:0"}, "cyclonedds"));
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--output", folder / "result.json"});
  ASSERT_TRUE(run.wait(patience)) << run.errors();
  const json result = read_json(folder / "result.json");
  ASSERT_FALSE(result.is_discarded()) << run.errors();
  const json truth = bench.truth();
  const auto points = points_of_axis(result["points"]);
  const auto shown = points_of_axis(on_page(visitor, result["points"].size())["points"]);
  ASSERT_EQ(points.size(), step_count);
  ASSERT_EQ(shown.size(), step_count);
  int flagged = 0;
  for (std::size_t i = 0; i < step_count; ++i) {
    const auto names = names_of(points[i]);
    flagged += std::count(names.begin(), names.end(), which.flag) > 0 ? 1 : 0;
    if (*which.refusal != '\0') {
      EXPECT_FALSE(points[i]["valid"].get<bool>());
      EXPECT_THAT(points[i]["problem"].get<std::string>(), HasSubstr(which.refusal));
      EXPECT_EQ(shown[i]["problem"], points[i]["problem"]);
    } else if (names.empty()) {
      EXPECT_TRUE(points[i]["valid"].get<bool>()) << points[i]["problem"];
      EXPECT_LE(deviation_of_point(points[i], truth, axis), max_deviation) << points[i];
    }
    if (*which.flag == '\0' && *which.refusal == '\0') {
      EXPECT_TRUE(names.empty()) << points[i]["flags"];
    }
    expect_same_on_page(points[i], shown[i]);
  }
  EXPECT_THAT(run.output(), HasSubstr(which.refusal));
  if (*which.flag != '\0') {
    EXPECT_GT(flagged, 0) << which.flag;
    EXPECT_THAT(run.output(), HasSubstr(std::string(which.flag) + " (")) << "the table's legend";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Live, BenchSwitch,
    testing::Values(
        Switch{"none", {}}, Switch{"soft_ends_of_sensor", {"soft-ends=18,at=sensor"}, "peaks_bent"},
        Switch{"soft_end_of_reference", {"soft-ends=18,at=reference,end=upper"}, "peaks_bent"},
        Switch{"ring_down", {"ring-down=0.2"}},
        Switch{"knock_on_sensor", {"knock=5,at=sensor"}, "disturbance_cut_out"},
        Switch{"knock_on_reference", {"knock=5,at=reference"}, "disturbance_cut_out"},
        Switch{"filter_switched", {"delay-change=1e-3,after=1.2"}, "changed_within_step"},
        Switch{"held_values", {"held=0.1,at=sensor"}, "values_off_stamps"},
        Switch{"read_in_batches", {"fifo=8"}, "", "time stamps are not trusted"},
        Switch{"railway_hum", {"hum=0.02,at=sensor,frequency=16.7"}},
        Switch{"railway_hum_while_driven", {"hum=0.02,at=sensor,frequency=16.7,while=driven"}},
        Switch{"wandering_exciter", {"wandering=0.02"}}),
    [](const auto& one) { return std::string(one.param.name); });

} // namespace
} // namespace dyncal::tests
