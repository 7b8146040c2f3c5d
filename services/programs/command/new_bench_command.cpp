#include "services/programs/command/new_bench_command.hpp"

#include <unistd.h>

#include <algorithm>
#include <iostream>

#include <fmt/core.h>

#include "drivers/can/dbc/dbc.hpp"
#include "services/bench/draft/bench_text.hpp"
#include "services/bench/draft/draft_questions.hpp"
#include "services/bench/draft/new_file.hpp"
#include "services/checks/bench_check/checks.hpp"
#include "services/checks/bench_check/report.hpp"
#include "services/daemon/program/program.hpp"
#include "services/programs/command/draft_options.hpp"

namespace dyncal::inline programs {
namespace {

using bench_draft::BenchDraft;

std::filesystem::path path_of(const NewBenchCommand& command, const std::string& name) {
  return command.output.empty() ? std::filesystem::path(name + ".toml") : command.output;
}

BenchDraft draft_of(const NewBenchCommand& command) {
  BenchDraft draft = command.draft;
  draft.sensor = *bench_draft::parse_sensor_kind(command.sensor); // the options allow no other
  draft.acs = *bench_draft::parse_acs_kind(command.acs);
  draft.generator = *bench_draft::parse_generator_kind(command.generator);
  return draft;
}

// Channels of one system that two options name; nothing where each has its own.
std::optional<Error> same_channel(const BenchDraft& draft) {
  using bench_draft::SensorKind;
  const auto same = [](const char* one, const char* other, const std::string& channel) {
    return Error{ErrorCode::bad_argument,
                 fmt::format("{} and {} name the same channel '{}': each needs one of its own", one,
                             other, channel)};
  };
  const std::string channel = channel_of(draft);
  if (draft.sensor == SensorKind::analogue && draft.reference == channel) {
    return same("--reference", "--channel", channel);
  }
  if (draft.sensor != SensorKind::analogue && draft.reference == draft.sync) {
    return same("--reference", "--sync", draft.sync);
  }
  if (draft.sensor == SensorKind::file && draft.sensor_sync == channel) {
    return same("--sensor-sync", "--channel", channel);
  }
  return std::nullopt;
}

// Of what a draft by options lacks, or has twice.
Expected<void> check_options(const BenchDraft& draft) {
  if (draft.name.find('/') != std::string::npos) {
    return fail(ErrorCode::bad_argument, "--name must not have a '/'");
  }
  if (draft.sensor == bench_draft::SensorKind::file && draft.sensor_file.empty()) {
    return fail(ErrorCode::bad_argument, "--sensor file needs --sensor-file, the sensor's record");
  }
  if (draft.acs == bench_draft::AcsKind::file && draft.acs_file.empty()) {
    return fail(ErrorCode::bad_argument, "--acs file needs --acs-file, the reference's record");
  }
  if (const auto twice = same_channel(draft)) {
    return fail(*twice);
  }
  return {};
}

// The signals of a DBC file that have a unit are what a sensor measures.
Expected<void> read_channels(BenchDraft& draft) {
  if (draft.sensor != bench_draft::SensorKind::can || draft.dbc.empty()) {
    return {};
  }
  const auto dbc = drivers::can::read_dbc_file(draft.dbc);
  if (!dbc) {
    return fail(ErrorCode::bad_file, "--dbc: " + dbc.error().message);
  }
  for (const auto& message : dbc->messages) {
    for (const auto& signal : message.signals) {
      if (!signal.unit.empty()) {
        draft.dbc_channels.push_back(signal.name);
      }
    }
  }
  return {};
}

// As a bench file in `folder` names it: what is below by a relative name, so that both can move.
std::string name_from(const std::filesystem::path& folder, const std::string& file) {
  if (file.empty()) {
    return file;
  }
  const auto absolute = std::filesystem::absolute(file).lexically_normal();
  const auto relative = absolute.lexically_relative(folder);
  return relative.empty() || *relative.begin() == ".." ? absolute.string() : relative.string();
}

std::string texts_of(const Findings& findings, Severity severity, const BenchDraft& draft) {
  std::string texts;
  for (const Finding& finding : findings) {
    if (finding.severity == severity) {
      texts += (texts.empty() ? "" : "; ") +
               sentence_with_options(draft, finding.subject, finding.sentence);
    }
  }
  return texts;
}

// Returns the warnings of the check.
Expected<std::string> write_files(BenchDraft draft, const std::filesystem::path& path) {
  const auto folder = std::filesystem::absolute(path).lexically_normal().parent_path();
  draft.sensor_file = name_from(folder, draft.sensor_file);
  draft.acs_file = name_from(folder, draft.acs_file);
  draft.dbc = name_from(folder, draft.dbc);
  const bool own_dbc = draft.sensor == bench_draft::SensorKind::can && draft.dbc.empty();
  const std::string dbc_name = path.stem().string() + "-sensor.dbc";
  const std::filesystem::path dbc_path = path.parent_path() / dbc_name;
  DYNCAL_TRY(bench_draft::check_new_file(path)); // before a DBC file is written for nothing
  if (own_dbc) {
    DYNCAL_TRY(bench_draft::write_new_file(dbc_path, bench_draft::dbc_text()));
  }
  const std::string text = bench_draft::bench_text(draft, dbc_name);
  const std::vector<bench_check::BenchView> views{bench_check::look_at_bench_text(text, path)};
  const Findings findings = bench_check::check_benches(views);
  const std::string errors = texts_of(findings, Severity::error, draft);
  auto written = errors.empty()
                     ? bench_draft::write_new_file(path, text)
                     : fail(ErrorCode::bad_argument,
                            "nothing was written, 'dyncal check' would refuse it: " + errors);
  if (!written && own_dbc) {
    std::error_code ignored;
    std::filesystem::remove(dbc_path, ignored);
  }
  return written.map([&] { return texts_of(findings, Severity::warning, draft); });
}

Expected<std::string> write_draft(BenchDraft draft, const std::filesystem::path& path) {
  return read_channels(draft).and_then([&] { return write_files(std::move(draft), path); });
}

int conclude(const Expected<std::string>& warnings, const std::filesystem::path& path) {
  if (!warnings) {
    return report_error(warnings.error());
  }
  if (!warnings->empty()) {
    fmt::print(stderr, "warning: {}\n", *warnings);
  }
  fmt::print("{} is written; adapt it, then: dyncal check {}\n", path.string(), path.string());
  return 0;
}

std::optional<std::string> name_problem(const NewBenchCommand& command, const std::string& name) {
  if (name.find('/') != std::string::npos) {
    return "a name has no '/'; --output says where the file is written";
  }
  const auto free = bench_draft::check_new_file(path_of(command, name));
  return free ? std::nullopt : std::optional(free.error().message);
}

// Answers that the check refuses are what is offered when all is asked for again.
int ask_and_write(const NewBenchCommand& command, BenchDraft draft) {
  fmt::print("Enter takes what is in brackets; Ctrl-C ends without writing a file.\n");
  std::fflush(stdout);
  while (true) {
    auto answered = bench_draft::ask_for_draft(
        draft, [&](const std::string& name) { return name_problem(command, name); }, std::cin,
        std::cout);
    if (!answered) {
      return report_error(answered.error());
    }
    const auto path = path_of(command, answered->name);
    const auto written = write_draft(*answered, path);
    if (written) {
      return conclude(written, path);
    }
    fmt::print("{}\nOnce more; Enter keeps an answer.\n", written.error().message);
    std::fflush(stdout);
    draft = std::move(*answered);
  }
}

} // namespace

int run_new_bench(const NewBenchCommand& command) {
  const BenchDraft draft = draft_of(command);
  if (draft.name.empty()) {
    return isatty(STDIN_FILENO) != 0
               ? ask_and_write(command, draft)
               : report_error({ErrorCode::bad_argument, "--name is missing; without it there must "
                                                        "be a terminal to ask on"});
  }
  if (const auto complete = check_options(draft); !complete) {
    return report_error(complete.error());
  }
  const auto path = path_of(command, draft.name);
  return conclude(write_draft(draft, path), path);
}

} // namespace dyncal::inline programs
