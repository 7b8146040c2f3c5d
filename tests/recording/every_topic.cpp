// Writes a recording with messages of every topic a recording can have, whose values are hard to
// carry: every_topic FILE. Demos have no CAN bus, no oscilloscope and no requests.
#include <cstdint>
#include <limits>
#include <string>

#include "services/records/capture/recorded_topics.hpp"
#include "services/records/mcap/recording_writer.hpp"

namespace {

using namespace dyncal;

constexpr double denormal = std::numeric_limits<double>::denorm_min();
constexpr std::uint64_t largest = std::numeric_limits<std::uint64_t>::max();

template <class T>
void fill(T& /*message*/, std::uint32_t /*number*/) {}

void fill(wire::SampleBlock& block, std::uint32_t number) {
  block.source("source " + std::string(number % 7, 'x'));
  block.session(largest - number);
  block.block(number);
  block.first_sample((std::uint64_t{1} << 53U) + number);
  block.sample_count(2);
  block.channel_count(2);
  block.acknowledged_run(number % 2 == 0 ? "" : "run 1");
  block.end_of_stream(number % 3 == 0);
  block.origin_ns(-1);
  block.interval_numerator_ns(1'000'000'007);
  block.interval_denominator(3);
  if (number % 2 == 0) {
    block.stamps_ns() = {std::numeric_limits<std::int64_t>::min(), 1'700'000'000'123'456'789};
    block.stamp_uncertainty_ns() = {1, 0xFFFFFFFFU};
    block.stamp_flags() = {0, 255};
  }
  block.values() = {-0.0, denormal, std::numeric_limits<double>::infinity(),
                    0.1 * static_cast<double>(number)};
  block.received_utc_ns(1'700'000'000'000'000'001);
}

void fill(wire::TriggeredRecord& record, std::uint32_t number) {
  record.source("dso" + std::string(number % 5, 'y'));
  record.session(largest);
  record.shot(number + 1);
  record.run("R1");
  record.step(number);
  record.sample_count(3);
  record.channel_count(1);
  record.end_of_stream(number % 2 == 0);
  record.trigger_utc_ns(-7);
  record.first_sample_s(-1e-6 / 3.0);
  record.interval_s(denormal);
  record.values() = {1.0 / 3.0, -0.0, 0.1 * static_cast<double>(number)};
  record.attempt(2);
}

void fill(wire::CatchUpRequest& request, std::uint32_t number) {
  request.source("dau");
  request.asker("recorder-" + std::to_string(number));
  request.request("r");
  request.session(largest);
  request.after(largest - number);
}

} // namespace

int main(int argc, char** argv) {
  constexpr std::uint32_t messages = 50; // of a topic
  if (argc != 2) {
    return 2;
  }
  auto writer = recording::RecordingWriter::create(
      argv[1], {"every_topic", recording::recorded_schemas(), recording::recorded_channels(),
                recording::Compression::none});
  bool written = writer.has_value();
  recording::for_each_recorded_topic([&]<class T>(const bus::Topic<T>& topic) {
    recording::Chunk chunk;
    for (std::uint32_t number = 0; number < messages; ++number) {
      T message;
      message.bench("bench");
      fill(message, number);
      const std::string bytes = recording::encode(message);
      recording::Message one;
      one.channel_id = recording::channel_of(topic.name).id;
      one.sequence = number;
      one.log_time = number;
      one.publish_time = number;
      one.data = bytes;
      chunk.add(recording::channel_of(topic.name), one);
    }
    written = written && writer->add_chunk(chunk);
  });
  return written && writer->close() ? 0 : 1;
}
