// How the records of a chunk are made smaller, and large again: as they are, or zstd where the
// build has it. LZ4 frames of others are read where the build has liblz4.
//
// `size` comes from the file: it is bounded before memory is taken. Plain functions, any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "services/base/error.hpp"

namespace dyncal::inline records::recording {

enum class Compression { none, zstd };

// "none" or "zstd". Fails (bad_argument) on another name, and on zstd where the build has none.
[[nodiscard]] base::Expected<Compression> parse_compression(const std::string& name);
// As the file spells it: "" or "zstd".
[[nodiscard]] const char* to_string(Compression compression);

// Empty if it does not become smaller, or cannot be done.
[[nodiscard]] std::string compress(std::string_view records, Compression compression);

// More than any chunk of ours has; a foreign file with larger ones is not read.
inline constexpr std::uint64_t max_chunk_bytes = std::uint64_t{256} << 20U;
inline constexpr std::uint64_t max_record_bytes = 2 * max_chunk_bytes; // longer ones are not read

// Whether this build can uncompress it: where it cannot, nothing is known of the bytes.
[[nodiscard]] bool knows_compression(const std::string& compression);

// Fails (bad_file) with a part of a sentence: what is wrong with the bytes.
[[nodiscard]] base::Expected<std::string>
uncompress(std::string_view bytes, const std::string& compression, std::uint64_t size);

} // namespace dyncal::inline records::recording
