// What the process that guards an output does when its program is gone, and how long.
#include "services/run/output_guard.hpp"

#include <array>
#include <cstdlib>

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/udp_port.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;

// Ends with the status of the guard; in a process of its own, whose other files the guard closes.
[[noreturn]] void guard(const std::string& last_words, std::chrono::milliseconds limit) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0 || dup2(ends[0], STDIN_FILENO) < 0 ||
      write(ends[1], last_words.data(), last_words.size()) < 0) {
    std::abort();
  }
  close(ends[1]);
  const std::string gone = fmt::format("127.0.0.1:{}", tests::own_udp_port()); // nobody listens
  std::exit(guard_output(gone, STDIN_FILENO, limit));
}

TEST(OutputGuardDeathTest, EndsWithWhatMayBeWhereTheGeneratorIsGoneForEver) {
  const auto began = std::chrono::steady_clock::now();
  EXPECT_EXIT(guard("", 3s), testing::ExitedWithCode(1),
              "the output of the generator 127.0.0.1:[0-9]+ MAY BE ON: switch it off by hand if "
              "you can; trying for 0.05 min(.|\n)*THE OUTPUT OF THE GENERATOR 127.0.0.1:[0-9]+ MAY "
              "BE ON after 0.05 min of trying, which end now: switch it off by hand");
  const auto took = std::chrono::steady_clock::now() - began;
  EXPECT_GE(took, 3s);
  EXPECT_LE(took, 20s);
}

TEST(OutputGuardDeathTest, DoesNothingAfterAFarewell) {
  EXPECT_EXIT(guard(".", 3s), testing::ExitedWithCode(0), "^$");
}

} // namespace
} // namespace dyncal::inline run
