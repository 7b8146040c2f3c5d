#include "drivers/dso/scope_commands.hpp"

namespace dyncal::drivers::dso {

const std::vector<ScopeCommands>& known_scopes() {
  static const std::vector<ScopeCommands> scopes = {
      {
          .family = "rigol-mso5000",
          .models = {"MSO5", "MSO7", "MSO8", "DS7", "DS8"},
          .set_up = {":STOP", ":SYSTem:AOUTput TOUT", ":ACQuire:TYPE NORMal", ":TRIGger:MODE EDGE",
                     ":TRIGger:COUPling DC", ":WAVeform:MODE RAW", ":WAVeform:FORMat BYTE"},
          .input_on = ":CHANnel<n>:DISPlay ON",
          .input_scale = ":CHANnel<n>:SCALe",
          .input_offset = ":CHANnel<n>:OFFSet",
          .offset_is_centre = false,
          .window_scale = ":TIMebase:MAIN:SCALe",
          .window_offset = ":TIMebase:MAIN:OFFSet",
          .memory_depth = ":ACQuire:MDEPth",
          .trigger_source = ":TRIGger:EDGE:SOURce",
          .trigger_level = ":TRIGger:EDGE:LEVel",
          .trigger_slope_rising = ":TRIGger:EDGE:SLOPe POSitive",
          .single = ":SINGle",
          .stop = ":STOP",
          .state = ":TRIGger:STATus?",
          .finished = {"STOP"},
          .input_name = "CHANnel<n>",
          .input_name_short = "CHAN<n>",
          .points = ":WAVeform:POINts",
          .reads_in_chunks = true,
          .chunk = 250'000,
          .voltage = VoltageRule::rigol,
      },
      {
          .family = "rigol-ds1000z",
          .models = {"DS1", "MSO1"},
          .set_up = {":STOP", ":ACQuire:TYPE NORMal", ":TRIGger:MODE EDGE", ":TRIGger:COUPling DC",
                     ":WAVeform:MODE RAW",
                     ":WAVeform:FORMat BYTE"}, // its trigger output is always on
          .input_on = ":CHANnel<n>:DISPlay ON",
          .input_scale = ":CHANnel<n>:SCALe",
          .input_offset = ":CHANnel<n>:OFFSet",
          .offset_is_centre = false,
          .window_scale = ":TIMebase:MAIN:SCALe",
          .window_offset = ":TIMebase:MAIN:OFFSet",
          .memory_depth = nullptr, // only while it runs; AUTO follows the window
          .trigger_source = ":TRIGger:EDGe:SOURce",
          .trigger_level = ":TRIGger:EDGe:LEVel",
          .trigger_slope_rising = ":TRIGger:EDGe:SLOPe POSitive",
          .single = ":SINGle",
          .stop = ":STOP",
          .state = ":TRIGger:STATus?",
          .finished = {"STOP"},
          .input_name = "CHANnel<n>",
          .input_name_short = "CHAN<n>",
          .points = nullptr,
          .reads_in_chunks = true,
          .chunk = 250'000,
          .voltage = VoltageRule::rigol,
      },
      {
          .family = "keysight-infiniivision",
          .models = {"DSO-X", "MSO-X", "DSOX", "MSOX"},
          .set_up = {":STOP", ":CALibrate:OUTPut TRIGgers", ":ACQuire:TYPE NORMal",
                     ":TRIGger:MODE EDGE", ":TRIGger:EDGE:COUPling DC", ":WAVeform:POINts:MODE RAW",
                     ":WAVeform:FORMat BYTE", ":WAVeform:UNSigned ON"},
          .input_on = ":CHANnel<n>:DISPlay ON",
          .input_scale = ":CHANnel<n>:SCALe",
          .input_offset = ":CHANnel<n>:OFFSet",
          .offset_is_centre = true,
          .window_scale = ":TIMebase:SCALe",
          .window_offset = ":TIMebase:POSition",
          .memory_depth = nullptr,
          .trigger_source = ":TRIGger:EDGE:SOURce",
          .trigger_level = ":TRIGger:EDGE:LEVel",
          .trigger_slope_rising = ":TRIGger:EDGE:SLOPe POSitive",
          .single = ":SINGle",
          .stop = ":STOP",
          .state = ":RSTate?",
          .finished = {"STOP"},
          .input_name = "CHANnel<n>",
          .input_name_short = "CHAN<n>",
          .points = ":WAVeform:POINts",
          .reads_in_chunks = false,
          .chunk = 4'000'000,
          .voltage = VoltageRule::keysight,
      },
  };
  return scopes;
}

const ScopeCommands* scope_by_family(std::string_view family) {
  for (const ScopeCommands& scope : known_scopes()) {
    if (family == scope.family) {
      return &scope;
    }
  }
  return nullptr;
}

const ScopeCommands* scope_by_identity(std::string_view identity) {
  const std::size_t first = identity.find(',');
  if (first == std::string_view::npos) {
    return nullptr;
  }
  std::string_view model = identity.substr(first + 1);
  model.remove_prefix(std::min(model.find_first_not_of(' '), model.size()));
  for (const ScopeCommands& scope : known_scopes()) {
    for (const char* beginning : scope.models) {
      if (model.starts_with(beginning)) {
        return &scope;
      }
    }
  }
  return nullptr;
}

std::string for_input(const char* command, int input) {
  std::string text = command;
  for (std::size_t place = text.find("<n>"); place != std::string::npos; place = text.find("<n>")) {
    text.replace(place, 3, std::to_string(input));
  }
  return text;
}

} // namespace dyncal::drivers::dso
