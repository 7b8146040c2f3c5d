#include "drivers/acs/socket_acs.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "drivers/utc_clock.hpp"

namespace dyncal::drivers::acs {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t max_description = 65536;
constexpr std::uint32_t frame_magic = 0x46534341; // "ACSF"
constexpr std::uint32_t max_samples = 65536;
constexpr milliseconds retry_interval{500};
constexpr std::chrono::hours silence_limit{24 * 365}; // between frames; the status tells of it
constexpr std::size_t chunk_bytes = 65536;
constexpr double min_block_s = 0.02;

static_assert(std::endian::native == std::endian::little,
              "frames are little-endian and read as they are");

template <class T>
T load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

} // namespace

Expected<void> SocketAcs::connect(milliseconds limit) {
  DYNCAL_TRY(const auto address, parse_address(settings_.address));
  DYNCAL_TRY(auto connection, TcpConnection::connect(address, limit, stop_));
  DYNCAL_TRY(const auto line, connection.read_line(max_description, limit));
  auto stream = parse_stream_description(line);
  if (!stream) {
    return fail(stream.error().code, settings_.address + ": " + stream.error().message);
  }
  stream_ = std::move(*stream);
  connection_.emplace(std::move(connection));
  return {};
}

Expected<SourceDescription> SocketAcs::describe() {
  const auto deadline = std::chrono::steady_clock::now() + settings_.connect_limit;
  for (;;) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - std::chrono::steady_clock::now());
    const auto connected = connect(left);
    if (connected) {
      return name_channels().map([&] { return stream_.source; });
    }
    // An instrument that is just being switched on refuses; everything else will not get better by
    // trying.
    const bool later = connected.error().code == ErrorCode::refused ||
                       connected.error().code == ErrorCode::disconnected;
    if (!later || left <= retry_interval || stop_.wait_for(retry_interval)) {
      return fail(connected.error());
    }
  }
}

// The names and units of the settings over those of the instrument.
Expected<void> SocketAcs::name_channels() {
  std::vector<ChannelDescription>& channels = stream_.source.channels;
  for (const auto& [device_name, name] : settings_.channels) {
    const auto found = std::ranges::find(channels, device_name, &ChannelDescription::name);
    if (found == channels.end()) {
      return fail(ErrorCode::invalid_setting, "the instrument at " + settings_.address +
                                                  " has no channel '" + device_name + "'");
    }
    found->name = name;
  }
  for (const auto& [name, unit] : settings_.units) {
    const auto found = std::ranges::find(channels, name, &ChannelDescription::name);
    if (found == channels.end()) {
      return fail(ErrorCode::invalid_setting,
                  "a unit is given for '" + name + "', which is not one of its channels");
    }
    found->unit = unit;
  }
  return {};
}

Expected<void> SocketAcs::connect_again(SampleSink& sink) {
  connection_.reset();
  while (!stop_.wait_for(retry_interval)) {
    auto connected = connect(settings_.connect_limit);
    if (connected) {
      // An instrument that came back with other channels: anyone who needs them will miss them.
      if (const auto named = name_channels(); !named) {
        ++channels_missing_;
        sink.warn(named.error().message);
      }
    }
    if (connected || connected.error().code == ErrorCode::malformed) {
      return connected;
    }
  }
  return {};
}

Expected<void> SocketAcs::run(SampleSink& sink) {
  for (;;) {
    const auto ended = read_session(sink);
    if (ended || stop_.raised()) {
      return {};
    }
    if (ended.error().code != ErrorCode::disconnected) {
      return fail(ended.error());
    }
    DYNCAL_TRY(connect_again(sink));
    if (stop_.raised()) {
      return {};
    }
  }
}

void SocketAcs::count(SampleSink& sink) const {
  SampleCounts counts = counts_;
  counts.add_cause("reconnections without a channel", channels_missing_);
  sink.count(counts);
}

// Returns at the end of the stream; fails with disconnected when the instrument is gone.
Expected<void> SocketAcs::read_session(SampleSink& sink) {
  sink.begin_session();
  sink.describe(stream_.source);
  SampleBlock pending;
  std::optional<std::uint64_t> next_of_block;
  const auto hand_over = [&] {
    if (pending.samples > 0) {
      pending.clock = stream_.clock;
      pending.received_utc_ns = utc_now_ns();
      counts_.add(pending, next_of_block);
      sink.take(std::exchange(pending, SampleBlock{}));
      count(sink);
    }
  };
  std::uint64_t next_sample = 0;
  for (;;) {
    auto frame = read_frame();
    if (!frame || frame->samples == 0) {
      hand_over();
      if (!frame && frame.error().code == ErrorCode::timeout) {
        sink.warn(frame.error().message);
        return fail(ErrorCode::disconnected, frame.error().message);
      }
      return frame ? Expected<void>{} : Expected<void>(fail(frame.error()));
    }
    if (frame->first_sample < next_sample) {
      hand_over();
      return fail(ErrorCode::malformed, settings_.address + ": sample numbers go back from " +
                                            std::to_string(next_sample) + " to " +
                                            std::to_string(frame->first_sample) +
                                            " within a connection");
    }
    if (frame->first_sample != next_sample) {
      hand_over();
    }
    next_sample = frame->first_sample + frame->samples;
    join(pending, std::move(*frame));
    if (static_cast<double>(pending.samples) >= min_block_s * stream_.source.nominal_rate_hz ||
        pending.samples >= max_samples) {
      hand_over();
    }
  }
}

// A long frame takes as long as it comes.
Expected<void> SocketAcs::read_rest_of_frame(std::span<char> bytes) {
  while (!bytes.empty()) {
    const std::span<char> next = bytes.first(std::min(bytes.size(), chunk_bytes));
    if (auto read = connection_->read_exactly(next, settings_.frame_limit); !read) {
      return read.error().code != ErrorCode::timeout
                 ? read
                 : fail(ErrorCode::timeout,
                        settings_.address +
                            ": the instrument has sent part of a frame and then "
                            "nothing for " +
                            std::to_string(settings_.frame_limit.count()) +
                            " ms; connecting to it again");
    }
    bytes = bytes.subspan(next.size());
  }
  return {};
}

Expected<SampleBlock> SocketAcs::read_frame() {
  std::array<char, 16> header{}; // magic, samples, first_sample
  const std::span<char> bytes(header);
  const auto first = connection_->read_exactly(bytes.first(1), silence_limit);
  DYNCAL_TRY(first.and_then([&] { return read_rest_of_frame(bytes.subspan(1)); }));
  SampleBlock frame;
  frame.samples = load<std::uint32_t>(header.data() + 4);
  frame.first_sample = load<std::uint64_t>(header.data() + 8);
  if (load<std::uint32_t>(header.data()) != frame_magic || frame.samples > max_samples) {
    return fail(ErrorCode::malformed,
                settings_.address + ": what was received is not a frame of the ACS stream");
  }
  const std::size_t channels = stream_.scale.size();
  const std::size_t width = stream_.float64 ? sizeof(double) : sizeof(std::int32_t);
  payload_.resize(frame.samples * channels * width);
  DYNCAL_TRY(read_rest_of_frame(payload_));
  frame.values.resize(frame.samples * channels);
  for (std::size_t i = 0; i < frame.samples; ++i) {
    for (std::size_t channel = 0; channel < channels; ++channel) {
      const char* raw = payload_.data() + (i * channels + channel) * width;
      frame.values[channel * frame.samples + i] =
          stream_.float64 ? load<double>(raw)
                          : static_cast<double>(load<std::int32_t>(raw)) * stream_.scale[channel];
    }
  }
  return frame;
}

// Appends `frame` to `pending`; both are column major.
void SocketAcs::join(SampleBlock& pending, SampleBlock frame) const {
  if (pending.samples == 0) {
    pending = std::move(frame);
    return;
  }
  const std::size_t channels = stream_.scale.size();
  std::vector<double> values;
  values.reserve(pending.values.size() + frame.values.size());
  for (std::size_t channel = 0; channel < channels; ++channel) {
    const auto append = [&](const SampleBlock& block) {
      const auto begin =
          block.values.begin() + static_cast<std::ptrdiff_t>(channel * block.samples);
      values.insert(values.end(), begin, begin + static_cast<std::ptrdiff_t>(block.samples));
    };
    append(pending);
    append(frame);
  }
  pending.values = std::move(values);
  pending.samples += frame.samples;
}

} // namespace dyncal::drivers::acs
