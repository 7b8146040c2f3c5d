#include "services/bus/cyclonedds/cyclone_dds_discovery.hpp"

#include <array>
#include <functional>
#include <limits>
#include <span>

#include "services/bus/participant_name.hpp"

namespace dyncal::bus {
namespace {

std::string prefix_of(const dds_guid_t& guid) {
  return hexadecimal(guid.v, guid_prefix_bytes);
}

// Hands over every instance of a built-in topic that is still alive.
template <class Sample>
void read_builtin(dds_entity_t participant, dds_entity_t topic,
                  const std::function<void(const Sample&)>& consume) {
  const dds_entity_t reader = dds_create_reader(participant, topic, nullptr, nullptr);
  if (reader < 0) {
    return;
  }
  constexpr std::size_t at_once = 64;
  std::array<void*, at_once> samples{};
  std::array<dds_sample_info_t, at_once> infos{};
  while (true) {
    const dds_return_t count = dds_take(reader, samples.data(), infos.data(), at_once, at_once);
    if (count <= 0) {
      break;
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      if (infos[i].valid_data && infos[i].instance_state == DDS_ALIVE_INSTANCE_STATE) {
        consume(*static_cast<const Sample*>(samples[i]));
      }
    }
    dds_return_loan(reader, samples.data(), count);
  }
  dds_delete(reader);
}

// The first of these that it announces.
std::string property_of(const dds_qos_t* qos, std::span<const char* const> names) {
  for (const char* name : names) {
    char* text = nullptr;
    if (dds_qget_prop(qos, name, &text) && text != nullptr) {
      std::string value(text);
      dds_free(text);
      return value;
    }
  }
  return "";
}

std::string entity_name_of(const dds_qos_t* qos) {
  char* text = nullptr;
  if (!dds_qget_entity_name(qos, &text) || text == nullptr) {
    return "";
  }
  std::string name(text);
  dds_free(text);
  return name;
}

std::vector<std::string> partitions_of(const dds_qos_t* qos) {
  std::vector<std::string> partitions;
  std::uint32_t count = 0;
  char** names = nullptr;
  if (dds_qget_partition(qos, &count, &names)) {
    for (std::uint32_t i = 0; i < count; ++i) {
      partitions.emplace_back(names[i]);
      dds_free(names[i]);
    }
    dds_free(names);
  }
  if (partitions.empty()) {
    partitions.emplace_back();
  }
  return partitions;
}

double seconds(dds_duration_t duration) {
  return duration == DDS_INFINITY ? std::numeric_limits<double>::infinity()
                                  : static_cast<double>(duration) * 1e-9;
}

// What an endpoint does not say has the default.
void add_times(const dds_qos_t* qos, DiscoveredEndpoint& endpoint) {
  dds_duration_t duration = 0;
  if (dds_qget_deadline(qos, &duration)) {
    endpoint.deadline_s = seconds(duration);
  }
  if (dds_qget_latency_budget(qos, &duration)) {
    endpoint.latency_budget_s = seconds(duration);
  }
  dds_liveliness_kind_t liveliness = DDS_LIVELINESS_AUTOMATIC;
  if (dds_qget_liveliness(qos, &liveliness, &duration)) {
    endpoint.liveliness = static_cast<Liveliness>(liveliness);
    endpoint.lease_s = seconds(duration);
  }
}

void add_order(const dds_qos_t* qos, DiscoveredEndpoint& endpoint) {
  dds_ownership_kind_t ownership = DDS_OWNERSHIP_SHARED;
  endpoint.exclusive_ownership =
      dds_qget_ownership(qos, &ownership) && ownership == DDS_OWNERSHIP_EXCLUSIVE;
  dds_presentation_access_scope_kind_t scope = DDS_PRESENTATION_INSTANCE;
  if (dds_qget_presentation(qos, &scope, &endpoint.coherent_access, &endpoint.ordered_access)) {
    endpoint.access_scope = static_cast<AccessScope>(scope);
  }
  dds_destination_order_kind_t order = DDS_DESTINATIONORDER_BY_RECEPTION_TIMESTAMP;
  if (dds_qget_destination_order(qos, &order)) {
    endpoint.destination_order = static_cast<DestinationOrder>(order);
  }
}

void add_representations(const dds_qos_t* qos, DiscoveredEndpoint& endpoint) {
  std::uint32_t count = 0;
  dds_data_representation_id_t* representations = nullptr;
  if (dds_qget_data_representation(qos, &count, &representations)) {
    endpoint.representations.assign(representations, representations + count);
    dds_free(representations);
  }
}

DiscoveredEndpoint endpoint_of(const dds_builtintopic_endpoint_t& sample, EndpointKind kind) {
  DiscoveredEndpoint endpoint{.participant = prefix_of(sample.participant_key),
                              .kind = kind,
                              .topic = sample.topic_name,
                              .type = sample.type_name,
                              .partitions = partitions_of(sample.qos)};
  dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
  endpoint.reliable = dds_qget_reliability(sample.qos, &reliability, nullptr) &&
                      reliability == DDS_RELIABILITY_RELIABLE;
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  endpoint.transient_local =
      dds_qget_durability(sample.qos, &durability) && durability >= DDS_DURABILITY_TRANSIENT_LOCAL;
  add_times(sample.qos, endpoint);
  add_order(sample.qos, endpoint);
  add_representations(sample.qos, endpoint);
  return endpoint;
}

} // namespace

Discovery discovered_by_cyclone_dds(dds_entity_t participant) {
  dds_guid_t guid{};
  dds_get_guid(participant, &guid);
  const std::string own = prefix_of(guid);
  Discovery discovery;
  read_builtin<dds_builtintopic_participant_t>(
      participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT,
      [&](const dds_builtintopic_participant_t& sample) {
        const std::string id = prefix_of(sample.key);
        if (id != own) {
          discovery.participants.push_back(
              {id,
               participant_name(entity_name_of(sample.qos), property_of(sample.qos, process_keys),
                                property_of(sample.qos, host_keys)),
               vendor_of(id)});
        }
      });
  const auto add = [&](EndpointKind kind) {
    return [&discovery, &own, kind](const dds_builtintopic_endpoint_t& sample) {
      if (prefix_of(sample.participant_key) != own) {
        discovery.endpoints.push_back(endpoint_of(sample, kind));
      }
    };
  };
  read_builtin<dds_builtintopic_endpoint_t>(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION,
                                            add(EndpointKind::writer));
  read_builtin<dds_builtintopic_endpoint_t>(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION,
                                            add(EndpointKind::reader));
  return discovery;
}

} // namespace dyncal::bus
