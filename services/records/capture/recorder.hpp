// Records one bench: every message on its topics goes into one MCAP file (recording_writer.hpp).
//
// One thread takes messages from the bus and never waits for the disk; another one writes. Between
// them lies a queue: bound max_queue_bytes; policy when full: the newest is not stored; counted as
// not_stored. So a publisher never waits for the recorder. Where the numbers of a source jump, or a
// run began before the recorder, the source is asked for what it has sent (source_gaps.hpp).
//
// A message counts as stored when the file that holds it can be read whatever happens to this
// process; it survives a power cut once the file has been synchronised, at least every two seconds.
// When the disk is nearly full, or writing fails, the recording is ended in order, the status names
// the reason, and what comes after counts as not stored. Status goes to the bus every second, as
// RecorderStatus; what was lost stands in the file as metadata "dyncal.losses", the
// bench file of the run as attachment "recipe.toml".
//
// start() fails (bad_file) when the file exists or cannot be made, (network) as readers do.
// status() from any thread, everything else from the owner's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/records/capture/recording_thread.hpp"
#include "services/records/mcap/chunk_codec.hpp"

namespace dyncal::inline records::recording {

struct RecorderOptions {
  std::filesystem::path path; // of the file, which must not be there yet
  std::string bench;
  std::string run; // only what is about this run, and all samples; empty: everything
  std::string dds; // to_string(Vendor), for the file and the status
  int domain = 0;
  Compression compression = Compression::none;
  std::size_t max_queue_bytes = std::size_t{256} << 20U;
  std::uint64_t min_free_bytes = std::uint64_t{256} << 20U; // of the disk; below, it ends
};

// Messages that came and are not stored, and will not be, are `not_stored`.
struct RecorderStatus : RecordingFigures {
  std::uint64_t missing = 0;   // blocks and records that never came and could not be had again
  std::uint64_t recovered = 0; // that had to be asked for again
  std::uint64_t malformed = 0; // messages that do not match the contract, not stored
  bool catches_up = false;     // what it asked sources for again has yet to come
};

class Recorder {
public:
  // `participant` outlives the object.
  [[nodiscard]] static base::Expected<std::unique_ptr<Recorder>>
  start(bus::Participant& participant, RecorderOptions options);
  ~Recorder(); // stops
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  [[nodiscard]] RecorderStatus status() const;
  [[nodiscard]] const std::filesystem::path& path() const;
  // Stores what has come, and ends the file in order. Fails (bad_file) when that was not possible;
  // what counts as stored is stored all the same.
  base::Expected<RecorderStatus> stop();

private:
  class Work;

  explicit Recorder(std::unique_ptr<Work> work);

  std::unique_ptr<Work> work_;
};

} // namespace dyncal::inline records::recording
