#include "drivers/virtual_bench/wire/left_over_settings.hpp"

#include <cstdio>

#include "drivers/virtual_bench/wire/scpi_text.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr const char* offset_header = "SOUR1:VOLT:OFFS";
constexpr const char* polarity_header = "OUTP1:POL";

} // namespace

LeftOverSettings::LeftOverSettings(GeneratorWords words, const LeftInGenerator& left)
    : words_(words), is_kept_(left.is_kept), states_{{"SOUR1:BURS:STAT", left.in_burst},
                                                     {"SOUR1:SWE:STAT", false}},
      numbers_{{offset_header, left.offset_v}, {"SOUR1:PHAS", 0.0}} {
  if (is_keysight()) {
    for (const char* kind : {"AM", "FM", "PM", "SUM"}) {
      states_["SOUR1:" + std::string(kind) + ":STAT"] = false;
    }
  } else {
    states_["SOUR1:MOD:STAT"] = false;
  }
}

bool LeftOverSettings::has(const std::string& header) const {
  return states_.contains(header) || numbers_.contains(header) || header == polarity_header;
}

std::string LeftOverSettings::state_text(bool is_on) const {
  if (is_keysight()) {
    return is_on ? "1" : "0";
  }
  return is_on ? "ON" : "OFF";
}

std::optional<std::string> LeftOverSettings::answer(const std::string& header) const {
  if (const auto state = states_.find(header); state != states_.end()) {
    return state_text(state->second);
  }
  if (const auto number = numbers_.find(header); number != numbers_.end()) {
    char text[40];
    std::snprintf(text, sizeof(text), is_keysight() ? "%+.14E" : "%.6E", number->second);
    return text;
  }
  if (header != polarity_header) {
    return std::nullopt;
  }
  if (is_keysight()) {
    return is_inverted_ ? "INV" : "NORM";
  }
  return is_inverted_ ? "INVERTED" : "NORMAL";
}

bool LeftOverSettings::set(const std::string& header, std::string_view argument) {
  const std::string word = upper(argument);
  if (const auto number = numbers_.find(header); number != numbers_.end()) {
    const auto value = parse_parameter(argument);
    if (value && !is_kept_) {
      number->second = *value;
    }
    return value.has_value();
  }
  const bool is_polarity = header == polarity_header;
  const bool is_set = is_polarity ? word.starts_with("INV") : word == "ON" || word == "1";
  const bool is_clear = is_polarity ? word.starts_with("NORM") : word == "OFF" || word == "0";
  if (!is_kept_ && is_set != is_clear) {
    (is_polarity ? is_inverted_ : states_[header]) = is_set;
  }
  return is_set != is_clear;
}

void LeftOverSettings::reset() {
  if (!is_kept_) {
    *this = LeftOverSettings(words_, {});
  }
}

} // namespace dyncal::drivers::virtual_bench
