#include "services/views/spreadsheet/means_csv.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace dyncal::inline views {
namespace {

MeansTable table() {
  return {{"name", "x", "y"},
          {{"a,b", NumberCell{0.1, 2}, NumberCell{std::numeric_limits<double>::quiet_NaN()}},
           {"say \"z\"", NumberCell{-1e-7}, NumberCell{3.0}}}};
}

TEST(MeansCsv, HasEveryDigitAndQuotesWhatItMust) {
  EXPECT_EQ(csv_of(table(), CsvForm::decimal_point),
            "name,x,y\r\n\"a,b\",0.1,\r\n\"say \"\"z\"\"\",-1e-07,3\r\n");
}

TEST(MeansCsv, IsWhatExcelReadsWithDecimalCommas) {
  EXPECT_EQ(csv_of(table(), CsvForm::decimal_comma),
            "\xEF\xBB\xBFname;x;y\r\n\"a,b\";0,1;\r\n\"say \"\"z\"\"\";-1e-07;3\r\n");
}

} // namespace
} // namespace dyncal::inline views
