#include "services/evaluation/method/series_shots.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <fmt/core.h>

#include "services/contract/digest.hpp"

namespace dyncal::inline evaluation {

std::vector<ShotRecord::Shot> shots_of_usual_length(const std::vector<ShotRecord::Shot>& shots,
                                                    std::size_t series_channels,
                                                    std::size_t trace_channels,
                                                    std::vector<Flag>& flags) {
  const auto form = [](const ShotRecord::Shot& shot) {
    return std::pair(shot.series->samples, shot.series->interval_s);
  };
  std::map<std::pair<std::size_t, double>, std::size_t> forms;
  for (const ShotRecord::Shot& shot : shots) {
    ++forms[form(shot)];
  }
  const auto usual = std::max_element(
      forms.begin(), forms.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<ShotRecord::Shot> chosen;
  for (const ShotRecord::Shot& shot : shots) {
    if (form(shot) == usual->first && shot.series->channels >= series_channels &&
        shot.trace->channels >= trace_channels) {
      chosen.push_back(shot);
    }
  }
  if (chosen.size() < shots.size()) {
    flags.push_back(
        {ResultFlag::shots_left_out, fmt::format("{} {}", shots.size() - chosen.size(),
                                                 to_string(ResultFlag::shots_left_out))});
  }
  return chosen;
}

std::string digest_of_shots(const StepSamples& acs, const std::vector<ShotRecord::Shot>& shots) {
  Digest digest;
  digest.add(acs.stamps_ns.data(), acs.stamps_ns.size() * sizeof(std::int64_t));
  for (const auto& column : acs.columns) {
    digest.add(column.data(), column.size() * sizeof(double));
  }
  for (const ShotRecord::Shot& shot : shots) {
    for (const TriggeredRecord* record : {shot.trace, shot.series}) {
      const std::array axis{record->first_sample_s, record->interval_s};
      digest.add(axis.data(), sizeof(axis));
      digest.add(record->values.data(), record->values.size() * sizeof(double));
    }
  }
  return digest.hex();
}

SourceSamples summary_of_shots(const SourceRecord& source,
                               const std::vector<ShotRecord::Shot>& shots,
                               const TriggeredRecord* ShotRecord::Shot::*record,
                               const ShotRecord::Loss& loss) {
  SourceSamples summary;
  summary.source = source.source();
  for (const ShotRecord::Shot& shot : shots) {
    summary.used += (shot.*record)->samples;
  }
  summary.unusable = loss.unusable_samples;
  summary.overflowed = loss.overflowed_samples;
  summary.first_stamp_ns = shots.front().trace->trigger_utc_ns;
  summary.last_stamp_ns = shots.back().trace->trigger_utc_ns;
  return summary;
}

} // namespace dyncal::inline evaluation
