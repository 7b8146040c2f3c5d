#include "drivers/virtual_bench/wire/datagram_path.hpp"

#include <utility>

namespace dyncal::drivers::virtual_bench {

void DatagramPath::send(const std::string& datagram) {
  if (random_.happens(settings_.loss)) {
    return;
  }
  if (!held_ && random_.happens(settings_.reorder)) {
    held_ = datagram;
    return;
  }
  deliver_(datagram);
  if (random_.happens(settings_.duplicate)) {
    deliver_(datagram);
  }
  if (held_) {
    deliver_(*std::exchange(held_, std::nullopt));
  }
}

} // namespace dyncal::drivers::virtual_bench
