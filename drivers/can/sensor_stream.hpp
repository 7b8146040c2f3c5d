// From the events of a bus to the time-stamped samples of one sensor: decoding, joining, numbering,
// timing, gaps.
//
// Stamps are those of the host's clock (settings: as UTC, or as a clock of its own) and mark the
// start of the sample's first frame, for canopen-sync the end of the SYNC frame. With a counter or
// a time field they are taken from the line between the sensor's clock and the frames' starts,
// which leaves out what a frame had to wait for the bus. Samples wait until that line has settled.
//
// Numbers: sample_numbers.hpp. Nothing is ever filled. A signal that a frame lacks gives NaN.
//
// The stream has no clock of its own: count() is to be called by its caller, about twice a
// second. Fails: invalid_setting. One thread; the DBC file is copied.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/bus/frame_source.hpp"
#include "drivers/can/dbc/dbc.hpp"
#include "drivers/can/growing_block.hpp"
#include "drivers/can/message_index.hpp"
#include "drivers/can/sample_joiner.hpp"
#include "drivers/can/sample_numbers.hpp"
#include "drivers/can/sensor_layout.hpp"
#include "drivers/can/stream_counts.hpp"
#include "drivers/can/stream_settings.hpp"
#include "drivers/can/time/frame_timer.hpp"
#include "drivers/can/time/wrapping_counter.hpp"
#include "drivers/error.hpp"
#include "drivers/sample_block.hpp"
#include "drivers/sample_sink.hpp"

namespace dyncal::drivers::can {

class SensorStream {
public:
  // Fails when the settings do not fit the DBC file or the link (no bit rate is known).
  [[nodiscard]] static Expected<std::unique_ptr<SensorStream>> create(StreamSettings settings,
                                                                      DbcFile dbc);

  [[nodiscard]] std::vector<FrameFilter> filters() const;
  // Once, before the first event.
  [[nodiscard]] Expected<void> begin(const LinkState& link, SampleSink& sink);
  // Fails when the sensor's frames lack what the settings demand (hardware stamps).
  [[nodiscard]] Expected<void> take(const BusEvent& event, SampleSink& sink);
  // Emits the block that is being filled: when nothing has come for a while.
  void flush(SampleSink& sink);
  // Also emits the samples that wait for their time, with the flag that their stamp is not trusted.
  // At the end.
  void finish(SampleSink& sink);
  // The account so far in the words that all drivers share.
  void count(SampleSink& sink) const;

  [[nodiscard]] StreamCounts counts() const;
  [[nodiscard]] const LinkState& link() const { return link_; }
  [[nodiscard]] TimeSource time_source() const { return time_source_; }
  [[nodiscard]] double u_stamp_s() const;

private:
  struct Waiting {
    std::uint64_t number = 0;
    std::int64_t key = 0; // unwrapped
    CanFrame timed;       // whose time counts: the first message's, or the SYNC
    std::int64_t base_ns = 0;
    std::vector<double> values;
  };

  SensorStream(StreamSettings settings, DbcFile dbc);

  Expected<void> take_frame(const CanFrame& frame, SampleSink& sink);
  void take_change(const LinkChange& change, SampleSink& sink);
  void take_fault(const BusFault& fault);
  void describe(SampleSink& sink);
  void refresh_utc(SampleSink& sink);
  void choose_time_source(const CanFrame& first, SampleSink& sink);
  void complete(JoinedSample joined, SampleSink& sink);
  // False: the sample is one that was there before, or late.
  [[nodiscard]] bool number(std::uint64_t key, const CanFrame& head, Waiting& sample,
                            SampleSink& sink);
  void decode(const JoinedSample& joined, std::vector<double>& values);
  void resolve(SampleSink& sink, bool give_up_waiting);
  void give_up_bus_time(SampleSink& sink);
  void emit(const Waiting& sample, std::int64_t stamp_ns, std::uint8_t flags, SampleSink& sink);
  [[nodiscard]] std::int64_t sensor_clock_ns(std::int64_t key) const;
  [[nodiscard]] bool follows_sensor_clock() const;

  StreamSettings settings_;
  std::shared_ptr<const DbcFile> dbc_;
  SensorLayout layout_;
  std::optional<MessageIndex> index_;
  LinkState link_;
  TimeSource time_source_ = TimeSource::kernel_stamp;
  bool time_source_known_ = false;
  double u_utc_s_ = 0.0;
  std::int64_t utc_asked_ns_ = 0;
  double described_u_s_ = 0.0;

  SampleJoiner joiner_{1};
  std::optional<WrappingCounter> counter_;
  std::optional<FrameTimer> timer_;
  ClockLine key_line_;
  std::optional<CanFrame> sync_;
  bool sync_used_ = false;

  std::deque<Waiting> for_bus_time_;    // until the adapter's clock is known
  std::deque<Waiting> for_sensor_time_; // until the sensor's clock is known
  SampleNumbers numbers_;
  GrowingBlock block_;
  std::int64_t last_kernel_ns_ = 0;
  StreamCounts counts_;
};

} // namespace dyncal::drivers::can
