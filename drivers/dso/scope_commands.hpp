// What differs between the oscilloscopes that dyncal can drive: one row of words and rules a
// family. The conversation itself is the same for all.
//
//   rigol-mso5000        MSO5000 and MSO7000/8000 (programming guide of the MSO5000 series)
//   rigol-ds1000z        DS1000Z and MSO1000Z (programming guide of the MSO1000Z/DS1000Z series)
//   keysight-infiniivision  3000 X-Series and later (programmer's guide)
// "<n>" in a command stands for the number of the input. Immutable; any thread.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace dyncal::drivers::dso {

// From the 8-bit code of a sample to volts.
enum class VoltageRule {
  rigol,   // (code - yorigin - yreference) * yincrement
  keysight // (code - yreference) * yincrement + yorigin
};

struct ScopeCommands {
  const char* family;
  std::vector<const char*> models; // beginnings of the model in *IDN?
  std::vector<const char*>
      set_up; // once after connecting; switches the trigger output on where it has a switch
  const char* input_on;       // with <n>
  const char* input_scale;    // with <n>; volt per division follows
  const char* input_offset;   // with <n>; volt follows
  bool offset_is_centre;      // the offset is the voltage at the screen's centre; otherwise what is
                              // added to the signal
  const char* window_scale;   // seconds per division follow
  const char* window_offset;  // seconds from the trigger to the screen's centre follow
  const char* memory_depth;   // number of points follows; nullptr: the instrument decides
  const char* trigger_source; // input follows as input_name
  const char* trigger_level;  // volt follows
  const char* trigger_slope_rising;
  const char* single;
  const char* stop;
  const char* state;                 // query
  std::vector<const char*> finished; // its answers when a single acquisition is complete
  const char* input_name;            // with <n>: "CHANnel<n>"
  const char* input_name_short;      // as the instrument answers it: "CHAN<n>"
  const char* points;   // points of the waveform, set before the preamble; nullptr: not needed
  bool reads_in_chunks; // :WAVeform:STARt and :WAVeform:STOP choose a part
  std::size_t chunk;    // most points in one :WAVeform:DATA?
  VoltageRule voltage;
};

[[nodiscard]] const std::vector<ScopeCommands>& known_scopes();

// By family name or by the model that *IDN? names; nullptr when there is none.
[[nodiscard]] const ScopeCommands* scope_by_family(std::string_view family);
[[nodiscard]] const ScopeCommands* scope_by_identity(std::string_view identity);

// Every "<n>" replaced.
[[nodiscard]] std::string for_input(const char* command, int input);

} // namespace dyncal::drivers::dso
