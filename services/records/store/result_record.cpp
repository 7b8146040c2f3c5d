#include "services/records/store/result_record.hpp"

#include <set>

#include "services/base/per_enumerator.hpp"

namespace dyncal::inline records {
namespace {

// Of an evaluation of files, without a network (result.schema.json).
constexpr const char* no_network = "none";

std::int64_t measured_steps(const StoredResult& result) {
  std::set<std::uint32_t> measured;
  for (const StoredPoint& point : result.points) {
    if (point.valid) {
      measured.insert(point.step);
    }
  }
  return static_cast<std::int64_t>(measured.size());
}

RunCompletion state_of(const ResultRecord& record) {
  const StoredResult& result = record.result;
  if (result.analysis_dds != no_network && result.ended_utc.empty()) {
    return RunCompletion::unfinished;
  }
  if (result.interrupted) {
    return RunCompletion::interrupted;
  }
  if (!result.problem.empty()) {
    return RunCompletion::ended_early;
  }
  return record.measured_steps < result.planned_steps ? RunCompletion::incomplete
                                                      : RunCompletion::complete;
}

} // namespace

std::string to_string(RunCompletion state) {
  return per_enumerator(state,
                        {"complete", "incomplete", "interrupted", "ended-early", "unfinished"});
}

Expected<ResultRecord> read_result_record(const std::filesystem::path& path) {
  DYNCAL_TRY(auto text, read_result_text(path));
  ByteCount no_progress;
  DYNCAL_TRY(auto result, result_of_text(text, result_file_of(path), no_progress));
  ResultRecord record;
  record.result = std::move(result);
  record.measured_steps = measured_steps(record.result);
  record.state = state_of(record);
  record.folder = std::filesystem::absolute(path).lexically_normal().string();
  record.document = std::move(text);
  return record;
}

} // namespace dyncal::inline records
