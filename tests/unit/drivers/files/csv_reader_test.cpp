#include "drivers/files/csv_reader.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/files/file_playing.hpp"

namespace dyncal::drivers::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// The blocks of a stretch put together.
struct Table {
  explicit Table(const CsvRows& from) : problem(from.problem) {
    for (const SampleBlock& block : from.blocks) {
      stamps_ns.insert(stamps_ns.end(), block.stamps_ns.begin(), block.stamps_ns.end());
      channels.resize(block.values.size() / block.samples);
      for (std::size_t channel = 0; channel < channels.size(); ++channel) {
        const auto first =
            block.values.begin() + static_cast<std::ptrdiff_t>(channel * block.samples);
        channels[channel].insert(channels[channel].end(), first,
                                 first + static_cast<std::ptrdiff_t>(block.samples));
      }
      rows += block.samples;
    }
  }
  [[nodiscard]] const std::vector<double>& channel(std::size_t index) const {
    return channels[index];
  }

  std::size_t rows = 0;
  std::vector<std::int64_t> stamps_ns;
  std::vector<std::vector<double>> channels;
  std::optional<CsvRows::Problem> problem;
};

Table rows_of(const std::string& first_line, const std::string& lines) {
  return Table(read_csv_rows(lines, CsvLayout::of(first_line).value()));
}

TEST(CsvRows, HoldStampsAsIntegersAndValuesBitForBit) {
  const Table rows =
      rows_of("t_ns,y,z",
              "-9223372036854775808,0.9052721090471139,-1e-308\n1700000000123456789,0.1,1e22\n");
  ASSERT_EQ(rows.rows, 2U);
  EXPECT_EQ(rows.stamps_ns[0], std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(rows.stamps_ns[1], 1700000000123456789);
  EXPECT_EQ(rows.channel(0)[0], 0.9052721090471139);
  EXPECT_EQ(rows.channel(1)[0], -1e-308);
  EXPECT_EQ(rows.channel(1)[1], 1e22);
}

TEST(CsvRows, HoldIntegersOfAnyLength) {
  std::string lines;
  std::vector<std::int64_t> expected{std::numeric_limits<std::int64_t>::min(),
                                     -1'234'567'890'123'456'789, -5, 0};
  for (std::int64_t power = 1; power < std::numeric_limits<std::int64_t>::max() / 10; power *= 10) {
    for (const std::int64_t number : {power, power + 7, 9 * power, 9 * power + power / 3 * 2}) {
      if (number > expected.back()) {
        expected.push_back(number);
      }
    }
  }
  expected.push_back(std::numeric_limits<std::int64_t>::max());
  for (const std::int64_t number : expected) {
    lines += std::to_string(number) + ",1\n";
  }
  const Table rows = rows_of("t_ns,y", lines);
  ASSERT_FALSE(rows.problem) << rows.problem->sentence;
  ASSERT_EQ(rows.rows, expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(rows.stamps_ns[i], expected[i]);
  }
  for (const char* wrong :
       {"12345678901234567890,1,                 \n", "9223372036854775808,1                   \n",
        "1234567890123456.5,1\n", "1234567x90123456789,1\n"}) {
    EXPECT_TRUE(rows_of("t_ns,y", wrong).problem) << wrong;
  }
}

TEST(CsvRows, AcceptEverySeparatorLineEndAndBlank) {
  for (const auto& [first_line, lines] : {std::pair{"a;t_ns;b", "1;2;3\n"},
                                          {"a\tt_ns\tb\r", "1\t2\t3"},
                                          {"a,t_ns,b\r", "1,2,3\r\n"},
                                          {"a, t_ns ,b", " 1 , +2,+3 \n\n  \n"}}) {
    const Table rows = rows_of(first_line, lines);
    ASSERT_FALSE(rows.problem) << rows.problem->sentence;
    ASSERT_EQ(rows.rows, 1U) << lines;
    EXPECT_EQ(rows.stamps_ns[0], 2);
    EXPECT_EQ(rows.channel(0)[0], 1.0);
    EXPECT_EQ(rows.channel(1)[0], 3.0);
  }
}

TEST(CsvRows, TakeEmptyFieldsAndNanAsNotMeasured) {
  const Table rows = rows_of("t_ns,y,z", "1,,2\n2,nan,\n3,4,\r\n");
  ASSERT_EQ(rows.rows, 3U);
  EXPECT_TRUE(std::isnan(rows.channel(0)[0]));
  EXPECT_TRUE(std::isnan(rows.channel(0)[1]));
  EXPECT_EQ(rows.channel(0)[2], 4.0);
  EXPECT_TRUE(std::isnan(rows.channel(1)[1]));
  EXPECT_TRUE(std::isnan(rows.channel(1)[2]));
}

TEST(CsvRows, KeepWhatIsBeforeTheFirstProblem) {
  const Table rows = rows_of("t_ns,y", "1,2\n\n2,3\n3,4 5\n4,5\n");
  EXPECT_EQ(rows.rows, 2U);
  ASSERT_TRUE(rows.problem);
  EXPECT_EQ(rows.problem->line, 3U);
  EXPECT_THAT(rows.problem->sentence, HasSubstr("'4 5' in column y is not a number"));
  EXPECT_THAT(rows_of("t_ns,y", "9223372036854775808,2\n").problem->sentence,
              HasSubstr("is not a whole number"));
}

TEST(CsvRows, EndABlockAtAGapAndWhenItIsFull) {
  std::string lines;
  const auto add = [&](std::uint64_t number) {
    lines += std::to_string(number) + ',' + std::to_string(10 * number) + ',' +
             std::to_string(number) + ".5," + std::to_string(number) + "\n";
  };
  constexpr std::uint64_t last = 5 + CsvRows::block_rows + 9;
  for (std::uint64_t number = 5; number <= last; ++number) {
    add(number);
  }
  add(last + 3);
  add(last + 4);
  add(last + 9);
  const CsvRows rows = read_csv_rows(lines, CsvLayout::of("sample_number,t_ns,y,z").value());
  ASSERT_FALSE(rows.problem);
  ASSERT_EQ(rows.blocks.size(), 4U);
  const std::size_t sizes[] = {CsvRows::block_rows, 10, 2, 1};
  const std::uint64_t firsts[] = {5, 5 + CsvRows::block_rows, last + 3, last + 9};
  for (std::size_t k = 0; k < 4; ++k) {
    const SampleBlock& block = rows.blocks[k];
    EXPECT_EQ(block.first_sample, firsts[k]);
    ASSERT_EQ(block.samples, sizes[k]);
    ASSERT_EQ(block.stamps_ns.size(), block.samples);
    ASSERT_EQ(block.values.size(), 2 * block.samples);
    for (std::size_t i = 0; i < block.samples; ++i) {
      ASSERT_EQ(block.stamps_ns[i], static_cast<std::int64_t>(10 * (firsts[k] + i)));
      ASSERT_EQ(block.values[i], static_cast<double>(firsts[k] + i) + 0.5);
      ASSERT_EQ(block.values[block.samples + i], static_cast<double>(firsts[k] + i));
    }
  }
}

class LargeCsv : public testing::Test {
protected:
  static constexpr std::size_t rows = 250'000; // several stretches

  void SetUp() override {
    text_ = "t_ns,y\n";
    std::mt19937_64 random(1);
    std::normal_distribution<double> value;
    for (std::size_t i = 0; i < rows; ++i) {
      values_.push_back(value(random));
      char number[32];
      const auto end = std::to_chars(number, number + sizeof number, values_.back()).ptr;
      text_ += std::to_string(stamp(i)) + ",";
      text_.append(number, end);
      text_ += '\n';
    }
  }
  static std::int64_t stamp(std::size_t row) {
    return 1'700'000'000'000'000'000 + static_cast<std::int64_t>(row * row % 7 + 10 * row);
  }

  std::string text_;
  std::vector<double> values_;
};

TEST_F(LargeCsv, ComesInOrderWhateverThreadReadIt) {
  const TemporaryFile file("large.csv", text_);
  auto reader = CsvReader::open(settings_for(file));
  ASSERT_TRUE(reader);
  std::size_t row = 0;
  for (std::size_t samples = 1;; samples = samples % 5'000 + 611) {
    const auto block = (*reader)->read(samples);
    ASSERT_TRUE(block) << block.error().message;
    if (block->samples == 0) {
      break;
    }
    ASSERT_EQ(block->first_sample, row);
    ASSERT_LE(block->samples, samples);
    for (std::size_t i = 0; i < block->samples; ++i, ++row) {
      ASSERT_EQ(block->clock ? block->clock->stamp_ns(row) : block->stamps_ns[i], stamp(row));
      ASSERT_EQ(block->values[i], values_[row]);
    }
  }
  EXPECT_EQ(row, rows);
}

TEST_F(LargeCsv, NamesTheFirstBadLineWhateverThreadMeetsIt) {
  const auto spoil = [&](std::size_t row) {
    text_[text_.find("\n" + std::to_string(stamp(row))) + 1] = 'x';
  };
  spoil(249'000);
  spoil(120'000);
  const TemporaryFile file("spoiled.csv", text_);
  FileSource source(settings_for(file));
  ASSERT_TRUE(source.describe());
  CollectingSink sink;
  const auto played = source.run(sink);
  ASSERT_FALSE(played);
  EXPECT_THAT(played.error().message, HasSubstr("spoiled.csv:120002: 'x"));
  EXPECT_EQ(sink.numbers.size(), 120'000U); // what is before it was played
}

TEST_F(LargeCsv, FlagsAStampThatFallsBetweenStretches) {
  // The first row of the second stretch: after the line end that follows the first 2 MB of rows.
  const std::size_t header = text_.find('\n') + 1;
  const std::size_t second = text_.find('\n', header + (std::size_t{1} << 21U)) + 1;
  const auto row = static_cast<std::size_t>(std::count(
                       text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(second), '\n')) -
                   1;
  text_[second] = '0'; // of 17...
  const TemporaryFile file("falling.csv", text_);
  FileSource source(settings_for(file));
  ASSERT_TRUE(source.describe());
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  EXPECT_EQ(sink.counts.stamps_not_trusted, 1U);
  std::size_t flagged = 0;
  for (const SampleBlock& block : sink.blocks) {
    for (std::size_t i = 0; i < block.flags.size(); ++i) {
      if (block.flags[i] != 0) {
        EXPECT_EQ(block.first_sample + i, row);
        EXPECT_EQ(block.flags[i], stamp_backwards);
        ++flagged;
      }
    }
  }
  EXPECT_EQ(flagged, 1U);
}

TEST(CsvReader, TakesUnitsFromBracketsBehindTheNames) {
  const TemporaryFile file("units.csv", "t_ns,x [\\metre],y [],z\n1,2,3,4\n2,3,4,5\n");
  FileSettings settings = settings_for(file);
  settings.channels = {{"x", "first"}};
  settings.units = {{"z", "\\volt"}};
  FileSource source(settings);
  const auto described = source.describe();
  ASSERT_TRUE(described) << described.error().message;
  EXPECT_EQ(described->channels[0].name, "first");
  EXPECT_EQ(described->channels[0].unit, "\\metre");
  EXPECT_EQ(described->channels[1].name, "y");
  EXPECT_EQ(described->channels[2].unit, "\\volt");
}

TEST_F(LargeCsv, TellsHowMuchIsRead) {
  const TemporaryFile file("share.csv", text_);
  const std::vector<double> shares = shares_of(settings_for(file));
  expect_rising_to_one(shares);
  EXPECT_LT(shares.front(), 0.01); // no stretch is behind before it is taken
  const double stretch =
      static_cast<double>(std::size_t{1} << 21U) / static_cast<double>(text_.size());
  for (std::size_t i = 1; i < shares.size(); ++i) {
    EXPECT_LT(shares[i] - shares[i - 1], 1.1 * stretch);
  }
}

TEST(CsvReader, ASmallFileIsReadAtItsEnd) {
  const TemporaryFile file("small.csv", "t_ns,x\n1,2\n2,3\n3,4");
  expect_rising_to_one(shares_of(settings_for(file)));
}

} // namespace
} // namespace dyncal::drivers::files
