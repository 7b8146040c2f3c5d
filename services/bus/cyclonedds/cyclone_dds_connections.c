#include "services/bus/cyclonedds/cyclone_dds_connections.h"

#include <dds/ddsi/ddsi_domaingv.h>

struct CycloneDdsConnections cyclone_dds_connections_of(const struct ddsi_domaingv* domain) {
  const struct CycloneDdsConnections connections = {
      {domain->disc_conn_mc, domain->data_conn_mc, domain->disc_conn_uc, domain->data_conn_uc}};
  return connections;
}
