// `dyncal linearity RUN`: how |H| and arg H change with the level, at every frequency of a stored
// run that was measured at several (services/views/linearity). Prints a table, or JSON. Exit status
// 0; 1 and one line when something is wrong. Belongs to one thread.
#include <optional>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/views/linearity/linearity_table.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline programs {
namespace {

struct LinearityOptions {
  std::filesystem::path run;
  std::vector<std::string> channels;
  std::optional<double> reference_level_m_s2;
  bool json = false;
};

void add_linearity_options(CLI::App& command, LinearityOptions& options) {
  take_run(command.add_option("RUN", options.run, "run folder, or a result file (JSON)"))
      ->required();
  command.add_option("--channel", options.channels,
                     "channel to look at (repeatable; default: all that respond)");
  command.add_option("--level", options.reference_level_m_s2,
                     "reference level, as planned, in m/s^2 (default: the highest whose value has "
                     "no flag that forbids a certificate)");
  command.add_flag("--json", options.json, "print JSON");
}

Expected<AmplitudeLinearity> look_at(const LinearityOptions& options) {
  DYNCAL_TRY(const auto result, read_values(options.run));
  return amplitude_linearity_of(
      result, options.channels.empty() ? responding_channels(result) : options.channels,
      options.reference_level_m_s2);
}

Expected<int> run_linearity(const LinearityOptions& options) {
  DYNCAL_TRY(const auto linearity,
             with_progress("reading the run", [&](const auto&) { return look_at(options); }));
  fmt::print("{}", options.json ? json_text(linearity_json(linearity), 2) + "\n"
                                : linearity_table(linearity));
  return 0;
}

const Command linearity_command{
    187, "linearity", "how the response changes with the level, where several were measured",
    add_linearity_options, run_linearity};

} // namespace
} // namespace dyncal::inline programs
