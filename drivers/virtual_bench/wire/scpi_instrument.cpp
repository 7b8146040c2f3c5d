#include "drivers/virtual_bench/wire/scpi_instrument.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>

#include "analysis/base/text.hpp"
#include "drivers/virtual_bench/wire/scpi_text.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr std::size_t max_errors = 20;
constexpr double max_frequency_hz = 5000.0;
constexpr double max_voltage_vpp = 20.0;
constexpr double max_rate_hz = 60e6; // of the points of an arbitrary waveform

// Long and short mnemonics, with and without the leading colon, become one form: "SOUR1:FREQ".
std::string canonical(std::string_view header) {
  static constexpr std::pair<const char*, const char*> short_forms[] = {
      {"SOURCE", "SOUR"}, {"FREQUENCY", "FREQ"}, {"VOLTAGE", "VOLT"}, {"FUNCTION", "FUNC"},
      {"OUTPUT", "OUTP"}, {"SYSTEM", "SYST"},    {"ERROR", "ERR"},    {"BENCH", "BENC"},
      {"STATE", "STAT"},  {"IMPEDANCE", "IMP"},  {"OFFSET", "OFFS"},  {"POLARITY", "POL"},
      {"BURST", "BURS"},  {"SWEEP", "SWE"},      {"PHASE", "PHAS"},   {"TRACE", "TRAC"},
      {"SRATE", "SRAT"}};
  std::string text = upper(header);
  if (!text.empty() && text.front() == ':') {
    text.erase(0, 1);
  }
  for (const auto& [long_form, short_form] : short_forms) {
    const std::size_t at = text.find(long_form);
    if (at != std::string::npos) {
      text.replace(at, std::string_view(long_form).size(), short_form);
    }
  }
  return text;
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.6E", value);
  return text;
}

} // namespace

std::string ScpiInstrument::time_text(double bench_time_s) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.9f", bench_time_s);
  return text;
}

void ScpiInstrument::complain(const char* error) {
  if (errors_.size() + 1 == max_errors) {
    errors_.emplace_back("-350,\"Queue overflow\"");
  } else if (errors_.size() < max_errors) {
    errors_.emplace_back(error);
  }
}

ScpiInstrument::Reply ScpiInstrument::execute(std::string_view line) {
  if (line.find('#') == std::string_view::npos) { // else it ends with a block, whatever is in it
    line = trimmed(line);
  }
  if (line.empty()) {
    return {};
  }
  const std::size_t space = std::min(line.find(' '), line.size());
  const std::string_view header = line.substr(0, space);
  const bool has_block = line.find('#') != std::string_view::npos;
  const std::string_view argument =
      has_block ? line.substr(std::min(space + 1, line.size())) : trimmed(line.substr(space));
  if (header.back() == '?') {
    return query(canonical(header.substr(0, header.size() - 1)), argument);
  }
  set(canonical(header), argument);
  return {};
}

std::string ScpiInstrument::identity() const {
  const BenchSettings& settings = bench_.settings();
  const std::string seed = std::to_string(settings.seed);
  if (settings.generator_words == GeneratorWords::keysight_33500) {
    return "Keysight Technologies,33512B,dyncal virtual bench " + settings.preset.name + "," + seed;
  }
  return "dyncal virtual bench," + settings.preset.name + "," + seed + ",1";
}

ScpiInstrument::Reply ScpiInstrument::query(const std::string& header, std::string_view argument) {
  if (header == "*IDN") {
    return {identity(), {}};
  }
  if (header == "*OPC") {
    return {"1", {}};
  }
  if (header == "SYST:ERR") {
    if (errors_.empty()) {
      return {"0,\"No error\"", {}};
    }
    std::string oldest = errors_.front();
    errors_.pop_front();
    return {std::move(oldest), {}};
  }
  if (header == "SOUR1:FREQ") {
    return {number_text(bench_.drive().frequency_hz), {}};
  }
  if (header == "SOUR1:VOLT") {
    return {number_text(2.0 * bench_.drive().amplitude_v), {}};
  }
  if (header == "OUTP1" || header == "OUTP1:STAT") {
    return {left_over_.state_text(is_on_), {}};
  }
  if (header == "BENC:TIME") {
    return {time_text(bench_.now_s()), {}};
  }
  if (header == "BENC:WAIT") {
    if (const auto time_s = parse_parameter(argument)) {
      return {{}, *time_s};
    }
    complain("-104,\"Data type error\"");
    return {};
  }
  if (auto answer = left_over_.answer(header)) {
    return {std::move(*answer), {}};
  }
  complain("-113,\"Undefined header\"");
  return {};
}

void ScpiInstrument::set(const std::string& header, std::string_view argument) {
  if (header == "*CLS") {
    errors_.clear();
  } else if (header == "*RST") {
    bench_.set_drive(Drive{});
    waveform_.clear();
    is_on_ = false;
    left_over_.reset();
  } else if (header == "SOUR1:FREQ") {
    set_frequency(argument);
  } else if (header == "SOUR1:VOLT") {
    set_voltage(argument);
  } else if (header == "OUTP1" || header == "OUTP1:STAT") {
    set_output(argument);
  } else if (header == "SOUR1:FUNC") {
    set_function(argument);
  } else if (set_waveform(header, argument)) {
    return;
  } else if (header == "SOUR1:VOLT:UNIT") {
    if (upper(argument) != "VPP") {
      complain("-224,\"Illegal parameter value\"");
    }
  } else if (header == "OUTP1:LOAD" || header == "OUTP1:IMP") {
    if (!upper(argument).starts_with("INF")) {
      complain("-224,\"Illegal parameter value\"");
    }
  } else if (!left_over_.has(header)) {
    complain("-113,\"Undefined header\"");
  } else if (!left_over_.set(header, argument)) {
    complain("-224,\"Illegal parameter value\"");
  }
}

void ScpiInstrument::set_function(std::string_view argument) {
  const std::string word = upper(argument);
  if (word == "ARB" && waveform_.is_complete()) {
    play_waveform(bench_.drive());
    return;
  }
  Drive drive = bench_.drive();
  drive.lines.clear();
  drive.rectangle = word.starts_with("SQU");
  if (!drive.rectangle && !word.starts_with("SIN")) {
    complain("-224,\"Illegal parameter value\"");
    return;
  }
  bench_.set_drive(drive);
}

// Its peak has the voltage that is set.
void ScpiInstrument::play_waveform(Drive drive) {
  drive.rectangle = false;
  drive.lines = waveform_.lines();
  for (DriveLine& line : drive.lines) {
    if (line.frequency_hz > max_frequency_hz || !bench_.has_response_at(line.frequency_hz)) {
      complain("-222,\"Data out of range\"");
      return;
    }
    line.amplitude_v *= drive.amplitude_v;
  }
  bench_.set_drive(drive);
}

bool ScpiInstrument::set_waveform(const std::string& header, std::string_view argument) {
  if (bench_.settings().generator_words != GeneratorWords::dg4000) {
    return false;
  }
  if (header == "SOUR1:TRAC:DATA:DAC16") {
    if (!waveform_.take(argument)) {
      complain("-161,\"Invalid block data\"");
    }
    return true;
  }
  if (header == "SOUR1:FUNC:ARB:MODE") {
    if (!upper(argument).starts_with("SRAT")) {
      complain("-224,\"Illegal parameter value\"");
    }
    return true;
  }
  if (header != "SOUR1:FUNC:ARB:SRAT") {
    return false;
  }
  const auto rate_hz = parse_parameter(argument);
  if (!rate_hz || !(*rate_hz > 0.0 && *rate_hz <= max_rate_hz)) {
    complain("-222,\"Data out of range\"");
    return true;
  }
  waveform_.set_rate(*rate_hz);
  if (!bench_.drive().lines.empty()) {
    play_waveform(bench_.drive());
  }
  return true;
}

void ScpiInstrument::set_frequency(std::string_view argument) {
  const auto frequency_hz = parse_parameter(argument);
  if (!frequency_hz) {
    complain("-104,\"Data type error\"");
  } else if (!(*frequency_hz > 0.0 && *frequency_hz <= max_frequency_hz) ||
             !bench_.has_response_at(*frequency_hz)) {
    complain("-222,\"Data out of range\"");
  } else {
    Drive drive = bench_.drive();
    drive.frequency_hz = *frequency_hz;
    bench_.set_drive(drive);
  }
}

void ScpiInstrument::set_voltage(std::string_view argument) {
  const auto voltage_vpp = parse_parameter(argument);
  if (!voltage_vpp) {
    complain("-104,\"Data type error\"");
  } else if (!(*voltage_vpp >= 0.0 && *voltage_vpp <= max_voltage_vpp)) {
    complain("-222,\"Data out of range\"");
  } else {
    Drive drive = bench_.drive();
    drive.amplitude_v = 0.5 * *voltage_vpp;
    drive.lines.empty() ? bench_.set_drive(drive) : play_waveform(drive);
  }
}

void ScpiInstrument::set_output(std::string_view argument) {
  const std::string word = upper(argument);
  const bool on = word == "ON" || word == "1";
  if (!on && word != "OFF" && word != "0") {
    complain("-224,\"Illegal parameter value\"");
    return;
  }
  Drive drive = bench_.drive();
  is_on_ = on;
  drive.on = on || (drive.on && bench_.settings().faults.output_stays_on);
  bench_.set_drive(drive);
}

} // namespace dyncal::drivers::virtual_bench
