#include "services/base/csv_rows.hpp"

#include <gmock/gmock.h>

namespace dyncal::inline base {
namespace {

using testing::ElementsAre;
using testing::Pair;
using testing::UnorderedElementsAre;

TEST(CsvRows, AreThoseOfASpreadsheetInAnyCountry) {
  for (const char* text : {"serial,model\nS-1,M\nS-2,\n", "serial;model\r\nS-1;M\r\nS-2;\r\n",
                           "\xef\xbb\xbfserial\tmodel\nS-1\tM\n\nS-2\t"}) {
    const CsvRows table = csv_rows(text);
    EXPECT_THAT(table.head, ElementsAre("serial", "model"));
    ASSERT_EQ(table.rows.size(), 2U) << text;
    EXPECT_THAT(table.rows[0].fields,
                UnorderedElementsAre(Pair("serial", "S-1"), Pair("model", "M")));
    EXPECT_THAT(table.rows[1].fields, UnorderedElementsAre(Pair("serial", "S-2")));
    EXPECT_TRUE(table.rows[1].fits);
  }
}

TEST(CsvRows, FieldsInQuotationMarksHoldSeparatorsQuotesAndLines) {
  const CsvRows table = csv_rows("serial,name\nS-1,\"digital, \"\"smart\"\"\ntriaxial\"\nS-2,b\n");
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0].fields.at("name"), "digital, \"smart\"\ntriaxial");
  EXPECT_EQ(table.rows[1].line, 4U);
}

TEST(CsvRows, SayWhereARowHasAnotherNumberOfFields) {
  const CsvRows table = csv_rows("a,b\n1\n1,2,3\n1,2\n");
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_FALSE(table.rows[0].fits);
  EXPECT_FALSE(table.rows[1].fits);
  EXPECT_TRUE(table.rows[2].fits);
}

TEST(CsvRows, OfNothingAreNone) {
  EXPECT_TRUE(csv_rows("").rows.empty());
  EXPECT_TRUE(csv_rows("a,b\n").rows.empty());
}

} // namespace
} // namespace dyncal::inline base
