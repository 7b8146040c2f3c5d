#include <fmt/core.h>

#include "services/doctor/checks.hpp"

namespace dyncal::services::doctor {
namespace {

constexpr double notable_part = 0.01;

std::string place_of(const ProgramIdentity& identity) {
  return fmt::format("{}:{} on {}", identity.program, identity.process_id, identity.host);
}

std::string direction_text(const Way& way) {
  const auto lost = lost_part(way);
  return lost ? fmt::format("{:.1f} % of {} lost", *lost * 100.0, way.sent) : "not measured";
}

bool is_notable(const Way& way) {
  return lost_part(way).value_or(0.0) > notable_part;
}

bool is_cut(const Way& way) {
  return lost_part(way) == 1.0;
}

// Where packets of reliable topics get through, and so the program was heard, but no probe does.
std::string why_cut() {
  return "none gets through, although answers that are sent again until they arrive do: nearly all "
         "packets are lost, or a firewall or a limit of packets a second lets few through";
}

std::string advice(const LinkLoss& loss, const std::string& own_host) {
  const std::string& other = loss.identity.host;
  const bool there = is_notable(loss.there);
  const std::string receiver = there && is_notable(loss.back) ? "both hosts"
                               : there                        ? other
                                                              : own_host;
  const std::string within =
      other == own_host
          ? ""
          : "look at cables and switch ports on the way (`ethtool -S`: errors, half duplex), avoid "
            "WLAN, see whether the link is full or limited (`tc -s qdisc`), and ";
  return fmt::format("DDS sends again what is lost, which delays samples and results: {}look "
                     "whether packets found no room on {} (`nstat -az UdpRcvbufErrors`; 'buffers' "
                     "tells of this host)",
                     within, receiver);
}

Finding finding_of(const LinkLoss& loss, const std::string& own_host) {
  const std::string place = place_of(loss.identity);
  if (!loss.answers_probes) {
    return {Severity::ok, "loss",
            fmt::format("{}: not measured, for it answers no probes; an older version does not",
                        place)};
  }
  if (!lost_part(loss.there)) {
    return {Severity::ok, "loss",
            fmt::format("{}: not measured, for only {} probes were sent; look for longer "
                        "(--seconds)",
                        place, loss.there.sent)};
  }
  const std::string measured = fmt::format("{}: probes there {}, echoes back {}", place,
                                           direction_text(loss.there), direction_text(loss.back));
  if (is_cut(loss.there) || is_cut(loss.back)) {
    return {Severity::warning, "loss",
            fmt::format("{}; {}; {}", measured, why_cut(), advice(loss, own_host))};
  }
  if (is_notable(loss.there) || is_notable(loss.back)) {
    return {Severity::warning, "loss", fmt::format("{}; {}", measured, advice(loss, own_host))};
  }
  return {Severity::ok, "loss", measured};
}

} // namespace

Findings check_loss(const LaboratoryView& view) {
  Findings findings;
  for (const LinkLoss& loss : view.losses) {
    findings.push_back(finding_of(loss, view.own.host));
  }
  if (findings.empty()) {
    findings.push_back(
        {Severity::ok, "loss", "not measured: no service answers that probes could be sent to"});
  }
  return findings;
}

} // namespace dyncal::services::doctor
