#include "services/records/mcap/text_crc.hpp"

#include <fmt/core.h>

namespace dyncal::inline records::recording {

std::string metadata_crc(const Metadata& metadata) {
  Metadata others = metadata;
  others.entries.erase(metadata_crc_key);
  std::string record;
  append_metadata(record, others);
  return fmt::format("{:08x}", crc32_of(record));
}

std::string schema_crc(const Schema& schema) {
  std::string record;
  append_schema(record, schema);
  return fmt::format("{:08x}", crc32_of(record));
}

} // namespace dyncal::inline records::recording
