#include "services/bus/malformed_messages.hpp"

namespace dyncal::bus {

void MalformedMessages::add(const std::string& type_name) {
  ++count_;
  {
    const std::lock_guard lock(mutex_);
    if (!warned_of_.insert(type_name).second) {
      return;
    }
  }
  if (warn_) {
    warn_("dropped a message that is not a " + type_name +
          " of this contract, or was changed on its way, and will drop others like it: check the "
          "program that sends it against idl/README.md, and the network");
  }
}

} // namespace dyncal::bus
