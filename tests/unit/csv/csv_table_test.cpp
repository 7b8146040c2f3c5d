#include "services/csv/csv_table.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <string>
#include <unistd.h>

#include <gtest/gtest.h>

namespace dyncal::services {
namespace {

std::string problem_of(const std::string& text) {
  const auto table = parse_csv(text, "data.csv");
  EXPECT_FALSE(table) << text;
  if (table) return {};
  EXPECT_EQ(table.error().code, ErrorCode::bad_file);
  return table.error().message;
}

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(CsvTable, ReadsStampsAsIntegersAndValuesBitForBit) {
  const auto table = parse_csv("t_ns,y,z\n1700000000123456789,0.9052721090471139,-1e-308\n-9223372036854775808,0.1,1e22\n", "data.csv");
  ASSERT_TRUE(table) << table.error().message;
  ASSERT_EQ(table->rows(), 2U);
  EXPECT_EQ(table->stamps_ns()[0], 1700000000123456789);
  EXPECT_EQ(table->stamps_ns()[1], std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(table->names(), (std::vector<std::string>{"y", "z"}));
  EXPECT_EQ(table->column(0)[0], 0.9052721090471139);
  EXPECT_EQ(table->column(1)[0], -1e-308);
  EXPECT_EQ(table->column(1)[1], 1e22);
  EXPECT_EQ(table->find("z"), std::optional<std::size_t>(1));
  EXPECT_EQ(table->find("t_ns"), std::nullopt);
}

TEST(CsvTable, AcceptsEverySeparatorLineEndAndPlaceOfTheTime) {
  for (const char* text : {"a;t_ns;b\n1;2;3\n", "a\tt_ns\tb\n1\t2\t3", "a,t_ns,b\r\n1,2,3\r\n",
                           "\xEF\xBB\xBF"
                           "a,t_ns,b\n1,2,3\n\n\n"}) {
    const auto table = parse_csv(text, "data.csv");
    ASSERT_TRUE(table) << table.error().message;
    ASSERT_EQ(table->rows(), 1U) << text;
    EXPECT_EQ(table->stamps_ns()[0], 2);
    EXPECT_EQ(table->column(0)[0], 1.0);
    EXPECT_EQ(table->column(1)[0], 3.0);
  }
}

TEST(CsvTable, TakesEmptyFieldsAndNanAsNotMeasured) {
  const auto table = parse_csv("t_ns,y,z\n1,,2\n2,nan,\n3,4,\r\n", "data.csv");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_TRUE(std::isnan(table->column(0)[0]));
  EXPECT_TRUE(std::isnan(table->column(0)[1]));
  EXPECT_EQ(table->column(0)[2], 4.0);
  EXPECT_TRUE(std::isnan(table->column(1)[1]));
  EXPECT_TRUE(std::isnan(table->column(1)[2]));
}

TEST(CsvTable, ReadsAFileOfStampsOnlyAndOneWithoutRows) {
  EXPECT_EQ(parse_csv("t_ns\n1\n2\n", "data.csv")->rows(), 2U);
  EXPECT_EQ(parse_csv("t_ns,y\n", "data.csv")->rows(), 0U);
  EXPECT_EQ(parse_csv("t_ns,y", "data.csv")->rows(), 0U);
}

TEST(CsvTable, NamesFileLineAndColumnOfWhatIsWrong) {
  EXPECT_EQ(problem_of("t_ns,y\n1,2\n2,x\n"), "data.csv:3: 'x' is not a number (column 'y')");
  EXPECT_EQ(problem_of("t_ns,y\n1.5,2\n"), "data.csv:2: '1.5' is not an integer (column 't_ns')");
  EXPECT_EQ(problem_of("t_ns,y\n,2\n"), "data.csv:2: '' is not an integer (column 't_ns')");
  EXPECT_TRUE(mentions(problem_of("t_ns,y\n9223372036854775808,2\n"), "data.csv:2: '9223372036854775808' is too large"));
  EXPECT_TRUE(mentions(problem_of("t_ns,y\n1,2 \n"), "data.csv:2: '2 ' is not a number"));
  EXPECT_TRUE(mentions(problem_of("t_ns,y\n1,1e999\n"), "is too large for column 'y'"));
  EXPECT_TRUE(mentions(problem_of("t_ns,y\n1,2,3\n"), "data.csv:2: more than the 2 fields"));
  EXPECT_TRUE(mentions(problem_of("t_ns,y\n1\n"), "data.csv:2: fewer than the 2 fields"));
  EXPECT_TRUE(mentions(problem_of("t_ns,y\n1,2\n\n3,4\n"), "data.csv:3:"));
  EXPECT_TRUE(mentions(problem_of("time,y\n1,2\n"), "data.csv:1: there is no column 't_ns'"));
  EXPECT_TRUE(mentions(problem_of("t_ns,y,y\n1,2,3\n"), "two columns 'y'"));
  EXPECT_TRUE(mentions(problem_of("t_ns,t_ns\n1,2\n"), "two columns 't_ns'"));
  EXPECT_TRUE(mentions(problem_of("t_ns,,y\n1,2,3\n"), "column 2 has no name"));
  EXPECT_TRUE(mentions(problem_of(""), "data.csv:1: column 1 has no name"));
}

class LargeCsv : public testing::Test {
protected:
  static constexpr std::size_t rows = 120'000; // several megabytes: several parts

  void SetUp() override {
    text_ = "t_ns,y\n";
    std::mt19937_64 random(1);
    std::normal_distribution<double> value;
    for (std::size_t i = 0; i < rows; ++i) {
      values_.push_back(value(random));
      char number[32];
      const auto end = std::to_chars(number, number + sizeof number, values_.back()).ptr;
      text_ += std::to_string(1'700'000'000'000'000'000 + static_cast<std::int64_t>(i)) + ",";
      text_.append(number, end);
      text_ += '\n';
    }
  }
  std::string text_;
  std::vector<double> values_;
};

TEST_F(LargeCsv, IsTheSameForAnyNumberOfThreads) {
  for (const unsigned threads : {1U, 2U, 3U, 7U}) {
    const auto table = parse_csv(text_, "data.csv", threads);
    ASSERT_TRUE(table) << table.error().message;
    ASSERT_EQ(table->rows(), rows);
    for (std::size_t i = 0; i < rows; ++i) {
      ASSERT_EQ(table->stamps_ns()[i], 1'700'000'000'000'000'000 + static_cast<std::int64_t>(i));
      ASSERT_EQ(table->column(0)[i], values_[i]);
    }
  }
}

TEST_F(LargeCsv, NamesTheFirstBadLineWhateverThreadMeetsIt) {
  std::string text = text_;
  const auto spoil = [&](std::int64_t row) { text[text.find(std::to_string(1'700'000'000'000'000'000 + row))] = 'x'; };
  spoil(110'000);
  spoil(60'000);
  for (const unsigned threads : {1U, 3U}) {
    const auto table = parse_csv(text, "data.csv", threads);
    ASSERT_FALSE(table);
    EXPECT_TRUE(mentions(table.error().message, "data.csv:60002:")) << table.error().message;
  }
}

TEST_F(LargeCsv, IsReadFromAFile) {
  const auto path = std::filesystem::temp_directory_path() / ("csv_table_test_" + std::to_string(::getpid()) + ".csv");
  std::ofstream(path) << text_;
  const auto table = read_csv(path);
  std::filesystem::remove(path);
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ(table->rows(), rows);
  EXPECT_EQ(table->column(0)[rows - 1], values_.back());
}

TEST(CsvTable, SaysWhyAFileCannotBeRead) {
  const auto missing = read_csv("/no/such/file.csv");
  ASSERT_FALSE(missing);
  EXPECT_TRUE(mentions(missing.error().message, "/no/such/file.csv: No such file"));
  EXPECT_TRUE(mentions(read_csv("/").error().message, "not a regular file"));
}

} // namespace
} // namespace dyncal::services
