#include "services/bench/draft/draft_questions.hpp"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline bench::bench_draft {
namespace {

Expected<BenchDraft> ask(const std::string& answers, std::string& questions) {
  std::istringstream in(answers);
  std::ostringstream out;
  auto draft = ask_for_draft(
      {},
      [](const std::string& name) {
        return name == "taken" ? std::optional<std::string>("there is taken.toml") : std::nullopt;
      },
      in, out);
  questions = out.str();
  return draft;
}

TEST(DraftQuestions, EmptyLinesMeanWhatIsOffered) {
  std::string questions;
  const auto draft = ask("acc-9" + std::string(20, '\n'), questions);
  ASSERT_TRUE(draft.has_value()) << draft.error().message;
  EXPECT_EQ(draft->name, "acc-9");
  EXPECT_EQ(draft->sensor, SensorKind::smartup);
  EXPECT_EQ(draft->level_m_s2, BenchDraft().level_m_s2);
  EXPECT_THAT(questions, testing::HasSubstr("Sensor (smartup, file, can, series, analogue) "
                                            "[smartup]: "));
}

TEST(DraftQuestions, WrongAnswersAreAskedForAgain) {
  std::string questions;
  const auto draft = ask("acc-9\nsmartap\nanalogue\nsocket\nnone\nch2\nhost:5026\n\n\n10 "
                         "zwanzig\n10 12.5\n-3\n2.5\n4\n",
                         questions);
  ASSERT_TRUE(draft.has_value()) << draft.error().message << questions;
  EXPECT_EQ(draft->sensor, SensorKind::analogue);
  EXPECT_EQ(draft->generator, GeneratorKind::none);
  EXPECT_EQ(draft->sensor_channel, "ch2");
  EXPECT_EQ(draft->acs_address, "host:5026");
  EXPECT_THAT(draft->frequencies_hz, testing::ElementsAre("10", "12.5"));
  EXPECT_EQ(draft->level_m_s2, 2.5);
  EXPECT_EQ(draft->duration_s, 4.0);
  EXPECT_THAT(questions, testing::HasSubstr("write one of smartup, file"));
  EXPECT_THAT(questions, testing::HasSubstr("'zwanzig' is not a frequency"));
  EXPECT_THAT(questions, testing::HasSubstr("write a positive number"));
}

TEST(DraftQuestions, NameAndPlacesAreCheckedAtOnce) {
  const tests::TemporaryFolder folder;
  const std::string record = folder.write("acs.csv", "t_ns,reference\n");
  std::string questions;
  const auto draft = ask("taken\nacc-9\nsmartup\nfile\nnone\n0.0.0.0\n0.0.0.0:7000\n\ngone.csv\n" +
                             record + "\n\n" + record + "\n\n0.5 10\n\n\n",
                         questions);
  ASSERT_TRUE(draft.has_value()) << draft.error().message << questions;
  EXPECT_EQ(draft->name, "acc-9");
  EXPECT_EQ(draft->listen, "0.0.0.0:7000");
  EXPECT_EQ(draft->acs_file, record);
  EXPECT_EQ(draft->reference_file, record);
  EXPECT_EQ(draft->duration_s, 6.0); // three periods of the lowest frequency
  EXPECT_THAT(questions, testing::HasSubstr("there is taken.toml"));
  EXPECT_THAT(questions, testing::HasSubstr("there is no file 'gone.csv'"));
}

TEST(DraftQuestions, AnswersThatEndEarly) {
  std::string questions;
  const auto draft = ask("acc-9\ncan\n", questions);
  ASSERT_FALSE(draft.has_value());
  EXPECT_EQ(draft.error().code, ErrorCode::interrupted);
}

} // namespace
} // namespace dyncal::inline bench::bench_draft
