#include "services/programs/command/logger_file.hpp"

#include <random>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace dyncal::inline programs {
namespace {

using testing::HasSubstr;

constexpr std::int64_t noon_ns = 1'772'366'400'000'000'000; // 2026-03-01T12:00:00Z

Expected<LoggerReading> newest(const std::string& text, const std::string& column = "Temp") {
  return newest_reading_of(text, {column, "degC"}, "room.csv");
}

// As loggers of several makers write the same.
TEST(LoggerFile, ReadsWhatDataLoggersWrite) {
  const std::vector<std::string> texts{
      "Time,Temp,RH\n2026-03-01T11:59:00Z,22,40\n2026-03-01T12:00:00Z,23.1,41\n",
      "\xEF\xBB\xBF"
      "Datum/Uhrzeit;Temp [\xC2\xB0"
      "C];rF\r\n2026-03-01 13:00:00+01:00;23,1;41\r\n",
      "Logger 174H\nSerial;4711\n\nDate;Time;Temp\n2026-03-01;12:00:00 UTC;23,1\n",
      "\"Time\"\t\"Temp\"\n\"2026-03-01T12:00:00.250Z\"\t\"23.1 \xC2\xB0"
      "C\"\n",
      "Time,Temp\n2026-03-01T12:00Z,\"23,1\"\n",
      "Time;Temp\n2026-03-01T12:00:00Z;23,1\n2026-03-01T12:01:00Z;---\n2026-03-01T12:0"};
  for (const std::string& text : texts) {
    const auto reading = newest(text);
    ASSERT_TRUE(reading) << text << reading.error().message;
    EXPECT_EQ(reading->utc_ns, noon_ns) << text;
    EXPECT_EQ(reading->value, 23.1) << text;
  }
}

TEST(LoggerFile, TakesAColumnByItsNumber) {
  const std::string text = "2026-03-01T12:00:00Z;1;2\n";
  EXPECT_EQ(newest(text, "2")->value, 1.0);
  EXPECT_EQ(newest(text, "3")->value, 2.0);
  EXPECT_FALSE(newest(text, "4"));
}

// A decimal comma between commas would be another number.
TEST(LoggerFile, TakesNoPartOfANumber) {
  const auto reading = newest("Time,Temp\n2026-03-01T12:00:00Z,23,1\n");
  ASSERT_FALSE(reading);
  EXPECT_THAT(reading.error().message, HasSubstr("no line with a time"));
  for (const char* text : {"1.234,5", "23.1.2", "", "-", "nan", "0x10", "12 something else"}) {
    EXPECT_FALSE(logger_value(text, "degC")) << text;
  }
  EXPECT_EQ(logger_value("+23,5 %", "%"), 23.5);
  EXPECT_EQ(logger_value("-4", "degC"), -4.0);
}

TEST(LoggerFile, TakesNoValueInAnotherUnit) {
  for (const char* text : {"296 K", "73 F",
                           "73.4 \xC2\xB0"
                           "F",
                           "23 %", "101325 Pa", "23 hPa"}) {
    EXPECT_FALSE(logger_value(text, "degC")) << text;
  }
  for (const char* text : {"23.1 degC",
                           "23,1 \xC2\xB0"
                           "C",
                           "23.1C", "23.1"}) {
    EXPECT_EQ(logger_value(text, "degC"), 23.1) << text;
  }
  EXPECT_EQ(logger_value("1013.2 mbar", "hPa"), 1013.2);
  EXPECT_EQ(logger_value("41 % rF", "%"), 41.0);
  for (const char* title : {"Temp [K]",
                            "Temp (\xC2\xB0"
                            "F)",
                            "Temp [%]"}) {
    const auto reading = newest(fmt::format("Time;{}\n2026-03-01T12:00:00Z;23,1\n", title));
    ASSERT_FALSE(reading) << title;
    EXPECT_THAT(reading.error().message, HasSubstr("not in degC"));
  }
  EXPECT_TRUE(newest("Time;Temp (room)\n2026-03-01T12:00:00Z;23,1\n"));
}

TEST(LoggerFile, TakesNoneOfSeveralColumns) {
  const std::string text = "Time;Temp in;Temp out\n2026-03-01T12:00:00Z;23,1;9\n";
  const auto reading = newest(text);
  ASSERT_FALSE(reading);
  EXPECT_THAT(reading.error().message, HasSubstr("several columns begin with 'Temp'"));
  EXPECT_EQ(newest(text, "Temp in")->value, 23.1);
  EXPECT_EQ(newest("Time;Temp;Temp out\n2026-03-01T12:00:00Z;23,1;9\n")->value, 23.1);
}

TEST(LoggerFile, NamesAColumnThatIsNotThere) {
  const auto reading = newest("Time;Hum\n2026-03-01T12:00:00Z;4\n");
  ASSERT_FALSE(reading);
  EXPECT_THAT(reading.error().message, HasSubstr("room.csv: has no column 'Temp'"));
  EXPECT_FALSE(newest_reading("/nowhere/room.csv", {"Temp", "degC"}));
}

TEST(LoggerFile, KnowsTimesAsPeopleAndLoggersWriteThem) {
  EXPECT_EQ(logger_time_ns("2026-03-01T12:00:00Z"), noon_ns);
  EXPECT_EQ(logger_time_ns("2026/03/01 12:00:00 UTC"), noon_ns);
  EXPECT_EQ(logger_time_ns("2026-03-01T10:30:00-01:30"), noon_ns);
  EXPECT_EQ(logger_time_ns("01.03.2026 12:00:00Z"), noon_ns);
  const auto here = logger_time_ns("01.03.2026 12:00");
  ASSERT_TRUE(here); // of this computer's zone: within a day
  EXPECT_LT(std::abs(*here - noon_ns), std::int64_t{86'400} * 1'000'000'000);
  // 3/1/2026 is two days.
  for (const char* text : {"3/1/2026 12:00", "2026-13-01 12:00", "2026-03-01", "12:00", "",
                           "2026-03-01 12:00:00 CET", "2026-03-01 12:00:00+1"}) {
    EXPECT_FALSE(logger_time_ns(text)) << text;
  }
}

// Whatever is in it, it is read or refused.
TEST(LoggerFile, SurvivesAnyBytes) {
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    std::mt19937 draw(seed);
    std::string text = "Time;Temp\n2026-03-01T12:00:00Z;23,1\n";
    for (int i = 0; i < 8; ++i) {
      text[std::uniform_int_distribution<std::size_t>(0, text.size() - 1)(draw)] =
          static_cast<char>(std::uniform_int_distribution(0, 255)(draw));
    }
    const auto reading = newest(text);
    EXPECT_TRUE(reading || !reading.error().message.empty()) << "seed " << seed;
  }
}

} // namespace
} // namespace dyncal::inline programs
