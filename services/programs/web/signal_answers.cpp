#include "services/programs/web/signal_answers.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/base/parsed_number.hpp"
#include "services/contract/channel_name.hpp"
#include "services/programs/web/laboratory_answers.hpp"
#include "services/programs/web/request_router.hpp"
#include "services/views/report/json_number.hpp"
#include "services/views/report/rounded_json.hpp"
#include "services/views/signals/sine_view.hpp"
#include "services/views/signals/spectrum.hpp"
#include "services/views/signals/trace.hpp"

namespace dyncal::inline programs::web {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* no_channel = "there is no such channel, or too many are looked at already";

double number_of(const std::string& text, double low, double high, double otherwise) {
  const double number = parsed_number<double>(text).value_or(otherwise);
  return std::isnan(number) ? otherwise : std::clamp(number, low, high);
}

// Six digits are more than a picture has. Null: not finite.
void add_shown(double value, std::string& text) {
  std::array<char, 32> digits{};
  const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                     std::chars_format::general, 6);
  text += std::isfinite(value) ? std::string_view(digits.data(), written.ptr) : "null";
}

Json shown(double value) {
  std::string text;
  add_shown(value, text);
  return Json::parse(text);
}

// As JSON. By hand: thousands of numbers ten times a second, which as objects of the library took
// 8 % of a core more for ten visitors.
std::string columns_text(const std::vector<TraceColumn>& columns) {
  std::string text = "[";
  for (const TraceColumn& column : columns) {
    text += text.size() == 1 ? "[" : ",[";
    add_shown(column.time_s, text);
    text += ',';
    add_shown(column.minimum, text);
    text += ',';
    add_shown(column.maximum, text);
    text += ']';
  }
  text += ']';
  return text;
}

// But its columns.
Json trace_json(const Trace& trace) {
  Json gaps = Json::array();
  for (const auto& [from_s, to_s] : trace.gaps) {
    gaps.push_back({shown(from_s), shown(to_s)});
  }
  return {{"rate_hz", json_number(trace.rate_hz)},
          {"begin_utc_ms", trace.begin_utc_ns == 0
                               ? Json(nullptr)
                               : Json(static_cast<double>(trace.begin_utc_ns) / 1e6)},
          {"level_rms", shown(trace.level_rms)},
          {"level_peak", shown(trace.level_peak)},
          {"over_range", trace.over_range},
          {"gaps", std::move(gaps)}};
}

Json fit_json(const std::string& channel, const analysis::Frequency& frequency,
              const SineView& view) {
  return {{"channel", channel},
          {"frequency_hz", json_number(frequency.hz())},
          {"u_frequency_hz", nullptr},
          {"phase_origin_ns", std::to_string(view.phase_origin_ns)},
          {"sine", json_number(view.fit.sine)},
          {"cosine", json_number(view.fit.cosine)},
          {"offset", json_number(view.fit.offset)},
          {"amplitude", json_number(view.fit.amplitude())},
          {"u_amplitude", json_number(view.fit.u_amplitude())},
          {"phase_rad", json_number(view.fit.phase_rad())},
          {"residual_rms", json_number(view.residual_rms)},
          {"sample_count", view.fit.samples},
          {"text", {{"amplitude", rounded_json(view.fit.amplitude(), view.fit.u_amplitude())}}}};
}

} // namespace

SignalAnswers::Question SignalAnswers::question_of(const std::string& bench,
                                                   const httplib::Request& request) {
  Question question{.bench = bench,
                    .source = request.get_param_value("source"),
                    .channel = request.get_param_value("channel")};
  const std::string signal = request.get_param_value("signal");
  if (const auto slash = signal.find('/'); slash != std::string::npos) {
    question.source = signal.substr(0, slash);
    question.channel = signal.substr(slash + 1);
  }
  question.seconds = number_of(request.get_param_value("seconds"), 1.0, 60.0, 10.0);
  question.columns = static_cast<std::size_t>(
      number_of(request.get_param_value("columns"), 100.0, 4000.0, 1000.0));
  return question;
}

std::optional<SignalAnswers::Found> SignalAnswers::find(const Question& question) const {
  return cache_.look([&](const network::BusState& laboratory) -> std::optional<Found> {
    const network::Bench* bench = laboratory.bench(question.bench);
    const auto source = bench == nullptr ? std::map<std::string, network::Source>::const_iterator()
                                         : bench->sources.find(question.source);
    if (bench == nullptr || source == bench->sources.end() || !source->second.description) {
      return std::nullopt;
    }
    const auto& channels = source->second.description->channels;
    const auto channel =
        std::ranges::find(channels, question.channel, &drivers::ChannelDescription::name);
    if (channel == channels.end()) {
      return std::nullopt;
    }
    return Found{.tapped = {question.bench, question.source,
                            source->second.kind.value_or(SourceKind::acs),
                            static_cast<std::size_t>(channel - channels.begin())},
                 .unit = channel->unit,
                 .minimum = channel->minimum,
                 .maximum = channel->maximum};
  });
}

Text SignalAnswers::signal(const std::string& bench, const httplib::Request& request) {
  const Question question = question_of(bench, request);
  const std::string key = fmt::format("{}\n{}\n{}\n{} {}", question.bench, question.source,
                                      question.channel, question.seconds, question.columns);
  const std::lock_guard lock(mutex_);
  const auto made = texts_.find(key);
  if (made != texts_.end() && clock_.now() - made->second.when < text_age) {
    return made->second.text;
  }
  const auto found = find(question);
  Trace trace;
  const auto look = [&](const ChannelRing& ring) {
    trace = make_trace(ring, question.seconds, question.columns, {found->minimum, found->maximum});
  };
  if (!found || !tap_.look(found->tapped, look)) {
    return nullptr;
  }
  Json json{{"source", question.source},
            {"channel", question.channel},
            {"unit", found->unit},
            {"minimum", json_number(found->minimum)},
            {"maximum", json_number(found->maximum)},
            {"missed", std::to_string(tap_.missed())}};
  json.update(trace_json(trace));
  std::erase_if(texts_, [now = clock_.now()](const auto& held) {
    return now - held.second.when >= text_age; // nobody is answered with it any more
  });
  if (texts_.size() >= max_texts) {
    texts_.clear();
  }
  std::string whole = json_text(json);
  whole.pop_back();
  whole += ",\"columns\":" + columns_text(trace.columns) + "}";
  Text text = std::make_shared<const std::string>(std::move(whole));
  texts_[key] = Made{text, clock_.now()};
  return text;
}

struct SignalAnswers::ExcitedStep {
  network::Excitation now;
  network::Plan plan; // without its steps

  [[nodiscard]] bool is_in(network::StepState state) const { return now.step.state == state; }
  [[nodiscard]] bool is_excited() const {
    return is_in(network::StepState::settling) || is_in(network::StepState::steady);
  }
};

Expected<Json> SignalAnswers::spectrum(const Question& question) {
  const auto found = find(question);
  std::vector<Sample> samples;
  double rate_hz = 0.0;
  const auto look = [&](const ChannelRing& ring) {
    rate_hz = ring.rate_hz();
    samples = ring.newest_stretch(static_cast<std::size_t>(rate_hz * question.seconds) + 1);
  };
  if (!found || !tap_.look(found->tapped, look)) {
    return fail(ErrorCode::no_source, no_channel);
  }
  std::vector<double> values;
  values.reserve(samples.size());
  for (const Sample& sample : samples) {
    values.push_back(sample.value);
  }
  const auto spectrum = spectrum_of(values, rate_hz);
  if (!spectrum) {
    return fail(ErrorCode::no_result, spectrum.error().message);
  }
  const auto step = excited_step(question.bench);
  const bool is_excited = step && step->is_excited();
  Json lines = Json::array();
  for (const auto& [hz, amplitude] : spectrum->lines) {
    lines.push_back({shown(hz), shown(amplitude)});
  }
  return Json{{"source", question.source},
              {"channel", question.channel},
              {"unit", found->unit},
              {"lines", std::move(lines)},
              {"fundamental_hz", json_number(spectrum->fundamental_hz)},
              {"amplitude", json_number(spectrum->amplitude)},
              {"thd", is_excited ? json_number(spectrum->thd) : Json(nullptr)},
              {"noise_floor", json_number(spectrum->noise_floor)},
              {"window", spectrum_window},
              {"resolution_hz", json_number(spectrum->resolution_hz)}};
}

// The one that is excited now, by what was announced last; nothing: no run is under way.
std::optional<SignalAnswers::ExcitedStep>
SignalAnswers::excited_step(const std::string& bench_name) const {
  return cache_.look([&](const network::BusState& laboratory) -> std::optional<ExcitedStep> {
    const network::Bench* bench = laboratory.bench(bench_name);
    const network::Run* run = bench == nullptr ? nullptr : bench->current_run();
    if (run == nullptr || !run->plan || !run->now || run->is_over()) {
      return std::nullopt;
    }
    ExcitedStep step{*run->now, *run->plan};
    step.plan.steps.clear();
    return step;
  });
}

// Null: the role has no channel.
Json SignalAnswers::fitted_json(const std::string& bench, const std::string& name,
                                const ExcitedStep& step) {
  const auto parsed = parse_channel_name(name);
  const auto frequency = analysis::Frequency::parse(step.now.step.frequency_text_hz);
  const auto found =
      parsed ? find({.bench = bench, .source = parsed->source, .channel = parsed->channel})
             : std::nullopt;
  std::vector<Sample> samples;
  std::optional<StepWindow> window;
  const auto look = [&](const ChannelRing& ring) {
    window =
        step.is_in(network::StepState::steady) && step.now.steady
            ? step_window(ring, step.now.began, *step.now.steady, is_triggered(found->tapped.kind))
            : std::nullopt;
    if (window) {
      samples = samples_around(ring, *window);
    }
  };
  if (!found || !frequency || !tap_.look(found->tapped, look)) {
    return nullptr;
  }
  const auto settled = window ? find_settled(samples, *window, *frequency) : std::nullopt;
  if (!settled) {
    return {{"channel", name}, {"unit", found->unit}, {"problem", "settling"}};
  }
  const auto view = view_sine(*settled, 1000);
  if (!view) {
    return {{"channel", name}, {"unit", found->unit}, {"problem", view.error().message}};
  }
  return {{"channel", name},
          {"unit", found->unit},
          {"fit", fit_json(name, *frequency, *view)},
          {"columns", Json::parse(columns_text(view->columns))},
          {"residual_columns", Json::parse(columns_text(view->residuals))}};
}

Expected<Json> SignalAnswers::fit(const std::string& bench) {
  const auto step = excited_step(bench);
  if (!step) {
    return fail(ErrorCode::no_result, "no step is excited on this bench now");
  }
  const auto fitted = [&](const std::string& channel) {
    return fitted_json(bench, channel, *step);
  };
  Json json{{"step", step->now.step.step},
            {"attempt", step->now.step.attempt},
            {"frequency_text_hz", step->now.step.frequency_text_hz},
            {"reference", fitted(step->plan.reference)},
            {"sync", fitted(step->plan.sync_acs)},
            {"dau_phase",
             fitted(step->plan.sync_dau.empty() ? step->plan.sync_dso : step->plan.sync_dau)}};
  if (!step->is_excited()) { // asked for all the same: earlier samples show where a step begins
    json["step"] = 0;
    json["reference"] = json["sync"] = json["dau_phase"] = nullptr;
  }
  return json;
}

bool SignalAnswers::answer(const httplib::Request& request, httplib::Response& response) {
  const auto address = bench_address(request.path);
  if (address && address->part == "signal") {
    answer_text(signal(address->bench, request), no_channel, response);
    return true;
  }
  if (!address || (address->part != "spectrum" && address->part != "fit")) {
    return false;
  }
  const auto json =
      address->part == "fit" ? fit(address->bench) : spectrum(question_of(address->bench, request));
  if (json) {
    answer_json(*json, response);
  } else {
    answer_error(404, "not_known", json.error().message, response);
  }
  return true;
}

} // namespace dyncal::inline programs::web
