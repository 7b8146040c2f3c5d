#include "services/views/certificate/xml_document.hpp"

#include <gmock/gmock.h>

namespace dyncal::inline views {
namespace {

using ::testing::HasSubstr;

TEST(XmlDocument, EscapesWhatItWrites) {
  const XmlDocument document = XmlDocument::make_dcc();
  document.root().add("dcc:comment", "<a> & \"b\" \x01").attribute("lang", "<'\">");
  const auto read = XmlDocument::parse(document.text(), "x.xml");
  ASSERT_TRUE(read) << read.error().message;
  const auto comment = read->root().child("comment");
  ASSERT_TRUE(comment);
  EXPECT_EQ(comment->text(), "<a> & \"b\" \xef\xbf\xbd");
  EXPECT_EQ(comment->attribute("lang"), "<'\">");
  EXPECT_TRUE(comment->children().empty());
}

TEST(XmlDocument, NamesFileAndLineOfWhatIsNotWellFormed) {
  const auto read = XmlDocument::parse("<a>\n<b>\n</a>", "x.xml");
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, HasSubstr("x.xml:3: is not well-formed XML"));
}

TEST(XmlDocument, RefusesWhateverDeclaresSomething) {
  for (const std::string text :
       {"<!DOCTYPE a><a/>", "<?xml version='1.0'?><!DOCTYPE a [<!ENTITY e 'x'>]><a>&e;</a>",
        "<a/><!-- fine --><!ELEMENT a ANY>", "", "text", "<a>&e;</a>"}) {
    EXPECT_FALSE(XmlDocument::parse(text, "x.xml")) << text;
  }
  EXPECT_FALSE(XmlDocument::parse(std::string("<a>\0</a>", 8), "x.xml"));
  EXPECT_FALSE(XmlDocument::parse(std::string(65U << 20U, ' '), "x.xml"));
  EXPECT_FALSE(XmlDocument::parse("<?xml version='1.0' encoding='ISO-8859-1'?><a/>", "x.xml"));
  EXPECT_TRUE(XmlDocument::parse("<a><!-- c --><![CDATA[<b>]]></a>", "x.xml"));
}

} // namespace
} // namespace dyncal::inline views
