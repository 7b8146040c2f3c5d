#include "services/bench/file/asked_keys.hpp"

#include <algorithm>
#include <utility>

namespace dyncal::inline bench {
namespace {

AskedKeys*& listener() {
  thread_local AskedKeys* of_this_thread = nullptr;
  return of_this_thread;
}

} // namespace

AskedKeys::AskedKeys() {
  listener() = this;
}

AskedKeys::~AskedKeys() {
  listener() = nullptr;
}

AskedKeys* AskedKeys::listening() {
  return listener();
}

void AskedKeys::add(AskedKey key) {
  if (std::find(all_.begin(), all_.end(), key) == all_.end()) {
    all_.push_back(std::move(key));
  }
}

} // namespace dyncal::inline bench
