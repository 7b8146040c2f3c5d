#include "services/bench/file/adc_file_writer.hpp"

#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/base/output_file.hpp"

namespace dyncal::inline bench {

Expected<void> write_adc_file(const std::filesystem::path& path, const AdcFileHead& head,
                              std::span<const analysis::AdcCalibrationPoint> measurements) {
  using Json = nlohmann::ordered_json;
  Json about = {{"BordID", head.board}, {"Date", head.date}};
  for (const auto& [key, text] : head.remarks) {
    about[key] = text;
  }
  Json frequencies = Json::object();
  for (const analysis::AdcCalibrationPoint& point : measurements) {
    Json& rows = frequencies[Json(point.frequency_hz).dump()];
    rows.push_back({{"Freq", point.frequency_hz},
                    {"Amplitude", point.gain},
                    {"Phase", point.phase_lag_rad},
                    {"TestAmplVPP.", point.test_amplitude_vpp},
                    {"u_Amplitude", point.u_gain},
                    {"u_Phase", point.u_phase_lag_rad}});
  }
  const Json file = {{"MeataData", about}, {"FitResults", {{head.channel, frequencies}}}};
  return write_output_file(path, json_text(file, 1) + '\n');
}

} // namespace dyncal::inline bench
