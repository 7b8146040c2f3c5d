#include "services/programs/web/journal_answers.hpp"

#include <filesystem>
#include <optional>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/bus/memory/stepped_clock.hpp"
#include "services/records/store/store.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/network/messages.hpp"
#include "tests/unit/services/records/store/example_results.hpp"

namespace dyncal::inline programs::web {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

const ActingPerson meter{"A. Meter", "meter", "lab3"};
constexpr const char* hostile = "<img src=x onerror=alert(1)>\u202egnp";

JournalEntry entry(JournalKind kind, const std::string& second, const std::string& text,
                   std::vector<AmendedValue> changes = {}) {
  return {kind, "2026-11-22T10:15:" + second + ".000000000Z", meter, text, std::move(changes)};
}

class JournalAnswersTest : public testing::Test {
protected:
  JournalAnswersTest() {
    cache_.change([](network::BusState& laboratory) {
      laboratory.take(network::measurement_of("acc-1", "r1", wire::MEASUREMENT_RUNNING));
    });
  }
  void make_folder() {
    fs::create_directories(folder_.path() / run_folder);
    folder_.write(std::string(run_folder) + "/result.json",
                  R"({"points": [{"comment": "of a point"}], "conducted_by": {"name": "B. Other",
                     "user": "other", "host": "lab4"}, "comment": "first of the day"})");
  }
  void append(const JournalEntry& one) {
    const auto kept = append_to_journal(folder_.path() / run_folder, one);
    ASSERT_TRUE(kept) << kept.error().message;
  }
  httplib::Response ask(const std::string& run = "") {
    httplib::Request request;
    request.path = "/api/bench/acc-1/journal";
    request.params.emplace("run", run);
    httplib::Response response;
    EXPECT_TRUE(answers_.answer(request, response));
    return response;
  }
  Json answer() { return Json::parse(ask().body); }
  [[nodiscard]] std::string store_place() const {
    return (folder_.path() / "dyncal.sqlite").string();
  }

  static constexpr const char* run_folder = "acc-1/20261122T101530.125Z-r1";
  tests::TemporaryFolder folder_;
  bus::SteppedClock clock_;
  StateCache cache_{clock_, [](nlohmann::ordered_json&) {}};
  RunFiles files_{folder_.path()};
  JournalAnswers answers_{cache_, files_, store_place()};
};

TEST_F(JournalAnswersTest, GiveWhatTheFolderHasInTheOrderOfTime) {
  make_folder();
  append(entry(JournalKind::event, "02", "the run has paused for 3 s"));
  append(entry(JournalKind::note, "01", hostile));
  append(entry(JournalKind::amendment, "03", "misread",
               {{"operator", "B. Other", "C. Third"}, {"dau/serial", "1", "2"}}));
  const Json json = answer();
  EXPECT_EQ(json["bench"], "acc-1");
  EXPECT_EQ(json["run"], "r1");
  EXPECT_EQ(json["conducted_by"], "C. Third");
  EXPECT_EQ(json["comment"], "first of the day");
  EXPECT_EQ(json["left_out"], 0);
  ASSERT_EQ(json["entries"].size(), 3U);
  EXPECT_EQ(
      json["entries"][0],
      (Json{{"utc_ms", 1795342501000.0}, {"kind", "note"}, {"by", "A. Meter"}, {"text", hostile}}));
  EXPECT_EQ(json["entries"][1]["kind"], "event");
  EXPECT_THAT(json["entries"][2]["text"].get<std::string>(),
              HasSubstr("serial number of dau corrected to 2"));
  EXPECT_FALSE(json.contains("problem"));
}

// A note is made while the page shows the run, and so is the result file.
TEST_F(JournalAnswersTest, FollowTheFolder) {
  make_folder();
  EXPECT_EQ(answer()["conducted_by"], "B. Other (other on lab4)");
  EXPECT_TRUE(answer()["entries"].empty());
  append(entry(JournalKind::note, "01", "the door was open"));
  EXPECT_EQ(answer()["entries"].size(), 1U);
  folder_.write(std::string(run_folder) + "/result.json", R"({"comment": "another"})");
  EXPECT_EQ(answer()["comment"], "another");
  EXPECT_EQ(answer()["conducted_by"], "");
}

TEST_F(JournalAnswersTest, GiveTheNewestOfMany) {
  make_folder();
  const std::size_t more = 7;
  for (std::size_t i = 0; i < JournalAnswers::max_entries + more; ++i) {
    append(entry(JournalKind::note, "01", std::to_string(i)));
  }
  const Json json = answer();
  EXPECT_EQ(json["left_out"], more);
  ASSERT_EQ(json["entries"].size(), JournalAnswers::max_entries);
  EXPECT_EQ(json["entries"][0]["text"], "7");
}

TEST_F(JournalAnswersTest, SayThatAJournalCannotBeRead) {
  make_folder();
  folder_.write(std::string(run_folder) + "/journal.jsonl", "{\"kind\": \"no\"}\n");
  const Json json = answer();
  EXPECT_THAT(json["problem"].get<std::string>(), StartsWith("journal.jsonl:1: "));
  EXPECT_TRUE(json["entries"].empty());
}

// The run of a conductor on another host.
TEST_F(JournalAnswersTest, GiveWhatTheStoreHasOfAFolderElsewhere) {
  Json nothing = answer();
  EXPECT_TRUE(nothing["entries"].empty()); // nor is there a store
  EXPECT_EQ(nothing["conducted_by"], "");
  auto store = Store::open(store_place());
  ASSERT_TRUE(store) << store.error().message;
  ASSERT_TRUE((*store)->add_entries("acc-1", "r1", {entry(JournalKind::note, "01", "far")}, meter));
  ASSERT_TRUE((*store)->add_entries("acc-1", "r2", {entry(JournalKind::note, "01", "no")}, meter));
  const Json json = answer();
  ASSERT_EQ(json["entries"].size(), 1U);
  EXPECT_EQ(json["entries"][0]["text"], "far");
}

TEST_F(JournalAnswersTest, RefuseRunsThatNobodyHeardOf) {
  make_folder();
  EXPECT_EQ(ask("r1").status, -1); // not set: 200
  EXPECT_EQ(ask("r9").status, 404);
  EXPECT_EQ(ask("../r1").status, 404);
}

} // namespace
} // namespace dyncal::inline programs::web
