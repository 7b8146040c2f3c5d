#include "services/analysis/twin_watch.hpp"

namespace dyncal::services {

void TwinWatch::add(std::uint64_t session) {
  if (session_ == session) {
    return;
  }
  if (left_ == session) {
    ++returns_;
  }
  left_ = session_;
  session_ = session;
}

} // namespace dyncal::services
