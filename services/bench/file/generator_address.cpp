#include "services/bench/file/generator_address.hpp"

namespace dyncal::inline bench {
namespace {

bool is_loopback(const std::string& address) {
  return address.starts_with("127.") || address.starts_with("localhost:") ||
         address.starts_with("[::1]");
}

} // namespace

bool may_be_one_generator(const std::string& first, const std::string& second) {
  return first == second || is_loopback(first) || is_loopback(second);
}

} // namespace dyncal::inline bench
