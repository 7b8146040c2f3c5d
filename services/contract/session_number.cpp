#include "services/contract/session_number.hpp"

#include <random>

namespace dyncal::inline contract {

std::uint64_t random_session() {
  std::random_device device;
  std::uint64_t session = 0;
  while (session == 0) {
    session = (std::uint64_t{device()} << 32U) | device();
  }
  return session;
}

} // namespace dyncal::inline contract
