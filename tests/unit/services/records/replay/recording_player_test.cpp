#include "services/records/replay/recording_player.hpp"

#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/records/mcap/example_recording.hpp"

namespace dyncal::inline records {
namespace {

TEST(RecordingPlayer, PutsNoGuardBackThatIsNotThere) {
  const tests::TemporaryFolder folder;
  const auto file = folder.path() / "run.mcap";
  {
    ExampleRecording recording(file);
    wire::SourceDescription description;
    description.bench("acc-1");
    description.source("dau");
    recording.add("SourceDescription", description);
    wire::ServiceStatus status;
    status.bench("acc-1");
    status.service("guard@lab-2:7");
    status.guarded_generator("192.0.2.7:5025");
    recording.add("ServiceStatus", status);
    status.service("analysis@lab-1:8");
    status.run("r1");
    status.guarded_generator("");
    recording.add("ServiceStatus", status);
    ASSERT_TRUE(recording.writer.close());
  }
  bus::MemoryNetwork network;
  bus::Participant playing = network.join("replay");
  bus::Participant listening = network.join("watch");
  ReplayOptions wish;
  wish.recording = file;
  wish.speed = 0.0;
  auto player = RecordingPlayer::open(playing, wish, {});
  ASSERT_TRUE(player) << player.error().message;
  auto states = listening.reader(bus::topics::service_status, "acc-1", nullptr).value();
  const auto figures = player->play({});
  ASSERT_TRUE(figures) << figures.error().message;
  EXPECT_EQ(figures->written, 2U);
  EXPECT_EQ(figures->left_out, 1U);
  EXPECT_EQ(figures->not_written, 0U);
  std::vector<std::string> services;
  states.take([&](const wire::ServiceStatus& one) {
    services.push_back(one.service().to_string());
    EXPECT_EQ(one.message(), "replay of run.mcap");
  });
  EXPECT_EQ(services, std::vector<std::string>{"analysis@lab-1:8"});
}

} // namespace
} // namespace dyncal::inline records
