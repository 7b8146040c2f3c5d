#include "drivers/dso/scope_commands.hpp"

namespace dyncal::drivers::dso {

const std::vector<ScopeCommands>& known_scopes() {
  static const std::vector<ScopeCommands> scopes = {
      {
          .family = "rigol-mso5000",
          .models = {"MSO5", "MSO7", "MSO8", "DS7", "DS8"},
          .set_up = {":STOP", ":SYSTem:AOUTput TOUT", ":ACQuire:TYPE NORMal", ":TRIGger:MODE EDGE",
                     ":TRIGger:COUPling DC", ":WAVeform:MODE RAW", ":WAVeform:FORMat BYTE"},
          .memory_depth = ":ACQuire:MDEPth",
      },
      {
          // The trigger output is always on. The memory depth can be set only while it runs; AUTO
          // follows the window.
          .family = "rigol-ds1000z",
          .models = {"DS1", "MSO1"},
          .set_up = {":STOP", ":ACQuire:TYPE NORMal", ":TRIGger:MODE EDGE", ":TRIGger:COUPling DC",
                     ":WAVeform:MODE RAW", ":WAVeform:FORMat BYTE"},
          .trigger_source = ":TRIGger:EDGe:SOURce",
          .trigger_level = ":TRIGger:EDGe:LEVel",
          .trigger_slope_rising = ":TRIGger:EDGe:SLOPe POSitive",
          .points = nullptr,
      },
      {
          .family = "keysight-infiniivision",
          .models = {"DSO-X", "MSO-X", "DSOX", "MSOX"},
          .set_up = {":STOP", ":CALibrate:OUTPut TRIGgers", ":ACQuire:TYPE NORMal",
                     ":TRIGger:MODE EDGE", ":TRIGger:EDGE:COUPling DC", ":WAVeform:POINts:MODE RAW",
                     ":WAVeform:FORMat BYTE", ":WAVeform:UNSigned ON"},
          .offset_is_centre = true,
          .window_scale = ":TIMebase:SCALe",
          .window_offset = ":TIMebase:POSition",
          .state = ":RSTate?",
          .reads_in_chunks = false,
          .max_points_per_block = 4'000'000,
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
