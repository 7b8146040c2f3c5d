#include "services/views/document/toml_comments.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline views {
namespace {

TEST(TomlComments, GoWithTheLinesThatHoldNothingElse) {
  EXPECT_EQ(without_comments("# MEASURE IT\n[bench]\nname = 1 # of ours\n  # more\nlevel = 2\n"),
            "[bench]\nname = 1\nlevel = 2\n");
}

TEST(TomlComments, StayWithinStrings) {
  const char* const text = "a = \"x # y\"\nb = 'C:\\# '\nc = \"q\\\" # r\"\n"
                           "d = \"\"\"\n# in it \"\n\"\"\"\ne = '''\n#'''\n";
  EXPECT_EQ(without_comments(text), text);
}

TEST(TomlComments, OneOfSeveralEmptyLinesStays) {
  EXPECT_EQ(without_comments("# head\n\n\na = 1\n\n# between\n\nb = 2"), "a = 1\n\nb = 2\n");
}

TEST(TomlComments, NothingIsLeftOfCommentsAlone) {
  EXPECT_EQ(without_comments("# a\n\n# b"), "");
  EXPECT_EQ(without_comments(""), "");
}

TEST(TomlComments, TextThatIsNoTomlKeepsItsWords) {
  EXPECT_EQ(without_comments("it's \"open\nnext # gone"), "it's \"open\nnext\n");
}

} // namespace
} // namespace dyncal::inline views
