// `dyncal new-bench`: writes a bench file to start from (services/bench/draft), by options, or by
// questions on a terminal when no name is given. It never overwrites a file, and writes nothing
// that `dyncal check` would refuse. Belongs to one thread.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>

#include <fmt/core.h>

#include "analysis/base/preferred_frequencies.hpp"
#include "analysis/sine/multisine_lines.hpp"
#include "drivers/can/dbc/dbc.hpp"
#include "services/base/output_file.hpp"
#include "services/base/per_enumerator.hpp"
#include "services/bench/draft/bench_draft.hpp"
#include "services/bench/draft/bench_text.hpp"
#include "services/bench/draft/draft_questions.hpp"
#include "services/checks/bench_check/checks.hpp"
#include "services/checks/bench_check/report.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/draft_options.hpp"

namespace dyncal::inline programs {
namespace {

using bench_draft::BenchDraft;

struct NewBenchOptions {
  BenchDraft draft;             // without a name: it is asked for
  std::filesystem::path output; // empty: NAME.toml
};

// The first name is that of the default.
template <class Kind>
void add_kind(CLI::App& command, const char* name, const char* help, Kind& kind) {
  command
      .add_option_function<std::string>(
          name, [&kind](const std::string& typed) { kind = *parse_enumerator<Kind>(typed); }, help)
      ->check(CLI::IsMember(enumerator_texts<Kind>()))
      ->default_str(enumerator_texts<Kind>().front());
}

void add_kinds(CLI::App& command, BenchDraft& draft) {
  add_kind(command, "--sensor",
           "smartup (of a SmartUp Unit), file (a record of it), can, series (triggered by an "
           "oscilloscope) or analogue (a channel of the analogue system)",
           draft.sensor);
  add_kind(command, "--acs", "analogue system with the reference: its stream, or a file",
           draft.acs);
  add_kind(command, "--generator", "what excites the bench", draft.generator);
}

void add_places(CLI::App& command, BenchDraft& draft) {
  add_default(command, "--listen", draft.listen, "address and UDP port that the unit sends to");
  add_default(command, "--sensor-id", draft.sensor_id, "id of the sensor in the unit");
  command.add_option("--sensor-file", draft.sensor_file, "the sensor's record");
  add_default(command, "--sensor-address", draft.sensor_address, "of a time series sensor");
  add_default(command, "--dso-address", draft.dso_address, "of the oscilloscope that triggers it");
  add_default(command, "--interface", draft.interface, "of a sensor on CAN");
  command.add_option("--dbc", draft.dbc, "its DBC file (default: one to adapt is written)");
  command.add_option("--channel", draft.sensor_channel,
                     "of the sensor (default: acceleration_z; sensor of an analogue one)");
  add_default(command, "--sensor-sync", draft.sensor_sync,
              "channel of sync in the sensor's record");
  add_default(command, "--acs-address", draft.acs_address, "of the analogue system");
  command.add_option("--acs-file", draft.acs_file, "the reference's record");
  add_default(command, "--reference", draft.reference, "its channel in the analogue system");
  command.add_option("--reference-file", draft.reference_file,
                     "the reference by its certificate, TOML or CSV (default: not known yet)");
  add_default(command, "--sync", draft.sync, "channel of sync in the analogue system");
  add_default(command, "--generator-address", draft.generator_address, "of the generator");
}

void add_excitation(CLI::App& command, BenchDraft& draft) {
  command
      .add_option("--frequencies", draft.frequencies_hz,
                  "in Hz, decimal text, comma separated; or \"third-octave 10..200\"")
      ->delimiter(',')
      ->capture_default_str();
  add_default(command, "--level", draft.level_m_s2, "in m/s^2, amplitude", CLI::PositiveNumber);
  add_default(command, "--repetitions", draft.repetitions, "of the whole list",
              CLI::Range(1, 1000));
  add_default(command, "--duration", draft.duration_s, "evaluated seconds of every step",
              CLI::PositiveNumber);
  command
      .add_option("--multisine", draft.multisine_period_s,
                  "excite all at once, as lines of a waveform of so many seconds, near the "
                  "--frequencies but where none falls on what others make; --duration is this")
      ->check(CLI::PositiveNumber);
  add_default(command, "--level-per-volt", draft.level_per_volt, "m/s^2 at the exciter for 1 V",
              CLI::PositiveNumber);
  add_default(command, "--maximum-voltage", draft.maximum_voltage_v,
              "of the generator, amplitude in V", CLI::PositiveNumber);
}

void add_new_bench(CLI::App& command, NewBenchOptions& bench) {
  command.add_option("--name", bench.draft.name,
                     "name of the bench (default: all is asked for on the terminal)");
  command.add_option("--output", bench.output, "file to write (default: NAME.toml)");
  add_kinds(command, bench.draft);
  add_places(command, bench.draft);
  add_excitation(command, bench.draft);
}

std::filesystem::path path_of(const NewBenchOptions& command, const std::string& name) {
  return command.output.empty() ? std::filesystem::path(name + ".toml") : command.output;
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

// Lines in place of frequencies.
Expected<void> propose_lines(BenchDraft& draft) {
  if (!(draft.multisine_period_s > 0.0)) {
    return {};
  }
  using bench_draft::SensorKind;
  if (draft.sensor != SensorKind::file || draft.acs != bench_draft::AcsKind::file ||
      draft.generator != bench_draft::GeneratorKind::none) {
    return fail(ErrorCode::bad_argument,
                "--multisine is for records that 'dyncal analyse' evaluates: give --sensor file, "
                "--acs file and --generator none as well");
  }
  std::vector<std::string> wishes = draft.frequencies_hz;
  if (wishes.size() == 1) {
    wishes = analysis::preferred_frequencies(wishes.front()).value_or(wishes);
  }
  auto lines = analysis::propose_multisine_lines(wishes, draft.multisine_period_s);
  if (!lines) {
    return fail(ErrorCode::bad_argument, "--multisine: " + lines.error().message);
  }
  draft.frequencies_hz = std::move(*lines);
  return {};
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
  draft.reference_file = name_from(folder, draft.reference_file);
  const bool own_dbc = draft.sensor == bench_draft::SensorKind::can && draft.dbc.empty();
  const std::string dbc_name = path.stem().string() + "-sensor.dbc";
  const std::filesystem::path dbc_path = path.parent_path() / dbc_name;
  DYNCAL_TRY(check_new_file(path)); // before a DBC file is written for nothing
  if (own_dbc) {
    DYNCAL_TRY(write_new_file(dbc_path, bench_draft::dbc_text()));
  }
  const std::string text = bench_draft::bench_text(draft, dbc_name);
  const std::vector<bench_check::BenchView> views{bench_check::look_at_bench_text(text, path)};
  const Findings findings = bench_check::check_benches(views);
  const std::string errors = texts_of(findings, Severity::error, draft);
  auto written = errors.empty()
                     ? write_new_file(path, text)
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

void print_written(const std::string& warnings, const std::filesystem::path& path) {
  if (!warnings.empty()) {
    fmt::print(stderr, "warning: {}\n", warnings);
  }
  fmt::print("{} is written; adapt it, then: dyncal check {}\n", path.string(), path.string());
}

std::optional<std::string> name_problem(const NewBenchOptions& command, const std::string& name) {
  if (name.find('/') != std::string::npos) {
    return "a name has no '/'; --output says where the file is written";
  }
  const auto free = check_new_file(path_of(command, name));
  return free ? std::nullopt : std::optional(free.error().message);
}

// Answers that the check refuses are what is offered when all is asked for again.
Expected<void> ask_and_write(NewBenchOptions& command) {
  fmt::print("Enter takes what is in brackets; Ctrl-C ends without writing a file.\n");
  std::fflush(stdout);
  while (true) {
    DYNCAL_TRY(command.draft,
               bench_draft::ask_for_draft(
                   command.draft,
                   [&](const std::string& name) { return name_problem(command, name); }, std::cin,
                   std::cout));
    const auto path = path_of(command, command.draft.name);
    const auto warnings = write_draft(command.draft, path);
    if (warnings) {
      print_written(*warnings, path);
      return {};
    }
    fmt::print("{}\nOnce more; Enter keeps an answer.\n", warnings.error().message);
    std::fflush(stdout);
  }
}

Expected<void> run_new_bench(NewBenchOptions& command) {
  if (command.draft.name.empty()) {
    return isatty(STDIN_FILENO) != 0
               ? ask_and_write(command)
               : fail(ErrorCode::bad_argument, "--name is missing; without it there must be a "
                                               "terminal to ask on");
  }
  DYNCAL_TRY(check_options(command.draft));
  DYNCAL_TRY(propose_lines(command.draft));
  const auto path = path_of(command, command.draft.name);
  DYNCAL_TRY(const auto warnings, write_draft(command.draft, path));
  print_written(warnings, path);
  return {};
}

const Command new_bench_command{
    40, "new-bench", "write a bench file to start from, by these options or by questions",
    add_new_bench, run_new_bench};

} // namespace
} // namespace dyncal::inline programs
