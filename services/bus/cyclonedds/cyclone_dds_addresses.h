// The IPv4 addresses that a domain of Cyclone DDS 0.10 announces, in the order of the network.
//
// In C, since the library's header of a domain is no C++. Any thread, after the domain was opened.
#ifndef DYNCAL_SERVICES_BUS_CYCLONEDDS_CYCLONE_DDS_ADDRESSES_H
#define DYNCAL_SERVICES_BUS_CYCLONEDDS_CYCLONE_DDS_ADDRESSES_H

struct ddsi_domaingv;

enum { max_cyclone_dds_addresses = 8 };
struct CycloneDdsAddresses {
  int count;
  unsigned char ipv4[max_cyclone_dds_addresses][4];
};

#ifdef __cplusplus
extern "C"
#endif
    struct CycloneDdsAddresses
    cyclone_dds_addresses_of(const struct ddsi_domaingv* domain);

#endif
