#include "drivers/dso/oscilloscope.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/link/scpi_answer.hpp"
#include "drivers/utc_clock.hpp"

namespace dyncal::drivers::dso {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr double horizontal_divisions = 10.0;
constexpr double vertical_divisions = 8.0;
constexpr milliseconds poll_interval{2};

std::size_t next_power_of_ten(std::size_t value) {
  std::size_t power = 1000; // the smallest memory that the known families have
  while (power < value && power < 100'000'000) {
    power *= 10;
  }
  return power;
}

} // namespace

double next_scope_step(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= value * (1.0 - 1e-12)) {
      return factor * decade;
    }
  }
  return 10.0 * decade;
}

Oscilloscope::Oscilloscope(OscilloscopeSettings settings, const StopSignal& stop)
    : settings_(std::move(settings)), stop_(stop) {}

void Oscilloscope::give_up_connection() {
  connection_.reset();
  prepared_.reset();
}

Expected<void> Oscilloscope::connect() {
  DYNCAL_TRY(auto connection, ScpiConnection::connect("oscilloscope", settings_.address,
                                                      settings_.answer_limit, stop_));
  // Errors from before this connection are not ours.
  DYNCAL_TRY(connection.send("*CLS"));
  DYNCAL_TRY(const auto identity, connection.query("*IDN?"));
  commands_ =
      settings_.family.empty() ? scope_by_identity(identity) : scope_by_family(settings_.family);
  if (commands_ == nullptr) {
    std::string families;
    for (const ScopeCommands& scope : known_scopes()) {
      families += (families.empty() ? "" : ", ") + std::string(scope.family);
    }
    return fail(ErrorCode::refused,
                message("'" + shown(identity) +
                        "' is not a known oscilloscope; name the family it follows (" + families +
                        ")"));
  }
  for (const char* setting : commands_->set_up) {
    DYNCAL_TRY(connection.command(setting));
  }
  identity_ = identity;
  connection_.emplace(std::move(connection));
  ++connections_;
  return {};
}

Expected<void> Oscilloscope::prepare(const Acquisition& acquisition) {
  if (settings_.trigger_input >= settings_.inputs.size() ||
      !(acquisition.before_trigger_s >= 0.0) || !(acquisition.after_trigger_s > 0.0) ||
      acquisition.points == 0) {
    return fail(ErrorCode::invalid_setting,
                message("an acquisition needs an input to trigger on, a window and points"));
  }
  if (connection_ && connection_->lost()) {
    give_up_connection();
  }
  wanted_ = acquisition;
  if (!connection_) {
    DYNCAL_TRY(connect());
  }
  if (prepared_ && *prepared_ == acquisition) {
    return {};
  }
  auto applied = apply(acquisition);
  if (applied) {
    prepared_ = acquisition;
  }
  return applied;
}

Expected<void> Oscilloscope::apply(const Acquisition& acquisition) {
  std::vector<std::string> settings = {commands_->stop};
  for (const InputSettings& input : settings_.inputs) {
    const double centre_v = commands_->offset_is_centre ? input.centre_v : -input.centre_v;
    settings.push_back(for_input(commands_->input_on, input.input));
    settings.push_back(for_input(commands_->input_scale, input.input) + " " +
                       scpi_decimal(next_scope_step(input.range_v / vertical_divisions)));
    settings.push_back(for_input(commands_->input_offset, input.input) + " " +
                       scpi_decimal(centre_v));
  }
  const double scale_s = next_scope_step(
      (acquisition.before_trigger_s + acquisition.after_trigger_s) / horizontal_divisions);
  settings.push_back(std::string(commands_->window_scale) + " " + scpi_decimal(scale_s));
  settings.push_back(
      std::string(commands_->window_offset) + " " +
      scpi_decimal(scale_s * horizontal_divisions / 2.0 - acquisition.before_trigger_s));
  if (commands_->memory_depth != nullptr) {
    settings.push_back(std::string(commands_->memory_depth) + " " +
                       std::to_string(next_power_of_ten(acquisition.points)));
  }
  settings.push_back(
      std::string(commands_->trigger_source) + " " +
      for_input(commands_->input_name, settings_.inputs[settings_.trigger_input].input));
  settings.push_back(commands_->trigger_slope_rising);
  settings.push_back(std::string(commands_->trigger_level) + " " +
                     scpi_decimal(settings_.trigger_level_v));
  for (const std::string& setting : settings) {
    DYNCAL_TRY(connection_->command(setting));
  }
  return {};
}

Expected<Shot> Oscilloscope::acquire(milliseconds trigger_limit) {
  if (!wanted_) {
    return fail(ErrorCode::invalid_setting, message("no acquisition is prepared"));
  }
  DYNCAL_TRY(prepare(Acquisition(*wanted_)));
  DYNCAL_TRY(connection_->command(commands_->single));
  DYNCAL_TRY(const auto triggered_utc_ns, wait_for_trigger(trigger_limit));
  auto shot = read_shot();
  if (shot) {
    shot->triggered_utc_ns = triggered_utc_ns;
  }
  return shot;
}

Expected<std::int64_t> Oscilloscope::wait_for_trigger(milliseconds limit) {
  const auto deadline = Clock::now() + limit;
  for (;;) {
    DYNCAL_TRY(const auto state, connection_->query(commands_->state));
    if (std::any_of(commands_->finished.begin(), commands_->finished.end(),
                    [&](const char* finished) { return state == finished; })) {
      return utc_now_ns();
    }
    if (Clock::now() >= deadline) {
      DYNCAL_TRY(connection_->command(commands_->stop));
      return fail(ErrorCode::timeout,
                  message("no trigger within " + std::to_string(limit.count()) +
                          " ms; is sync connected to input " +
                          std::to_string(settings_.inputs[settings_.trigger_input].input) +
                          ", and does the generator run?"));
    }
    if (stop_.wait_for(poll_interval)) {
      return fail(ErrorCode::disconnected, message("stopped"));
    }
  }
}

Expected<Shot> Oscilloscope::read_shot() {
  Shot shot;
  std::size_t points = 0;
  for (const InputSettings& input : settings_.inputs) {
    Preamble preamble;
    DYNCAL_TRY(auto trace, read_trace(input, preamble));
    if (shot.traces.empty()) {
      shot.first_sample_s = preamble.first_sample_s();
      shot.interval_s = preamble.x_increment_s;
      points = preamble.points;
    } else if (preamble.points != points || preamble.first_sample_s() != shot.first_sample_s ||
               preamble.x_increment_s != shot.interval_s) {
      give_up_connection();
      return fail(ErrorCode::malformed, message("the traces of one shot have different time axes"));
    }
    shot.traces.push_back(std::move(trace));
  }
  return shot;
}

Expected<Preamble> Oscilloscope::read_preamble(const InputSettings& input) {
  DYNCAL_TRY(
      connection_->command(":WAVeform:SOURce " + for_input(commands_->input_name, input.input)));
  // Read back: an instrument that is one answer behind is found out here.
  DYNCAL_TRY(const auto source, connection_->query(":WAVeform:SOURce?"));
  if (source != for_input(commands_->input_name_short, input.input)) {
    give_up_connection();
    return fail(ErrorCode::malformed,
                message("answers :WAVeform:SOURce? with '" + shown(source) + "' instead of " +
                        for_input(commands_->input_name_short, input.input)));
  }
  if (commands_->points != nullptr) {
    const std::size_t points = commands_->memory_depth != nullptr
                                   ? next_power_of_ten(prepared_->points)
                                   : prepared_->points;
    DYNCAL_TRY(connection_->command(std::string(commands_->points) + " " + std::to_string(points)));
  }
  DYNCAL_TRY(const auto answer, connection_->query(":WAVeform:PREamble?"));
  auto preamble = parse_preamble(answer);
  if (!preamble) {
    give_up_connection();
    return fail(ErrorCode::malformed, message(preamble.error().message));
  }
  return preamble;
}

Expected<Trace> Oscilloscope::read_trace(const InputSettings& input, Preamble& preamble) {
  DYNCAL_TRY(preamble, read_preamble(input));
  Trace trace{input.name, {}, preamble.y_increment_v};
  while (trace.volts.size() < preamble.points) {
    const std::size_t wanted =
        std::min(commands_->max_points_per_block, preamble.points - trace.volts.size());
    if (commands_->reads_in_chunks) {
      const std::string first = std::to_string(trace.volts.size() + 1);
      const std::string last = std::to_string(trace.volts.size() + wanted);
      for (const std::string& part : {":WAVeform:STARt " + first, ":WAVeform:STOP " + last}) {
        DYNCAL_TRY(connection_->command(part));
      }
    }
    DYNCAL_TRY(const auto codes, connection_->query_block(":WAVeform:DATA?", wanted));
    if (codes.size() != wanted) {
      give_up_connection();
      return fail(ErrorCode::malformed,
                  message("a block of " + std::to_string(codes.size()) + " bytes where " +
                          std::to_string(wanted) + " samples were asked for"));
    }
    append_volts(preamble, commands_->voltage, codes, trace.volts);
  }
  return trace;
}

} // namespace dyncal::drivers::dso
