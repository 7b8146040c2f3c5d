#include "services/views/report/run_equipment.hpp"

#include <fmt/core.h>

#include "services/views/language/setup_sentences.hpp"

namespace dyncal::inline views {

std::vector<CalibratedDevice> run_equipment(const StoredResult& result, const std::string& channel,
                                            Language language) {
  std::vector<CalibratedDevice> equipment;
  for (const RunSource& source : result.sources) {
    const bool is_of_sensor = channel.starts_with(source.source + "/");
    CalibratedDevice& device = equipment.emplace_back();
    device.name = is_of_sensor ? sentences::acquisition(language, source.source)
                               : sentences::device_of_source(language, source.description.device,
                                                             source.source);
    device.serial = is_of_sensor ? "" : source.description.serial;
  }
  if (result.corrections && result.corrections->adc_file) {
    const AdcFile& file = *result.corrections->adc_file;
    CalibratedDevice& adc = equipment.emplace_back();
    adc.name = sentences::adc_of(language, file.channel,
                                 result.roles ? result.roles->sync_dau : std::string("sync"));
    adc.certificate = fmt::format("{}, SHA-256 {}", file.path, file.sha256);
  }
  return equipment;
}

} // namespace dyncal::inline views
