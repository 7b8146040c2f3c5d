// What the virtual generator can be left with beside frequency and voltage: burst, sweep,
// modulations, DC offset, start phase, polarity, in the words of a DG4000 or of a 33500. They are
// kept and answered and do not act on the exciter.
//
// Written independently of what dyncal resets (drivers/generator/left_over_state.hpp): one must not
// share the other's mistakes. One thread.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/virtual_bench/model/virtual_bench.hpp"

namespace dyncal::drivers::virtual_bench {

class LeftOverSettings {
public:
  LeftOverSettings(GeneratorWords words, const LeftInGenerator& left);

  // Headers are in short form: "SOUR1:BURS:STAT".
  [[nodiscard]] bool has(const std::string& header) const;
  // Nothing where this generator has no such header.
  [[nodiscard]] std::optional<std::string> answer(const std::string& header) const;
  // False where it cannot be set to that. REQUIRES: has(header).
  bool set(const std::string& header, std::string_view argument);
  void reset();
  // On or off, as this generator answers it.
  [[nodiscard]] std::string state_text(bool is_on) const;

private:
  [[nodiscard]] bool is_keysight() const { return words_ == GeneratorWords::keysight_33500; }

  GeneratorWords words_;
  bool is_kept_;
  std::map<std::string, bool> states_;    // burst and the like
  std::map<std::string, double> numbers_; // V or degrees
  bool is_inverted_ = false;
};

} // namespace dyncal::drivers::virtual_bench
