#include "drivers/alsa/capture_source.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/sample_rate.hpp"
#include "drivers/utc_clock.hpp"

namespace dyncal::drivers::alsa {
namespace {

constexpr unsigned blocks_per_s = 20;

} // namespace

Expected<SourceDescription> CaptureSource::describe() {
  DYNCAL_TRY(device_->open());
  const unsigned channels = settings_.device.channels;
  description_ = {.device = device_->name().empty() ? settings_.device.device : device_->name(),
                  .serial = {},
                  .driver = "alsa",
                  .channels = {},
                  .nominal_rate_hz = static_cast<double>(settings_.device.rate_hz)};
  for (unsigned i = 1; i <= channels; ++i) {
    description_.channels.emplace_back().name = "channel_" + std::to_string(i);
  }
  DYNCAL_TRY(name_channels());
  return description_;
}

// By the settings.
Expected<void> CaptureSource::name_channels() {
  std::vector<ChannelDescription>& channels = description_.channels;
  const auto named = [&](const std::string& name) -> Expected<ChannelDescription*> {
    const auto found = std::ranges::find(channels, name, &ChannelDescription::name);
    if (found == channels.end()) {
      return fail(ErrorCode::invalid_setting, settings_.device.device + ": no channel '" + name +
                                                  "' among its " + std::to_string(channels.size()));
    }
    return &*found;
  };
  for (const auto& [theirs, ours] : settings_.channels) {
    DYNCAL_TRY(auto* const channel, named(theirs));
    channel->name = ours;
  }
  for (const auto& [name, unit] : settings_.units) {
    DYNCAL_TRY(auto* const channel, named(name));
    channel->unit = unit;
  }
  for (const auto& [name, factor] : settings_.scale) {
    DYNCAL_TRY(named(name));
  }
  scale_.clear();
  for (ChannelDescription& channel : channels) {
    const auto stated = settings_.scale.find(channel.name);
    const double scale = stated == settings_.scale.end() ? 1.0 : stated->second;
    scale_.push_back(scale);
    channel.maximum = std::abs(scale);
    channel.minimum = -channel.maximum;
    channel.resolution = resolution_of(settings_.device.format) * channel.maximum;
  }
  return {};
}

void CaptureSource::count(SampleSink& sink) const {
  SampleCounts counts = counts_;
  counts.add_cause("overruns", overruns_);
  counts.add_cause("absences of the device", absences_);
  sink.count(counts);
}

void CaptureSource::take(SampleSink& sink, const Captured& captured,
                         std::span<const std::byte> frames) {
  SampleBlock block;
  block.first_sample = next_sample_;
  block.samples = captured.frames;
  block.clock = SampleRate{settings_.device.rate_hz, 1}.clock(0);
  block.values = values_of(frames, settings_.device.format, scale_);
  block.received_utc_ns = utc_now_ns();
  next_sample_ += captured.frames;
  taken_ = next_sample_ + captured.waiting;
  taken_at_ = captured.at;
  counts_.received += captured.frames;
  sink.take(std::move(block));
  count(sink);
}

// A session whose numbers go on behind what was lost.
void CaptureSource::begin_again(SampleSink& sink, Instant started) {
  if (next_sample_ > 0) { // else there is nothing that they go on from
    const std::chrono::duration<double> passed = started - taken_at_;
    const double missed = std::max(0.0, passed.count()) * settings_.device.rate_hz;
    const std::uint64_t next = taken_ + static_cast<std::uint64_t>(std::llround(missed));
    counts_.lost_in_device += next - next_sample_;
    sink.warn(settings_.device.device + ": about " + std::to_string(next - next_sample_) +
              " samples are lost; a new session begins");
    next_sample_ = next;
  }
  sink.begin_session();
  sink.describe(description_);
  count(sink);
}

std::optional<Instant> CaptureSource::open_again(SampleSink& sink, const std::string& problem) {
  ++absences_;
  sink.warn(problem + "; it is waited for");
  count(sink);
  std::string said;
  while (!stop_.wait_for(settings_.retry_interval)) {
    const auto opened = device_->open();
    if (opened) {
      return *opened;
    }
    if (opened.error().code == ErrorCode::invalid_setting && opened.error().message != said) {
      said = opened.error().message;
      sink.warn(said);
    }
  }
  return std::nullopt;
}

std::optional<Instant> CaptureSource::restart(SampleSink& sink, const Captured& captured) {
  if (captured.event != CaptureEvent::overrun) {
    return open_again(sink, captured.problem);
  }
  ++overruns_;
  const auto started = device_->restart();
  return started ? *started : open_again(sink, started.error().message);
}

Expected<void> CaptureSource::run(SampleSink& sink) {
  const std::size_t frame_bytes = bytes_of(settings_.device.format) * settings_.device.channels;
  std::vector<std::byte> room(frame_bytes *
                              std::max<std::size_t>(1, settings_.device.rate_hz / blocks_per_s));
  sink.begin_session();
  sink.describe(description_);
  for (;;) {
    const Captured captured = device_->read(room);
    if (captured.event == CaptureEvent::stopped) {
      return {};
    }
    if (captured.event == CaptureEvent::frames) {
      if (captured.frames > 0) {
        take(sink, captured, std::span(room).first(captured.frames * frame_bytes));
      }
      continue;
    }
    const auto started = restart(sink, captured);
    if (!started) {
      return {};
    }
    begin_again(sink, *started);
  }
}

} // namespace dyncal::drivers::alsa
