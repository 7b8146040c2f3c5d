#include "services/bus/bus.hpp"

#include <algorithm>

#include "services/bus/adapters.hpp"

namespace dyncal::bus {
namespace {

constexpr int max_domain = 232; // the last one whose ports fit 16 bits (DDSI-RTPS 9.6.2.3)

services::Error network_error(std::string message) {
  return {services::ErrorCode::network, std::move(message)};
}

std::string words_of_this_build() {
  std::string words;
  for (const Vendor vendor : vendors_in_this_build()) {
    words += (words.empty() ? "" : " or ") + vendor_word(vendor);
  }
  return words.empty() ? "none" : words;
}

} // namespace

services::Expected<Participant> Participant::create(const ParticipantOptions& options) {
  if (options.domain < 0 || options.domain > max_domain) {
    return fail(network_error("DDS domain " + std::to_string(options.domain) +
                              " does not exist: choose one from 0 to " +
                              std::to_string(max_domain)));
  }
  services::Expected<std::unique_ptr<UntypedParticipant>> untyped = fail(network_error(
      vendor_word(options.vendor) + " is not in this build, which has " + words_of_this_build()));
#ifdef DYNCAL_HAVE_FAST_DDS
  if (options.vendor == Vendor::fast_dds) {
    untyped = create_fast_dds_participant(options);
  }
#endif
#ifdef DYNCAL_HAVE_CYCLONE_DDS
  if (options.vendor == Vendor::cyclone_dds) {
    untyped = create_cyclone_dds_participant(options);
  }
#endif
  return std::move(untyped).map(
      [](auto participant) { return Participant(std::move(participant)); });
}

services::Expected<Vendor> parse_vendor(const std::string& word) {
  for (const Vendor vendor : vendors_in_this_build()) {
    if (word == vendor_word(vendor)) {
      return vendor;
    }
  }
  return fail(services::ErrorCode::bad_argument,
              "\"" + word + "\" is no DDS of this build: say " + words_of_this_build());
}

std::string vendor_word(Vendor vendor) {
  return vendor == Vendor::fast_dds ? "fastdds" : "cyclonedds";
}

std::vector<Vendor> vendors_in_this_build() {
  return {
#ifdef DYNCAL_HAVE_FAST_DDS
      Vendor::fast_dds,
#endif
#ifdef DYNCAL_HAVE_CYCLONE_DDS
      Vendor::cyclone_dds,
#endif
  };
}

} // namespace dyncal::bus
