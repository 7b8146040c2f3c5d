// The page's "The step now" during a run: a number is of the step that is excited, or there is
// none.
#include <map>

#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"
#include "tests/system/web_visitor.hpp"

namespace dyncal::tests {
namespace {

using nlohmann::json;

constexpr double level_1_m_s2 = 20.0;
constexpr double level_2_m_s2 = 8.0;
constexpr double sync_acs_v = 9.75; // of the virtual bench, at every level
constexpr double sync_dau_v = 1.6208;

double amplitude_of(const json& fitted) {
  return fitted["fit"]["amplitude"].get<double>();
}

double u_amplitude(const json& fitted) {
  return fitted["fit"]["u_amplitude"].get<double>();
}

TEST(StepNow, NumbersAreOfTheStepThatIsExcited) {
  const auto folder = fresh_folder("step-now");
  LiveBench bench(folder, {.bench_arguments = {"--speed", "1", "--seed", "12"},
                           .excitation = "frequencies_hz = [\"40\", \"80\"]\nlevel = [20.0, 8.0]\n"
                                         "repetitions = 2\nsettling_s = 0.5\nduration_s = 2.0\n",
                           .rest = "adc_delay_s = 1e-6\n"});
  Laboratory page(folder / "page");
  WebVisitor visitor(page.start("dyncal-web", {"--listen", "127.0.0.1:0"}, "cyclonedds"));
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  std::map<std::uint32_t, int> numbers; // of the reference, by step
  std::map<std::string, int> of_role;
  int settling = 0;
  while (!run.wait(std::chrono::milliseconds(150))) {
    const json answer = visitor.ask("/api/bench/live/fit");
    if (!answer.is_object() || answer.value("step", 0U) == 0U) {
      continue;
    }
    const auto step = answer["step"].get<std::uint32_t>();
    const std::map<std::string, double> true_amplitude{
        {"reference", step % 2 == 1 ? level_1_m_s2 : level_2_m_s2},
        {"sync", sync_acs_v},
        {"dau_phase", sync_dau_v}};
    for (const auto& [role, amplitude] : true_amplitude) {
      const json& fitted = answer[role];
      if (!fitted.contains("fit")) {
        EXPECT_EQ(fitted.value("problem", ""), "settling") << answer;
        ++settling;
        continue;
      }
      EXPECT_NEAR(amplitude_of(fitted), amplitude, 0.006 * amplitude + 5.0 * u_amplitude(fitted))
          << role << " of step " << step;
      ++of_role[role];
      numbers[step] += role == "reference" ? 1 : 0;
    }
  }
  EXPECT_EQ(of_role.size(), 3U) << "every role has been shown";
  EXPECT_GT(of_role["reference"], 10);
  EXPECT_GE(numbers.size(), 3U) << "of 4 steps";
  EXPECT_GT(settling, 0);
}

} // namespace
} // namespace dyncal::tests
