#include "services/records/store/audit_trail.hpp"

#include <random>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/contract/digest.hpp"
#include "services/records/store/document_register.hpp"
#include "services/records/store/migrations.hpp"
#include "services/records/store/store.hpp"
#include "tests/unit/services/records/store/example_results.hpp"
#include "tests/unit/services/records/store/store_places.hpp"

namespace dyncal::inline records {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

const ActingPerson meter{"A. Meter", "meter", "lab3"};

class AuditTrailTest : public tests::StorePlaces {
protected:
  [[nodiscard]] std::unique_ptr<Store> store() const {
    auto opened = Store::open(place_);
    EXPECT_TRUE(opened) << opened.error().message;
    return std::move(*opened);
  }
  // Results, a document, a note, an amendment: 5 entries.
  void fill() const {
    for (const char* run : {"r1", "r2"}) {
      const auto added = store()->add(
          folder_.write("result.json", tests::text_of(tests::outcome_of({.run = run}))), meter);
      ASSERT_TRUE(added) << added.error().message;
    }
    auto known = DocumentRegister::open(place_);
    ASSERT_TRUE((*known)->enter({.sha256 = "d",
                                 .number = "2026-1",
                                 .kind = "DCC",
                                 .replaces = {},
                                 .result_sha256 = "r",
                                 .bench = "acc-1",
                                 .run = "r1",
                                 .serial = "7",
                                 .file = "f"},
                                meter));
    ASSERT_TRUE(store()->add_entries("acc-1", "r1", {note(), amendment()}, meter));
  }
  static JournalEntry note() {
    return {JournalKind::note, "2026-03-01T12:00:00.000000000Z", meter, "door opened"};
  }
  static JournalEntry amendment() {
    return {JournalKind::amendment,
            "2026-03-01T13:00:00.000000000Z",
            meter,
            "typing error",
            {{"dau/serial", "mpu-7", "SN-7"}}};
  }
  [[nodiscard]] std::vector<std::string> problems() const {
    auto found = store()->audit_problems();
    EXPECT_TRUE(found) << found.error().message;
    return *found;
  }
  // What an attacker does who may change the database.
  void disarm() const {
    const auto database = open();
    for (const char* table : {"audit", "documents", "run_entries"}) {
      if (GetParam() == tests::StoreKind::postgres) {
        ASSERT_TRUE(database->execute(fmt::format("ALTER TABLE {} DISABLE TRIGGER USER", table)));
      } else {
        for (const char* change : {"UPDATE", "DELETE"}) {
          ASSERT_TRUE(database->execute(fmt::format("DROP TRIGGER {}_refuses_{}", table, change)));
        }
      }
    }
  }
};

TEST_P(AuditTrailTest, SaysWhoDidWhat) {
  fill();
  const auto entries = store()->audit();
  ASSERT_TRUE(entries) << entries.error().message;
  ASSERT_THAT(*entries, SizeIs(5));
  const char* const actions[] = {"result_added", "result_added", "document_issued", "note_added",
                                 "run_amended"};
  std::string previous;
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const AuditEntry& entry = entries->at(i);
    EXPECT_EQ(entry.number, static_cast<std::int64_t>(i) + 1);
    EXPECT_EQ(entry.action, actions[i]);
    EXPECT_EQ(entry.by, meter);
    EXPECT_EQ(entry.previous_sha256, previous);
    previous = entry.sha256;
  }
  EXPECT_THAT(entries->at(4).detail, HasSubstr("serial number of dau corrected to SN-7"));
  EXPECT_THAT(problems(), IsEmpty());
}

// By arithmetic of the header's, not by the code.
TEST_P(AuditTrailTest, HashesAsItSays) {
  fill();
  const auto entries = store()->audit();
  ASSERT_THAT(*entries, SizeIs(5));
  for (const AuditEntry& entry : *entries) {
    std::string text = entry.previous_sha256 + "\n";
    for (const std::string& part :
         {std::to_string(entry.number), entry.at_utc, entry.by.name, entry.by.user, entry.by.host,
          entry.action, entry.subject, entry.detail}) {
      text += std::to_string(part.size()) + ":" + part + "\n";
    }
    EXPECT_EQ(entry.sha256, sha256_hex(text));
  }
}

TEST_P(AuditTrailTest, RefusesEveryChange) {
  fill();
  for (const char* table : {"audit", "documents", "run_entries"}) {
    for (const std::string& change :
         {fmt::format("DELETE FROM {}", table),
          fmt::format("UPDATE {} SET {} = 'x'", table,
                      std::string(table) == "audit" ? "detail" : "run")}) {
      const auto done = open()->execute(change);
      ASSERT_FALSE(done) << change;
      EXPECT_THAT(done.error().message, HasSubstr("is append-only")) << change;
    }
  }
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_P(AuditTrailTest, FindsWhatWasChangedAllTheSame) {
  fill();
  disarm();
  const auto database = open();
  for (const char* column : {"detail", "name", "login", "host", "at_utc", "action", "subject"}) {
    const auto before =
        database->execute(fmt::format("SELECT {} FROM audit WHERE number = 2", column));
    ASSERT_TRUE(database->execute(fmt::format("UPDATE audit SET {} = $1 WHERE number = 2", column),
                                  {std::string("forged")}));
    EXPECT_THAT(problems(), Contains(HasSubstr("entry 2 of "))) << column;
    ASSERT_TRUE(database->execute(fmt::format("UPDATE audit SET {} = $1 WHERE number = 2", column),
                                  {before->at(0).at(0)}));
  }
  EXPECT_THAT(problems(), IsEmpty());
  ASSERT_TRUE(database->execute("UPDATE results SET document = '{}' WHERE run = 'r1'"));
  EXPECT_THAT(problems(), Contains(HasSubstr("the text of a result")));
  ASSERT_TRUE(database->execute("UPDATE run_entries SET entry = '{}' WHERE kind = 'amendment'"));
  EXPECT_THAT(problems(), Contains(HasSubstr("the text of a journal entry")));
  ASSERT_TRUE(database->execute("DELETE FROM documents"));
  EXPECT_THAT(problems(), Contains(HasSubstr("DCC 2026-1 of run r1")));
}

TEST_P(AuditTrailTest, FindsEntriesThatAreGone) {
  fill();
  disarm();
  std::mt19937 draw(37);
  const int gone = std::uniform_int_distribution(1, 4)(draw);
  ASSERT_TRUE(open()->execute("DELETE FROM audit WHERE number = $1", {std::int64_t{gone}}));
  EXPECT_THAT(problems(), Contains(fmt::format("entry {} is missing", gone)));
  EXPECT_THAT(problems(), Contains(HasSubstr("does not follow the one before")));
  EXPECT_THAT(problems(), Contains(HasSubstr("not in its trail")));
}

// Without the last entries the chain is whole; what they were about is still there.
TEST_P(AuditTrailTest, FindsThatItsEndIsGone) {
  fill();
  disarm();
  ASSERT_TRUE(open()->execute("DELETE FROM audit WHERE number = 5"));
  EXPECT_THAT(problems(), Contains(HasSubstr("a journal entry")));
}

TEST_P(AuditTrailTest, BeginsWithWhatAnOlderStoreHas) {
  const auto database = open();
  ASSERT_TRUE(migrate(*database, 4));
  ASSERT_TRUE(database->execute(
      "INSERT INTO results VALUES ('" + sha256_hex("text") +
      "','b','c','bench','run','complete','m','','','sw',1,1,'','','','2026-01-01','text')"));
  ASSERT_TRUE(database->execute("INSERT INTO documents VALUES ('d','2026-1','DCC','','','','r',"
                                "'bench','run','7','f')"));
  ASSERT_TRUE(migrate(*database));
  const auto entries = audit_entries(*database);
  ASSERT_TRUE(entries && entries->size() == 2);
  EXPECT_EQ(entries->at(0).action, "store_found");
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_P(AuditTrailTest, KnowsResultsThatGaveWay) {
  for (const bool ended : {false, true}) {
    const auto added = store()->add(folder_.write(
        "result.json", tests::text_of(tests::outcome_of(
                           {.run = "r1", .magnitude = ended ? 1.01 : 1.0, .ended = ended}))));
    ASSERT_TRUE(added) << added.error().message;
  }
  const auto entries = store()->audit();
  ASSERT_THAT(*entries, SizeIs(3));
  EXPECT_EQ(entries->at(1).action, "result_removed");
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_P(AuditTrailTest, AmendsWhatTheStoreLists) {
  fill();
  EXPECT_THAT(*store()->runs({.sensor = "mpu-7"}), SizeIs(1)); // r2
  const auto runs = store()->runs({.sensor = "SN-7"});
  ASSERT_TRUE(runs && runs->size() == 1);
  EXPECT_EQ(runs->front().run, "r1");
  EXPECT_THAT(runs->front().amendments, Contains(HasSubstr("was mpu-7")));
  const auto calibrations = store()->calibrations("SN-7");
  ASSERT_TRUE(calibrations);
  EXPECT_THAT(*calibrations, SizeIs(1));
  ASSERT_TRUE(store()->add_entries("acc-1", "r1", {note(), amendment()}, meter)); // again
  EXPECT_THAT(*store()->entries_of("acc-1", "r1"), SizeIs(2));
  EXPECT_THAT(*store()->audit(), SizeIs(5));
}

// A run folder is the truth, and a new store takes its journal from it.
TEST_P(AuditTrailTest, TakesTheJournalOfARunFolder) {
  folder_.write("result.json", tests::text_of(tests::outcome_of({.run = "r1"})));
  ASSERT_TRUE(append_to_journal(folder_.path(), amendment()));
  ASSERT_TRUE(store()->add(folder_.path()));
  EXPECT_THAT(*store()->entries_of("acc-1", "r1"), SizeIs(1));
  ASSERT_TRUE(append_to_journal(folder_.path(), note()));
  const auto again = store()->add(folder_.path());
  ASSERT_TRUE(again);
  EXPECT_EQ(*again, StoreAddition::already_there);
  EXPECT_THAT(*store()->entries_of("acc-1", "r1"), SizeIs(2));
  EXPECT_THAT(*store()->runs({.sensor = "SN-7"}), Not(IsEmpty()));
  EXPECT_THAT(problems(), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(, AuditTrailTest,
                         testing::Values(tests::StoreKind::sqlite, tests::StoreKind::postgres),
                         tests::kind_name);

} // namespace
} // namespace dyncal::inline records
