#include "drivers/can/log_player.hpp"

#include <chrono>
#include <utility>

#include "drivers/can/bus/log_source.hpp"
#include "drivers/can/sensor_stream.hpp"

namespace dyncal::drivers::can {

namespace {

// Keeps what the stream gives.
class Keeper : public SampleSink {
public:
  void describe(const SourceDescription& description) override { last_description = description; }
  void begin_session() override { first_of_session_ = next_sample_ + 1; }
  void count(const SampleCounts& counts) override { last_counts = counts; }
  void warn(const std::string& sentence) override { warnings.push_back(sentence); }
  void take(SampleBlock block) override {
    block.first_sample += first_of_session_;
    next_sample_ = block.first_sample + block.samples;
    blocks.push_back(std::move(block));
  }

  SourceDescription last_description;
  SampleCounts last_counts;
  std::vector<std::string> warnings;
  std::vector<SampleBlock> blocks;

private:
  std::uint64_t first_of_session_ = 0;
  std::uint64_t next_sample_ = 0;
};

Expected<void> play(LogSource& log, SensorStream& stream, Keeper& keeper) {
  auto state = ReadState::more;
  while (state == ReadState::more) {
    std::vector<BusEvent> events;
    DYNCAL_TRY(state, log.read(events, std::chrono::milliseconds(0)));
    for (const BusEvent& event : events) {
      DYNCAL_TRY(stream.take(event, keeper));
    }
  }
  stream.finish(keeper);
  stream.count(keeper);
  return {};
}

} // namespace

Expected<SourceDescription> LogPlayer::describe() {
  DYNCAL_TRY(auto dbc, read_dbc_file(dbc_));
  Keeper keeper;
  keeper.warnings = dbc.warnings;
  DYNCAL_TRY(const auto stream, SensorStream::create(settings_, std::move(dbc)));
  LogSource log(log_, interface_name_, 0.0);
  DYNCAL_TRY(const auto link, log.open(stream->filters()));
  const auto played =
      stream->begin(link, keeper).and_then([&] { return play(log, *stream, keeper); });
  DYNCAL_TRY(played);
  description_ = std::move(keeper.last_description);
  blocks_ = std::move(keeper.blocks);
  warnings_ = std::move(keeper.warnings);
  counts_ = std::move(keeper.last_counts);
  return description_;
}

Expected<void> LogPlayer::run(SampleSink& sink) {
  sink.begin_session();
  sink.describe(description_);
  for (const std::string& warning : warnings_) {
    sink.warn(warning);
  }
  for (SampleBlock& block : std::exchange(blocks_, {})) {
    if (stop_.raised()) {
      break;
    }
    sink.take(std::move(block));
  }
  sink.count(counts_);
  return {};
}

} // namespace dyncal::drivers::can
