// How a run begins: what reaches the analysis before its sources have answered, and who is refused.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/programs/analysis/played_session.hpp"

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;
using tests::PlayedSource;

bool is_of_samples(const bus::MessageInTransit& message) {
  return message.topic == bus::topics::acs_samples || message.topic == bus::topics::dau_samples;
}

// However long they have run: what they sent before would come ahead of their answer.
TEST_F(RunSessionTest, IsSentNothingThatItsSourcesSentBeforeTheRun) {
  std::size_t sent = 0;
  std::size_t sent_to_others = 0;
  network_.lose([&](const bus::MessageInTransit& message) {
    (message.receiver == "analysis" ? sent : sent_to_others) += is_of_samples(message) ? 1 : 0;
    return false;
  });
  for (int block = 0; block < 100; ++block) {
    acs_.send_nothing();
    dau_.send_nothing();
  }
  bus::Participant late = network_.join("late joiner"); // they are there to be sent
  auto reader = late.reader<wire::SampleBlock>(bus::topics::acs_samples, bus::Profile::samples,
                                               tests::played_bench, nullptr)
                    .value();
  EXPECT_EQ(sent_to_others, 100U);
  describe(acs_);
  describe(dau_);
  work();
  EXPECT_EQ(sent, 0U);
  acs_.answer(tests::played_run);
  dau_.answer(tests::played_run);
  EXPECT_EQ(sent, 2U);
  work();
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
}

class TwinTest : public RunSessionTest {
protected:
  // The twin's description comes second.
  void arm_with_twin(wire::SourceDescription first, wire::SourceDescription second) {
    second.session(first.session() + 1);
    PlayedSource twin(network_, second, "another host");
    sources_["acs"].description = first;
    describe(dau_);
    work();
    sources_["acs"].earlier = {first};
    sources_["acs"].description = second;
    work();
    for (int turn = 0; turn < 3; ++turn) {
      acs_.send_nothing();
      twin.send_nothing();
      work();
    }
    pass(Arming::limit - 1s);
    EXPECT_EQ(arm_state(), wire::ARM_WAITING);
    acs_.answer(tests::played_run);
    dau_.answer(tests::played_run);
    pass(2s);
  }
};

TEST_F(TwinTest, KeepsARunFromBeingArmed) {
  arm_with_twin(acs_.description(), acs_.description());
  EXPECT_EQ(arm_state(), wire::ARM_REFUSED);
  EXPECT_EQ(published_.newest_status().message(),
            "two services send as source 'acs' of bench 'synthetic'; end one of them, or give it "
            "another name");
}

// Before either has sent a sample: statuses come all the time.
TEST_F(RunSessionTest, IsNotArmedOnTwinsThatWereSeenBefore) {
  describe(acs_);
  describe(dau_);
  for (const std::uint64_t session : {1U, 2U, 1U, 2U}) {
    sources_["acs"].twins.add(session);
  }
  work();
  acs_.answer(tests::played_run);
  dau_.answer(tests::played_run);
  pass(Arming::limit + 1s);
  EXPECT_EQ(arm_state(), wire::ARM_REFUSED);
  EXPECT_THAT(published_.newest_status().message(),
              testing::HasSubstr("two services send as source 'acs' of bench 'synthetic'"));
}

TEST_F(TwinTest, IsNamedByHostAndProcess) {
  wire::SourceDescription first = acs_.description();
  first.host("bench-pc");
  first.process_id(17);
  wire::SourceDescription second = acs_.description();
  second.host("lab-pc");
  second.process_id(4);
  arm_with_twin(first, second);
  EXPECT_EQ(arm_state(), wire::ARM_REFUSED);
  EXPECT_EQ(published_.newest_status().message(),
            "two services (bench-pc:17 and lab-pc:4) send as source 'acs' of bench 'synthetic'; "
            "end one of them, or give it another name");
}

} // namespace
} // namespace dyncal::inline programs
