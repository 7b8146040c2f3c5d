#include "services/programs/command/recording_command.hpp"

#include <algorithm>
#include <map>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "services/base/byte_count.hpp"
#include "services/base/printable_text.hpp"
#include "services/base/version.hpp"
#include "services/daemon/program/program.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/mcap/recording_reader.hpp"
#include "services/records/mcap/repair.hpp"

namespace dyncal::inline programs {
namespace {

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

std::string time_text(std::uint64_t utc_ns) {
  const auto seconds = static_cast<std::time_t>(utc_ns / 1'000'000'000);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}Z", fmt::gmtime(seconds));
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
Expected<recording::ScanReport> read_all(const RecordingCommand& command,
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

} // namespace

int run_recording_check(const RecordingCommand& command) {
  const auto report = read_all(command, {});
  if (!report) {
    return report_error(report.error());
  }
  print_findings(*report, command.file);
  return report->damage_count == 0
             ? 0
             : report_error({ErrorCode::bad_file,
                             fmt::format("{}: is damaged in {} places, listed above; 'dyncal "
                                         "recording repair' saves what is sound",
                                         command.file.string(), report->damage_count)});
}

int run_recording_repair(const RecordingCommand& command) {
  std::filesystem::path repaired = command.repaired;
  if (repaired.empty()) {
    repaired = command.file;
    repaired.replace_extension(".repaired.mcap");
  }
  const auto report = [&] {
    const WorkProgress progress("repairing");
    return recording::repair(command.file, repaired, software_version(), progress.count());
  }();
  if (!report) {
    return report_error(report.error());
  }
  print_findings(*report, command.file);
  fmt::print("wrote {}\n", repaired.string());
  return 0;
}

int run_recording_info(const RecordingCommand& command) {
  Contents contents;
  std::string beside; // attachments and metadata
  const auto report = read_all(
      command, {.message = [&](const recording::MessageInFile& message) { contents.add(message); },
                .attachment =
                    [&](const recording::Attachment& attachment) {
                      beside += fmt::format("attachment {} ({} bytes)\n", one_line(attachment.name),
                                            attachment.data.size());
                    },
                .metadata =
                    [&](const recording::Metadata& metadata) {
                      beside += one_line(metadata.name) + "\n";
                      for (const auto& [key, value] : metadata.entries) {
                        beside += fmt::format("  {}\n", one_line(key + " = " + value));
                      }
                    }});
  if (!report) {
    return report_error(report.error());
  }
  fmt::print("{}written by {}\n", beside, one_line(report->library));
  if (report->messages > 0) {
    fmt::print("from {} to {}, {:.1f} s\n", time_text(contents.first), time_text(contents.last),
               static_cast<double>(contents.last - contents.first) * 1e-9);
  }
  for (const auto& [topic, count] : contents.topics) {
    fmt::print("{:<20} {:>9} messages {:>12.3f} MB\n", one_line(topic), count.messages,
               static_cast<double>(count.bytes) * 1e-6);
  }
  print_findings(*report, command.file);
  return 0;
}

} // namespace dyncal::inline programs
