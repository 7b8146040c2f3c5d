#include "services/programs/web/laboratory_answers.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/parsed_number.hpp"
#include "services/programs/web/request_router.hpp"
#include "services/views/figures/error_bar_names.hpp"
#include "services/views/live/run_json.hpp"
#include "services/views/report/json_members.hpp"
#include "services/views/report/json_number.hpp"
#include "services/views/report/mean_budget.hpp"

namespace dyncal::inline programs::web {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 8> parts{"run",    "figures",  "budget", "journal",
                                                "signal", "spectrum", "fit",    "command"};

// 0: it is no number.
std::uint32_t number_of(const httplib::Request& request, const char* parameter) {
  return parsed_number<std::uint32_t>(request.get_param_value(parameter)).value_or(0);
}

void send_file(const ServedFile& file, const std::string& name, const httplib::Request& request,
               httplib::Response& response) {
  const bool is_picture = name.ends_with(".svg");
  response.set_header("Content-Security-Policy",
                      "default-src 'none'; style-src 'unsafe-inline'; sandbox");
  response.set_header("Content-Disposition",
                      fmt::format("{}; filename*=UTF-8''{}", is_picture ? "inline" : "attachment",
                                  percent_encoded(name)));
  answer_with(file, media_type(name), request, response);
}

// Nothing: there is no such result.
std::optional<Json> step_budget(const httplib::Request& request, const network::Run& run) {
  const auto found = run.results.find({number_of(request, "step"), number_of(request, "repetition"),
                                       request.get_param_value("channel")});
  if (found == run.results.end()) {
    return std::nullopt;
  }
  const StepResult& result = found->second;
  return Json{{"channel", result.channel},
              {"step", result.step},
              {"repetition", result.repetition},
              {"contributions", JsonWriter::of(result.budget)}};
}

// Of a mean, by its frequency, and its level where the frequency has several.
std::optional<Json> mean_budget(const httplib::Request& request, const StoredResult& result) {
  const auto level = parsed_number<double>(request.get_param_value("level"));
  const std::string frequency = request.get_param_value("frequency");
  const std::vector<StoredValue> values = result.values_of(request.get_param_value("channel"));
  const auto value = std::ranges::find_if(values, [&](const StoredValue& one) {
    return one.frequency_text_hz == frequency && (!level || one.level_m_s2 == *level);
  });
  if (value == values.end()) {
    return std::nullopt;
  }
  return Json{{"channel", value->channel},
              {"frequency_text_hz", value->frequency_text_hz},
              {"level_m_s2", json_number(value->level_m_s2)},
              {"contributions", JsonWriter::of(budget_of_mean(result, *value))}};
}

} // namespace

std::optional<BenchAddress> bench_address(std::string_view path) {
  constexpr std::string_view begin = "/api/bench/";
  if (!path.starts_with(begin) || path.size() == begin.size()) {
    return std::nullopt;
  }
  const std::string_view rest = path.substr(begin.size());
  const auto slash = rest.rfind('/');
  if (slash != std::string_view::npos) {
    for (const std::string_view part : parts) {
      if (rest.substr(slash + 1) == part && slash > 0) {
        return BenchAddress{std::string(rest.substr(0, slash)), std::string(part)};
      }
    }
  }
  return BenchAddress{std::string(rest), ""};
}

void answer_text(const Text& text, const std::string& otherwise, httplib::Response& response) {
  if (text) {
    response.set_content(*text, "application/json");
  } else {
    answer_error(404, "not_known", otherwise, response);
  }
}

Text LaboratoryAnswers::results(const std::string& bench, const std::string& run) const {
  return cache_.results(bench, run, [&](const std::string& name, Json& json) {
    json["files"] = Json::array();
    for (const RunFile& file : files_.files_of(bench, name)) {
      json["files"].push_back(
          {{"name", file.name},
           {"bytes", file.bytes},
           {"href", fmt::format("/files/{}/{}/{}", percent_encoded(bench), percent_encoded(name),
                                percent_encoded(file.name))}});
    }
  });
}

bool LaboratoryAnswers::answer(const httplib::Request& request, httplib::Response& response) const {
  if (request.path == "/api/laboratory") {
    answer_text(cache_.laboratory(), "", response);
    return true;
  }
  if (answer_file(request, response)) {
    return true;
  }
  const auto address = bench_address(request.path);
  if (!address) {
    return false;
  }
  if (address->part.empty()) {
    answer_text(cache_.bench(address->bench), "no bench of this name was heard of", response);
  } else if (address->part == "run") {
    answer_text(results(address->bench, request.get_param_value("run")),
                "no such run of this bench was heard of", response);
  } else if (address->part == "figures") {
    answer_figures(address->bench, request, response);
  } else if (address->part == "budget") {
    answer_budget(address->bench, request, response);
  } else {
    return false;
  }
  return true;
}

void LaboratoryAnswers::answer_figures(const std::string& bench, const httplib::Request& request,
                                       httplib::Response& response) const {
  const auto bars = dyncal::figures::parse_error_bars(
      request.has_param("bars") ? request.get_param_value("bars") : "U");
  if (!bars) {
    answer_error(400, "malformed", "bars must be U, u or none", response);
    return;
  }
  answer_text(cache_.figures(bench, request.get_param_value("run"),
                             request.get_param_value("channel"), *bars),
              "no such run with results of this channel was heard of", response);
}

void LaboratoryAnswers::answer_budget(const std::string& name, const httplib::Request& request,
                                      httplib::Response& response) const {
  const std::string run_name = request.get_param_value("run");
  const bool is_mean = request.has_param("frequency");
  const auto json = cache_.look([&](const network::BusState& laboratory) -> std::optional<Json> {
    const network::Bench* bench = laboratory.bench(name);
    const network::Run* run = find_run(bench, run_name);
    auto members = run == nullptr ? std::nullopt
                   : is_mean      ? mean_budget(request, live::heard_result(*bench, *run))
                                  : step_budget(request, *run);
    if (!members) {
      return std::nullopt;
    }
    Json whole{{"bench", name}, {"run", run->name}};
    whole.update(*members);
    return whole;
  });
  if (json) {
    answer_json(*json, response);
  } else {
    answer_error(404, "not_known", "no such result was heard of", response);
  }
}

bool LaboratoryAnswers::answer_file(const httplib::Request& request,
                                    httplib::Response& response) const {
  constexpr std::string_view begin = "/files/";
  if (!request.path.starts_with(begin)) {
    return false;
  }
  const std::string rest = request.path.substr(begin.size());
  const auto first = rest.find('/');
  const auto second = first == std::string::npos ? first : rest.find('/', first + 1);
  const auto file =
      second == std::string::npos
          ? std::nullopt
          : files_.find(rest.substr(0, first), rest.substr(first + 1, second - first - 1),
                        rest.substr(second + 1));
  const auto opened = file ? files_.open(*file) : std::nullopt;
  if (opened) {
    send_file(*opened, file->path.filename().string(), request, response);
  } else {
    answer_error(404, "not_known", "the run has no such file", response);
  }
  return true;
}

} // namespace dyncal::inline programs::web
