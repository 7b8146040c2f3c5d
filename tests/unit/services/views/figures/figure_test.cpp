#include "services/views/figures/figure.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline views::figures {
namespace {

using testing::HasSubstr;

class FigureFiles : public testing::Test {
protected:
  tests::TemporaryFolder temporary_;
  std::filesystem::path folder_ = temporary_.path();
};

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(FigureFiles, AreWrittenIntoAFolderThatIsMade) {
  const Figure figure{"name", {.title = {"a title", ""}}, "a,b\n"};
  const auto paths = write(figure, folder_ / "new" / "folder");
  ASSERT_TRUE(paths) << paths.error().message;
  EXPECT_THAT(*paths, testing::ElementsAre(folder_ / "new/folder/name.svg",
                                           folder_ / "new/folder/name.csv"));
  EXPECT_EQ(content((*paths)[0]), figure.svg());
  EXPECT_THAT(figure.svg(), HasSubstr("a title"));
  EXPECT_EQ(content((*paths)[1]), "a,b\n");
}

TEST_F(FigureFiles, ThatCannotBeWrittenAreNamedInTheError) {
  const auto in_the_way = folder_ / "file";
  std::ofstream(in_the_way) << "x";
  const auto paths = write({"name", {}, ""}, in_the_way);
  ASSERT_FALSE(paths);
  EXPECT_EQ(paths.error().code, ErrorCode::bad_file);
  EXPECT_THAT(paths.error().message, HasSubstr(in_the_way.string()));
}

TEST_F(FigureFiles, AreNotLeftHalfWrittenWithoutAnError) {
  std::filesystem::create_directory(folder_ / "name.csv");
  const auto paths = write({"name", {}, "a"}, folder_);
  ASSERT_FALSE(paths);
  EXPECT_THAT(paths.error().message, HasSubstr("name.csv"));
}

TEST(CsvNumber, GivesBackTheSameBits) {
  for (const double value :
       {0.1, 1.0 / 3.0, 996.9551234567891e-6, -5e-324, 1.7976931348623157e308}) {
    EXPECT_EQ(std::strtod(csv_number(value).c_str(), nullptr), value);
  }
}

TEST(CsvComment, StaysOnOneLine) {
  EXPECT_EQ(csv_comment("a\nb\r"), "# a b \n");
}

} // namespace
} // namespace dyncal::inline views::figures
