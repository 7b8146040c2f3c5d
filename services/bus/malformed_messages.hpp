// Counts messages that do not match the contract, and warns the user of the first one of each type.
//
// They come from programs that do not keep to idl/README.md: another encoding, a key that is too
// long, a message that ends too soon. They are dropped. Any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <string>

namespace dyncal::bus {

class MalformedMessages {
public:
  // `warn` may be empty; it is called from the vendor's threads.
  explicit MalformedMessages(std::function<void(const std::string&)> warn)
      : warn_(std::move(warn)) {}

  void add(const std::string& type_name);
  [[nodiscard]] std::uint64_t count() const { return count_; }

private:
  std::function<void(const std::string&)> warn_;
  std::atomic<std::uint64_t> count_{0};
  std::mutex mutex_;
  std::set<std::string> warned_of_; // one entry a type of the contract at most
};

} // namespace dyncal::bus
