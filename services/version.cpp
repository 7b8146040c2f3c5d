#include "services/version.hpp"

namespace dyncal::services {

std::string software_version() {
  return DYNCAL_SOFTWARE;
}

} // namespace dyncal::services
