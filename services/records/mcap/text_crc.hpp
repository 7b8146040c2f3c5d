// CRCs of records that the format has none for, as texts where it lets writers put texts: metadata
// vouch for themselves by an entry, a channel (which stands in chunks) for its schema.
//
// Plain functions, any thread.
#pragma once

#include <string>

#include "services/records/mcap/mcap_record.hpp"

namespace dyncal::inline records::recording {

inline constexpr const char* metadata_crc_key = "crc32";
inline constexpr const char* schema_crc_key = "dyncal.schema_crc32";

// Of all entries but that of its own name.
[[nodiscard]] std::string metadata_crc(const Metadata& metadata);
[[nodiscard]] std::string schema_crc(const Schema& schema);

} // namespace dyncal::inline records::recording
