#include "services/checks/doctor/laboratory_watch.hpp"

#include <gtest/gtest.h>

#include "services/bus/host_clocks/clock_responder.hpp"
#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline checks::doctor {
namespace {

using namespace std::chrono_literals;

class LaboratoryWatchTest : public testing::Test {
protected:
  void write_description(std::uint64_t session, const std::string& host) {
    wire::SourceDescription description;
    description.bench("acc-1");
    description.source("dau");
    description.session(session);
    description.host(host);
    descriptions_.write(description);
  }
  void write_status(std::uint64_t session, std::uint64_t lost = 0) {
    wire::SourceStatus status;
    status.bench("acc-1");
    status.source("dau");
    status.session(session);
    status.lost_in_transit(lost);
    statuses_.write(status);
    watch_->work();
  }
  network::Source dau() { return watch_->view().sources[{"acc-1", "dau"}]; }

  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  bus::Participant here_ = network_.join("doctor");
  bus::Participant there_ = network_.join("there");
  bus::Writer<wire::SourceDescription> descriptions_ =
      there_.writer(bus::topics::source_description, "acc-1").value();
  bus::Writer<wire::SourceStatus> statuses_ =
      there_.writer(bus::topics::source_status, "acc-1").value();
  std::unique_ptr<LaboratoryWatch> watch_ = std::move(
      *LaboratoryWatch::open(here_, {"dyncal-doctor", "lab-1", 1, "dyncal", "memory"}, clock_));
};

TEST_F(LaboratoryWatchTest, SeesNothingWhereNothingIs) {
  watch_->work();
  EXPECT_TRUE(watch_->view().sources.empty());
  EXPECT_TRUE(watch_->view().programs.empty());
}

TEST_F(LaboratoryWatchTest, KeepsTheFirstAndTheNewestStatusOfASource) {
  write_description(1, "lab-2");
  write_status(1, 3);
  write_status(1, 8);
  EXPECT_EQ(dau().first_counts.lost_on_way, 3U);
  EXPECT_EQ(dau().counts.lost_on_way, 8U);
  EXPECT_EQ(dau().host, "lab-2");
  write_description(2, "lab-2");
  write_status(2, 4);
  EXPECT_EQ(dau().first_counts.lost_on_way, 4U) << "a new session counts anew";
  EXPECT_FALSE(dau().turns.twins()) << "a service that was restarted";
}

TEST_F(LaboratoryWatchTest, TellsGuardsAndRecordersFromAnalyses) {
  auto services = there_.writer(bus::topics::service_status, "acc-1").value();
  wire::ServiceStatus status;
  status.bench("acc-1");
  status.service("guard@lab-2:7");
  status.guarded_generator("192.0.2.7:5025");
  services.write(status);
  status.service("recorder@lab-2:8");
  status.guarded_generator("");
  status.recording("r1.mcap");
  services.write(status);
  status.service("analysis@lab-2:9");
  status.recording("");
  status.run("r1");
  services.write(status);
  watch_->work();
  const LaboratoryView view = watch_->view();
  ASSERT_EQ(view.guards.size(), 1U);
  EXPECT_EQ(view.guards.begin()->first, LaboratoryView::Key("acc-1", "guard@lab-2:7"));
  ASSERT_EQ(view.analyses.size(), 1U);
  EXPECT_EQ(view.analyses.begin()->first, "analysis@lab-2:9");
}

TEST_F(LaboratoryWatchTest, SeesTwins) {
  write_description(1, "lab-2");
  write_description(2, "lab-3");
  for (int i = 0; i < 3; ++i) {
    write_status(1);
    write_status(2);
  }
  EXPECT_TRUE(dau().turns.twins());
}

TEST_F(LaboratoryWatchTest, SeesProgramsTheirClocksAndWhatIsLost) {
  auto responder = std::move(
      *ClockResponder::open(there_, {"dyncal-acs", "lab-2", 7, "dyncal", "memory"}, clock_));
  for (int i = 0; i < 2000; ++i) {
    watch_->work();
    responder->work();
    clock_.advance(1ms);
  }
  ASSERT_EQ(watch_->view().programs.size(), 1U);
  EXPECT_EQ(watch_->view().programs[0].identity.program, "dyncal-acs");
  ASSERT_EQ(watch_->view().clocks.size(), 1U);
  EXPECT_NEAR(watch_->view().clocks[0].clock.offset_s, 0.0, watch_->view().clocks[0].clock.bound_s);
  ASSERT_EQ(watch_->view().losses.size(), 1U);
  EXPECT_EQ(watch_->view().losses[0].identity.host, "lab-2");
  EXPECT_EQ(lost_part(watch_->view().losses[0]), 0.0);
}

} // namespace
} // namespace dyncal::inline checks::doctor
