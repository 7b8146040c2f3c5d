#include <fmt/core.h>

#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/laboratory_view.hpp"

namespace dyncal::inline checks::doctor {
namespace {

constexpr double notable_part = 0.01;

std::string place_of(const ProgramIdentity& identity) {
  return fmt::format("{}:{} on {}", identity.program, identity.process_id, identity.host);
}

// Packets of reliable topics get through, and so the program was heard, but no probe does.
constexpr const char* cut =
    "none gets through, although answers that are sent again until they arrive do: nearly all "
    "packets are lost, or a firewall or a limit of packets a second lets few through; ";

std::string advice(const LinkLoss& loss, const std::string& own_host) {
  const std::string& other = loss.identity.host;
  const std::string within =
      other == own_host
          ? ""
          : "look at cables and switch ports on the way (`ethtool -S`: errors, half duplex), avoid "
            "WLAN, see whether the link is full or limited (`tc -s qdisc`), and ";
  return fmt::format("DDS sends again what is lost, which delays samples and results: {}look "
                     "whether packets found no room on {} (`nstat -az UdpRcvbufErrors`; 'buffers' "
                     "tells of this host)",
                     within, other == own_host ? "it" : other + " or here");
}

Finding finding_of(const LinkLoss& loss, const std::string& own_host) {
  const std::string place = place_of(loss.identity);
  if (!loss.answers_probes) {
    return {Severity::ok, "loss",
            fmt::format("{}: not measured, for it answers no probes; an older version does not",
                        place)};
  }
  const auto lost = lost_part(loss);
  if (!lost) {
    return {Severity::ok, "loss",
            fmt::format("{}: not measured, for only {} probes were sent; look for longer "
                        "(--seconds)",
                        place, loss.sent)};
  }
  const std::string measured =
      fmt::format("{}: {:.1f} % of {} probes brought no echo", place, *lost * 100.0, loss.sent);
  if (*lost <= notable_part) {
    return {Severity::ok, "loss", measured};
  }
  return {Severity::warning, "loss",
          fmt::format("{}; {}{}", measured, *lost == 1.0 ? cut : "", advice(loss, own_host))};
}

Finding about_long_packets(const LinkLoss& loss) {
  return {Severity::error, "path",
          fmt::format("{}: none of {} packets as long as those with samples got there, and short "
                      "ones do: on the way, or at that host, an MTU is smaller than 1500; set it "
                      "to 1500 there (`tracepath` shows where)",
                      place_of(loss.identity), loss.long_sent)};
}

} // namespace

Findings check_loss(const LaboratoryView& view) {
  Findings findings;
  for (const LinkLoss& loss : view.losses) {
    findings.push_back(finding_of(loss, view.own.host));
    if (drops_long_packets(loss)) {
      findings.push_back(about_long_packets(loss));
    }
  }
  if (findings.empty()) {
    findings.push_back(
        {Severity::ok, "loss", "not measured: no service answers that probes could be sent to"});
  }
  return findings;
}

} // namespace dyncal::inline checks::doctor
