#include "drivers/alsa/capture_source.hpp"

#include <cstring>
#include <deque>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/collecting_sink.hpp"

namespace dyncal::drivers::alsa {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using tests::CollectingSink;

// What happens next; the value of a sample is its number on the device.
struct Happening {
  Captured captured;
  std::optional<Error> opened{}; // of a device that is gone: it cannot be opened yet
  Instant started{};
};

struct Script {
  std::deque<Happening> happenings;
  std::int16_t next_value = 0;
  int opened = 0;
};

class ScriptedDevice : public CaptureDevice {
public:
  ScriptedDevice(std::shared_ptr<Script> script, const DeviceSettings& settings)
      : script_(std::move(script)), channels_(settings.channels) {}

  Expected<Instant> open() override {
    ++script_->opened;
    return begin();
  }
  Expected<Instant> restart() override { return begin(); }
  Captured read(std::span<std::byte> room) override {
    if (script_->happenings.empty()) {
      return {.event = CaptureEvent::stopped};
    }
    const Captured captured = script_->happenings.front().captured;
    if (captured.event == CaptureEvent::frames) {
      script_->happenings.pop_front();
    }
    for (std::size_t i = 0; i < captured.frames * channels_; ++i) {
      std::memcpy(room.data() + 2 * i, &script_->next_value, 2);
      script_->next_value = static_cast<std::int16_t>(script_->next_value + 1);
    }
    return captured;
  }
  std::string name() const override { return "Scripted"; }

private:
  Expected<Instant> begin() {
    if (script_->happenings.empty() ||
        script_->happenings.front().captured.event == CaptureEvent::frames) {
      return Instant{};
    }
    const Happening happening = script_->happenings.front();
    if (happening.opened) {
      script_->happenings.front().captured.event = CaptureEvent::gone;
      script_->happenings.front().opened.reset();
      return fail(happening.opened->code, happening.opened->message);
    }
    script_->happenings.pop_front();
    return happening.started;
  }

  std::shared_ptr<Script> script_;
  std::size_t channels_;
};

Happening frames(std::size_t count, milliseconds at, std::size_t waiting = 0) {
  return {
      .captured = {
          .event = CaptureEvent::frames, .frames = count, .waiting = waiting, .at = Instant(at)}};
}

class CaptureSourceTest : public testing::Test {
protected:
  CaptureSourceTest() {
    settings.device = {
        .device = "hw:7", .rate_hz = 1000, .format = SampleFormat::s16, .channels = 1};
    settings.retry_interval = milliseconds(0);
  }

  void run(std::deque<Happening> happenings) {
    script->happenings = std::move(happenings);
    CaptureSource source(settings, [this](const DeviceSettings& device, const StopSignal&) {
      return std::make_unique<ScriptedDevice>(script, device);
    });
    const auto described = source.describe();
    ASSERT_TRUE(described) << described.error().message;
    const auto done = source.run(sink);
    ASSERT_TRUE(done) << done.error().message;
  }

  CaptureSettings settings;
  std::shared_ptr<Script> script = std::make_shared<Script>();
  CollectingSink sink;
};

TEST_F(CaptureSourceTest, GivesFramesAsBlocksOfOneClock) {
  settings.device.channels = 2;
  settings.channels = {{"channel_2", "sync"}};
  settings.units = {{"sync", R"(\volt)"}};
  settings.scale = {{"sync", -16.0}};
  run({frames(50, milliseconds(50)), frames(30, milliseconds(80))});
  ASSERT_EQ(sink.descriptions.size(), 1U);
  const SourceDescription& described = sink.descriptions[0];
  EXPECT_EQ(described.device, "Scripted");
  EXPECT_EQ(described.channels[0].name, "channel_1");
  EXPECT_EQ(described.channels[1].name, "sync");
  EXPECT_EQ(described.channels[1].unit, R"(\volt)");
  EXPECT_EQ(described.channels[1].minimum, -16.0);
  EXPECT_EQ(described.channels[1].resolution, 16.0 / 32768.0);
  ASSERT_EQ(sink.numbers.size(), 80U);
  EXPECT_EQ(sink.numbers.back(), 79U);
  EXPECT_EQ(sink.stamps_ns.back(), 79'000'000);
  EXPECT_EQ(sink.channel(0)[79], 158.0 / 32768.0);
  EXPECT_EQ(sink.channel(1)[79], -16.0 * 159.0 / 32768.0);
  EXPECT_EQ(sink.counts.received, 80U);
  EXPECT_EQ(sink.counts.lost_in_device, 0U);
}

TEST_F(CaptureSourceTest, CountsAnOverrunOnInTheNumbersOfANewSession) {
  std::mt19937_64 random(1);
  const std::size_t waiting = random() % 100;
  const auto passed = static_cast<std::int64_t>(random() % 500);
  // At 50 ms the device held 50 + waiting frames, and was started again `passed` after that.
  run({frames(50, milliseconds(50), waiting),
       {.captured = {.event = CaptureEvent::overrun},
        .started = Instant(milliseconds(50 + passed))},
       frames(10, milliseconds(700))});
  const std::uint64_t next = 50 + waiting + static_cast<std::uint64_t>(passed);
  ASSERT_EQ(sink.blocks.size(), 2U);
  EXPECT_EQ(sink.blocks[1].first_sample, next);
  EXPECT_EQ(sink.stamps_ns[50], static_cast<std::int64_t>(next) * 1'000'000);
  EXPECT_THAT(sink.sessions_begun_at, ElementsAre(0, 1));
  EXPECT_EQ(sink.counts.lost_in_device, next - 50);
  EXPECT_THAT(sink.counts.causes, ElementsAre(NamedCount{"overruns", 1}));
  EXPECT_THAT(sink.warnings, ElementsAre(HasSubstr("hw:7: about")));
  EXPECT_EQ(script->opened, 1);
}

TEST_F(CaptureSourceTest, OpensADeviceAgainThatWasUnplugged) {
  run({frames(50, milliseconds(50)),
       {.captured = {.event = CaptureEvent::gone, .problem = "hw:7: is gone"},
        .opened = Error{ErrorCode::not_found, "hw:7: cannot be opened"},
        .started = Instant(milliseconds(90'050))},
       frames(10, milliseconds(90'060)),
       frames(10, milliseconds(90'070))});
  ASSERT_EQ(sink.blocks.size(), 3U);
  EXPECT_EQ(sink.blocks[1].first_sample, 90'050U);
  EXPECT_EQ(sink.blocks[2].first_sample, 90'060U);
  EXPECT_THAT(sink.sessions_begun_at, ElementsAre(0, 1));
  EXPECT_EQ(sink.counts.lost_in_device, 90'000U);
  EXPECT_THAT(sink.counts.causes, ElementsAre(NamedCount{"absences of the device", 1}));
  EXPECT_THAT(sink.warnings[0], HasSubstr("hw:7: is gone; it is waited for"));
  EXPECT_EQ(script->opened, 3); // at the beginning, in vain, and when it was back
}

TEST_F(CaptureSourceTest, SaysOnceThatADeviceCameBackAsAnother) {
  run({frames(50, milliseconds(50)),
       {.captured = {.event = CaptureEvent::gone, .problem = "hw:7: is gone"},
        .opened = Error{ErrorCode::invalid_setting, "hw:7: does not have the format"},
        .started = Instant(milliseconds(60))},
       frames(10, milliseconds(70))});
  EXPECT_THAT(sink.warnings, ElementsAre(HasSubstr("is gone"), HasSubstr("does not have"),
                                         HasSubstr("about 10 samples")));
}

TEST_F(CaptureSourceTest, LosesNothingBeforeItsFirstFrames) {
  run({{.captured = {.event = CaptureEvent::overrun}, .started = Instant(milliseconds(400))},
       frames(10, milliseconds(500))});
  ASSERT_EQ(sink.blocks.size(), 1U);
  EXPECT_EQ(sink.blocks[0].first_sample, 0U);
  EXPECT_EQ(sink.counts.lost_in_device, 0U);
}

TEST_F(CaptureSourceTest, RefusesChannelsThatItDoesNotHave) {
  settings.scale = {{"sync", 1.0}};
  CaptureSource source(settings, [this](const DeviceSettings& device, const StopSignal&) {
    return std::make_unique<ScriptedDevice>(script, device);
  });
  const auto described = source.describe();
  ASSERT_FALSE(described);
  EXPECT_EQ(described.error().code, ErrorCode::invalid_setting);
  EXPECT_THAT(described.error().message, HasSubstr("hw:7: no channel 'sync' among its 1"));
}

} // namespace
} // namespace dyncal::drivers::alsa
