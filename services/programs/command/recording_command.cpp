// `dyncal recording check|repair|info FILE`: whether a recording is sound, a whole one of one that
// is not, and what is in it. Belongs to the thread that owns standard output.
#include <algorithm>
#include <filesystem>
#include <map>

#include <fmt/core.h>

#include "services/base/byte_count.hpp"
#include "services/base/printable_text.hpp"
#include "services/base/version.hpp"
#include "services/evaluation/result/members.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/mcap/recording_reader.hpp"
#include "services/records/mcap/repair.hpp"

namespace dyncal::inline programs {
namespace {

struct RecordingOptions {
  std::filesystem::path file;
  std::filesystem::path repaired; // of repair; empty: FILE with ".repaired.mcap"
};

void add_recording(CLI::App& command, RecordingOptions& recording) {
  command.add_option("FILE", recording.file, "recording")->required();
}

void add_repair(CLI::App& command, RecordingOptions& recording) {
  add_recording(command, recording);
  command.add_option("--output", recording.repaired, "the new file (default: FILE.repaired.mcap)");
}

void print_findings(const recording::ScanReport& report, const std::filesystem::path& path) {
  for (const recording::Damage& damage : report.damages) {
    fmt::print("{}\n", one_line(to_string(damage, path)));
  }
  fmt::print("{}: {} messages in {} chunks can be read; {} places are damaged, {} chunks lost\n",
             path.string(), report.messages,
             report.chunks - report.lost_chunks - report.unknown_chunks,
             report.damage_count - report.unknown_chunks, report.lost_chunks);
  if (report.unchecked_chunks > 0) {
    fmt::print("{} chunks have no CRC: nothing shows whether they are sound\n",
               report.unchecked_chunks);
  }
  if (report.loose_messages > 0) {
    fmt::print("{} messages stand outside chunks and have no CRC: nothing shows whether they are "
               "sound\n",
               report.loose_messages);
  }
  if (report.unknown_chunks > 0) {
    fmt::print("{} chunks have a compression that this build does not know: they may be sound\n",
               report.unknown_chunks);
  }
  if (!report.ended_in_order) {
    fmt::print("its recorder did not end it (was it killed?); 'dyncal recording repair' makes a "
               "file with an index\n");
  }
}

struct TopicCount {
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
};

struct Contents {
  std::map<std::string, TopicCount> topics;
  std::uint64_t first = 0;
  std::uint64_t last = 0;

  void add(const recording::MessageInFile& message) {
    TopicCount& topic = topics[message.channel.topic];
    ++topic.messages;
    topic.bytes += message.message.data.size();
    first = first == 0 ? message.message.log_time : std::min(first, message.message.log_time);
    last = std::max(last, message.message.log_time);
  }
};

// By the megabytes that are behind.
Expected<recording::ScanReport> read_all(const RecordingOptions& command,
                                         recording::ScanEvents events) {
  const WorkProgress progress("reading");
  DYNCAL_TRY(auto reader, recording::RecordingReader::open(command.file));
  ByteCount bytes(progress.count(), "reading", bytes_of_file(command.file));
  events.walked = [&](std::uint64_t walked) {
    bytes.set_done(walked);
    return true; // Ctrl-C ends the program
  };
  return reader.scan(events);
}

Expected<int> run_recording_check(const RecordingOptions& command) {
  DYNCAL_TRY(const auto report, read_all(command, {}));
  print_findings(report, command.file);
  if (report.damage_count == 0) {
    return 0;
  }
  static_cast<void>(report_error(
      {ErrorCode::bad_file, fmt::format("{}: is damaged in {} places, listed above; 'dyncal "
                                        "recording repair' saves what is sound",
                                        command.file.string(), report.damage_count)}));
  return problems_found;
}

Expected<void> run_recording_repair(RecordingOptions& command) {
  if (command.repaired.empty()) {
    command.repaired = command.file;
    command.repaired.replace_extension(".repaired.mcap");
  }
  DYNCAL_TRY(const auto report, with_progress("repairing", [&](const SharedWorkCount& count) {
               return recording::repair(command.file, command.repaired, software_version(), count);
             }));
  print_findings(report, command.file);
  fmt::print("wrote {}\n", command.repaired.string());
  return {};
}

Expected<void> run_recording_info(const RecordingOptions& command) {
  Contents contents;
  std::string beside; // attachments and metadata
  const auto add_attachment = [&](const recording::Attachment& attachment) {
    beside += fmt::format("attachment {} ({} bytes)\n", one_line(attachment.name),
                          attachment.data.size());
  };
  const auto add_metadata = [&](const recording::Metadata& metadata) {
    beside += one_line(metadata.name) + "\n";
    for (const auto& [key, value] : metadata.entries) {
      beside += fmt::format("  {}\n", one_line(key + " = " + value));
    }
  };
  const auto report = read_all(
      command, {.message = [&](const recording::MessageInFile& message) { contents.add(message); },
                .attachment = add_attachment,
                .metadata = add_metadata});
  DYNCAL_TRY(report);
  fmt::print("{}written by {}\n", beside, one_line(report->library));
  if (report->messages > 0) {
    fmt::print("from {} to {}, {:.1f} s\n", utc_text(static_cast<std::int64_t>(contents.first)),
               utc_text(static_cast<std::int64_t>(contents.last)),
               static_cast<double>(contents.last - contents.first) * 1e-9);
  }
  for (const auto& [topic, count] : contents.topics) {
    fmt::print("{:<20} {:>9} messages {:>12.3f} MB\n", one_line(topic), count.messages,
               static_cast<double>(count.bytes) * 1e-6);
  }
  print_findings(*report, command.file);
  return {};
}

const Command recording_command{120, "recording", "check, repair or describe a recording (.mcap)"};
const Command recording_check_command{121, "recording check",
                                      "read all of it, and name every place that is damaged",
                                      add_recording, run_recording_check};
const Command recording_repair_command{122, "recording repair",
                                       "write what is sound of it into a new file with an index",
                                       add_repair, run_recording_repair};
const Command recording_info_command{123, "recording info", "what is in it", add_recording,
                                     run_recording_info};

} // namespace
} // namespace dyncal::inline programs
