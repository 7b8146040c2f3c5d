#include "services/programs/command/run_command.hpp"

#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "drivers/utc_clock.hpp"
#include "services/base/printable_text.hpp"
#include "services/bench/file/adc_file.hpp"
#include "services/bench/file/check_table.hpp"
#include "services/checks/bench_check/checks.hpp"
#include "services/checks/doctor/unheard_analysis.hpp"
#include "services/contract/run_identity.hpp"
#include "services/contract/topics.hpp"
#include "services/daemon/program/bench_program.hpp"
#include "services/daemon/program/watched_network.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/figure_options.hpp"
#include "services/programs/command/kept_run.hpp"
#include "services/programs/command/laboratory_look.hpp"
#include "services/programs/command/progress_line.hpp"
#include "services/programs/command/required_check.hpp"
#include "services/programs/command/run_again.hpp"
#include "services/programs/command/run_end_hook.hpp"
#include "services/programs/command/run_sensor.hpp"
#include "services/records/run_folder/folder_access.hpp"
#include "services/records/run_folder/run_folder.hpp"
#include "services/records/store/store.hpp"
#include "services/run/bench_queue.hpp"
#include "services/run/guard_watch.hpp"
#include "services/run/run_controller.hpp"
#include "services/run/run_plan.hpp"
#include "services/security/identity_check.hpp"
#include "services/views/report/show_outcome.hpp"

namespace dyncal::inline programs {

namespace {

void add_run(CLI::App& command, RunOptions& run) {
  command.add_option("BENCH.toml", run.bench_file, "bench file")->required();
  command.add_option("--run", run.run, "name of the run (default: the time)");
  auto* wait = command.add_flag("--wait", run.wait, "wait while another run has the bench");
  command.add_option("--resume", run.resume, "resume the named run after its conductor died")
      ->excludes("--run")
      ->excludes(wait);
  command.add_option("--without-check", run.without_check,
                     "begin without the check that the bench file demands; the reason is in the "
                     "result and in its documents");
  command.add_option("--sensor", run.sensor,
                     "serial number of the sensor in the library (default: the 'sensor' of the "
                     "bench file)");
  add_operator_option(command, run.conducted_by);
  command.add_option("--comment", run.comment, "a line about the run, for result and documents");
  command.add_option("--output", run.output, "write the result to this file as JSON");
  add_figure_options(command, run.figures);
  run.keep.folder = "runs";
  add_keep_options(command, run.keep);
  add_network_options(command, run.network);
}

Expected<void> run_run(RunOptions& run, const std::stop_token& stop) {
  DYNCAL_TRY(const auto outcome, conduct_run(run, stop));
  return check_complete(outcome);
}

const Command run_command{20, "run", "run the excitation list of a bench and print the result",
                          add_run, run_run};

// At a run.
struct Attempt {
  std::string name;
  bool misses_analysis = false; // none has been heard of it
};

// All that the attempts at a run have in common.
struct Conduct {
  const RunOptions& command;
  const BenchFile& bench;
  const std::vector<analysis::AdcCalibrationPoint>& adc;
  const NetworkOptions& network;
  bus::Participant& participant;
  const ShowProgress& show;
  const std::stop_token& stop;
  Attempt& newest;
};

void show_notice(const ShowProgress& show, const std::string& sentence) {
  RunProgress progress;
  progress.notice = sentence;
  show(progress);
}

struct ConductedRun {
  RunOutcome outcome;
  std::unique_ptr<KeptRun> kept;
};

// Nothing: the bench demands none.
std::optional<CheckDemand> check_demand(const Conduct& run) {
  auto settings = check_settings_of(run.bench.text);
  if (!settings) {
    return std::nullopt;
  }
  const KeepOptions& keep = run.command.keep;
  return CheckDemand{std::move(*settings), keep.folder ? store_place(keep.store, *keep.folder) : "",
                     run.command.without_check};
}

// Before anything else that is looked at when the sources are known.
RunKeeping keeping_with_check(const Conduct& run, KeptRun& kept) {
  RunKeeping keeping = kept.keeping();
  if (const auto demand = check_demand(run)) {
    keeping.check = [&kept, demand = *demand,
                     next = std::move(keeping.check)](const RunOutcome& planned) -> Expected<void> {
      DYNCAL_TRY(const auto check, require_check(demand, planned, utc_now_ns()));
      kept.set_check(check);
      return next ? next(planned) : Expected<void>{};
    };
  }
  return keeping;
}

// `text`: of its RunIdentity.
Expected<ConductedRun> conduct(const Conduct& run, const std::string& text) {
  const bool resumes = !run.command.resume.empty();
  run.newest.name = RunIdentity::parse(text).name;
  DYNCAL_TRY(auto kept, KeptRun::open(run.command.keep, run.bench,
                                      {.run = text,
                                       .is_resumed = resumes,
                                       .conducted_by = acting_person(run.command.conducted_by),
                                       .comment = one_line(run.command.comment),
                                       .sensor = run.command.sensor,
                                       .adc_file = adc_file_of(run.bench),
                                       .dds = run.network.dds,
                                       .domain = run.network.domain,
                                       .notice =
                                           [show = &run.show](const std::string& sentence) {
                                             show_notice(*show, sentence);
                                           }},
                                      run.participant));
  const ShowProgress show = [&](const RunProgress& progress) {
    kept->note(progress);
    run.show(progress);
  };
  RunController controller(run.participant, run.bench, text, show);
  controller.set_keeping(keeping_with_check(run, *kept));
  auto outcome =
      resumes ? controller.resume(run.adc, run.stop) : controller.conduct(run.adc, run.stop);
  if (!outcome) {
    run.newest.misses_analysis =
        outcome.error().code == ErrorCode::no_analysis && !controller.has_heard_analysis();
    kept->discard();
    return fail(outcome.error());
  }
  outcome->adc_file = adc_file_of(run.bench);
  return ConductedRun{std::move(*outcome), std::move(kept)};
}

// Every attempt is a run of its own.
Expected<ConductedRun> conduct_new(const Conduct& run) {
  const auto identity = RunIdentity::begin(run.command.run, utc_now_ns());
  return identity ? conduct(run, identity->text()) : fail(identity.error());
}

// Waits for the end of other runs; again when one of several that waited was quicker.
Expected<ConductedRun> conduct_in_turn(const Conduct& run) {
  DYNCAL_TRY(auto queue, BenchQueue::open(run.participant, bus::system_clock(), run.bench.bench));
  std::string shown;
  const auto show_phase = [&](const std::string& phase) {
    if (phase != std::exchange(shown, phase)) {
      show_notice(run.show, phase);
    }
  };
  while (true) {
    DYNCAL_TRY(queue.wait_until_free(show_phase, run.stop));
    auto conducted = conduct_new(run);
    const bool refused = !conducted && conducted.error().code == ErrorCode::no_source;
    if (!refused || run.stop.stop_requested() || !queue.taken_by()) {
      return conducted;
    }
  }
}

// The newest run of that name: by its folder, else by what analyses hold. As typed: there is none.
std::string newest_run_called(const Conduct& run, bus::Reader<wire::ServiceStatus>& statuses) {
  const std::string& typed = run.command.resume;
  if (run.command.keep.folder) {
    const auto folder = find_run_folder(*run.command.keep.folder, run.bench.bench, typed);
    const RunIdentity kept = RunIdentity::parse(folder.filename().string());
    if (!kept.conductor.empty()) {
      return kept.text();
    }
  }
  RunIdentity newest{typed, "", ""};
  statuses.take([&](const wire::ServiceStatus& status) {
    const RunIdentity held = RunIdentity::parse(status.run().to_string());
    if (held.is_called(typed) && held.start >= newest.start) {
      newest = held;
    }
  });
  return newest.text();
}

// Nobody else may conduct it: a run that lives is heard within a few seconds.
Expected<ConductedRun> resume_run(const Conduct& run) {
  DYNCAL_TRY(auto queue, BenchQueue::open(run.participant, bus::system_clock(), run.bench.bench));
  DYNCAL_TRY(auto statuses, run.participant.reader(bus::topics::service_status, run.bench.bench,
                                                   std::make_shared<bus::WakeUp>()));
  if (const auto other = queue.listen(run.stop)) {
    return fail(ErrorCode::no_source,
                fmt::format("bench '{}' is in use by {}; wait for its end, or end it there",
                            run.bench.bench, *other));
  }
  return conduct(run, newest_run_called(run, statuses));
}

Expected<ConductedRun> conduct_as_asked(const Conduct& run) {
  if (!run.command.resume.empty()) {
    return resume_run(run);
  }
  if (run.command.wait) {
    return conduct_in_turn(run);
  }
  return conduct_new(run);
}

// What guards say of the exciter after the run, of which they hear more than its generator says.
void take_words_of_guards(bus::Reader<wire::ServiceStatus>& statuses, const BenchFile& bench,
                          RunOutcome& outcome) {
  const auto now = bus::system_clock().now();
  GuardWatch guards(bench.bench, bench.generator.address, now);
  statuses.take([&](const wire::ServiceStatus& status) { guards.take(status, now); });
  const std::string failure = guards.failure(now);
  if (is_instrument(bench.generator.driver) && !failure.empty()) {
    outcome.output_may_be_on = true;
    outcome.problem += (outcome.problem.empty() ? "" : "; ") + one_line(failure);
  }
}

// What documents of the run will look for.
const std::string& sensor_of(const RunOptions& command, const BenchFile& bench) {
  return command.sensor.empty() ? bench.sensor : command.sensor;
}

// The folder first, which is what is left if the rest fails; then the database, which may let wait.
// What is kept is evaluated once more at the end.
Expected<void> show_and_keep(const Conduct& conduct, ConductedRun& run) {
  const RunOptions& command = conduct.command;
  auto statuses = conduct.participant.reader(bus::topics::service_status, conduct.bench.bench,
                                             std::make_shared<bus::WakeUp>());
  const auto kept = run.kept->finish(run.outcome);
  auto shown = show_outcome(run.outcome, command.output, command.figures, run.kept->statements());
  if (const auto folder = run.kept->folder(); folder && kept) {
    fmt::print("kept in {}\n", folder->string());
    std::fflush(stdout);
    run.kept->add_to_store(run.outcome);
    const auto judged = show_conformity(sensor_of(command, conduct.bench), command.keep, *folder);
    if (!judged) {
      fmt::print(stderr, "tolerances: {}\n", one_line(judged.error().message));
    }
  }
  Expected<void> done = kept ? std::move(shown) : fail(kept.error());
  if (!done && run.outcome.output_may_be_on) {
    done.error().message += "; " + output_warning(run.outcome);
  }
  done = done.and_then([&] { return run.kept->hold_against_recording(run.outcome, conduct.stop); });
  if (statuses) { // all this has taken a while
    take_words_of_guards(*statuses, conduct.bench, run.outcome);
  }
  return done;
}

// The last, and it changes nothing.
void tell_end(const BenchFile& bench, ConductedRun& run) {
  const auto told =
      run_end_hook(bench.text, run.outcome, run.kept->folder().value_or(std::filesystem::path()));
  if (!told) {
    const std::string sentence =
        "the command at the end of the run (on_end): " + told.error().message;
    run.kept->log(sentence);
    fmt::print(stderr, "dyncal: {}\n", one_line(sentence));
  }
}

// What this host hears instead of an analysis, in brackets. `links` as they were at the beginning.
std::string why_unheard(const NetworkOptions& network, const std::map<std::string, unsigned>& links,
                        const std::stop_token& stop) {
  constexpr double look_s = 3.0;
  std::string why;
  const auto looked = look_at_laboratory(network, look_s, stop, [&](const LaboratoryLook& look) {
    doctor::HostView host = look.host;
    host.link_changes_before = links;
    why = " (" + doctor::why_no_analysis_is_heard(look.view, host) + ")";
  });
  return looked ? why : " (" + looked.error().message + ")";
}

// Without what is measured again.
std::chrono::seconds planned_time(const ExcitationSettings& excitation) {
  const double steps = static_cast<double>(excitation.frequencies_hz.size()) *
                           static_cast<double>(excitation.repetitions) +
                       (excitation.repeat_first ? 1.0 : 0.0);
  return std::chrono::ceil<std::chrono::seconds>(
      std::chrono::duration<double>(steps * (excitation.settling_s + excitation.duration_s)));
}

// One DDS vendor falls silent where a certificate ends, the other goes on.
Expected<void> check_certificate_lasts(const NetworkOptions& network, const BenchFile& bench) {
  if (network.security.empty()) {
    return {};
  }
  DYNCAL_TRY(const auto vendor, bus::parse_vendor(network.dds));
  return require_validity(network.security, vendor, planned_time(bench.excitation),
                          std::time(nullptr));
}

// What would be excited for nothing.
Expected<void> check_bench(const BenchFile& bench) {
  const auto errors =
      bench_check::find_errors_before_run(bench_check::look_at_bench_text(bench.text, bench.path));
  if (errors.empty()) {
    return {};
  }
  const auto& first = errors.front();
  std::string sentence = BenchProblem{first.file, first.line, first.subject, first.sentence}.text();
  if (errors.size() > 1) {
    sentence += fmt::format(" (all {} errors: dyncal check {})", errors.size(), first.file);
  }
  return fail(ErrorCode::bad_file, std::move(sentence));
}

} // namespace

Expected<RunOutcome> conduct_run(const RunOptions& command, const std::stop_token& asked) {
  FolderAccess().set_umask();
  DYNCAL_TRY(RunIdentity::begin(command.run, utc_now_ns()));
  DYNCAL_TRY(const auto bench, read_bench_file(command.bench_file));
  DYNCAL_TRY(check_bench(bench));
  DYNCAL_TRY(require_sensor(sensor_of(command, bench), command.keep));
  DYNCAL_TRY(const auto adc, read_adc_calibration(bench));
  DYNCAL_TRY(check_outputs(command.output, command.figures));
  NetworkOptions network = command.network;
  add_network_settings(bench.network, network);
  DYNCAL_TRY(check_certificate_lasts(network, bench));
  const auto links = doctor::link_changes();
  Attempt newest{command.resume};
  std::atomic<bool> excited = !command.resume.empty(); // then the name does not change any more
  auto joined = WatchedNetwork::join(network, "dyncal-run", asked, [&](const std::string& why) {
    if (bench.generator.driver != GeneratorDriver::none) { // files are not resumed
      run_again(why, excited ? newest.name : "");
    }
  });
  DYNCAL_TRY(joined);
  const std::stop_token stop = (*joined)->stop();
  ProgressLine progress(stderr);
  const ShowProgress show = [&](const RunProgress& state) {
    excited = excited || state.step > 0;
    progress.show(state);
  };
  const Conduct conduct{command, bench, adc, network, (*joined)->participant, show, stop, newest};
  auto run = conduct_as_asked(conduct);
  progress.end();
  const auto shown = run ? show_and_keep(conduct, *run) : fail(run.error());
  if (run) {
    tell_end(bench, *run);
  }
  auto heard = (*joined)->outcome(shown);
  if (!heard && newest.misses_analysis) {
    joined->reset(); // what is looked for may be in its way
    heard.error().message += why_unheard(network, links, asked);
  }
  DYNCAL_TRY(heard);
  return std::move(run->outcome);
}

} // namespace dyncal::inline programs
