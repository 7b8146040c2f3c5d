#include "services/records/mcap/chunk_codec.hpp"

#include <memory>

#include <fmt/core.h>

#ifdef DYNCAL_HAVE_LZ4
#include <lz4frame.h>
#endif
#ifdef DYNCAL_HAVE_ZSTD
#include <zstd.h>
#endif

namespace dyncal::inline records::recording {
namespace {

using base::ErrorCode;
using base::Expected;

#ifdef DYNCAL_HAVE_LZ4
Expected<std::string> uncompress_lz4(std::string_view bytes, std::uint64_t size) {
  LZ4F_dctx* opened = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&opened, LZ4F_VERSION)) != 0) {
    return fail(ErrorCode::bad_file, "there is no memory for its LZ4 frame");
  }
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      opened, LZ4F_freeDecompressionContext);
  std::string records(size, '\0');
  std::size_t written = 0;
  std::size_t wanted = 1; // 0: the frame is complete
  while (wanted != 0) {
    std::size_t room = records.size() - written;
    std::size_t taken = bytes.size();
    wanted = LZ4F_decompress(context.get(), records.data() + written, &room, bytes.data(), &taken,
                             nullptr);
    if (LZ4F_isError(wanted) != 0 || (room == 0 && taken == 0)) {
      return fail(ErrorCode::bad_file, "its LZ4 frame cannot be decompressed");
    }
    written += room;
    bytes.remove_prefix(taken);
  }
  if (written != size) {
    return fail(ErrorCode::bad_file, "its LZ4 frame is not of the size it claims");
  }
  return records;
}
#endif

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

bool knows_compression(const std::string& compression) {
#ifdef DYNCAL_HAVE_LZ4
  const bool is_lz4 = compression == "lz4";
#else
  const bool is_lz4 = false;
#endif
#ifdef DYNCAL_HAVE_ZSTD
  const bool is_zstd = compression == "zstd";
#else
  const bool is_zstd = false;
#endif
  return compression.empty() || is_lz4 || is_zstd;
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
#ifdef DYNCAL_HAVE_LZ4
  if (compression == "lz4") {
    return uncompress_lz4(bytes, size);
  }
#endif
  return fail(ErrorCode::bad_file,
              fmt::format("its compression '{}' is not known to this build", compression));
}

} // namespace dyncal::inline records::recording
