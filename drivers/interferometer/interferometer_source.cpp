#include "drivers/interferometer/interferometer_source.hpp"

#include <algorithm>
#include <utility>

#include "analysis/interferometer/rounded_text.hpp"

namespace dyncal::drivers::interferometer {
namespace {

Expected<std::size_t> column_of(const SourceDescription& device, const std::string& name) {
  const auto found = std::ranges::find(device.channels, name, &ChannelDescription::name);
  if (found != device.channels.end()) {
    return static_cast<std::size_t>(found - device.channels.begin());
  }
  std::string there;
  for (const ChannelDescription& channel : device.channels) {
    there += (there.empty() ? "" : ", ") + channel.name;
  }
  return fail(ErrorCode::invalid_setting,
              "its interferometer has the signal '" + name +
                  "', but the device has no such channel; it has: " + there);
}

Expected<std::size_t> decimation_of(double rate_hz, const InterferometerSettings& settings) {
  if (!(rate_hz > 0.0)) {
    return fail(ErrorCode::invalid_setting,
                "its interferometer needs a constant sample rate, and the device states none");
  }
  const auto factor = factor_of(rate_hz, settings);
  return factor ? Expected<std::size_t>(*factor)
                : fail(ErrorCode::invalid_setting,
                       "its interferometer has output_rate_hz = " +
                           analysis::rounded_text(*settings.output_rate_hz, 9) +
                           ", but the device takes " + analysis::rounded_text(rate_hz, 9) +
                           " samples a second, which is not 1 to 512 times as many; choose "
                           "another, or leave it out");
}

std::optional<analysis::SignalRange> range_of(const ChannelDescription& channel,
                                              const std::optional<analysis::SignalRange>& stated) {
  const double half = 0.5 * channel.resolution;
  const auto range = stated.value_or(analysis::SignalRange{channel.minimum, channel.maximum});
  return range.high > range.low
             ? std::optional(analysis::SignalRange{range.low + half, range.high - half})
             : std::nullopt;
}

std::span<const double> column(const SampleBlock& block, std::size_t index) {
  return std::span(block.values).subspan(index * block.samples, block.samples);
}

} // namespace

Expected<StreamLayout> lay_out(const SourceDescription& device,
                               const InterferometerSettings& settings) {
  StreamLayout layout;
  DYNCAL_TRY(layout.u1, column_of(device, settings.u1));
  DYNCAL_TRY(layout.u2, column_of(device, settings.u2));
  DYNCAL_TRY(layout.factor, decimation_of(device.nominal_rate_hz, settings));
  const ChannelDescription& u1 = device.channels[layout.u1];
  const ChannelDescription& u2 = device.channels[layout.u2];
  if (u1.unit != u2.unit) {
    return fail(ErrorCode::invalid_setting, "its interferometer has signals in two units, " +
                                                u1.unit + " and " + u2.unit +
                                                "; state one for both with the key 'units'");
  }
  layout.ranges = {range_of(u1, settings.range_u1), range_of(u2, settings.range_u2)};
  layout.output = device;
  std::erase_if(layout.output.channels, [&](const ChannelDescription& channel) {
    return channel.name == settings.u1 || channel.name == settings.u2;
  });
  for (const ChannelDescription& channel : layout.output.channels) {
    if (channel.name == settings.channel) {
      return fail(ErrorCode::invalid_setting,
                  "its interferometer makes the channel '" + settings.channel +
                      "', and the device has one of that name; give it another name with the key "
                      "'channel'");
    }
  }
  layout.output.channels.push_back(
      {.name = settings.channel, .quantity = "Displacement", .unit = R"(\metre)"});
  layout.output.nominal_rate_hz = device.nominal_rate_hz / static_cast<double>(layout.factor);
  return layout;
}

Expected<SourceDescription> InterferometerSource::describe() {
  DYNCAL_TRY(of_device_, device_->describe());
  DYNCAL_TRY(auto layout, lay_out(of_device_, settings_));
  set_up(std::move(layout));
  return description();
}

void InterferometerSource::set_up(StreamLayout layout) {
  const double rate_hz = of_device_.nominal_rate_hz;
  demodulator_.emplace(settings_, layout.ranges, rate_hz);
  channels_.emplace(layout.factor, layout.output.channels.size());
  complaints_.emplace(settings_.u1 + " and " + settings_.u2, rate_hz);
  if (!settings_.record.empty()) {
    recording_.emplace(settings_.record, of_device_.channels[layout.u1],
                       of_device_.channels[layout.u2], rate_hz);
  }
  described_ = demodulator_->described();
  layout_ = std::move(layout);
}

SourceDescription InterferometerSource::description() const {
  SourceDescription description = layout_->output;
  description.quadrature_signals = {described_};
  return description;
}

Expected<void> InterferometerSource::run(SampleSink& sink) {
  sink_ = &sink;
  auto ended = device_->run(*this);
  if (recording_) {
    recording_->begin_session(); // which ends the last file
  }
  return ended;
}

void InterferometerSource::begin_session() {
  next_output_.reset();
  sink_->begin_session();
  if (recording_) {
    recording_->begin_session();
  }
  if (layout_) {
    demodulator_->begin_again();
    channels_->begin_again();
  }
}

// A device that came back as it was keeps its ellipse.
void InterferometerSource::describe(const SourceDescription& description) {
  if (!layout_ || description != of_device_) {
    of_device_ = description;
    layout_.reset();
    auto layout = lay_out(description, settings_);
    if (!layout) {
      sink_->warn(layout.error().message);
      return;
    }
    set_up(std::move(*layout));
  }
  sink_->describe(this->description());
}

void InterferometerSource::describe_if_changed() {
  if (!(demodulator_->described() == described_)) {
    described_ = demodulator_->described();
    sink_->describe(description());
  }
}

SampleBlock InterferometerSource::decimated(const SampleBlock& block) {
  turns_.clear();
  demodulator_->push(column(block, layout_->u1), column(block, layout_->u2), turns_);
  std::vector<std::span<const double>> columns;
  for (std::size_t i = 0; i < of_device_.channels.size(); ++i) {
    if (i != layout_->u1 && i != layout_->u2) {
      columns.push_back(column(block, i));
    }
  }
  columns.emplace_back(turns_);
  SampleBlock output = channels_->push(block, columns);
  const std::size_t others = (columns.size() - 1) * output.samples;
  for (double& value : std::span(output.values).subspan(others)) {
    value *= settings_.displacement_per_turn_m;
  }
  return output;
}

void InterferometerSource::take(SampleBlock block) {
  if (!layout_ || block.samples == 0) {
    return; // said when it was described
  }
  if (channels_->is_behind_gap(block)) {
    demodulator_->begin_again();
  }
  SampleBlock output = decimated(block);
  if (recording_) {
    const auto added =
        recording_->add(block, column(block, layout_->u1), column(block, layout_->u2));
    if (!added) {
      sink_->warn(added.error().message);
    }
  }
  complaints_->look(*demodulator_, block.samples, *sink_);
  describe_if_changed();
  if (output.samples > 0) {
    counts_.add(output, next_output_);
    sink_->take(std::move(output));
  }
}

// Samples are those that go out; causes of the device are of its own.
void InterferometerSource::count(const SampleCounts& counts) {
  SampleCounts all = counts_;
  all.stamps_not_trusted = counts.stamps_not_trusted;
  all.clock_uncertainty_s = counts.clock_uncertainty_s;
  all.causes = counts.causes;
  if (layout_) {
    const DemodulationCounts& of_phase = demodulator_->counts();
    all.add_cause("pairs of doubtful phase", of_phase.doubtful);
    all.add_cause("pairs without a beam", of_phase.without_beam);
    all.add_cause("pairs at an end of the range", of_phase.clipped);
    all.add_cause("pairs not measured", of_phase.not_measured);
  }
  sink_->count(all);
}

} // namespace dyncal::drivers::interferometer
