// `dyncal means RUN --output FILE`: the means of a run with U, k and flags for spreadsheets
// (services/views/spreadsheet), CSV or XLSX by the name of the file. It never overwrites one.
// Belongs to one thread.
#include <fmt/core.h>

#include "services/base/output_file.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/views/spreadsheet/means_csv.hpp"
#include "services/views/spreadsheet/means_workbook.hpp"

namespace dyncal::inline programs {
namespace {

struct MeansOptions {
  std::filesystem::path run;
  std::filesystem::path output;
  bool decimal_comma = false;
};

void add_means(CLI::App& command, MeansOptions& options) {
  take_run(command.add_option("RUN", options.run, "run folder, or a result file (JSON)"))
      ->required();
  command.add_option("--output", options.output, "file to write: .xlsx, or else CSV")->required();
  command.add_flag("--decimal-comma", options.decimal_comma,
                   "CSV with semicolons, decimal commas and a byte order mark");
}

Expected<int> run_means(const MeansOptions& options, const std::stop_token& /*stop*/) {
  DYNCAL_TRY(const auto result, read_values(options.run));
  DYNCAL_TRY(check_new_file(options.output));
  if (options.output.extension() == ".xlsx") {
    DYNCAL_TRY(write_workbook(options.output, result));
  } else {
    const CsvForm form = options.decimal_comma ? CsvForm::decimal_comma : CsvForm::decimal_point;
    DYNCAL_TRY(write_new_file(options.output, csv_of(means_table(result), form)));
  }
  fmt::print("wrote {}: {} means\n", options.output.string(), result.values.size());
  return 0;
}

const Command means_command{165, "means", "the means of a run for spreadsheets: CSV or XLSX",
                            add_means, run_means};

} // namespace
} // namespace dyncal::inline programs
