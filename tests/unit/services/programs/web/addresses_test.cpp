#include "services/programs/web/addresses.hpp"

#include <string>

#include <gtest/gtest.h>

namespace dyncal::inline programs::web {
namespace {

TEST(MethodsOf, AreThoseOfEveryAddress) {
  for (const char* path :
       {"/", "/events", "/page/style.css", "/javascript/x.js", "/guide/", "/files/b/r/n",
        "/api/laboratory", "/api/history", "/api/bench-files", "/api/bench/acc-1",
        "/api/bench/acc-1/run", "/api/bench/acc-1/figures", "/api/bench/acc-1/budget",
        "/api/bench/acc-1/journal", "/api/bench/acc-1/signal", "/api/bench/acc-1/spectrum",
        "/api/bench/acc-1/fit"}) {
    ASSERT_NE(methods_of(path), nullptr) << path;
    EXPECT_STREQ(methods_of(path), reading_methods) << path;
  }
  EXPECT_STREQ(methods_of("/api/run"), acting_methods);
  EXPECT_STREQ(methods_of("/api/bench/acc-1/command"), acting_methods);
  EXPECT_STREQ(methods_of("*"), all_methods);
  for (const char* path : {"", "/nothing", "/api", "/api/", "/api/bench/", "/page", "/Events"}) {
    EXPECT_EQ(methods_of(path), nullptr) << path;
  }
}

TEST(Allows, ComparesWholeMethods) {
  EXPECT_TRUE(allows(reading_methods, "GET"));
  EXPECT_TRUE(allows(reading_methods, "OPTIONS"));
  EXPECT_TRUE(allows(acting_methods, "POST"));
  for (const char* method : {"POST", "OPTION", "GET, HEAD", "", "get"}) {
    EXPECT_FALSE(allows(reading_methods, method)) << method;
  }
}

} // namespace
} // namespace dyncal::inline programs::web
