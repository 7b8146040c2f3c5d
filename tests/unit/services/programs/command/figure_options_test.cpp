#include "services/programs/command/figure_options.hpp"

#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline programs {
namespace {

using figures::ErrorBars;
using testing::HasSubstr;
using testing::Not;

std::optional<ErrorBars> parsed(const std::string& bars) {
  CLI::App app;
  FigureFiles files;
  add_figure_options(app, files);
  try {
    app.parse("--figures f --error-bars " + bars);
  } catch (const CLI::ParseError&) {
    return std::nullopt;
  }
  return files.error_bars;
}

TEST(FigureOptions, TakesEveryKindOfBarsByBothOfItsNames) {
  EXPECT_EQ(parsed("standard"), ErrorBars::standard);
  EXPECT_EQ(parsed("u"), ErrorBars::standard);
  EXPECT_EQ(parsed("expanded"), ErrorBars::expanded);
  EXPECT_EQ(parsed("U"), ErrorBars::expanded);
  EXPECT_EQ(parsed("none"), ErrorBars::none);
  EXPECT_EQ(parsed("all"), std::nullopt);
}

struct Written {
  std::string svg;
  std::string csv;
};

// The figure over frequency, or that of the deviations from the mean, of a run with a result.
Written written(const std::string& name, const std::string& bars) {
  const tests::TemporaryFolder folder;
  RunOutcome outcome = tests::example_outcome();
  const auto files = write_figures(outcome, folder.path(), *parsed(bars));
  EXPECT_TRUE(files);
  Written text;
  for (const std::filesystem::path& path : *files) {
    if (path.filename().string().starts_with(name)) {
      std::ifstream file(path);
      (path.extension() == ".svg" ? text.svg : text.csv) =
          std::string(std::istreambuf_iterator<char>(file), {});
    }
  }
  return text;
}

std::size_t lines_of(const std::string& svg) {
  std::size_t count = 0;
  for (std::size_t at = svg.find("<line"); at != std::string::npos;
       at = svg.find("<line", at + 1)) {
    ++count;
  }
  return count;
}

TEST(FigureOptions, WithoutBarsThePictureHasNoneAndTheLegendDoesNotNameThem) {
  const Written with = written("transfer-function", "u");
  const Written without = written("transfer-function", "none");
  EXPECT_THAT(with.svg, HasSubstr(">mean ± u<"));
  EXPECT_THAT(written("transfer-function", "U").svg, HasSubstr(">mean ± U<"));
  EXPECT_THAT(without.svg, HasSubstr(">mean<"));
  EXPECT_THAT(without.svg, Not(HasSubstr("±")));
  EXPECT_LT(lines_of(without.svg), lines_of(with.svg));
  EXPECT_EQ(without.csv, with.csv); // the numbers have u all the same
}

TEST(FigureOptions, WithoutBarsDeviationsHaveNeitherBarsNorBand) {
  EXPECT_THAT(written("deviation", "U").svg, HasSubstr("± U of the mean"));
  EXPECT_THAT(written("deviation", "U").svg, HasSubstr("#1 ± u"));
  const Written without = written("deviation", "none");
  EXPECT_THAT(without.svg, HasSubstr(">#1<"));
  EXPECT_THAT(without.svg, Not(HasSubstr("±")));
  EXPECT_EQ(without.csv, written("deviation", "u").csv);
}

} // namespace
} // namespace dyncal::inline programs
