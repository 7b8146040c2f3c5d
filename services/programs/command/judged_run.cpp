#include "services/programs/command/judged_run.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/base/output_file.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/views/conformity/asked_conformity.hpp"
#include "services/views/conformity/conformity_json.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline programs {

Expected<JudgedRun> judge_run(StoredResult result, const std::vector<std::string>& channels,
                              const std::filesystem::path& tolerance_file,
                              const std::optional<Tolerances>& of_sensor) {
  const std::vector<std::string> chosen = channels.empty() ? responding_channels(result) : channels;
  DYNCAL_TRY(auto report, asked_conformity(result, chosen, tolerance_file, of_sensor));
  if (!report) {
    return fail(ErrorCode::bad_argument,
                "name the tolerances: --tolerances FILE, or --sensor with a sensor that has "
                "[conformity] and [[tolerance]]");
  }
  return JudgedRun{std::move(result), std::move(*report)};
}

Expected<std::filesystem::path> keep_conformity(const std::filesystem::path& run,
                                                const JudgedRun& judged) {
  std::filesystem::path file = file_beside_run(run, "conformity.json");
  DYNCAL_TRY(
      write_output_file(file, json_text(conformity_json(judged.report, judged.result), 2) + "\n"));
  return file;
}

} // namespace dyncal::inline programs
