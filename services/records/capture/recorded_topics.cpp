#include "services/records/capture/recorded_topics.hpp"

#include <algorithm>

#include "services/records/mcap/text_crc.hpp"

namespace dyncal::inline records::recording {
namespace {

template <class T>
const T& first_with_name(const std::vector<T>& all, std::string_view name, std::string T::*member) {
  return *std::find_if(all.begin(), all.end(), [&](const T& one) { return one.*member == name; });
}

std::vector<Schema> make_schemas() {
  std::vector<Schema> schemas;
  for_each_recorded_topic([&]<class T>(const bus::Topic<T>& /*topic*/) {
    const std::string& name = bus::type_support<T>().name;
    const bool known = std::any_of(schemas.begin(), schemas.end(),
                                   [&](const Schema& one) { return one.name == name; });
    if (!known) {
      schemas.push_back({static_cast<std::uint16_t>(schemas.size() + 1), name, "omgidl",
                         std::string(idl_text())});
    }
  });
  return schemas;
}

std::vector<Channel> make_channels() {
  std::vector<Channel> channels;
  for_each_recorded_topic([&]<class T>(const bus::Topic<T>& topic) {
    const Schema& schema =
        first_with_name(recorded_schemas(), bus::type_support<T>().name, &Schema::name);
    channels.push_back({static_cast<std::uint16_t>(channels.size() + 1),
                        schema.id,
                        topic.name,
                        "cdr",
                        {{schema_crc_key, schema_crc(schema)}}});
  });
  return channels;
}

} // namespace

const std::vector<Schema>& recorded_schemas() {
  static const std::vector<Schema> schemas = make_schemas();
  return schemas;
}

const std::vector<Channel>& recorded_channels() {
  static const std::vector<Channel> channels = make_channels();
  return channels;
}

const Channel& channel_of(std::string_view topic) {
  return first_with_name(recorded_channels(), topic, &Channel::topic);
}

} // namespace dyncal::inline records::recording
