#include "services/command/watch_command.hpp"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <deque>
#include <map>
#include <set>

#include <fmt/core.h>

#include "idl/dyncal.h"
#include "services/contract/topics.hpp"
#include "services/evaluation/result/result_flag.hpp"
#include "services/host_clocks/clock_asker.hpp"
#include "services/report/rounding.hpp"
#include "services/version.hpp"

namespace dyncal::services {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t lines_kept = 12; // of the newest results on a terminal

std::string state_word(wire::SourceState state) {
  switch (state) {
  case wire::SOURCE_STARTING:
    return "starting";
  case wire::SOURCE_RUNNING:
    return "running";
  case wire::SOURCE_SILENT:
    return "SILENT";
  case wire::SOURCE_ENDED:
    return "ended";
  case wire::SOURCE_FAILED:
    break;
  }
  return "FAILED";
}

std::string arm_word(wire::ArmState arm) {
  switch (arm) {
  case wire::ARM_WAITING:
    return "waits for its sources";
  case wire::ARM_ARMED:
    return "armed";
  case wire::ARM_REFUSED:
    return "REFUSED";
  case wire::ARM_FINISHED:
    break;
  }
  return "finished";
}

std::string excitation_word(wire::ExcitationState state) {
  switch (state) {
  case wire::EXCITATION_SETTLING:
    return "settling";
  case wire::EXCITATION_STEADY:
    return "measuring";
  case wire::EXCITATION_DONE:
    return "done";
  case wire::EXCITATION_ABORTED:
    break;
  }
  return "aborted";
}

std::string source_line(const wire::SourceStatus& status) {
  std::string line = fmt::format(
      "{}/{}: {}, {:.1f} S/s, {} received, {} lost in the device, {} lost on the way, {} "
      "duplicate, {} rejected, "
      "{} stamps not trusted, {} dropped, buffer {:.0f} %, {} readers",
      status.bench().c_str(), status.source().c_str(), state_word(status.state()), status.rate_hz(),
      status.received(), status.lost_in_device(), status.lost_in_transit(), status.duplicates(),
      status.rejected(), status.stamps_not_trusted(), status.dropped_in_service(),
      status.buffer_fill() * 100.0, status.matched_readers());
  return status.message().empty() ? line : line + " | " + status.message();
}

// ", samples_lost (dau: samples lost)"; nothing without flags.
std::string flags_text(const std::vector<Flag>& flags) {
  std::string text;
  for (const Flag& flag : flags) {
    text += fmt::format(", {} ({})", name_of(flag.kind), flag.sentence);
  }
  return text;
}

std::string result_line(const wire::CalibrationResult& result, const std::vector<Flag>& flags) {
  const std::string head = fmt::format(
      "{} {}: step {}, {} Hz, #{}, {}", result.bench().c_str(), result.run().c_str(), result.step(),
      result.frequency_text_hz(), result.repetition(), result.channel().c_str());
  if (!result.valid()) {
    return fmt::format("{}: no result: {}{}", head, result.problem(), flags_text(flags));
  }
  const RoundedValue magnitude = round_by_uncertainty(result.magnitude(), result.u_magnitude());
  const RoundedValue phase = round_by_uncertainty(result.phase_rad(), result.u_phase_rad());
  return fmt::format("{}: |H| = {} (u {}), arg H = {} rad (u {}), {} lost{}", head, magnitude.value,
                     magnitude.u, phase.value, phase.u, result.lost(), flags_text(flags));
}

std::string function_line(const wire::TransferFunction& function, const std::vector<Flag>& flags) {
  const std::string head = fmt::format("{} {}: {}", function.bench().c_str(),
                                       function.run().c_str(), function.channel().c_str());
  if (!function.group_delay_valid()) {
    return fmt::format("{}: no group delay: {}{}", head, function.group_delay_problem(),
                       flags_text(flags));
  }
  const RoundedValue ms =
      round_by_uncertainty(function.group_delay_s() * 1e3, function.u_group_delay_s() * 1e3);
  return fmt::format("{}: group delay {} ms (u {}){}", head, ms.value, ms.u, flags_text(flags));
}

std::string clock_line(const wire::SampleClockReport& report, const std::vector<Flag>& flags) {
  const double u_hz = report.u_mean_interval_s() * report.mean_rate_hz() * report.mean_rate_hz();
  const RoundedValue hz = round_by_uncertainty(report.mean_rate_hz(), u_hz);
  return fmt::format("{} {}: sample clock of {}: {} Hz (u {}), {} lost{}", report.bench().c_str(),
                     report.run().c_str(), report.source().c_str(), hz.value,
                     std::isnan(u_hz) ? "not known" : hz.u, report.lost(), flags_text(flags));
}

std::string run_line(const wire::ServiceStatus& status) {
  if (!status.recording().empty()) {
    const std::string problem = status.message().empty() ? "" : ": " + status.message();
    return fmt::format("{}: recorded in {}, {} messages stored, {} not{}", status.bench().c_str(),
                       status.recording(), status.messages_stored(), status.messages_not_stored(),
                       problem);
  }
  const std::string line =
      fmt::format("{} {}: {} {}, {} results", status.bench().c_str(), status.run().c_str(),
                  status.service().c_str(), arm_word(status.arm()), status.results_published());
  return status.message().empty() ? line : line + " | " + status.message();
}

std::string step_line(const wire::Excitation& excitation) {
  const std::string attempt =
      excitation.attempt() > 1 ? fmt::format(", attempt {}", excitation.attempt()) : "";
  return fmt::format("{} {}: step {}, {} Hz, {} m/s^2, {}{}", excitation.bench().c_str(),
                     excitation.run().c_str(), excitation.step(), excitation.frequency_text_hz(),
                     excitation.level_m_s2(), excitation_word(excitation.state()), attempt);
}

std::string host_line(const HostClock& host) {
  const RoundedValue offset = round_by_uncertainty(host.clock.offset_s, host.clock.bound_s);
  return fmt::format("clock of {}: {} s from ours (within {} s)", host.host, offset.value,
                     offset.u);
}

// Lines that are replaced by newer ones of the same key, and lines that follow one another.
class Screen {
public:
  explicit Screen(bool terminal) : terminal_(terminal) {}

  void replace(const std::string& key, const std::string& line) {
    std::string& place = lines_[key];
    if (place != line && !terminal_) {
      fmt::print("{}\n", line);
    }
    place = line;
  }

  void append(const std::string& line) {
    if (!terminal_) {
      fmt::print("{}\n", line);
      return;
    }
    newest_.push_back(line);
    if (newest_.size() > lines_kept) {
      newest_.pop_front();
    }
  }

  // What the flags that have been seen mean, each once.
  void explain(const std::vector<Flag>& flags) {
    for (const Flag& flag : flags) {
      if (explained_.insert(flag.kind).second && !terminal_) {
        fmt::print("flag {}\n", explanation_line(flag.kind));
      }
    }
  }

  void draw() {
    if (terminal_) {
      fmt::print("\x1b[H\x1b[2J");
      for (const auto& [key, line] : lines_) {
        fmt::print("{}\n", line);
      }
      fmt::print("\n");
      for (const std::string& line : newest_) {
        fmt::print("{}\n", line);
      }
      if (!explained_.empty()) {
        fmt::print("\nFlags:\n");
      }
      for (const ResultFlag kind : explained_) {
        fmt::print("  {}\n", explanation_line(kind));
      }
      if (lines_.empty()) {
        fmt::print("nothing on this DDS domain yet\n");
      }
    }
    std::fflush(stdout);
  }

private:
  static std::string explanation_line(ResultFlag kind) {
    return fmt::format("{}: {}", name_of(kind), explanation_of(kind));
  }

  bool terminal_;
  std::map<std::string, std::string> lines_;
  std::deque<std::string> newest_;
  std::set<ResultFlag> explained_;
};

// The clocks of other hosts; one that has not moved beyond what is known of it keeps its line.
class ShownClocks {
public:
  void show(const std::vector<HostClock>& hosts, Screen& screen) {
    for (const HostClock& host : hosts) {
      const auto [shown, first] = shown_.try_emplace(host.host, host.clock);
      const double moved_s = std::abs(host.clock.offset_s - shown->second.offset_s);
      if (first || moved_s > host.clock.bound_s + shown->second.bound_s) {
        shown->second = host.clock;
        screen.replace("0 " + host.host, host_line(host));
      }
    }
  }

private:
  std::map<std::string, ClockOffset> shown_;
};

struct Readers {
  bus::Reader<wire::SourceStatus> sources;
  bus::Reader<wire::ServiceStatus> services;
  bus::Reader<wire::Excitation> excitation;
  bus::Reader<wire::CalibrationResult> results;
  bus::Reader<wire::TransferFunction> functions;
  bus::Reader<wire::SampleClockReport> clocks;
};

Expected<Readers> open_readers(bus::Participant& participant, const std::string& bench,
                               const std::shared_ptr<bus::WakeUp>& wake_up) {
  auto sources = participant.reader(bus::topics::source_status, bench, wake_up);
  auto services = participant.reader(bus::topics::service_status, bench, wake_up);
  auto excitation = participant.reader(bus::topics::excitation, bench, wake_up);
  auto results = participant.reader(bus::topics::calibration_result, bench, wake_up);
  auto functions = participant.reader(bus::topics::transfer_function, bench, wake_up);
  auto clocks = participant.reader(bus::topics::sample_clock_report, bench, wake_up);
  if (const auto error = first_error(sources, services, excitation, results, functions, clocks)) {
    return fail(*error);
  }
  return Readers{std::move(*sources), std::move(*services),  std::move(*excitation),
                 std::move(*results), std::move(*functions), std::move(*clocks)};
}

void take_all(Readers& readers, Screen& screen) {
  readers.sources.take([&](const wire::SourceStatus& status) {
    const std::string key = fmt::format("1 {}/{}", status.bench().c_str(), status.source().c_str());
    screen.replace(key, source_line(status));
  });
  readers.services.take([&](const wire::ServiceStatus& status) {
    screen.replace(fmt::format("2 {} {} {}", status.bench().c_str(), status.run().c_str(),
                               status.service().c_str()),
                   run_line(status));
  });
  readers.excitation.take([&](const wire::Excitation& excitation) {
    screen.replace(fmt::format("3 {} {}", excitation.bench().c_str(), excitation.run().c_str()),
                   step_line(excitation));
  });
  readers.results.take([&](const wire::CalibrationResult& result) {
    const auto flags = flags_from_message(result.flags(), result.flag_names());
    screen.append(result_line(result, flags));
    screen.explain(flags);
  });
  readers.functions.take([&](const wire::TransferFunction& function) {
    const auto flags = flags_from_message(function.flags(), function.flag_names());
    screen.append(function_line(function, flags));
    screen.explain(flags);
  });
  readers.clocks.take([&](const wire::SampleClockReport& report) {
    const auto flags = flags_from_message(report.flags(), report.flag_names());
    screen.append(clock_line(report, flags));
    screen.explain(flags);
  });
}

} // namespace

int run_watch(const WatchCommand& command, const std::stop_token& stop) {
  auto participant = join_network(command.network, "dyncal-watch");
  if (!participant) {
    return report_error(participant.error());
  }
  const auto wake_up = std::make_shared<bus::WakeUp>();
  auto readers = open_readers(*participant, command.bench, wake_up);
  if (!readers) {
    return report_error(readers.error());
  }
  auto asker = ClockAsker::open(
      *participant, this_program("dyncal-watch", software_version(), command.network.dds),
      bus::system_clock(), wake_up);
  if (!asker) {
    return report_error(asker.error());
  }
  ShownClocks clocks;
  Screen screen(isatty(STDOUT_FILENO) != 0);
  const auto began = std::chrono::steady_clock::now();
  auto next_draw = began;
  const auto over = [&] {
    return stop.stop_requested() ||
           (command.seconds &&
            std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() >
                *command.seconds);
  };
  while (!over()) {
    wake_up->wait_until(std::chrono::steady_clock::now() + 200ms);
    take_all(*readers, screen);
    asker->work();
    clocks.show(asker->other_hosts(), screen);
    if (std::chrono::steady_clock::now() >= next_draw) {
      screen.draw();
      next_draw = std::chrono::steady_clock::now() + 1s;
    }
  }
  return 0;
}

} // namespace dyncal::services
