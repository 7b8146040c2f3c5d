#include "drivers/tables/reference_table.hpp"

#include <random>

#include <gtest/gtest.h>

#include "tests/unit/drivers/tables/table_examples.hpp"

namespace dyncal::drivers::tables {
namespace {

TEST(ReferenceTable, NamesAFileOfAnotherKind) {
  const auto rows = parse_reference_table("acs.csv", "t_ns,reference\n1,2\n");
  ASSERT_FALSE(rows.has_value());
  EXPECT_EQ(rows.error().code, ErrorCode::malformed);
  EXPECT_EQ(rows.error().message,
            "acs.csv: line 1: the file is no table of a calibration system; expected "
            "'loop;frequency;ex_amp;ex_amp_std;phase;phase_std', or the names Frequency, "
            "Acceleration, Phase of a SPEKTRA system, and behind them units");
  const auto forced =
      parse_reference_table("acs.csv", "t_ns,reference\n1,2\n\n", TableFormat::ptb_csv);
  ASSERT_FALSE(forced.has_value());
  EXPECT_TRUE(forced.error().message.starts_with("acs.csv: line 1: there are the columns"));
}

TEST(ReferenceTable, RefusesAFileThatIsCutAnywhere) {
  for (const std::string& whole : {strict_example, spektra_csv_example, spektra_prp_example}) {
    const auto all = parse_reference_table("t", whole);
    ASSERT_TRUE(all.has_value()) << all.error().message;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const auto rows = parse_reference_table("t", whole.substr(0, size));
      if (rows) { // what is there ends with a whole row
        EXPECT_EQ(whole[size - 1], '\n') << size;
        ASSERT_LT(rows->size(), all->size());
        EXPECT_EQ(rows->front(), all->front());
      } else {
        EXPECT_TRUE(rows.error().message.starts_with("t: line ")) << rows.error().message;
        EXPECT_NE(rows.error().message.find("; expected "), std::string::npos);
      }
    }
  }
}

TEST(ReferenceTable, TakesOnlyWholeRowsOfAFileThatIsWrittenTo) {
  for (const std::string& whole : {strict_example, spektra_csv_example, spektra_prp_example}) {
    const auto all = *parse_reference_table("t", whole);
    std::size_t seen = 0;
    for (std::size_t size = 0; size <= whole.size(); ++size) {
      const auto rows = parse_reference_table("t", whole.substr(0, size), {}, TableIs::written_to);
      ASSERT_TRUE(rows.has_value()) << size << ": " << rows.error().message;
      ASSERT_GE(rows->size(), seen);
      seen = rows->size();
      for (std::size_t i = 0; i < seen; ++i) {
        EXPECT_EQ((*rows)[i], all[i]);
      }
    }
    EXPECT_EQ(seen, all.size());
  }
}

TEST(ReferenceTable, SaysWhereARandomByteBreaksIt) {
  std::mt19937 random(38);
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string text = i % 2 == 0 ? strict_example : spektra_prp_example;
    text[random() % text.size()] = static_cast<char>(random() % 256);
    const auto rows = parse_reference_table("t", text);
    if (!rows) {
      ++refused;
      EXPECT_TRUE(rows.error().message.starts_with("t: line ")) << rows.error().message;
    }
  }
  EXPECT_GT(refused, 300);
}

} // namespace
} // namespace dyncal::drivers::tables
