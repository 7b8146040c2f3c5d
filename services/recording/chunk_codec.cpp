#include "services/recording/chunk_codec.hpp"

#include <fmt/core.h>

#ifdef DYNCAL_HAVE_ZSTD
#include <zstd.h>
#endif

namespace dyncal::recording {
namespace {

using services::ErrorCode;
using services::Expected;

} // namespace

Expected<Compression> parse_compression(const std::string& name) {
  if (name == "none") {
    return Compression::none;
  }
  if (name != "zstd") {
    return fail(ErrorCode::bad_argument,
                fmt::format("unknown compression '{}'; use none or zstd", name));
  }
#ifdef DYNCAL_HAVE_ZSTD
  return Compression::zstd;
#else
  return fail(ErrorCode::bad_argument,
              "this build has no zstd (Debian: libzstd-dev); record without compression");
#endif
}

const char* to_string(Compression compression) {
  return compression == Compression::zstd ? "zstd" : "";
}

std::string compress([[maybe_unused]] std::string_view records,
                     [[maybe_unused]] Compression compression) {
#ifdef DYNCAL_HAVE_ZSTD
  if (compression == Compression::zstd) {
    std::string smaller(ZSTD_compressBound(records.size()), '\0');
    const std::size_t size =
        ZSTD_compress(smaller.data(), smaller.size(), records.data(), records.size(), 1);
    if (ZSTD_isError(size) == 0 && size < records.size()) {
      smaller.resize(size);
      return smaller;
    }
  }
#endif
  return {};
}

Expected<std::string> uncompress(std::string_view bytes, const std::string& compression,
                                 std::uint64_t size) {
  if (size > max_chunk_bytes) {
    return fail(ErrorCode::bad_file, fmt::format("it claims to hold {} bytes", size));
  }
  if (compression.empty()) {
    if (bytes.size() != size) {
      return fail(ErrorCode::bad_file,
                  fmt::format("it holds {} bytes and claims {}", bytes.size(), size));
    }
    return std::string(bytes);
  }
#ifdef DYNCAL_HAVE_ZSTD
  if (compression == "zstd") {
    const auto known = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
    if (known == ZSTD_CONTENTSIZE_ERROR || (known != ZSTD_CONTENTSIZE_UNKNOWN && known != size)) {
      return fail(ErrorCode::bad_file, "its zstd frame is not of the size it claims");
    }
    std::string records(size, '\0');
    if (ZSTD_decompress(records.data(), records.size(), bytes.data(), bytes.size()) != size) {
      return fail(ErrorCode::bad_file, "its zstd frame cannot be decompressed");
    }
    return records;
  }
#endif
  return fail(ErrorCode::bad_file,
              fmt::format("its compression '{}' is not known to this build", compression));
}

} // namespace dyncal::recording
