#include "services/records/exchange/exported_recording.hpp"

#include <algorithm>
#include <map>

#include <fmt/core.h>

#include "services/contract/source_block.hpp"
#include "services/contract/source_description.hpp"
#include "services/records/capture/recorded_topics.hpp"
#include "services/records/replay/recorded_messages.hpp"

namespace dyncal::inline records {
namespace {

std::vector<std::string> names_of(const std::vector<drivers::ChannelDescription>& channels) {
  std::vector<std::string> names;
  names.reserve(channels.size());
  for (const auto& channel : channels) {
    names.push_back(channel.name);
  }
  return names;
}

// What the role `text` ("source/channel") names of this source; nothing of another one.
std::optional<std::string> channel_of_role(const std::string& text, const std::string& source) {
  return text.starts_with(source + "/") ? std::optional(text.substr(source.size() + 1))
                                        : std::nullopt;
}

// What a record of this source holds by the run it was taken for.
std::vector<std::string> channels_by_roles(const wire::Measurement& plan,
                                           const std::string& source) {
  std::vector<std::string> names;
  for (const std::string& role : plan.dut()) {
    if (auto name = channel_of_role(role, source)) {
      names.push_back(std::move(*name));
    }
  }
  if (auto name = channel_of_role(plan.sync_dso(), source)) {
    names.push_back(std::move(*name));
  }
  return names;
}

std::size_t channels_in(const wire::SampleBlock& block) {
  return is_usable(block, block.channel_count()) ? block.channel_count() : 0;
}
std::size_t channels_in(const wire::TriggeredRecord& record) {
  return is_usable(record, record.channel_count()) ? record.channel_count() : 0;
}

std::string run_of(const wire::SampleBlock& /*block*/) {
  return {};
}
std::string run_of(const wire::TriggeredRecord& record) {
  return record.run();
}

// The first sample's number in its session; records have none.
std::optional<std::uint64_t> first_sample_of(const wire::SampleBlock& block) {
  return block.first_sample();
}
std::optional<std::uint64_t> first_sample_of(const wire::TriggeredRecord& /*record*/) {
  return std::nullopt;
}

std::int64_t first_stamp_of(const wire::SampleBlock& block) {
  return view_block(block).first_stamp_ns();
}
std::int64_t first_stamp_of(const wire::TriggeredRecord& record) {
  return record.received_utc_ns();
}

// All usable messages of these sessions in order.
template <class T>
Expected<void> walk(const recording::RecordingReader& reader, const RecordedSource& recorded,
                    const std::function<Expected<void>(std::size_t session, const T&,
                                                       const RecordedPlace&)>& visit) {
  RecordedMessages messages(reader);
  for (const auto& [position, place] : recorded.messages) {
    const auto message = messages.at(place);
    if (!message) {
      return fail(ErrorCode::bad_file, fmt::format("{}: at byte {}: {}", reader.path().string(),
                                                   place.chunk, message.error().message));
    }
    const auto decoded = recording::decode<T>(message->data);
    if (!decoded) {
      continue; // the index has refused what is of another contract
    }
    DYNCAL_TRY(visit(position.session, *decoded, place));
  }
  return {};
}

} // namespace

bool is_usable(const wire::SampleBlock& block, std::size_t channels) {
  const SourceBlock view = view_block(block);
  return view.samples > 0 && view.channels == channels && view.is_consistent() &&
         (view.stamp_uncertainty_ns.empty() || view.stamp_uncertainty_ns.size() == view.samples);
}

bool is_usable(const wire::TriggeredRecord& record, std::size_t channels) {
  return record.sample_count() > 0 && channels > 0 && record.channel_count() == channels &&
         record.values().size() ==
             static_cast<std::size_t>(record.sample_count()) * record.channel_count();
}

std::vector<drivers::ChannelDescription>
ExportedRecording::channels_of(const std::string& source, const RecordedSource& recorded,
                               std::uint64_t session, std::size_t count,
                               const std::string& run) const {
  const auto found = recorded.descriptions.find(session);
  const wire::SourceDescription* description = found != recorded.descriptions.end() ? &found->second
                                               : recorded.newest ? &*recorded.newest
                                                                 : nullptr;
  std::vector<drivers::ChannelDescription> described;
  if (description != nullptr) {
    described = from_message(*description).channels;
  }
  if (described.size() == count) {
    return described;
  }
  std::vector<std::string> names;
  if (const auto planned = contents_.runs.find(run); planned != contents_.runs.end()) {
    names = channels_by_roles(planned->second.plan, source);
  }
  std::vector<drivers::ChannelDescription> channels;
  for (std::size_t i = 0; i < count; ++i) {
    drivers::ChannelDescription channel;
    channel.name = names.size() == count ? names[i] : fmt::format("channel_{}", i + 1);
    const auto same =
        std::ranges::find_if(described, [&](const auto& one) { return one.name == channel.name; });
    channels.push_back(same == described.end() ? channel : *same);
  }
  return channels;
}

template <class T>
Expected<void> ExportedRecording::add_parts(const std::string& bench, const std::string& name,
                                            const RecordedSource& recorded) {
  std::map<std::size_t, std::pair<std::size_t, std::string>> of_sessions; // channels, run
  auto walked = walk<T>(
      *reader_, recorded,
      [&](std::size_t session, const T& message, const RecordedPlace& /*place*/) -> Expected<void> {
        if (const std::size_t channels = channels_in(message); channels > 0) {
          of_sessions.try_emplace(session, channels, run_of(message));
        }
        return {};
      });
  if (!walked) {
    return walked;
  }
  const std::size_t first = sources_.size();
  for (const auto& [session, seen] : of_sessions) {
    auto channels =
        channels_of(name, recorded, recorded.sessions[session], seen.first, seen.second);
    auto part = std::find_if(
        sources_.begin() + static_cast<std::ptrdiff_t>(first), sources_.end(),
        [&](const ExportedSource& one) { return names_of(one.channels) == names_of(channels); });
    if (part == sources_.end()) {
      const std::size_t number = sources_.size() - first + 1;
      part = sources_.insert(
          part, ExportedSource{.name = number == 1 ? name : fmt::format("{}_{}", name, number),
                               .bench = bench,
                               .source = name,
                               .recorded = &recorded});
    }
    part->channels = std::move(channels);
    part->sessions.insert(session);
    const auto described = recorded.descriptions.find(recorded.sessions[session]);
    part->description =
        described == recorded.descriptions.end() ? recorded.newest : described->second;
  }
  for (std::size_t i = first; i < sources_.size(); ++i) {
    DYNCAL_TRY(survey<T>(sources_[i]));
  }
  return {};
}

template <class T>
Expected<void> ExportedRecording::survey(ExportedSource& source) const {
  bool first = true;
  source.left_out = 0;
  auto walked = walk<T>(
      *reader_, *source.recorded,
      [&](std::size_t session, const T& message, const RecordedPlace& /*place*/) -> Expected<void> {
        const bool belongs = source.sessions.contains(session) && message.sample_count() > 0;
        if (belongs && !is_usable(message, source.channels.size())) {
          ++source.left_out;
        }
        return {};
      });
  if (!walked) {
    return walked;
  }
  return for_each<T>(source, [&](const InOrder<T>& one) -> Expected<void> {
    source.samples += one.message.sample_count();
    source.lost += one.lost_before;
    if (std::exchange(first, false)) {
      source.first_stamp_ns = first_stamp_of(one.message);
    }
    return {};
  });
}

template <class T>
Expected<void>
ExportedRecording::for_each(const ExportedSource& source,
                            const std::function<Expected<void>(const InOrder<T>&)>& visit) const {
  std::optional<std::size_t> current;
  std::optional<std::uint64_t> next;
  return walk<T>(
      *reader_, *source.recorded,
      [&](std::size_t session, const T& message, const RecordedPlace& place) -> Expected<void> {
        if (!source.sessions.contains(session) || !is_usable(message, source.channels.size())) {
          return {};
        }
        const auto first = first_sample_of(message);
        if (std::exchange(current, session) != session) {
          next.reset();
        }
        InOrder<T> one{session, 0, message, place};
        if (first && next && *first > *next) {
          one.lost_before = *first - *next;
        }
        if (first) {
          next = *first + message.sample_count();
        }
        return visit(one);
      });
}

template Expected<void> ExportedRecording::for_each<wire::SampleBlock>(
    const ExportedSource&,
    const std::function<Expected<void>(const InOrder<wire::SampleBlock>&)>&) const;
template Expected<void> ExportedRecording::for_each<wire::TriggeredRecord>(
    const ExportedSource&,
    const std::function<Expected<void>(const InOrder<wire::TriggeredRecord>&)>&) const;

Expected<void> ExportedRecording::add_source(const std::pair<std::string, std::string>& key,
                                             const RecordedSource& recorded) {
  const bool several_benches = std::ranges::any_of(
      contents_.sources, [&](const auto& one) { return one.first.first != key.first; });
  const std::size_t first = sources_.size();
  auto added = recorded.triggered
                   ? add_parts<wire::TriggeredRecord>(key.first, key.second, recorded)
                   : add_parts<wire::SampleBlock>(key.first, key.second, recorded);
  for (std::size_t i = first; several_benches && i < sources_.size(); ++i) {
    sources_[i].name = key.first + "_" + sources_[i].name;
  }
  return added;
}

Expected<ExportedRecording> ExportedRecording::open(recording::RecordingReader& reader,
                                                    const ExportProgress& progress,
                                                    const SharedWorkCount& count,
                                                    const std::stop_token& stop) {
  DYNCAL_TRY(auto contents, index_contents(reader, count, stop));
  ExportedRecording recording(reader, std::move(contents));
  std::size_t done = 0;
  for (const auto& [key, source] : recording.contents_.sources) {
    if (!progress(0.2 * static_cast<double>(done++) /
                  static_cast<double>(recording.contents_.sources.size()))) {
      return fail(ErrorCode::interrupted, "stopped before anything was written");
    }
    DYNCAL_TRY(recording.add_source(key, source));
  }
  if (recording.samples() == 0) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: holds no samples of any source: there is nothing to export",
                            reader.path().string()));
  }
  return recording;
}

std::uint64_t ExportedRecording::samples() const {
  std::uint64_t samples = 0;
  for (const ExportedSource& source : sources_) {
    samples += source.samples;
  }
  return samples;
}

} // namespace dyncal::inline records
