#include "drivers/text_stream/text_stream.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>

#include "drivers/utc_clock.hpp"

namespace dyncal::drivers::text_stream {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t max_line = 4096;
constexpr milliseconds connect_limit{5000};
constexpr milliseconds retry_interval{500};
constexpr std::chrono::hours silence_limit{24 * 365}; // the status tells of it
constexpr double block_s = 0.05;

// Numbers with blanks or commas between them; nothing where there is anything else.
std::optional<std::vector<double>> numbers_of(const std::string& line) {
  std::vector<double> values;
  const char* place = line.data();
  const char* const end = line.data() + line.size();
  for (;;) {
    place = std::find_if(place, end, [](char letter) {
      return letter != ' ' && letter != '\t' && letter != ',' && letter != ';';
    });
    if (place == end) {
      return values.empty() ? std::nullopt : std::optional(values);
    }
    place += *place == '+' ? 1 : 0;
    const auto [next, status] = std::from_chars(place, end, values.emplace_back());
    if (status != std::errc() || std::isinf(values.back())) {
      return std::nullopt;
    }
    place = next;
  }
}

Expected<std::unique_ptr<SampleSource>> make(const AcsKeys& keys) {
  const double rate_hz = keys.numbers.at("sample_rate_hz");
  const auto rate = sample_rate_from_hz(rate_hz);
  if (!rate) {
    return fail(ErrorCode::invalid_setting,
                "invalid sample_rate_hz: must be between 1e-6 and 1e9 Hz with at most nine "
                "decimals");
  }
  return std::make_unique<TextStream>(
      TextStreamSettings{keys.texts.at("address"), *rate, keys.channels, keys.units});
}

} // namespace

const AcsDriver& driver() {
  static const AcsDriver row{.name = "text-stream",
                             .texts = {{"address", "HOST:PORT of the instrument"}},
                             .numbers = {{"sample_rate_hz", "Hz"}},
                             .make = make};
  return row;
}

Expected<void> TextStream::connect() {
  DYNCAL_TRY(const auto address, parse_address(settings_.address));
  DYNCAL_TRY(auto connection, TcpConnection::connect(address, connect_limit, stop_));
  connection_.emplace(std::move(connection));
  return connection_->read_line(max_line, silence_limit).map([](const std::string&) {});
}

Expected<std::vector<double>> TextStream::read_sample() {
  DYNCAL_TRY(const auto line, connection_->read_line(max_line, silence_limit));
  auto values = numbers_of(line);
  if (!values || (!first_sample_.empty() && values->size() != first_sample_.size())) {
    return fail(ErrorCode::malformed,
                settings_.address + ": the line '" + line + "' is not one number a channel");
  }
  return *std::move(values);
}

Expected<SourceDescription> TextStream::describe() {
  const auto deadline = std::chrono::steady_clock::now() + connect_limit;
  auto connected = connect();
  // One that is just being switched on refuses.
  while (!connected && connected.error().code == ErrorCode::refused &&
         std::chrono::steady_clock::now() < deadline && !stop_.wait_for(retry_interval)) {
    connected = connect();
  }
  DYNCAL_TRY(connected);
  DYNCAL_TRY(first_sample_, read_sample());
  description_.driver = driver().name;
  description_.nominal_rate_hz = settings_.rate.hz();
  for (std::size_t i = 1; i <= first_sample_.size(); ++i) {
    description_.channels.push_back(
        {.name = "channel_" + std::to_string(i), .quantity = "", .unit = ""});
  }
  return name_channels().map([&] { return description_; });
}

// The names and units of the settings.
Expected<void> TextStream::name_channels() {
  const auto channel_named = [&](const std::string& name) {
    return std::ranges::find(description_.channels, name, &ChannelDescription::name);
  };
  for (const auto& [device_name, name] : settings_.channels) {
    const auto found = channel_named(device_name);
    if (found == description_.channels.end()) {
      return fail(ErrorCode::invalid_setting, "the instrument at " + settings_.address +
                                                  " has no channel '" + device_name + "'");
    }
    found->name = name;
  }
  for (const auto& [name, unit] : settings_.units) {
    const auto found = channel_named(name);
    if (found == description_.channels.end()) {
      return fail(ErrorCode::invalid_setting,
                  "a unit is given for '" + name + "', which is not one of its channels");
    }
    found->unit = unit;
  }
  return {};
}

Expected<void> TextStream::run(SampleSink& sink) {
  for (;;) {
    const auto ended = read_session(sink);
    if (stop_.raised()) {
      return {};
    }
    if (!ended && ended.error().code != ErrorCode::disconnected) {
      return ended;
    }
    while (!connect()) {
      if (stop_.wait_for(retry_interval)) {
        return {};
      }
    }
  }
}

Expected<void> TextStream::read_session(SampleSink& sink) {
  sink.begin_session();
  sink.describe(description_);
  const std::size_t channels = first_sample_.size();
  const auto room = static_cast<std::size_t>(std::max(1.0, block_s * settings_.rate.hz()));
  std::optional<std::uint64_t> next_sample;
  std::uint64_t first = 0;
  std::vector<std::vector<double>> samples;
  const auto hand_over = [&] {
    SampleBlock block;
    block.first_sample = first;
    block.samples = samples.size();
    block.clock = settings_.rate.clock(0);
    block.received_utc_ns = utc_now_ns();
    for (std::size_t channel = 0; channel < channels; ++channel) {
      for (const std::vector<double>& sample : samples) {
        block.values.push_back(sample[channel]);
      }
    }
    first += samples.size();
    samples.clear();
    counts_.add(block, next_sample);
    sink.take(std::move(block));
    sink.count(counts_);
  };
  for (;;) {
    auto sample = read_sample();
    const bool is_last = !sample;
    if (!is_last) {
      samples.push_back(*std::move(sample));
    }
    if (!samples.empty() && (is_last || samples.size() >= room)) {
      hand_over();
    }
    DYNCAL_TRY(sample);
  }
}

} // namespace dyncal::drivers::text_stream
