// What differs between the oscilloscopes that dyncal can drive: one row of commands and rules a
// family. The conversation itself is the same for all.
//
//   rigol-mso5000           MSO5000, MSO7000, MSO8000 (programming guide of the MSO5000 series)
//   rigol-ds1000z           DS1000Z, MSO1000Z (programming guide of the MSO1000Z/DS1000Z series)
//   keysight-infiniivision  3000 X-Series and later (programmer's guide)
//
// "<n>" in a command stands for the number of the input.
//
// The defaults of ScopeCommands are the base row, the Rigol MSO5000 without its memory depth; a
// family's row names what is different there. Immutable; any thread.
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
  const char* family = "";
  std::vector<const char*> models; // beginnings of the model in *IDN?
  // Once after connecting; switches the trigger output on where it has a switch.
  std::vector<const char*> set_up;

  // Inputs. Volts per division follow the scale, volts the offset.
  const char* input_on = ":CHANnel<n>:DISPlay ON";
  const char* input_scale = ":CHANnel<n>:SCALe";
  const char* input_offset = ":CHANnel<n>:OFFSet";
  bool offset_is_centre = false; // true: the offset is the voltage at the screen's centre; false:
                                 // it is added to the signal
  const char* input_name = "CHANnel<n>";
  const char* input_name_short = "CHAN<n>"; // as the instrument answers it

  // Window. Seconds per division follow the scale, seconds from the trigger to the screen's centre
  // the offset, a number of points the memory depth (nullptr: the instrument decides).
  const char* window_scale = ":TIMebase:MAIN:SCALe";
  const char* window_offset = ":TIMebase:MAIN:OFFSet";
  const char* memory_depth = nullptr;

  // Trigger. The input follows the source as input_name, volts the level.
  const char* trigger_source = ":TRIGger:EDGE:SOURce";
  const char* trigger_level = ":TRIGger:EDGE:LEVel";
  const char* trigger_slope_rising = ":TRIGger:EDGE:SLOPe POSitive";

  // One acquisition.
  const char* single = ":SINGle";
  const char* stop = ":STOP";
  const char* state = ":TRIGger:STATus?";
  std::vector<const char*> finished = {
      "STOP"}; // answers to `state` once the acquisition is complete

  // The trace.
  const char* points = ":WAVeform:POINts";    // set before the preamble; nullptr: not needed
  bool reads_in_chunks = true;                // :WAVeform:STARt and :WAVeform:STOP choose a part
  std::size_t max_points_per_block = 250'000; // in one :WAVeform:DATA?
  VoltageRule voltage = VoltageRule::rigol;
};

[[nodiscard]] const std::vector<ScopeCommands>& known_scopes();

// By family name or by the model that *IDN? names; nullptr when there is none.
[[nodiscard]] const ScopeCommands* scope_by_family(std::string_view family);
[[nodiscard]] const ScopeCommands* scope_by_identity(std::string_view identity);

// Every "<n>" replaced.
[[nodiscard]] std::string for_input(const char* command, int input);

} // namespace dyncal::drivers::dso
