// What a recording holds for other programs: its sources with their samples in order, each with one
// set of channels, and what was lost on the way.
//
// A source whose channels changed is several of these, the later ones with a number behind their
// name. Messages of a source come in the order of sessions and numbers, each once, however often
// the file has them. A block or record whose sizes contradict each other or its description is left
// out and counted. Fails (bad_file) when nothing was sampled, or with what is damaged. One thread.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "drivers/sample_block.hpp"
#include "idl/dyncal.h"
#include "services/base/error.hpp"
#include "services/records/replay/recording_index.hpp"

namespace dyncal::inline records {

// What goes on meanwhile: a share of 0 to 1 is done; false: stop.
using ExportProgress = std::function<bool(double share)>;

struct ExportedSource {
  std::string name; // in what is exported
  std::string bench;
  std::string source;
  std::optional<wire::SourceDescription> description{}; // the newest with these channels
  std::vector<drivers::ChannelDescription> channels{};
  const RecordedSource* recorded = nullptr;
  std::set<std::size_t> sessions{}; // with these channels, of recorded->sessions
  // Of its messages:
  std::uint64_t samples = 0; // of each channel
  std::uint64_t lost = 0;
  std::uint64_t left_out = 0;      // blocks or records
  std::int64_t first_stamp_ns = 0; // of the first sample in order; records: as they were received
};

// A message in its place: its session from 0 on, and how many samples between the last one of the
// session and its first are missing.
template <class T>
struct InOrder {
  std::size_t session = 0;
  std::uint64_t lost_before = 0;
  const T& message;
  RecordedPlace place;
};

class ExportedRecording {
public:
  // `reader` outlives the object.
  [[nodiscard]] static Expected<ExportedRecording> open(recording::RecordingReader& reader,
                                                        const ExportProgress& progress,
                                                        const SharedWorkCount& count = nullptr,
                                                        const std::stop_token& stop = {});

  [[nodiscard]] const std::vector<ExportedSource>& sources() const { return sources_; }
  [[nodiscard]] const RecordingContents& contents() const { return contents_; }
  [[nodiscard]] recording::RecordingReader& reader() const { return *reader_; }
  [[nodiscard]] std::uint64_t samples() const; // of all sources

  // Those with samples that can be used. T is wire::SampleBlock or wire::TriggeredRecord, as the
  // source has them. Ends with the first failure of `visit`.
  template <class T>
  [[nodiscard]] Expected<void>
  for_each(const ExportedSource& source,
           const std::function<Expected<void>(const InOrder<T>&)>& visit) const;

private:
  explicit ExportedRecording(recording::RecordingReader& reader, RecordingContents contents)
      : reader_(&reader), contents_(std::move(contents)) {}
  [[nodiscard]] Expected<void> add_source(const std::pair<std::string, std::string>& key,
                                          const RecordedSource& recorded);
  template <class T>
  [[nodiscard]] Expected<void> add_parts(const std::string& bench, const std::string& name,
                                         const RecordedSource& recorded);
  template <class T>
  [[nodiscard]] Expected<void> survey(ExportedSource& source) const;
  [[nodiscard]] std::vector<drivers::ChannelDescription>
  channels_of(const std::string& source, const RecordedSource& recorded, std::uint64_t session,
              std::size_t count, const std::string& run) const;

  recording::RecordingReader* reader_;
  RecordingContents contents_;
  std::vector<ExportedSource> sources_;
};

[[nodiscard]] bool is_usable(const wire::SampleBlock& block, std::size_t channels);
[[nodiscard]] bool is_usable(const wire::TriggeredRecord& record, std::size_t channels);

} // namespace dyncal::inline records
