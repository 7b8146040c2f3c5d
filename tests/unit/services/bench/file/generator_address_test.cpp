#include "services/bench/file/generator_address.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline bench {
namespace {

TEST(GeneratorAddress, IsComparedAsItIsWrittenButForLoopback) {
  EXPECT_TRUE(may_be_one_generator("192.0.2.7:5025", "192.0.2.7:5025"));
  EXPECT_FALSE(may_be_one_generator("192.0.2.7:5025", "192.0.2.8:5025"));
  EXPECT_FALSE(may_be_one_generator("192.0.2.7:5025", "192.0.2.7:5026"));
  for (const char* here : {"127.0.0.1:5025", "localhost:5025", "[::1]:5025"}) {
    EXPECT_TRUE(may_be_one_generator(here, "192.0.2.7:5025")) << here;
    EXPECT_TRUE(may_be_one_generator("192.0.2.7:5025", here)) << here;
  }
}

} // namespace
} // namespace dyncal::inline bench
