#include "drivers/can/sensor_stream.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/can/dbc/signal_decoder.hpp"
#include "drivers/can/stream_description.hpp"
#include "drivers/can/time/system_clock.hpp"

namespace dyncal::drivers::can {

namespace {

constexpr std::size_t max_waiting = 1U << 17U; // 16 s at 8000 samples/s
constexpr std::size_t max_causes = 32;
constexpr std::uint8_t trusted = 0;
constexpr std::uint8_t not_trusted = stamp_no_uncertainty;

// A sensor's own oscillator, against its nominal rate: a counter follows the sampling rate of the
// element, a time field a timer.
ClockLineOptions key_line_options(bool key_is_time) {
  ClockLineOptions options;
  options.max_rate = key_is_time ? 0.02 : 0.2;
  return options;
}

} // namespace

SensorStream::SensorStream(StreamSettings settings, DbcFile dbc)
    : settings_(std::move(settings)), dbc_(std::make_shared<const DbcFile>(std::move(dbc))) {}

Expected<std::unique_ptr<SensorStream>> SensorStream::create(StreamSettings settings, DbcFile dbc) {
  std::unique_ptr<SensorStream> stream(new SensorStream(std::move(settings), std::move(dbc)));
  DYNCAL_TRY(stream->layout_, lay_out(stream->settings_, *stream->dbc_));
  stream->index_.emplace(stream->layout_.messages);
  stream->joiner_ = SampleJoiner(stream->layout_.messages.size());
  if (!stream->layout_.keys.empty()) {
    stream->counter_.emplace(stream->layout_.keys.front()->length_bits,
                             stream->layout_.key_rate_hz);
  }
  stream->key_line_ = ClockLine(key_line_options(stream->layout_.key_is_time));
  return stream;
}

std::vector<FrameFilter> SensorStream::filters() const {
  std::vector<FrameFilter> filters = index_->filters();
  if (settings_.time_source == TimeSource::canopen_sync) {
    filters.push_back({settings_.sync_id, 0x7FF, false});
  }
  return filters;
}

Expected<void> SensorStream::begin(const LinkState& link, SampleSink& sink) {
  link_ = link;
  if (settings_.bit_rates.nominal_per_s <= 0.0) {
    settings_.bit_rates.nominal_per_s = link.bit_rate_per_s;
  }
  if (settings_.bit_rates.data_per_s <= 0.0) {
    settings_.bit_rates.data_per_s = link.data_bit_rate_per_s;
  }
  if (settings_.correct_frame_duration && settings_.bit_rates.nominal_per_s <= 0.0) {
    return fail(ErrorCode::invalid_setting, "interface '" + link.name +
                                                "' does not report its bit rate, which the "
                                                "duration of a frame follows from; give it with "
                                                "'bit_rate_per_s'");
  }
  timer_.emplace(
      FrameTimerSettings{.bit_rates = settings_.bit_rates,
                         .use_hardware_stamps = settings_.time_source != TimeSource::kernel_stamp,
                         .hardware_stamp_point = settings_.hardware_stamp_point,
                         .hardware_tick_s = settings_.hardware_tick_s,
                         .correct_frame_duration = settings_.correct_frame_duration,
                         .latency_s = settings_.latency_s,
                         .u_latency_s = settings_.u_latency_s},
      link);
  u_utc_s_ = settings_.time_base == TimeBase::local
                 ? 0.0
                 : settings_.u_utc_s.value_or(system_clock_quality().u_s);
  // Without a counter only the first frame tells whether the adapter stamps; until then the
  // kernel's stamps are what there is.
  if (settings_.time_source) {
    time_source_ = *settings_.time_source;
  } else if (!layout_.keys.empty() && layout_.key_tick_s > 0.0) {
    time_source_ = layout_.key_is_time ? TimeSource::payload_time : TimeSource::counter;
  }
  describe(sink);
  return {};
}

bool SensorStream::follows_sensor_clock() const {
  return time_source_ == TimeSource::payload_time || time_source_ == TimeSource::counter;
}

double SensorStream::u_stamp_s() const {
  const bool waits_count =
      time_source_ == TimeSource::kernel_stamp || time_source_ == TimeSource::hardware_stamp;
  const double u_wait_s =
      waits_count && settings_.bus_is_shared ? u_bus_wait_s(link_, settings_.bit_rates) : 0.0;
  const double u_common_s = timer_->u_common_s();
  return std::sqrt(u_common_s * u_common_s + u_utc_s_ * u_utc_s_ + u_wait_s * u_wait_s);
}

void SensorStream::describe(SampleSink& sink) {
  described_u_s_ = u_stamp_s();
  sink.describe(describe_stream(
      settings_, layout_, dbc_->path, link_.name,
      {.source = time_source_, .by_adapter = timer_->uses_hardware(), .u_s = described_u_s_}));
}

// A host that has just been started becomes synchronised while the service runs, and may lose it
// again: every sample carries what held for it, the description the best so far.
void SensorStream::refresh_utc(SampleSink& sink) {
  constexpr std::int64_t interval_ns = 1'000'000'000;
  if (settings_.time_base == TimeBase::local || settings_.u_utc_s ||
      std::abs(last_kernel_ns_ - utc_asked_ns_) < interval_ns) {
    return;
  }
  utc_asked_ns_ = last_kernel_ns_;
  u_utc_s_ = system_clock_quality().u_s;
  if (u_stamp_s() < described_u_s_ / 2.0) {
    describe(sink);
  }
}

void SensorStream::choose_time_source(const CanFrame& first, SampleSink& sink) {
  time_source_known_ = true;
  const bool by_stamp = time_source_ == TimeSource::kernel_stamp && !settings_.time_source;
  if (by_stamp && first.hardware_ns != 0) {
    time_source_ = TimeSource::hardware_stamp;
  }
  describe(sink);
}

Expected<void> SensorStream::take(const BusEvent& event, SampleSink& sink) {
  if (const auto* frame = std::get_if<CanFrame>(&event)) {
    return take_frame(*frame, sink);
  }
  if (const auto* lost = std::get_if<FramesLost>(&event)) {
    counts_.dropped_frames += lost->frames;
    numbers_.frames_were_dropped(lost->frames);
  } else if (const auto* change = std::get_if<LinkChange>(&event)) {
    take_change(*change, sink);
  } else if (const auto* fault = std::get_if<BusFault>(&event)) {
    take_fault(*fault);
  }
  return {};
}

void SensorStream::take_change(const LinkChange& change, SampleSink& sink) {
  link_ = change.link;
  if (!change.what.empty()) {
    sink.warn(change.what);
  }
  if (!change.interrupted) {
    return;
  }
  ++counts_.interruptions;
  numbers_.was_interrupted();
  joiner_.give_up_open();
  sync_.reset();
  give_up_bus_time(sink);
  timer_->restart(); // drivers seed the adapter's clock again when the link comes up
}

// The clock that the waiting samples would have been timed by is gone; the next one knows nothing
// of it.
void SensorStream::give_up_bus_time(SampleSink& sink) {
  if (!for_bus_time_.empty()) {
    resolve(sink, true);
  }
}

void SensorStream::take_fault(const BusFault& fault) {
  if (fault.state != BusState::unknown) {
    link_.bus = fault.state;
  }
  if (fault.transmit_errors) {
    link_.transmit_errors = fault.transmit_errors;
    link_.receive_errors = fault.receive_errors;
  }
  if (counts_.faults.size() < max_causes || counts_.faults.contains(fault.cause)) {
    ++counts_.faults[fault.cause];
  }
  if (fault.frames_lost || fault.state == BusState::bus_off) {
    numbers_.was_interrupted();
  }
}

Expected<void> SensorStream::take_frame(const CanFrame& frame, SampleSink& sink) {
  const bool is_sync =
      time_source_ == TimeSource::canopen_sync && !frame.extended && frame.id == settings_.sync_id;
  const DbcMessage* message = is_sync ? nullptr : index_->find(frame);
  if (!is_sync && message == nullptr) {
    return {};
  }
  if (settings_.correct_frame_duration && frame.bit_rate_switch &&
      settings_.bit_rates.data_per_s <= 0.0) {
    return fail(ErrorCode::invalid_setting,
                link_.name +
                    ": the sensor switches to a data bit rate, which the interface does not "
                    "report; give it with 'data_bit_rate_per_s'");
  }
  if (settings_.time_source == TimeSource::hardware_stamp && frame.hardware_ns == 0) {
    return fail(
        ErrorCode::invalid_setting,
        link_.name +
            ": time source 'hardware-stamp' is asked for, but the adapter stamps no frames; leave "
            "'time_source' out or name 'kernel-stamp'");
  }
  last_kernel_ns_ = frame.kernel_ns;
  if (!timer_->add(frame)) {
    ++counts_.clock_restarts;
    give_up_bus_time(sink);
  }
  if (!time_source_known_) {
    choose_time_source(frame, sink);
  }
  if (is_sync) {
    sync_ = frame;
    sync_used_ = false;
    return {};
  }
  ++counts_.frames;
  const auto at = static_cast<std::size_t>(
      std::find(layout_.messages.begin(), layout_.messages.end(), message) -
      layout_.messages.begin());
  std::uint64_t key = 0;
  if (!layout_.keys.empty()) {
    const auto bits = raw_bits(*layout_.keys[at], frame.payload());
    if (!bits) {
      ++counts_.rejected;
      return {};
    }
    key = *bits;
  }
  if (auto joined = joiner_.add(at, key, frame)) {
    complete(std::move(*joined), sink);
  }
  return {};
}

void SensorStream::complete(JoinedSample joined, SampleSink& sink) {
  Waiting sample;
  sample.timed = *joined.frames.front();
  if (time_source_ == TimeSource::canopen_sync) {
    if (!sync_ || sync_used_) {
      ++counts_.rejected;
      return;
    }
    sync_used_ = true;
  }
  const CanFrame head = sample.timed;
  if (time_source_ == TimeSource::canopen_sync) {
    sample.timed = *sync_;
  }
  if (!number(joined.key, head, sample, sink)) {
    return;
  }
  decode(joined, sample.values);
  for_bus_time_.push_back(std::move(sample));
  resolve(sink, false);
}

bool SensorStream::number(std::uint64_t key, const CanFrame& head, Waiting& sample,
                          SampleSink& sink) {
  if (!layout_.keys.empty()) {
    const auto reading = counter_->read(key, head.kernel_ns);
    if (reading.step == WrappingCounter::Step::repeated) {
      ++counts_.repeated;
      return false;
    }
    if (reading.step == WrappingCounter::Step::late) { // its number counts as lost already
      ++counts_.late;
      return false;
    }
    if (reading.step == WrappingCounter::Step::restarted) {
      ++counts_.restarts;
      finish(sink);
      sink.begin_session();
      key_line_.restart();
      numbers_.begin_session();
      block_.begin_session();
    }
    sample.key = reading.value;
  }
  sample.number = numbers_.next(layout_, sample.key, head.kernel_ns);
  counts_.lost += numbers_.lost_before();
  return true;
}

void SensorStream::decode(const JoinedSample& joined, std::vector<double>& values) {
  for (const ChannelLayout& channel : layout_.channels) {
    const DbcMessage& message = *layout_.messages[channel.message];
    const DecodedSignal decoded = decode_signal(message, message.signals[channel.signal],
                                                joined.frames[channel.message]->payload());
    if (decoded.state == SignalState::truncated) {
      ++counts_.short_frames;
    } else if (decoded.state == SignalState::not_available || decoded.state == SignalState::error) {
      ++counts_.no_value;
    }
    values.push_back(decoded.value * channel.unit_factor);
  }
}

std::int64_t SensorStream::sensor_clock_ns(std::int64_t key) const {
  return std::llround(static_cast<double>(key) * layout_.key_tick_s * 1e9);
}

void SensorStream::resolve(SampleSink& sink, bool give_up_waiting) {
  while (!for_bus_time_.empty()) {
    Waiting& sample = for_bus_time_.front();
    const bool at_sync = time_source_ == TimeSource::canopen_sync;
    auto base =
        at_sync ? timer_->end_of_frame_ns(sample.timed) : timer_->start_of_frame_ns(sample.timed);
    const bool hopeless = !base && (give_up_waiting || for_bus_time_.size() > max_waiting);
    if (!base && !hopeless) {
      break;
    }
    sample.base_ns = base.value_or(timer_->kernel_start_of_frame_ns(sample.timed));
    Waiting resolved = std::move(sample);
    for_bus_time_.pop_front();
    if (hopeless || !follows_sensor_clock()) {
      const std::int64_t stamp_ns = resolved.base_ns;
      emit(resolved, stamp_ns, hopeless ? not_trusted : trusted, sink);
      continue;
    }
    if (!key_line_.add(sensor_clock_ns(resolved.key), resolved.base_ns)) {
      ++counts_.clock_restarts;
      for (; !for_sensor_time_.empty(); for_sensor_time_.pop_front()) {
        const std::int64_t stamp_ns = for_sensor_time_.front().base_ns;
        emit(for_sensor_time_.front(), stamp_ns, not_trusted, sink);
      }
    }
    for_sensor_time_.push_back(std::move(resolved));
  }
  while (!for_sensor_time_.empty() &&
         (key_line_.ready() || give_up_waiting || for_sensor_time_.size() > max_waiting)) {
    Waiting sample = std::move(for_sensor_time_.front());
    for_sensor_time_.pop_front();
    const std::int64_t stamp_ns =
        key_line_.ready() ? key_line_.to_host(sensor_clock_ns(sample.key)) : sample.base_ns;
    emit(sample, stamp_ns, key_line_.ready() ? trusted : not_trusted, sink);
  }
}

void SensorStream::emit(const Waiting& sample, std::int64_t stamp_ns, std::uint8_t flags,
                        SampleSink& sink) {
  if (block_.must_go_before(sample.number, stamp_ns)) {
    flush(sink);
  }
  const double u_line_s =
      std::hypot(timer_->u_line_s(), follows_sensor_clock() ? key_line_.u_s() : 0.0);
  const bool is_trusted = block_.add({.number = sample.number,
                                      .stamp_ns = stamp_ns,
                                      .u_stamp_s = std::hypot(u_stamp_s(), u_line_s),
                                      .flags = flags,
                                      .received_utc_ns = sample.timed.kernel_ns},
                                     sample.values);
  counts_.not_trusted += is_trusted ? 0 : 1;
  ++counts_.samples;
}

void SensorStream::flush(SampleSink& sink) {
  if (block_.empty()) {
    return;
  }
  refresh_utc(sink);
  sink.take(block_.release());
}

void SensorStream::finish(SampleSink& sink) {
  resolve(sink, true);
  flush(sink);
}

void SensorStream::count(SampleSink& sink) const {
  sink.count(sample_counts(counts(), link_, u_stamp_s()));
}

StreamCounts SensorStream::counts() const {
  StreamCounts counts = counts_;
  counts.incomplete += joiner_.counts().incomplete;
  counts.repeated += joiner_.counts().repeated;
  return counts;
}

} // namespace dyncal::drivers::can
