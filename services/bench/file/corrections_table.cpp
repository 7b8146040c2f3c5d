#include "services/bench/file/bench_tables.hpp"

#include <cmath>
#include <fstream>
#include <limits>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/bench/file/reference_file.hpp"

namespace dyncal::inline bench {

namespace {

// Of the file that `dyncal calibrate dso-delay` writes; what else it holds is for people.
void read_delay_file(TomlTable& table, const std::filesystem::path& path,
                     CorrectionSettings& corrections) {
  std::ifstream stream(path);
  if (!stream || std::filesystem::is_directory(path)) {
    table.refuse("file", fmt::format("{}: cannot be read; \"dyncal calibrate dso-delay\" writes "
                                     "such a file",
                                     path.string()));
    return;
  }
  const auto json = nlohmann::json::parse(stream, nullptr, false);
  const auto number = [&](const char* key) {
    const bool is_there = json.is_object() && json.contains(key) && json[key].is_number();
    return is_there ? json[key].get<double>() : std::numeric_limits<double>::quiet_NaN();
  };
  const double value_s = number("value_s");
  const double u_s = number("u_s");
  if (std::isfinite(value_s) && std::isfinite(u_s) && u_s >= 0.0) {
    corrections.dso_delay_s = value_s;
    corrections.u_dso_delay_s = u_s;
  } else {
    table.refuse("file", fmt::format("{}: is no JSON object with the finite numbers value_s and "
                                     "u_s, the second of them not negative",
                                     path.string()));
  }
}

void read_trigger_delay(TomlTable table, NamedFiles& files, CorrectionSettings& corrections) {
  if (!table.has("file")) {
    corrections.dso_delay_s = table.number("value_s", 0.0, "seconds");
    corrections.u_dso_delay_s = table.number("u_s", 0.0, "seconds");
  } else if (table.has("value_s") || table.has("u_s")) {
    table.refuse("file", "is given beside value_s or u_s; the file says both");
  } else {
    read_delay_file(table, files.resolve(table.required_text("file")), corrections);
  }
  if (corrections.u_dso_delay_s > 1.0) {
    table.refuse(table.has("file") ? "file" : "u_s",
                 "gives a standard uncertainty above 1 s, which is not plausible; is it given in "
                 "microseconds or nanoseconds?");
  }
  if (corrections.u_dso_delay_s < 0.0) {
    table.refuse("u_s", "is a standard uncertainty and must not be negative");
  }
  table.finish();
}

AdcCorrectionSettings read_adc(TomlTable table, NamedFiles& files) {
  AdcCorrectionSettings adc;
  const std::string file = table.required_text("file");
  adc.file = files.resolve(file);
  if (!file.empty() && !std::filesystem::is_regular_file(adc.file)) {
    table.refuse("file",
                 fmt::format("names {}, which does not exist or is not a file", adc.file.string()));
  }
  adc.channel = table.required_text("channel");
  adc.phase_sign = table.one_of("phase_sign", {"lag", "lead"}, "lag") == "lag" ? PhaseSign::lag
                                                                               : PhaseSign::lead;
  adc.test_amplitude_vpp = table.optional_number("test_amplitude_vpp", "V peak to peak");
  table.finish();
  return adc;
}

} // namespace

CorrectionSettings read_corrections(TomlTable table, NamedFiles& files) {
  CorrectionSettings corrections;
  if (auto adc = table.table("adc")) {
    corrections.adc = read_adc(std::move(*adc), files);
  }
  if (table.has("reference")) {
    auto file = read_reference_file(table.required_text("reference"), files);
    if (file) {
      corrections.reference = std::move(file->response);
      corrections.reference_standard = std::move(file->standard);
      corrections.reference_notes = std::move(file->notes);
      corrections.reference_phase_in_rad = file->phase_in_rad;
    } else {
      table.refuse("reference", "names " + file.error().message);
    }
  }
  corrections.reference_delay_s = table.number("reference_delay_s", 0.0, "seconds");
  if (auto delay = table.table("dso_delay")) {
    read_trigger_delay(std::move(*delay), files, corrections);
  }
  table.finish();
  return corrections;
}

} // namespace dyncal::inline bench
