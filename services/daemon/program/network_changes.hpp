// Whether an interface or an IPv4 address of this host has changed, as the kernel announces it
// (rtnetlink), so that nobody has to list them all twice a second.
//
// Where the kernel cannot be asked, or has announced more than its buffer holds, something has
// changed. Of the network namespace in which the object was made. One thread.
#pragma once

#include "drivers/link/file_descriptor.hpp"

namespace dyncal::services {

class NetworkChanges {
public:
  NetworkChanges();

  // Since the last call, or since the object was made.
  [[nodiscard]] bool any();

private:
  drivers::FileDescriptor announcements_;
};

} // namespace dyncal::services
