#include "services/records/store/document_register.hpp"

#include <gmock/gmock.h>

#include "tests/unit/services/records/store/store_places.hpp"

namespace dyncal::inline records {
namespace {

using testing::HasSubstr;

class DocumentRegisterTest : public tests::StorePlaces {
protected:
  [[nodiscard]] std::unique_ptr<DocumentRegister> known() const {
    auto opened = DocumentRegister::open(place_);
    EXPECT_TRUE(opened) << opened.error().message;
    return std::move(*opened);
  }
};

IssuedDocument document(const std::string& number, const std::string& sha256,
                        const std::string& kind = "DCC") {
  return {.sha256 = sha256,
          .number = number,
          .kind = kind,
          .replaces = {},
          .result_sha256 = "result",
          .bench = "acc-1",
          .run = "first",
          .serial = "17",
          .file = "/somewhere/" + sha256};
}

std::string refusal(const Expected<void>& done) {
  return done ? "" : done.error().message;
}

TEST_P(DocumentRegisterTest, GivesANumberOnce) {
  const auto register_of_laboratory = known();
  ASSERT_TRUE(register_of_laboratory->enter(document("2026-1", "a")));
  EXPECT_THAT(refusal(register_of_laboratory->enter(document("2026-1", "b"))),
              HasSubstr("a number is given once"));
  EXPECT_TRUE(register_of_laboratory->enter(document("2026-1", "c", "PDF")));
  IssuedDocument other = document("2026-1", "d", "XLSX");
  other.result_sha256 = "other";
  EXPECT_THAT(refusal(register_of_laboratory->enter(other)), HasSubstr("of run 'first'"));
  EXPECT_TRUE(register_of_laboratory->enter(document("2026-2", "e")));
}

TEST_P(DocumentRegisterTest, KnowsItsFiles) {
  ASSERT_TRUE(known()->enter(document("2026-1", "a")));
  const auto found = known()->find_file("a");
  ASSERT_TRUE(found && *found);
  EXPECT_EQ((*found)->number, "2026-1");
  EXPECT_EQ((*found)->file, "/somewhere/a");
  EXPECT_THAT((*found)->issued_utc, HasSubstr("T"));
  const auto none = known()->find_file("b");
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
}

TEST_P(DocumentRegisterTest, ReplacesWhatWasIssuedOnce) {
  const auto register_of_laboratory = known();
  ASSERT_TRUE(register_of_laboratory->enter(document("2026-1", "a")));
  IssuedDocument second = document("2026-2", "b");
  second.replaces = "2026-7";
  EXPECT_THAT(refusal(register_of_laboratory->enter(second)),
              HasSubstr("no document has number 2026-7"));
  second.replaces = "2026-1";
  ASSERT_TRUE(register_of_laboratory->enter(second));
  EXPECT_EQ(register_of_laboratory->replacement_of("2026-1").value_or("?"), "2026-2");
  EXPECT_EQ(register_of_laboratory->replacement_of("2026-2").value_or("?"), "");
  IssuedDocument third = document("2026-3", "c");
  third.replaces = "2026-1";
  EXPECT_THAT(refusal(register_of_laboratory->enter(third)),
              HasSubstr("was replaced by 2026-2 already"));
}

INSTANTIATE_TEST_SUITE_P(, DocumentRegisterTest,
                         testing::Values(tests::StoreKind::sqlite, tests::StoreKind::postgres),
                         tests::kind_name);

} // namespace
} // namespace dyncal::inline records
