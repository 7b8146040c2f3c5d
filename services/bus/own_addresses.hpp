// The addresses of this host that a participant announces, at which others send to it.
//
// They are fixed when it is made: one that the host gets later is not used, and what is sent to one
// that is gone does not arrive. Any thread.
#pragma once

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace dyncal::bus {

class OwnAddresses {
public:
  void set(std::vector<std::string> addresses) {
    const std::lock_guard lock(mutex_);
    addresses_ = std::move(addresses);
  }
  // IPv4. Empty where none is known: some tell with the first writer or reader.
  [[nodiscard]] std::vector<std::string> get() const {
    const std::lock_guard lock(mutex_);
    return addresses_;
  }

private:
  mutable std::mutex mutex_;
  std::vector<std::string> addresses_;
};

} // namespace dyncal::bus
