#include "services/bus/cyclonedds/cyclone_dds_log.hpp"

#include <chrono>
#include <cstdio>
#include <dds/ddsrt/log.h>
#include <string>
#include <string_view>

#include "services/bus/line_limit.hpp"

namespace dyncal::bus {
namespace {

// Of packets that cannot be sent, a hundred a second where this host has no network for a while:
// one is enough.
bool is_said_often(std::string_view message) {
  static LineLimit unsent{1};
  static LineLimit others;
  LineLimit& limit =
      message.find("ddsi_udp_conn_write") == std::string_view::npos ? others : unsent;
  return !limit.passes(message, std::chrono::steady_clock::now());
}

void write_or_count(void* refused, const dds_log_data_t* data) {
  // Not always at its beginning: some lines are not ended before.
  const std::string_view message(data->message, data->size);
  if (message.find("malformed packet received") != std::string_view::npos) {
    static_cast<RefusedPackets*>(refused)->add(0); // it does not tell from whom
    return;
  }
  if (is_said_often(message)) {
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
