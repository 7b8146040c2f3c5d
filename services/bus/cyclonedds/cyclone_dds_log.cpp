#include "services/bus/cyclonedds/cyclone_dds_log.hpp"

#include <cstdio>
#include <dds/ddsrt/log.h>
#include <string>
#include <string_view>

namespace dyncal::bus {
namespace {

void write_or_count(void* refused, const dds_log_data_t* data) {
  // Not always at its beginning: some lines are not ended before.
  const std::string_view message(data->message, data->size);
  if (message.find("malformed packet received") != std::string_view::npos) {
    static_cast<RefusedPackets*>(refused)->add(0); // it does not tell from whom
    return;
  }
  const std::string line =
      std::string(data->message - data->hdrsize, data->hdrsize + data->size) + '\n';
  std::fwrite(line.data(), 1, line.size(), stderr);
}

} // namespace

std::shared_ptr<RefusedPackets>
packets_refused_by_cyclone_dds(const std::function<void(const std::string&)>& warn) {
  // Never destroyed: Cyclone DDS may log while the process ends.
  static const auto* const refused = [&] {
    auto counter = std::make_shared<RefusedPackets>(warn);
    dds_set_log_sink(write_or_count, counter.get());
    return new std::shared_ptr<RefusedPackets>(std::move(counter));
  }();
  return *refused;
}

} // namespace dyncal::bus
