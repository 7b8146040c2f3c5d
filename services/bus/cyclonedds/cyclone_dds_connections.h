// The connections through which a domain of Cyclone DDS 0.10 receives: discovery and data, by
// multicast and to the host alone. Several may be the same one, and NULL where there is none. And
// the IPv4 addresses that it announces, in the order of the network.
//
// In C, since the library's header of a domain is no C++. Any thread, after the domain was opened.
#ifndef DYNCAL_SERVICES_BUS_CYCLONEDDS_CYCLONE_DDS_CONNECTIONS_H
#define DYNCAL_SERVICES_BUS_CYCLONEDDS_CYCLONE_DDS_CONNECTIONS_H

struct ddsi_domaingv;
struct ddsi_tran_conn;

struct CycloneDdsConnections {
  struct ddsi_tran_conn* receiving[4];
};

enum { max_cyclone_dds_addresses = 8 };
struct CycloneDdsAddresses {
  int count;
  unsigned char ipv4[max_cyclone_dds_addresses][4];
};

#ifdef __cplusplus
extern "C"
#endif
    struct CycloneDdsConnections
    cyclone_dds_connections_of(const struct ddsi_domaingv* domain);
#ifdef __cplusplus
extern "C"
#endif
    struct CycloneDdsAddresses
    cyclone_dds_addresses_of(const struct ddsi_domaingv* domain);

#endif
