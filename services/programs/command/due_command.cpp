// `dyncal due`: which sensors, references and equipment are to be calibrated
// (services/records/store/due_calibrations.hpp). Exit status 0: none until then; 3: some; 1 and one
// line when something is wrong. Belongs to one thread.
#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/calendar_day.hpp"
#include "services/base/json_text.hpp"
#include "services/base/printable_text.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/records/store/due_calibrations.hpp"
#include "services/views/lab_file/laboratory_file.hpp"

namespace dyncal::inline programs {
namespace {

struct DueOptions {
  StorePlace store;
  std::vector<std::filesystem::path> benches;
  std::filesystem::path laboratory;
  int within_days = 30;
  bool all = false;
  bool json = false;
};

void add_due(CLI::App& command, DueOptions& options) {
  command.add_option("BENCH.toml", options.benches,
                     "bench files whose references are looked at, too");
  command.add_option("--lab", options.laboratory, "laboratory file: its reference and equipment");
  add_checked(command, "--within", options.within_days, "days from today", CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_flag("--all", options.all, "list also what is not due");
  command.add_flag("--json", options.json, "print JSON");
  add_store_place(command, options.store);
  command.footer("Exit status: 0 nothing is due, 1 failure, 2 wrong command line, 3 something is.");
}

Expected<std::vector<CalibrationDate>> gather_dates(const DueOptions& options) {
  DYNCAL_TRY(auto dates, calibration_dates(options.store.text()));
  const auto add = [&](const std::vector<CalibratedDevice>& devices, const char* what) {
    for (CalibrationDate& date : dates_of_devices(devices, what)) {
      dates.push_back(std::move(date));
    }
  };
  for (const std::filesystem::path& path : options.benches) {
    DYNCAL_TRY(const auto bench, read_bench_file(path));
    add(bench.corrections.reference_standard.devices, "reference");
  }
  if (!options.laboratory.empty()) {
    DYNCAL_TRY(const auto laboratory, read_laboratory_file(options.laboratory));
    if (laboratory.reference) {
      add(laboratory.reference->devices, "reference");
    }
    add(laboratory.equipment, "equipment");
  }
  return newest_of_each(std::move(dates));
}

void print_table(const std::vector<CalibrationDate>& dates, const std::string& today) {
  fmt::print("{:<18} {:<11} {:<10} {:<20} {:<32} {:<16} {}\n", "due", "last", "what", "serial",
             "name", "certificate", "owner");
  for (const CalibrationDate& date : dates) {
    const std::string due = date.due.empty() ? "never done" : date.due;
    const std::string overdue = date.is_due_by(today) && !date.due.empty() ? " overdue" : "";
    fmt::print("{:<10}{:<8} {:<11} {:<10} {:<20} {:<32} {:<16} {}\n", due, overdue, date.last,
               date.what, one_line(date.serial), one_line(date.name), one_line(date.certificate),
               one_line(date.owner));
  }
}

Expected<int> run_due(const DueOptions& options) {
  DYNCAL_TRY(auto dates, gather_dates(options));
  const std::string today = today_utc();
  const std::string until = days_after(today, options.within_days);
  const auto due =
      std::ranges::count_if(dates, [&](const auto& date) { return date.is_due_by(until); });
  if (!options.all) {
    std::erase_if(dates, [&](const CalibrationDate& date) { return !date.is_due_by(until); });
  }
  if (options.json) {
    fmt::print("{}\n", json_text(calibration_dates_json(dates, today), 2));
  } else {
    if (!dates.empty()) {
      print_table(dates, today);
    }
    fmt::print("{} due within {} days\n", due, options.within_days);
  }
  return due == 0 ? 0 : problems_found;
}

const Command due_command{95, "due", "which sensors and references are to be calibrated", add_due,
                          run_due};

} // namespace
} // namespace dyncal::inline programs
