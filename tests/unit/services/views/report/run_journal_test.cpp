#include "services/views/report/run_journal.hpp"

#include <fstream>
#include <thread>

#include <gmock/gmock.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline views {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const ActingPerson meter{"A. Meter", "meter", "lab3"};

JournalEntry amendment() {
  JournalEntry entry = journal_entry(JournalKind::amendment, "typing error", meter);
  entry.changes = {{"dau/serial", "0x1", "SN-7"}, {"customer", "", "M\xC3\xBCller & S\xC3\xB6hne"}};
  return entry;
}

TEST(RunJournal, GivesBackWhatWasAppended) {
  const tests::TemporaryFolder folder;
  const auto none = read_journal(folder.path());
  ASSERT_TRUE(none);
  EXPECT_THAT(*none, IsEmpty());
  const JournalEntry note = journal_entry(JournalKind::note, "door opened,\n\"twice\"", meter);
  ASSERT_TRUE(append_to_journal(folder.path(), note));
  ASSERT_TRUE(append_to_journal(folder.path(), amendment()));
  const auto read = read_journal(folder.path());
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_THAT(*read, SizeIs(2));
  EXPECT_EQ(read->at(0).text, note.text);
  EXPECT_EQ(read->at(0).by, meter);
  EXPECT_EQ(read->at(0).utc, note.utc);
  EXPECT_EQ(line_of(read->at(0)), line_of(note));
  EXPECT_EQ(read->at(1).kind, JournalKind::amendment);
  ASSERT_THAT(read->at(1).changes, SizeIs(2));
  EXPECT_EQ(read->at(1).changes[1].after, "M\xC3\xBCller & S\xC3\xB6hne");
}

TEST(RunJournal, RefusesALineThatIsNoEntry) {
  const std::string good = line_of(amendment());
  for (const std::string& bad :
       {std::string("{}"), std::string("[]"), std::string("note"), good.substr(0, 40),
        std::string(R"({"kind":"note","utc":"yesterday","by":{},"text":"x"})"),
        std::string(R"({"kind":"lie","utc":"2026-03-01T12:00:00.000000000Z","text":"x"})"),
        std::string(R"({"kind":"note","utc":"2026-03-01T12:00:00.000000000Z","by":7})")}) {
    const tests::TemporaryFolder folder;
    folder.write(journal_file_name, good + "\n" + bad + "\n");
    const auto read = read_journal(folder.path());
    ASSERT_FALSE(read) << bad;
    EXPECT_THAT(read.error().message, HasSubstr("journal.jsonl:2"));
  }
}

TEST(RunJournal, KeepsLinesOfSeveralWritersApart) {
  const tests::TemporaryFolder folder;
  constexpr int each = 50;
  {
    std::vector<std::jthread> writers;
    for (int writer = 0; writer < 4; ++writer) {
      writers.emplace_back([&folder, writer] {
        for (int i = 0; i < each; ++i) {
          static_cast<void>(append_to_journal(
              folder.path(), journal_entry(JournalKind::event,
                                           std::string(200, 'a') + std::to_string(writer), meter)));
        }
      });
    }
  }
  const auto read = read_journal(folder.path());
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_THAT(*read, SizeIs(4 * each));
}

TEST(RunJournal, SaysWhatWasAmendedWhenByWhomAndWhy) {
  JournalEntry entry = amendment();
  entry.utc = "2026-03-02T08:00:00.000000000Z";
  EXPECT_THAT(
      amendment_sentences(entry),
      ElementsAre("serial number of dau corrected to SN-7 on 2026-03-02 by A. Meter, was 0x1: "
                  "typing error",
                  HasSubstr("customer corrected to M")));
}

} // namespace
} // namespace dyncal::inline views
