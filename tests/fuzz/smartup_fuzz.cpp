// Any bytes at the receiver of SmartUp Units: they may be counted, they may not break anything. The
// input is a series of datagrams, parted by separator, from two senders in turn. After them the
// accounts must agree with what was handed on.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "drivers/smartup/reception.hpp"

namespace {

using namespace dyncal::drivers;
using namespace dyncal::drivers::smartup;

constexpr std::uint32_t wanted_id = 0xbccb0100;
constexpr std::uint32_t with_sync_id = 0xbccb0200;
constexpr std::uint32_t sync_id = 0xbccb0a00;
constexpr std::uint8_t separator[] = {0xf8, 0xf9, 0xfa, 0xfb};

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

class CheckingSink : public SampleSink {
public:
  void describe(const SourceDescription& description) override {
    for (const auto& channel : description.channels) {
      require(!channel.name.empty());
    }
  }
  void warn(const std::string& sentence) override { require(!sentence.empty()); }
  void begin_session() override { next_ = 0; }
  void count(const SampleCounts& counts) override { counts_ = counts; }
  void take(SampleBlock block) override {
    require(block.samples > 0 && block.samples <= 4096);
    require(block.stamps_ns.size() == block.samples &&
            block.stamp_uncertainty_ns.size() == block.samples);
    require(block.flags.empty() || block.flags.size() == block.samples);
    require(!block.values.empty() && block.values.size() % block.samples == 0);
    require(block.first_sample >= next_);
    next_ = block.first_sample + block.samples;
    samples_ += block.samples;
  }

  void check_accounts() const { require(samples_ == counts_.received); }

private:
  std::uint64_t next_ = 0;
  std::uint64_t samples_ = 0;
  SampleCounts counts_;
};

class IgnoringObserver : public ReceptionObserver {
public:
  void on_report(const SensorReport&) override {}
  void on_report(const ReceptionCounts&) override {}
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::array<CheckingSink, 2> sinks;
  IgnoringObserver observer;
  std::vector<WantedSensor> wanted(2);
  wanted[0].settings.sensor = wanted_id;
  wanted[0].settings.naming.names = {{"Data_11", "sync"}};
  wanted[0].sink = &sinks[0];
  wanted[1].settings.sensor = with_sync_id;
  wanted[1].settings.sync_sensor = sync_id;
  wanted[1].sink = &sinks[1];
  Reception reception(wanted, observer);

  std::span<const std::uint8_t> rest(data, size);
  HostTime now{1, 1};
  for (std::uint32_t turn = 0; !rest.empty(); ++turn) {
    const auto end =
        std::search(rest.begin(), rest.end(), std::begin(separator), std::end(separator));
    const auto length = static_cast<std::size_t>(end - rest.begin());
    reception.take(rest.first(length),
                   {0x7f000001, static_cast<std::uint16_t>(turn % 5 == 4 ? 2 : 1)}, now);
    rest = rest.subspan(std::min(rest.size(), length + sizeof separator));
    now.monotonic_ns += 40'000'000;
    now.utc_ns += 40'000'000;
    if (turn % 2 == 0) {
      reception.tick(now);
    }
  }
  reception.finish(now);
  for (const CheckingSink& sink : sinks) {
    sink.check_accounts();
  }
  return 0;
}
