// SHA-256 over messages of a recording, in their order: topic, times, sequence and bytes. The same
// from a recording and from its export. One thread.
#pragma once

#include <string>
#include <string_view>

#include "services/contract/digest.hpp"
#include "services/recording/mcap_record.hpp"

namespace dyncal::services {

class MessageDigest {
public:
  void add(std::string_view topic, const recording::Message& message) {
    std::string head;
    recording::append_number(head, topic.size(), 2);
    head += topic;
    recording::append_number(head, message.log_time, 8);
    recording::append_number(head, message.publish_time, 8);
    recording::append_number(head, message.sequence, 4);
    recording::append_number(head, message.data.size(), 8);
    digest_.add(head.data(), head.size());
    digest_.add(message.data.data(), message.data.size());
  }
  // The object is spent afterwards.
  [[nodiscard]] std::string hex() { return digest_.hex(); }

private:
  Digest digest_;
};

} // namespace dyncal::services
