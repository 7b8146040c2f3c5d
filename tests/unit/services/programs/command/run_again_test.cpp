#include "services/programs/command/run_again.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline programs {
namespace {

using Words = std::vector<std::string>;

TEST(RunAgain, GoesOnWithTheRunInPlaceOfItsName) {
  EXPECT_EQ(
      arguments_again({"dyncal", "run", "b.toml", "--run", "first", "--output", "r.json"}, "first"),
      (Words{"dyncal", "run", "b.toml", "--output", "r.json", "--resume=first"}));
  EXPECT_EQ(arguments_again({"dyncal", "run", "--run=first", "--wait", "b.toml"}, "first"),
            (Words{"dyncal", "run", "b.toml", "--resume=first"}));
}

TEST(RunAgain, GoesOnASecondTime) {
  EXPECT_EQ(arguments_again({"dyncal", "run", "b.toml", "--resume=first"}, "first"),
            (Words{"dyncal", "run", "b.toml", "--resume=first"}));
  EXPECT_EQ(arguments_again({"dyncal", "run", "--resume", "first", "b.toml"}, "first"),
            (Words{"dyncal", "run", "b.toml", "--resume=first"}));
}

TEST(RunAgain, BeginsAsItWasCalledWhereNothingWasExcited) {
  const Words own{"dyncal", "run", "b.toml", "--run", "first", "--wait"};
  EXPECT_EQ(arguments_again(own, ""), own);
}

} // namespace
} // namespace dyncal::inline programs
