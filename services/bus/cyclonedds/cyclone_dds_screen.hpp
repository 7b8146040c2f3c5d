// Looks at what comes from the network before Cyclone DDS reads it (rtps/message_check.hpp); what
// is refused is a lost packet to it.
//
// Cyclone DDS 0.10 has no place for that. Its connections read through a function each, which is
// replaced here by one that calls it and checks what it gave. A domain has up to four connections
// and makes none later. They are found through the domain of a registered type.
//
// One object a domain; it outlives the domain's threads. install() may be called by any thread, and
// again: the second call does nothing.
#pragma once

#include <memory>

struct ddsi_domaingv;

namespace dyncal::bus {

class RefusedPackets;

class CycloneDdsScreen {
public:
  explicit CycloneDdsScreen(std::shared_ptr<RefusedPackets> refused);
  CycloneDdsScreen(const CycloneDdsScreen&) = delete;
  CycloneDdsScreen& operator=(const CycloneDdsScreen&) = delete;
  ~CycloneDdsScreen();

  void install(const ddsi_domaingv& domain);

private:
  class Connections;
  std::unique_ptr<Connections> connections_;
};

} // namespace dyncal::bus
