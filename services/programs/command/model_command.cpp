#include "services/programs/command/model_command.hpp"

#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/error.hpp"
#include "services/daemon/program/program.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/views/model/channel_model.hpp"
#include "services/views/model/model_figure.hpp"
#include "services/views/model/model_json.hpp"
#include "services/views/model/model_table.hpp"
#include "services/views/report/result_json.hpp"

namespace dyncal::inline programs {
namespace {

ModelRequest request_of(const ModelCommand& command) {
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

Expected<void> check_options(const ModelCommand& command) {
  const bool asks_for_filter = command.rate_hz > 0.0 || command.cutoff_hz > 0.0 ||
                               command.taps > 0 || command.delay_samples.has_value();
  if (command.filter.empty() && asks_for_filter) {
    return fail(ErrorCode::bad_argument, "--rate-hz, --cutoff-hz, --taps and --delay-samples are "
                                         "settings of a filter: add --filter fir or --filter iir");
  }
  return {};
}

Expected<std::vector<ChannelModel>> models_of(const ModelCommand& command) {
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

Expected<void> write_files(const ModelCommand& command, const std::vector<ChannelModel>& models) {
  if (!command.json.empty()) {
    std::vector<std::string> files;
    for (const std::filesystem::path& file : command.results) {
      files.push_back(file.string());
    }
    DYNCAL_TRY(write_json(command.json, model_json(files, models)));
    fmt::print("\n{} written\n", command.json.string());
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

} // namespace

std::vector<std::string> model_kind_names() {
  std::vector<std::string> names{"auto"};
  for (const analysis::ResponseKind kind : analysis::all_response_kinds) {
    names.emplace_back(name_of(kind));
  }
  return names;
}

int run_model(const ModelCommand& command) {
  const auto models = models_of(command);
  if (!models) {
    return report_error(models.error());
  }
  for (std::size_t i = 0; i < models->size(); ++i) {
    fmt::print("{}{}", i == 0 ? "" : "\n", model_text((*models)[i]));
  }
  if (const auto written = write_files(command, *models); !written) {
    return report_error(written.error());
  }
  return 0;
}

} // namespace dyncal::inline programs
