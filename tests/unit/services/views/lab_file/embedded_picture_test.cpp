#include "services/views/lab_file/embedded_picture.hpp"

#include <fstream>

#include <gmock/gmock.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline views {
namespace {

using ::testing::HasSubstr;

class Picture : public ::testing::Test {
protected:
  Expected<EmbeddedPicture> picture_of(const std::string& bytes) {
    const std::filesystem::path file = folder_.path() / "picture";
    std::ofstream(file, std::ios::binary) << bytes;
    return read_picture(file);
  }

private:
  tests::TemporaryFolder folder_;
};

std::string svg(const std::string& inside) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\">" + inside + "</svg>";
}

TEST_F(Picture, IsEmbeddedAsData) {
  EXPECT_EQ(base64("Hello"), "SGVsbG8=");
  EXPECT_EQ(base64(""), "");
  const auto png = picture_of("\x89PNG\r\n\x1a\n...");
  ASSERT_TRUE(png);
  EXPECT_THAT(png->data_uri(), ::testing::StartsWith("data:image/png;base64,iVBORw0KGgo"));
  EXPECT_TRUE(picture_of("\xff\xd8\xff..."));
  EXPECT_TRUE(picture_of(svg("<g clip-path=\"url(#clip1)\"/><use href=\"#a\"/>")));
  EXPECT_TRUE(picture_of(svg("<image href=\"data:image/png;base64,AA==\"/>")));
}

TEST_F(Picture, ThatFetchesOrRunsSomethingIsRefused) {
  for (const std::string inside :
       {"<script>alert(1)</script>", "<SCRIPT/>", "<image href=\"http://x.example/a.png\"/>",
        "<image xlink:href='file:///etc/passwd'/>", "<use href = \"other.svg#a\"/>",
        "<style>@import 'a.css';</style>", "<rect fill=\"url(http://x.example/)\"/>",
        "<rect onload=\"x()\"/>", "<foreignObject/>", "<a href=\"javascript:x()\"/>",
        "<image href=\"&#104;ttp://x\"/>", "<image href=\"data:image/svg+xml,x\"/>"}) {
    EXPECT_FALSE(picture_of(svg(inside))) << inside;
  }
  EXPECT_FALSE(picture_of("<!DOCTYPE svg [<!ENTITY a 'b'>]>" + svg("")));
  EXPECT_FALSE(picture_of("GIF89a"));
  EXPECT_FALSE(picture_of(""));
  EXPECT_FALSE(picture_of(svg(std::string(5U << 20U, ' '))));
  const auto missing = read_picture("/nowhere/logo.png");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("/nowhere/logo.png"));
}

} // namespace
} // namespace dyncal::inline views
