#include "drivers/virtual_bench/wire/waveform_memory.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

std::string packet_of(const std::vector<double>& values, const char* order) {
  const std::string bytes = std::to_string(2 * values.size());
  std::string packet =
      std::string("VOLATILE,") + order + ",#" + std::to_string(bytes.size()) + bytes;
  for (const double value : values) {
    const auto code = static_cast<unsigned>(std::lround(8191.5 * (1.0 + value)));
    packet += static_cast<char>(code & 0xFFU);
    packet += static_cast<char>(code >> 8U);
  }
  return packet;
}

TEST(WaveformMemory, FindsTheLinesOfAWaveformWhateverItsLength) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> phase(-3.0, 3.0);
  for (const std::size_t points : {1024U, 3000U, 999U}) {
    const double first_rad = phase(random);
    const double second_rad = phase(random);
    std::vector<double> values;
    for (std::size_t i = 0; i < points; ++i) {
      const double turns = static_cast<double>(i) / static_cast<double>(points);
      values.push_back(0.5 * std::sin(two_pi * 101.0 * turns + first_rad) +
                       0.25 * std::sin(two_pi * 303.0 * turns + second_rad));
    }
    WaveformMemory memory;
    const std::vector<double> begin(values.begin(), values.begin() + 300);
    const std::vector<double> end(values.begin() + 300, values.end());
    EXPECT_TRUE(memory.take(packet_of(begin, "CON")));
    EXPECT_FALSE(memory.is_complete());
    EXPECT_TRUE(memory.take(packet_of(end, "END")));
    ASSERT_TRUE(memory.is_complete());
    memory.set_rate(0.1 * static_cast<double>(points));
    const auto lines = memory.lines();
    ASSERT_EQ(lines.size(), 2U) << points;
    EXPECT_NEAR(lines[0].frequency_hz, 10.1, 1e-9);
    EXPECT_NEAR(lines[0].amplitude_v, 0.5, 1e-4);
    EXPECT_NEAR(lines[0].phase_rad, first_rad, 1e-4);
    EXPECT_NEAR(lines[1].frequency_hz, 30.3, 1e-9);
    EXPECT_NEAR(lines[1].amplitude_v, 0.25, 1e-4);
    EXPECT_NEAR(lines[1].phase_rad, second_rad, 1e-4);
  }
}

TEST(WaveformMemory, TakesNothingOfWhatIsNoPacket) {
  WaveformMemory memory;
  const std::string packet = packet_of(std::vector<double>(100, 0.5), "END");
  for (const std::string& broken :
       {packet.substr(0, packet.size() - 1), std::string("VOLATILE,END"),
        "NONVOL" + packet.substr(8), packet_of(std::vector<double>(100, 1.5), "END"),
        packet_of(std::vector<double>(20'000, 0.0), "END"),
        packet_of(std::vector<double>(100, 0.5), "NOW")}) {
    EXPECT_FALSE(memory.take(broken)) << broken.substr(0, 20);
    EXPECT_FALSE(memory.is_complete());
  }
}

// Points may be line ends.
TEST(EndOfLine, IsNotWithinABlock) {
  EXPECT_EQ(end_of_line("*IDN?\n*OPC?\n"), 5U);
  EXPECT_EQ(end_of_line(":OUTP1 O"), std::string_view::npos);
  const std::string line = "DAC16 VOLATILE,END,#14\n\n\n\n\n";
  EXPECT_EQ(end_of_line(line), line.size() - 1);
  for (std::size_t came = 0; came < line.size(); ++came) {
    EXPECT_EQ(end_of_line(std::string_view(line).substr(0, came)), std::string_view::npos) << came;
  }
  EXPECT_EQ(end_of_line("A #x\n"), 4U);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
