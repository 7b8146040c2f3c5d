// `dyncal model RESULT.json...`: the parametric response of each sensor, and the filter that undoes
// it.
//
// Prints which orders the values support and the parameters with u; writes all numbers as JSON
// (services/views/model/model.schema.json), the residuals as figures. Exit status 1 and one line
// when a file is not a result, or nothing can be fitted. Belongs to one thread.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
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
  std::vector<std::string> channels; // empty: all that respond
  std::string kind = "auto";
  bool include_flagged = false;
  std::filesystem::path output; // as JSON
  std::filesystem::path figures;
  std::string filter; // empty: none; fir, iir
  double rate_hz = 0.0;
  double cutoff_hz = 0.0;
  int taps = 0;
  std::optional<int> delay_samples;
};

void add_model_filter(CLI::App& command, ModelOptions& model) {
  command
      .add_option("--filter", model.filter,
                  "design a filter that undoes the response, with a low pass: fir or iir")
      ->check(CLI::IsMember({"fir", "iir"}));
  command
      .add_option("--rate-hz", model.rate_hz,
                  "sample rate of the filter (default: the sensor's, as measured)")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--cutoff-hz", model.cutoff_hz,
                  "end of the filter's pass band (default: the highest fitted frequency)")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--taps", model.taps,
                  "coefficients b of the filter (default: by the width of the transition)")
      ->check(CLI::Range(2, 513));
  command
      .add_option("--delay-samples", model.delay_samples,
                  "by how many samples the filter's output may be late (default: that with the "
                  "smallest error)")
      ->check(CLI::NonNegativeNumber);
}

void add_model(CLI::App& command, ModelOptions& model) {
  command
      .add_option("RESULT.json", model.results,
                  "result of dyncal run or analyse; several are joined")
      ->required();
  command.add_option("--channel", model.channels,
                     "channel to fit (repeatable; default: all that respond)");
  command.add_option("--kind", model.kind, "the model (default: what the values support)")
      ->check(CLI::IsMember(model_kind_names()))
      ->capture_default_str();
  command.add_flag("--include-flagged", model.include_flagged,
                   "also fit values whose flags say that they may be wrong beyond u");
  command.add_option("--output", model.output,
                     "write models, covariances and filters to this file as JSON");
  command.add_option("--figures", model.figures,
                     "write figures of the residuals (SVG and CSV) into this folder");
  add_model_filter(command, model);
}

ModelRequest request_of(const ModelOptions& command) {
  ModelRequest request;
  for (const analysis::ResponseKind kind : analysis::all_response_kinds) {
    if (command.kind == name_of(kind)) {
      request.kind = kind;
    }
  }
  if (!command.filter.empty()) {
    request.filter = {.iir = command.filter == "iir",
                      .rate_hz = command.rate_hz,
                      .cutoff_hz = command.cutoff_hz,
                      .taps = command.taps,
                      .delay_samples = command.delay_samples};
  }
  return request;
}

Expected<void> check_options(const ModelOptions& command) {
  const bool asks_for_filter = command.rate_hz > 0.0 || command.cutoff_hz > 0.0 ||
                               command.taps > 0 || command.delay_samples.has_value();
  if (command.filter.empty() && asks_for_filter) {
    return fail(ErrorCode::bad_argument, "--rate-hz, --cutoff-hz, --taps and --delay-samples are "
                                         "settings of a filter: add --filter fir or --filter iir");
  }
  return {};
}

Expected<std::vector<ChannelModel>> models_of(const ModelOptions& command) {
  DYNCAL_TRY(check_options(command));
  const WorkProgress progress("reading");
  DYNCAL_TRY(auto responses,
             read_responses(command.results, {command.channels, command.include_flagged},
                            progress.count()));
  progress.count()->begin("fitting", "channels", responses.size());
  std::vector<ChannelModel> models;
  for (MeasuredResponse& response : responses) {
    DYNCAL_TRY(auto model, model_channel(std::move(response), request_of(command)));
    models.push_back(std::move(model));
    progress.count()->add_done();
  }
  return models;
}

Expected<void> write_files(const ModelOptions& command, const std::vector<ChannelModel>& models) {
  if (!command.output.empty()) {
    std::vector<std::string> files;
    for (const std::filesystem::path& file : command.results) {
      files.push_back(file.string());
    }
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

std::vector<std::string> model_kind_names() {
  std::vector<std::string> names{"auto"};
  for (const analysis::ResponseKind kind : analysis::all_response_kinds) {
    names.emplace_back(name_of(kind));
  }
  return names;
}

Expected<void> run_model(const ModelOptions& command) {
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
