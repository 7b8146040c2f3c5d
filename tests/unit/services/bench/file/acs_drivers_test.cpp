#include "services/bench/file/acs_drivers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bench/file/bench_file.hpp"

namespace dyncal::inline bench {
namespace {

using testing::HasSubstr;

Expected<BenchFile> bench(const std::string& source) {
  return parse_bench_file("bench = \"acc-1\"\n[excitation]\nfrequencies_hz = [\"10\"]\n"
                          "level = 10.0\n[generator]\ndriver = \"none\"\n"
                          "[method]\nkind = \"analogue\"\nreference = \"acs/reference\"\n"
                          "dut = [\"acs/sensor\"]\n[sources.acs]\n" +
                              source,
                          "/lab/bench.toml");
}

// All keys of a driver, or all but one.
std::string keys_of(const drivers::AcsDriver& driver, const std::string& without = "") {
  std::string text = std::string("driver = \"") + driver.name + "\"\n";
  for (const drivers::AcsTextKey& key : driver.texts) {
    text += without == key.name ? "" : std::string(key.name) + " = \"127.0.0.1:5026\"\n";
  }
  for (const drivers::AcsNumberKey& key : driver.numbers) {
    text += without == key.name ? "" : std::string(key.name) + " = 1000.0\n";
  }
  return text;
}

TEST(AcsDrivers, HaveTheKeysOfTheirRow) {
  ASSERT_FALSE(acs_drivers().empty());
  for (const drivers::AcsDriver* driver : acs_drivers()) {
    EXPECT_EQ(acs_driver_named(driver->name), driver);
    const auto file = bench(keys_of(*driver) + "units = { reference = \"m/s^2\" }\n");
    ASSERT_TRUE(file) << file.error().message;
    const SourceSettings& source = *file->source("acs");
    const auto& acs = *source.as<AcsSourceSettings>();
    EXPECT_EQ(acs.driver, driver->name);
    EXPECT_EQ(acs.texts.size(), driver->texts.size());
    EXPECT_EQ(acs.numbers.size(), driver->numbers.size());
    EXPECT_EQ(source.time_base, drivers::TimeBase::local);
    ASSERT_NE(driver->make, nullptr);
    EXPECT_TRUE(driver->make({acs.texts, acs.numbers, source.channels, source.units}));
  }
}

TEST(AcsDrivers, RefuseABenchFileThatLacksAKeyOrHasAnother) {
  for (const drivers::AcsDriver* driver : acs_drivers()) {
    for (const drivers::AcsTextKey& key : driver->texts) {
      const auto file = bench(keys_of(*driver, key.name));
      ASSERT_FALSE(file);
      EXPECT_THAT(file.error().message, HasSubstr(std::string(key.name) + "' is missing"));
      EXPECT_THAT(file.error().message, HasSubstr(key.meaning));
    }
    for (const drivers::AcsNumberKey& key : driver->numbers) {
      EXPECT_EQ(bench(keys_of(*driver, key.name)).has_value(), key.otherwise.has_value());
    }
    EXPECT_FALSE(bench(keys_of(*driver) + "adress = \"x\"\n"));
  }
  EXPECT_EQ(acs_driver_named("alsa"), nullptr); // has a reader of its own
}

TEST(AcsDrivers, GiveTheRateForChecksBeforehand) {
  const auto file =
      bench("driver = \"text-stream\"\naddress = \"127.0.0.1:1\"\nsample_rate_hz = 250.5\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->source("acs")->nominal_rate_hz, 250.5);
}

} // namespace
} // namespace dyncal::inline bench
