#include "services/evaluation/result/result_messages.hpp"

namespace dyncal::inline evaluation {

void add_adc_file(const std::optional<AdcFile>& file, wire::Measurement& measurement) {
  if (file) {
    measurement.adc_file(file->path);
    measurement.adc_channel(file->channel);
    measurement.adc_file_sha256(file->sha256);
  }
}

std::optional<AdcFile> adc_file_of(const wire::Measurement& measurement) {
  return measurement.adc_file().empty()
             ? std::nullopt
             : std::optional(AdcFile{measurement.adc_file(), measurement.adc_channel(),
                                     measurement.adc_file_sha256()});
}

} // namespace dyncal::inline evaluation
