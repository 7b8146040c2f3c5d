#include "services/programs/web/host_rules.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline programs::web {
namespace {

TEST(IsOwnHost, TakesAddressesAndNamesOfThisComputer) {
  const std::vector<std::string> names{"lab-1"};
  for (const char* host : {"127.0.0.1:8080", "127.0.0.1", "192.0.2.7:80", "[::1]:8080", "[::1]",
                           "localhost:8080", "LOCALHOST", "lab-1:8080", "Lab-1"}) {
    EXPECT_TRUE(is_own_host(host, names)) << host;
  }
  for (const char* host : {"evil.example", "evil.example:8080", "", ":8080", "lab-1.evil.example",
                           "127.0.0.1.evil.example", "localhost.evil.example", "[::1", "[evil]"}) {
    EXPECT_FALSE(is_own_host(host, names)) << host;
  }
}

TEST(IsOwnOrigin, TakesTheSameHostAndNoneOther) {
  EXPECT_TRUE(is_own_origin("", "lab-1:8080"));
  EXPECT_TRUE(is_own_origin("http://lab-1:8080", "lab-1:8080"));
  EXPECT_TRUE(is_own_origin("https://lab-1", "lab-1"));
  for (const char* origin : {"null", "http://evil.example", "http://lab-1:8081",
                             "http://lab-1:8080.evil.example", "lab-1:8080", "ftp://lab-1:8080"}) {
    EXPECT_FALSE(is_own_origin(origin, "lab-1:8080")) << origin;
  }
}

} // namespace
} // namespace dyncal::inline programs::web
