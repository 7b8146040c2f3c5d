#include "services/evaluation/method/selected_channels.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/core.h>

#include "services/contract/digest.hpp"
#include "services/contract/unit.hpp"
#include "services/evaluation/method/signal_check.hpp"

namespace dyncal::inline evaluation {

SelectedChannels::SelectedChannels(SourceInterval source, std::vector<ChannelName> names,
                                   std::span<const double> mains_hz)
    : source_(std::move(source)), names_(std::move(names)), mains_hz_(mains_hz) {
  for (const ChannelName& name : names_) {
    columns_.push_back(*record().channel(name.channel));
  }
  samples_ = select_samples(record(), interval(), columns_);
  rise_ = select_rise();
}

void SelectedChannels::narrow(const TimeInterval& interval) {
  source_.interval = interval;
  samples_ = select_samples(record(), interval, columns_);
  rise_ = select_rise();
}

// What an interval was narrowed by belongs to it.
StepSamples SelectedChannels::select_rise() const {
  if (!source_.rise_record) {
    return {};
  }
  StepSamples rise = select_samples(*source_.rise_record, source_.rise, columns_);
  if (interval().begin_ns <= source_.rise.end_ns + 1) {
    return rise;
  }
  const StepSamples more =
      select_samples(record(), {source_.rise.end_ns + 1, interval().begin_ns - 1}, columns_);
  const auto copies = std::make_shared<StepSamples::Copies>();
  copies->columns.resize(columns_.size());
  for (const StepSamples* part : {&std::as_const(rise), &more}) {
    copies->stamps_ns.insert(copies->stamps_ns.end(), part->stamps_ns.begin(),
                             part->stamps_ns.end());
    for (std::size_t k = 0; k < part->columns.size(); ++k) {
      copies->columns[k].insert(copies->columns[k].end(), part->columns[k].begin(),
                                part->columns[k].end());
    }
  }
  return {copies->stamps_ns, {copies->columns.begin(), copies->columns.end()}, 0, 0, 0, copies};
}

void SelectedChannels::leave_out(const TimeInterval& interval) {
  const auto copies = std::make_shared<StepSamples::Copies>();
  copies->columns.resize(samples_.columns.size());
  for (std::size_t i = 0; i < samples_.stamps_ns.size(); ++i) {
    const std::int64_t stamp_ns = samples_.stamps_ns[i];
    if (stamp_ns >= interval.begin_ns && stamp_ns < interval.end_ns) {
      ++samples_.cut_out;
      continue;
    }
    copies->stamps_ns.push_back(stamp_ns);
    for (std::size_t k = 0; k < copies->columns.size(); ++k) {
      copies->columns[k].push_back(samples_.columns[k][i]);
    }
  }
  samples_.stamps_ns = copies->stamps_ns;
  samples_.columns.assign(copies->columns.begin(), copies->columns.end());
  samples_.copies = copies;
}

bool SelectedChannels::has(const std::string& channel) const {
  return std::any_of(names_.begin(), names_.end(),
                     [&](const ChannelName& name) { return name.text() == channel; });
}

analysis::ChannelSamples SelectedChannels::channel(std::size_t i) const {
  return {names_[i].text(),
          samples_.columns[i],
          description(i).resolution,
          expectation_of(description(i)),
          mains_hz_,
          rise_.columns.empty() ? analysis::RisingSine{}
                                : analysis::RisingSine{rise_.stamps_ns, rise_.columns[i]}};
}

std::vector<analysis::ChannelSamples> SelectedChannels::channels_from(std::size_t first) const {
  std::vector<analysis::ChannelSamples> channels;
  for (std::size_t i = first; i < size(); ++i) {
    channels.push_back(channel(i));
  }
  return channels;
}

const std::string& SelectedChannels::unit(std::size_t i) const {
  return description(i).unit;
}

StepSamples SelectedChannels::quiet_samples() const {
  return source_.quiet_record ? select_samples(*source_.quiet_record, source_.quiet, columns_)
                              : StepSamples{};
}

SourceSamples SelectedChannels::summary() const {
  SourceSamples summary;
  summary.source = record().source();
  summary.used = samples_.stamps_ns.size();
  const SampleLoss lost = record().lost_in(interval());
  summary.lost = lost.missing;
  summary.unusable = lost.unusable;
  summary.overflowed = lost.overflowed;
  summary.not_trusted = samples_.not_trusted;
  summary.not_measured = samples_.not_measured;
  summary.cut_out = samples_.cut_out;
  if (!samples_.stamps_ns.empty()) {
    summary.first_stamp_ns = samples_.stamps_ns.front();
    summary.last_stamp_ns = samples_.stamps_ns.back();
  }
  return summary;
}

std::string digest_of(std::initializer_list<const SelectedChannels*> parts) {
  Digest digest;
  for (const SelectedChannels* part : parts) {
    const StepSamples& samples = part->samples();
    digest.add(samples.stamps_ns.data(), samples.stamps_ns.size() * sizeof(std::int64_t));
    for (const auto& column : samples.columns) {
      digest.add(column.data(), column.size() * sizeof(double));
    }
  }
  return digest.hex();
}

std::string ratio_unit(const std::string& input, const std::string& output) {
  if (input.empty() || output.empty()) {
    return "";
  }
  return input == output ? R"(\one)"
                         : fmt::format("({})/({})", short_form(output), short_form(input));
}

} // namespace dyncal::inline evaluation
