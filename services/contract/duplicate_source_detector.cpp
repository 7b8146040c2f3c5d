#include "services/contract/duplicate_source_detector.hpp"

namespace dyncal::inline contract {

void DuplicateSourceDetector::add(std::uint64_t session) {
  if (session_ == session) {
    if (++in_a_row_ == alone_) {
      left_.reset();
      returns_ = 0;
    }
    return;
  }
  in_a_row_ = 1;
  if (left_ == session) {
    ++returns_;
  }
  left_ = session_;
  session_ = session;
}

} // namespace dyncal::inline contract
