// `dyncal model RESULT.json...`: the parametric response of each sensor, and the filter that undoes
// it.
//
// Prints which orders the values support and the parameters with u; writes all numbers as JSON
// (services/views/model/model.schema.json), the residuals as figures. Exit status 1 and one line
// when a file is not a result, or nothing can be fitted. Belongs to one thread.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/programs/command/command.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/views/model/channel_model.hpp"
#include "services/views/model/model_figure.hpp"
#include "services/views/model/model_json.hpp"
#include "services/views/model/model_table.hpp"
#include "services/views/report/result_json.hpp"

namespace dyncal::inline programs {
namespace {

struct ModelOptions {
  std::vector<std::filesystem::path> results;
  ResponseSelection selection;
  ModelRequest request;
  std::string filter; // empty: none; fir, iir
  FilterRequest filter_settings;
  std::filesystem::path output; // as JSON
  std::filesystem::path figures;
};

void add_model_filter(CLI::App& command, ModelOptions& model) {
  FilterRequest& settings = model.filter_settings;
  CLI::Option* filter =
      add_checked(command, "--filter", model.filter,
                  "design a filter that undoes the response, with a low pass: fir or iir",
                  CLI::IsMember({"fir", "iir"}));
  command
      .add_option("--rate-hz", settings.rate_hz,
                  "sample rate of the filter (default: the sensor's, as measured)")
      ->check(CLI::PositiveNumber)
      ->needs(filter);
  command
      .add_option("--cutoff-hz", settings.cutoff_hz,
                  "end of the filter's pass band (default: the highest fitted frequency)")
      ->check(CLI::PositiveNumber)
      ->needs(filter);
  command
      .add_option("--taps", settings.taps,
                  "coefficients b of the filter (default: by the width of the transition)")
      ->check(CLI::Range(2, 513))
      ->needs(filter);
  command
      .add_option("--delay-samples", settings.delay_samples,
                  "by how many samples the filter's output may be late (default: that with the "
                  "smallest error)")
      ->check(CLI::NonNegativeNumber)
      ->needs(filter);
}

// "auto" and every kind.
void add_kind(CLI::App& command, std::optional<analysis::ResponseKind>& chosen) {
  std::vector<std::string> names{"auto"};
  for (const analysis::ResponseKind kind : analysis::all_response_kinds) {
    names.emplace_back(name_of(kind));
  }
  const auto choose = [&chosen](const std::string& name) {
    const auto& kinds = analysis::all_response_kinds;
    const auto found = std::ranges::find(kinds, name, [](auto kind) { return name_of(kind); });
    chosen = found == kinds.end() ? std::nullopt : std::optional(*found);
  };
  command
      .add_option_function<std::string>("--kind", choose,
                                        "the model (default: what the values support)")
      ->check(CLI::IsMember(names))
      ->default_str("auto");
}

void add_model(CLI::App& command, ModelOptions& model) {
  command
      .add_option("RESULT.json", model.results,
                  "result of dyncal run or analyse; several are joined")
      ->required();
  command.add_option("--channel", model.selection.channels,
                     "channel to fit (repeatable; default: all that respond)");
  add_kind(command, model.request.kind);
  command.add_flag("--include-flagged", model.selection.include_flagged,
                   "also fit values whose flags say that they may be wrong beyond u");
  command.add_option("--output", model.output,
                     "write models, covariances and filters to this file as JSON");
  command.add_option("--figures", model.figures,
                     "write figures of the residuals (SVG and CSV) into this folder");
  add_model_filter(command, model);
}

Expected<std::vector<ChannelModel>> models_of(const ModelOptions& command) {
  const WorkProgress progress("reading");
  DYNCAL_TRY(auto responses, read_responses(command.results, command.selection, progress.count()));
  progress.count()->begin("fitting", "channels", responses.size());
  std::vector<ChannelModel> models;
  for (MeasuredResponse& response : responses) {
    DYNCAL_TRY(models.emplace_back(), model_channel(std::move(response), command.request));
    progress.count()->add_done();
  }
  return models;
}

Expected<void> write_files(const ModelOptions& command, const std::vector<ChannelModel>& models) {
  if (!command.output.empty()) {
    const std::vector<std::string> files(command.results.begin(), command.results.end());
    DYNCAL_TRY(write_json(command.output, model_json(files, models)));
    fmt::print("\n{} written\n", command.output.string());
  }
  if (!command.figures.empty()) {
    for (const ChannelModel& model : models) {
      DYNCAL_TRY(const auto written, figures::write(model_figure(model), command.figures));
      for (const std::filesystem::path& path : written) {
        fmt::print("{} written\n", path.string());
      }
    }
  }
  return {};
}

Expected<void> run_model(ModelOptions& command) {
  if (!command.filter.empty()) {
    command.filter_settings.iir = command.filter == "iir";
    command.request.filter = command.filter_settings;
  }
  DYNCAL_TRY(const auto models, models_of(command));
  for (std::size_t i = 0; i < models.size(); ++i) {
    fmt::print("{}{}", i == 0 ? "" : "\n", model_text(models[i]));
  }
  return write_files(command, models);
}

const Command model_command{
    190, "model",
    "fit gain, delay, first and second order to results; a filter that undoes the response",
    add_model, run_model};

} // namespace
} // namespace dyncal::inline programs
