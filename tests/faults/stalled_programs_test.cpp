// Programs of a bench that stand still for a while and go on, as on a computer with too much to do:
// what they were to send comes late, and no value changes. The demo goes much faster than a bench,
// so that a second without one of its programs is half a minute of its samples. DYNCAL_SEED gives
// other stalls, DYNCAL_DRAWS more of them.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/system/evaluated_again.hpp"
#include "tests/system/test_folder.hpp"

namespace dyncal::tests {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t usual_seed = 39;

std::uint64_t number_of(const char* variable, std::uint64_t usual) {
  const char* text = std::getenv(variable);
  return text ? std::strtoull(text, nullptr, 10) : usual;
}

class StalledPrograms : public testing::TestWithParam<std::string> {
protected:
  // Until the demo has ended. Returns how many there were.
  static int stall_in_turn(ProgramRun& demo, std::mt19937_64& random) {
    const std::vector<std::string> programs{"dyncal-acs", "dyncal-dau", "dyncal-analysis",
                                            "dyncal-guard", "dyncal-virtual-bench"};
    std::uniform_int_distribution<std::size_t> which(0, programs.size());
    std::uniform_int_distribution<int> for_ms(10, 1000);
    std::uniform_int_distribution<int> behind_ms(1, 150);
    int stalls = 0;
    const auto signal = [&](std::size_t program, int number) {
      if (program == programs.size()) {
        demo.send(number);
        return true;
      }
      return demo.send_to_child(programs[program], number);
    };
    while (!demo.wait(std::chrono::milliseconds(behind_ms(random)))) {
      const std::size_t program = which(random);
      stalls += signal(program, SIGSTOP) ? 1 : 0;
      (void)demo.wait(std::chrono::milliseconds(for_ms(random)));
      signal(program, SIGCONT);
    }
    return stalls;
  }
};

INSTANTIATE_TEST_SUITE_P(EachVendor, StalledPrograms, testing::Values("fastdds", "cyclonedds"),
                         [](const auto& vendor) { return vendor.param; });

TEST_P(StalledPrograms, ChangeNoValueAndTheRecordingGivesTheSameBits) {
  std::mt19937_64 random(number_of("DYNCAL_SEED", usual_seed));
  for (std::uint64_t draw = 0; draw < number_of("DYNCAL_DRAWS", 1); ++draw) {
    const auto folder = fresh_folder_of_this_test();
    ProgramRun demo("dyncal",
                    {"demo", "--dds", GetParam(), "--speed", "max", "--repetitions", "1",
                     "--duration", "0.5", "--folder", folder / "runs", "--output", folder / "demo"},
                    folder);
    EXPECT_GT(stall_in_turn(demo, random), 0);
    EXPECT_EQ(demo.wait(0s), 0) << "draw " << draw << '\n' << demo.errors();
    const auto live = read_json(folder / "demo" / "result.json")["points"];
    EXPECT_GE(live.size(), 17U);
    EXPECT_EQ(points_evaluated_again(folder / "runs"), live) << "draw " << draw;
  }
}

} // namespace
} // namespace dyncal::tests
