#include "services/bench/file/multisine_keys.hpp"

#include <string>

#include <fmt/core.h>

#include "analysis/sine/multisine_lines.hpp"

namespace dyncal::inline bench {
namespace {

constexpr double max_dropped_periods = 10.0;
constexpr double whole_period = 1.0 - 1e-9; // that duration_s must have at least

void refuse_of_single_frequencies(TomlTable& table) {
  for (const char* key : {"settling", "settling_s"}) {
    if (table.has(key)) {
      table.refuse(key, "is for one frequency after the other: a multi-sine has dropped_periods");
    }
  }
  for (const char* key : {"repeat_first", "window"}) {
    if (table.has(key)) {
      table.refuse(key, "is for one frequency after the other; leave it out for a multi-sine");
    }
  }
}

} // namespace

void read_multisine(TomlTable& table, ExcitationSettings& excitation) {
  MultisineSettings multisine;
  multisine.period_s = table.number("period_s", multisine.period_s, "seconds");
  multisine.dropped_periods = table.number("dropped_periods", multisine.dropped_periods, "periods");
  if (table.one_of("kind", {"sine", "multisine"}, "sine") == "sine") {
    for (const char* key : {"period_s", "dropped_periods"}) {
      if (table.has(key)) {
        table.refuse(key, "is for a multi-sine: excitation.kind = \"multisine\"");
      }
    }
    return;
  }
  if (!(multisine.dropped_periods >= 0.0 && multisine.dropped_periods <= max_dropped_periods)) {
    table.refuse("dropped_periods", fmt::format("must be between 0 and {}", max_dropped_periods));
  }
  refuse_of_single_frequencies(table);
  if (!table.has("duration_s")) {
    excitation.duration_s = multisine.period_s;
  } else if (excitation.duration_s < whole_period * multisine.period_s) {
    table.refuse("duration_s", "must be a period (period_s) at least, so that the lines can be "
                               "told apart");
  }
  excitation.settling_s = multisine.dropped_periods * multisine.period_s;
  excitation.multisine = multisine;
}

void check_multisine(TomlTable table, const BenchFile& file) {
  const ExcitationSettings& excitation = file.excitation;
  if (!excitation.multisine || excitation.frequencies_hz.empty()) {
    return;
  }
  if (file.method.kind != EvaluationMethod::sample_timestamping) {
    table.refuse("kind", fmt::format("can be \"multisine\" with method.kind = "
                                     "\"sample-timestamping\" only, not with \"{}\"",
                                     to_string(file.method.kind)));
    return;
  }
  const auto checked =
      file.method.mains_hz.empty()
          ? analysis::check_multisine_lines(excitation.frequencies_hz,
                                            excitation.multisine->period_s)
          : analysis::check_multisine_lines(excitation.frequencies_hz,
                                            excitation.multisine->period_s, file.method.mains_hz);
  if (!checked) {
    table.refuse("frequencies_hz",
                 fmt::format("cannot be excited together: {}; 'dyncal new-bench --multisine' "
                             "proposes lines",
                             checked.error().message));
  }
}

} // namespace dyncal::inline bench
