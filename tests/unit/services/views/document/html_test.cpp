#include "services/views/document/html.hpp"

#include <gmock/gmock.h>

namespace dyncal::inline views {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Html, EscapesText) {
  EXPECT_EQ(escaped("a<b>&\"c\"'d'"), "a&lt;b&gt;&amp;&quot;c&quot;&#39;d&#39;");
  EXPECT_EQ(escaped(std::string("\x01\x7f\n\t", 4)), "\xef\xbf\xbd\xef\xbf\xbd\n\t");
  EXPECT_EQ(escaped("m/s\xc2\xb2"), "m/s\xc2\xb2");
  EXPECT_EQ(escaped("m/s\xb2"), "m/s\xef\xbf\xbd"); // Latin-1
  EXPECT_EQ(escaped("a\xc2\x9b"
                    "31m\xc2\xa0\xe2\x80\xae"
                    "b\xe2\x81\xa6\xe2\x80\xa8"),
            "a\xef\xbf\xbd"
            "31m\xc2\xa0\xef\xbf\xbd"
            "b\xef\xbf\xbd\xef\xbf\xbd");
  EXPECT_EQ(element("p", "<b>", "warning"), "<p class=\"warning\">&lt;b&gt;</p>\n");
}

TEST(Html, TablesRepeatTheirHeadAndEscapeCells) {
  HtmlTable table("values", {"<i>f</i> / Hz", "flags"});
  EXPECT_TRUE(table.empty());
  table.row({"10", "<script>"});
  table.html_row({"<b>20</b>", ""});
  const std::string html = table.finish();
  EXPECT_THAT(html, HasSubstr("<thead><tr><th><i>f</i> / Hz</th><th>flags</th></tr></thead>"));
  EXPECT_THAT(html, HasSubstr("<td>10</td><td>&lt;script&gt;</td>"));
  EXPECT_THAT(html, HasSubstr("<td><b>20</b></td>"));
}

TEST(Html, DefinitionsWithoutTextAreLeftOut) {
  DefinitionTable table;
  table.add("nothing", "");
  EXPECT_EQ(table.finish(), "");
  table.add("<name>", "<text>");
  EXPECT_THAT(table.finish(), HasSubstr("<th>&lt;name&gt;</th><td>&lt;text&gt;</td>"));
  EXPECT_THAT(table.finish(), Not(HasSubstr("nothing")));
}

} // namespace
} // namespace dyncal::inline views
