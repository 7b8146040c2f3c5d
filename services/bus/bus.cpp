#include "services/bus/bus.hpp"

#include "services/bus/adapters.hpp"
#include "services/bus/vendor.hpp"

namespace dyncal::bus {
namespace {

constexpr int max_domain = 232; // the last one whose ports fit 16 bits (DDSI-RTPS 9.6.2.3)

std::string names_in_this_build() {
  std::string names;
  for (const Vendor vendor : vendors_in_this_build()) {
    names += (names.empty() ? "" : ", ") + to_string(vendor);
  }
  return names.empty() ? "none" : names;
}

base::Expected<std::unique_ptr<UntypedParticipant>>
create_by_vendor(const ParticipantOptions& options, const SecurityFiles* security) {
#ifdef DYNCAL_HAVE_FAST_DDS
  if (options.vendor == Vendor::fast_dds) {
    return create_fast_dds_participant(options, security);
  }
#endif
#ifdef DYNCAL_HAVE_CYCLONE_DDS
  if (options.vendor == Vendor::cyclone_dds) {
    return create_cyclone_dds_participant(options, security);
  }
#endif
  return fail(base::ErrorCode::network,
              "DDS implementation '" + to_string(options.vendor) +
                  "' is not in this build, which has: " + names_in_this_build());
}

} // namespace

base::Expected<std::unique_ptr<UntypedParticipant>>
create_untyped_participant(const ParticipantOptions& options, const SecurityFiles* security) {
  if (options.domain < 0 || options.domain > max_domain) {
    return fail(base::ErrorCode::network, "invalid DDS domain " + std::to_string(options.domain) +
                                              ": must be between 0 and " +
                                              std::to_string(max_domain));
  }
  return create_by_vendor(options, security);
}

base::Expected<Participant> Participant::create(const ParticipantOptions& options) {
  return create_untyped_participant(options, nullptr).map([](auto participant) {
    return Participant(std::move(participant));
  });
}

base::Expected<Vendor> parse_vendor(const std::string& name) {
  for (const Vendor vendor : vendors_in_this_build()) {
    if (name == to_string(vendor)) {
      return vendor;
    }
  }
  if (name == "memory") {
    return fail(base::ErrorCode::bad_argument,
                "'memory' is the bus of unit tests and cannot leave a process; this build has: " +
                    names_in_this_build());
  }
  return fail(base::ErrorCode::bad_argument, "unknown DDS implementation '" + name +
                                                 "'; this build has: " + names_in_this_build());
}

std::string to_string(Vendor vendor) {
  return vendor == Vendor::fast_dds ? "fastdds" : "cyclonedds";
}

// Cyclone DDS first where there is a choice, because Fast DDS lives only behind its screen
// (services/bus/fastdds).
std::vector<Vendor> vendors_in_this_build() {
  return {
#ifdef DYNCAL_HAVE_CYCLONE_DDS
      Vendor::cyclone_dds,
#endif
#ifdef DYNCAL_HAVE_FAST_DDS
      Vendor::fast_dds,
#endif
  };
}

} // namespace dyncal::bus
