#include "services/programs/command/required_check.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include <fmt/core.h>

#include "services/contract/run_identity.hpp"
#include "services/evaluation/result/members.hpp"
#include "services/records/store/control_chart.hpp"
#include "services/records/store/result_record.hpp"

namespace dyncal::inline programs {
namespace {

constexpr double ns_per_hour = 3.6e12;
constexpr double percent = 100.0;
constexpr double degrees = 180.0 / std::numbers::pi;

bool is_of_check_sensor(const RunOutcome& planned, const std::string& sensor) {
  const std::vector<ChannelName> dut =
      planned.recipe ? planned.recipe->dut() : std::vector<ChannelName>{};
  return std::ranges::any_of(planned.sources, [&](const RunSource& source) {
    const bool is_dut =
        dut.empty() || std::ranges::find(dut, source.source, &ChannelName::source) != dut.end();
    return is_dut && (source.description.serial == sensor || source.description.device == sensor ||
                      source.source == sensor);
  });
}

Expected<ControlChart> chart_of(const CheckDemand& demand, const std::string& bench) {
  std::error_code unknown;
  if (demand.store.empty() ||
      (!is_server(demand.store) && !std::filesystem::exists(demand.store, unknown))) {
    return ControlChart{};
  }
  DYNCAL_TRY(auto store, Store::open_existing(demand.store));
  DYNCAL_TRY(auto calibrations, store->calibrations(demand.settings.sensor));
  std::erase_if(calibrations, [](const Calibration& one) {
    return one.run.state != to_string(RunCompletion::complete);
  });
  ControlOptions options{.first = static_cast<std::size_t>(demand.settings.first), .bench = bench};
  if (demand.settings.limit_percent) {
    options.limit_magnitude_rel = *demand.settings.limit_percent / percent;
  }
  if (demand.settings.limit_deg) {
    options.limit_phase_rad = *demand.settings.limit_deg / degrees;
  }
  return control_chart_of(std::move(calibrations), options);
}

tl::unexpected<Error> refused(const CheckDemand& demand, const std::string& bench,
                              const std::string& why) {
  return fail(ErrorCode::no_result,
              fmt::format("bench '{}' demands a check with sensor '{}' that is at most {} h old: "
                          "{}. Mount the check sensor and run this bench file with it, then "
                          "again; or state --without-check REASON, which the result will say",
                          bench, demand.settings.sensor, demand.settings.max_age_h, why));
}

} // namespace

Expected<DailyCheck> require_check(const CheckDemand& demand, const RunOutcome& planned,
                                   std::int64_t now_utc_ns) {
  DailyCheck check;
  check.sensor = demand.settings.sensor;
  check.left_out = demand.left_out;
  if (is_of_check_sensor(planned, demand.settings.sensor)) {
    check.left_out.clear();
    return check;
  }
  if (!demand.left_out.empty()) {
    return check;
  }
  DYNCAL_TRY(const auto chart, chart_of(demand, planned.bench));
  if (chart.calibrations.empty()) {
    return refused(demand, planned.bench,
                   demand.store.empty() ? "without a store (--store) none is known"
                                        : "the store has no complete one of this bench");
  }
  const StoredRun& newest = chart.calibrations.back().run;
  check.run = RunIdentity::parse(newest.run).name;
  check.began_utc = newest.began_utc;
  check.state = to_string(chart.state);
  const std::int64_t began_utc_ns = parse_utc_text(newest.began_utc);
  const double age_h = static_cast<double>(now_utc_ns - began_utc_ns) / ns_per_hour;
  const bool is_known = began_utc_ns != 0;
  if (!is_known || !(std::abs(age_h) <= demand.settings.max_age_h)) {
    return refused(demand, planned.bench,
                   is_known ? fmt::format("the newest, run '{}', began {:.1f} h {} (in UTC: {})",
                                          check.run, std::abs(age_h),
                                          age_h < 0.0 ? "after now" : "ago", newest.began_utc)
                            : fmt::format("of the newest, run '{}', nobody knows when it was, for "
                                          "its stamps are not in UTC",
                                          check.run));
  }
  if (chart.state == CheckState::action) {
    return refused(demand, planned.bench,
                   fmt::format("the newest, run '{}', is beyond its action limits ('dyncal history "
                               "{} --check' shows where)",
                               check.run, demand.settings.sensor));
  }
  return check;
}

} // namespace dyncal::inline programs
