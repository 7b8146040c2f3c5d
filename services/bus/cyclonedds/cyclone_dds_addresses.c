#include "services/bus/cyclonedds/cyclone_dds_addresses.h"

#include <string.h>

#include <dds/ddsi/ddsi_domaingv.h>

struct CycloneDdsAddresses cyclone_dds_addresses_of(const struct ddsi_domaingv* domain) {
  struct CycloneDdsAddresses addresses = {0, {{0}}};
  for (int i = 0; i < domain->n_interfaces && addresses.count < max_cyclone_dds_addresses; ++i) {
    const ddsi_locator_t* own = &domain->interfaces[i].loc;
    if (own->kind == NN_LOCATOR_KIND_UDPv4) { /* its address is the end of 16 bytes */
      memcpy(addresses.ipv4[addresses.count++], own->address + 12, 4);
    }
  }
  return addresses;
}
