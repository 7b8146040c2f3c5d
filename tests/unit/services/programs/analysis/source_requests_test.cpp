// What sources are asked, and by how many writers.
#include "services/programs/analysis/source_requests.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline programs {
namespace {

class SourceRequestsTest : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  bus::Participant analysis_ = network_.join("analysis");
  bus::Participant source_ = network_.join("dau");
  bus::Reader<wire::Command> commands_ =
      source_.reader(bus::topics::command, "bench", nullptr).value();
  bus::Reader<wire::CatchUpRequest> catch_ups_ =
      source_.reader(bus::topics::catch_up_request, "bench", nullptr).value();
  std::shared_ptr<SourceRequests> requests_ =
      SourceRequests::open(analysis_, "bench", "analysis@test:1").value();
};

TEST_F(SourceRequestsTest, AsksForAnAnswerInTheStream) {
  requests_->ask_for_answer("r1", "dau");
  requests_->ask_for_answer("r2", "acs"); // the next run, by the same writer
  std::vector<wire::Command> asked;
  commands_.take([&](const wire::Command& command) { asked.push_back(command); });
  ASSERT_EQ(asked.size(), 2U);
  EXPECT_EQ(asked[0].kind(), wire::COMMAND_ARM);
  EXPECT_EQ(asked[0].target().to_string(), "dau");
  EXPECT_EQ(asked[0].bench().to_string(), "bench");
  EXPECT_EQ(asked[0].run(), "r1");
  EXPECT_EQ(asked[0].sender(), "analysis@test:1");
  EXPECT_EQ(asked[1].run(), "r2");
  EXPECT_EQ(asked[1].target().to_string(), "acs");
}

TEST_F(SourceRequestsTest, AsksForWhatWasMissed) {
  requests_->ask_to_catch_up("r1", "dau", "r1 of analysis",
                             {.request = "3", .behind = {.session = 7, .number = 41}});
  std::vector<wire::CatchUpRequest> asked;
  catch_ups_.take([&](const wire::CatchUpRequest& request) { asked.push_back(request); });
  ASSERT_EQ(asked.size(), 1U);
  EXPECT_EQ(asked[0].bench().to_string(), "bench");
  EXPECT_EQ(asked[0].source().to_string(), "dau");
  EXPECT_EQ(asked[0].asker().to_string(), "r1 of analysis");
  EXPECT_EQ(asked[0].request(), "3");
  EXPECT_EQ(asked[0].run(), "r1");
  EXPECT_EQ(asked[0].session(), 7U);
  EXPECT_EQ(asked[0].after(), 41U);
}

} // namespace
} // namespace dyncal::inline programs
