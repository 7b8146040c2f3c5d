#include "drivers/virtual_bench/wire/datagram_path.hpp"

#include <gtest/gtest.h>
#include <vector>

namespace dyncal::drivers::virtual_bench {
namespace {

std::vector<int> send_numbers(const PathSettings& settings, int count) {
  std::vector<int> arrived;
  DatagramPath path(6, settings,
                    [&](const std::string& datagram) { arrived.push_back(std::stoi(datagram)); });
  for (int i = 0; i < count; ++i) {
    path.send(std::to_string(i));
  }
  return arrived;
}

TEST(DatagramPath, DeliversInOrderWhenNothingIsWrong) {
  const std::vector<int> arrived = send_numbers({}, 100);
  ASSERT_EQ(arrived.size(), 100U);
  EXPECT_TRUE(std::is_sorted(arrived.begin(), arrived.end()));
}

TEST(DatagramPath, LosesAndDoublesAsLikelyAsAsked) {
  EXPECT_NEAR(static_cast<double>(send_numbers({.loss = 0.1}, 10'000).size()), 9000.0, 150.0);
  EXPECT_NEAR(static_cast<double>(send_numbers({.duplicate = 0.1}, 10'000).size()), 11'000.0,
              150.0);
}

TEST(DatagramPath, SwapsADatagramWithTheNextOne) {
  const std::vector<int> arrived = send_numbers({.reorder = 0.1}, 10'000);
  EXPECT_GE(arrived.size(), 9999U); // the last one may still be held
  int swapped = 0;
  for (std::size_t i = 1; i < arrived.size(); ++i) {
    if (arrived[i] < arrived[i - 1]) {
      EXPECT_EQ(arrived[i], arrived[i - 1] - 1);
      ++swapped;
    }
  }
  EXPECT_NEAR(swapped, 900, 150);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
