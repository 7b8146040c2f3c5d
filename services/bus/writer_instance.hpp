// The instance that each message of one writer belongs to.
//
// A source writes one instance, block after block: the key is read and hashed when it changes, not
// with every message. Key members stand first in a message, so equal bytes at its beginning are an
// equal key. One thread.
#pragma once

#include <memory>
#include <string>

#include "services/bus/cdr_key.hpp"
#include "services/bus/type_support.hpp"

namespace dyncal::bus {

class WriterInstance {
public:
  using Hash = KeyHash (*)(const std::string& canonical_key);

  // `layout` outlives the object.
  WriterInstance(const KeyLayout& layout, Hash hash) : layout_(layout), hash_(hash) {}

  // Of a message that encode() has made. Null when its key is not the contract's.
  [[nodiscard]] std::shared_ptr<const Instance> of(const std::string& payload) {
    if (last_ && payload.compare(0, beginning_.size(), beginning_) == 0) {
      return last_;
    }
    last_.reset();
    if (auto key = read_key(layout_, payload.data(), payload.size())) {
      const KeyHash hash = hash_(canonical_key(*key));
      beginning_ = key_payload(*key, ByteOrder::little);
      last_ = std::make_shared<const Instance>(Instance{std::move(*key), hash});
    }
    return last_;
  }

private:
  const KeyLayout& layout_;
  const Hash hash_;
  std::string beginning_; // of every message of the last instance: header and key
  std::shared_ptr<const Instance> last_;
};

} // namespace dyncal::bus
