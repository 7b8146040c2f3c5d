#include "drivers/files/tdms/tdms_raw_data.hpp"

#include <algorithm>
#include <utility>

namespace dyncal::drivers::files {
namespace {

using Outcome = tl::expected<void, std::string>;
using Problem = tl::unexpected<std::string>;
using Channels = std::vector<TdmsPlacedChannel>;

// Values of one channel, or of one scaler of it, in a chunk.
struct Part {
  TdmsPlacedChannel of;
  TdmsScaler scaler;
  std::uint64_t values = 0;
  std::uint64_t offset = 0; // of its first value, from the start of its block
  std::uint64_t stride = 0;
  std::size_t block = 0; // of the chunk: a channel's, or a buffer of DAQmx
};

// Rows of one width, one after the other.
struct Block {
  std::uint64_t rows = 0;
  std::uint64_t row_bytes = 0;
};

struct Chunk {
  std::vector<Block> blocks;
  std::vector<Part> parts;
  bool is_daqmx = false;
};

Problem too_large() {
  return Problem("states more values than any file holds; the file is damaged");
}

Problem no_channel() {
  return Problem("has raw data of no channel; the file is damaged");
}

tl::expected<std::uint64_t, std::string> bytes_of(const std::vector<Block>& blocks) {
  std::uint64_t bytes = 0;
  for (const Block& block : blocks) {
    std::uint64_t of_block = 0;
    if (__builtin_mul_overflow(block.rows, block.row_bytes, &of_block) ||
        __builtin_add_overflow(bytes, of_block, &bytes)) {
      return too_large();
    }
  }
  return bytes;
}

TdmsScaler own_values(const TdmsIndex& index) {
  return {.id = tdms_raw_input, .type = index.type};
}

Chunk contiguous(const Channels& channels) {
  Chunk chunk;
  for (const TdmsPlacedChannel& one : channels) {
    const std::uint64_t size = *size_of(one.index->type);
    chunk.parts.push_back(
        {one, own_values(*one.index), one.index->values, 0, size, chunk.blocks.size()});
    // Texts are passed over as a whole.
    chunk.blocks.push_back(size == 0 ? Block{1, one.index->bytes} : Block{one.index->values, size});
  }
  return chunk;
}

tl::expected<Chunk, std::string> row_after_row(const Channels& channels) {
  Chunk chunk;
  Block rows;
  for (const TdmsPlacedChannel& one : channels) {
    const std::uint64_t size = *size_of(one.index->type);
    if (size == 0 || one.index->values != channels.front().index->values) {
      return Problem("has rows of channels that are not of one length, or of texts");
    }
    chunk.parts.push_back({one, own_values(*one.index), one.index->values, rows.row_bytes, 0, 0});
    rows.row_bytes += size;
  }
  for (Part& part : chunk.parts) {
    part.stride = rows.row_bytes;
  }
  rows.rows = channels.front().index->values;
  chunk.blocks.push_back(rows);
  return chunk;
}

tl::expected<Chunk, std::string> of_daqmx(const Channels& channels) {
  Chunk chunk;
  chunk.is_daqmx = true;
  const std::vector<std::uint32_t>& row_bytes = channels.front().index->row_bytes;
  for (const std::uint32_t bytes : row_bytes) {
    chunk.blocks.push_back({0, bytes});
  }
  for (const TdmsPlacedChannel& one : channels) {
    if (!one.index->is_daqmx || one.index->row_bytes != row_bytes) {
      return Problem("has raw data of DAQmx whose channels do not agree on the buffers");
    }
    for (const TdmsScaler& scaler : one.index->scalers) {
      Block& buffer = chunk.blocks[scaler.buffer];
      buffer.rows = std::max(buffer.rows, one.index->values);
      chunk.parts.push_back(
          {one, scaler, one.index->values, scaler.byte_in_row, buffer.row_bytes, scaler.buffer});
    }
  }
  return chunk;
}

// Values of `part` in chunks that begin at `place`.
void add(const Part& part, const TdmsRawData& data, std::uint64_t place, std::uint64_t values,
         std::uint64_t chunks, std::uint64_t chunk_bytes) {
  const std::uint64_t size = *size_of(part.scaler.type);
  if (size == 0 || values == 0 || chunks == 0) {
    return;
  }
  const bool is_line = part.scaler.bit >= 0;
  TdmsChannel& channel = *part.of.channel;
  auto& stretches = channel.data[part.scaler.id];
  stretches.push_back({.type = is_line ? TdmsType::u8 : part.scaler.type,
                       .big_endian = data.big_endian,
                       .bit = part.scaler.bit,
                       .place = place + part.offset,
                       .stride = part.stride,
                       .values = values,
                       .chunks = chunks,
                       .chunk_bytes = chunk_bytes});
  if (is_line && data.big_endian) {
    stretches.back().place += size - 1; // the lowest byte has the bit
  }
  if (&stretches == &channel.data.begin()->second) { // its scalers have as many each
    channel.values += values * chunks;
  }
}

// Rows of one width that all are there need no chunks.
void join_chunks(Chunk& chunk, const TdmsRawData& data) {
  Block& block = chunk.blocks.front();
  const bool all_rows = std::all_of(chunk.parts.begin(), chunk.parts.end(),
                                    [&](const Part& part) { return part.values == block.rows; });
  if (chunk.blocks.size() > 1 || !all_rows) {
    return;
  }
  block.rows = data.bytes / block.row_bytes;
  for (Part& part : chunk.parts) {
    part.values = block.rows;
  }
}

// Rows of each block in what is left behind the last whole chunk. In a closed segment every block
// is shortened alike; in one that was never closed the first ones are whole, and what not all
// channels have is dropped.
tl::expected<std::vector<Block>, std::string> shortened(const Chunk& chunk, std::uint64_t left,
                                                        std::uint64_t chunk_bytes, bool closed) {
  __extension__ using Wide = unsigned __int128;
  std::vector<Block> blocks = chunk.blocks;
  std::uint64_t used = 0;
  for (Block& block : blocks) {
    const std::uint64_t rows = block.row_bytes == 0 ? 0 : (left - used) / block.row_bytes;
    block.rows = closed ? static_cast<std::uint64_t>(Wide{block.rows} * left / chunk_bytes)
                        : std::min(block.rows, rows);
    used += block.rows * block.row_bytes;
  }
  if (closed && (used != left || (chunk.is_daqmx && blocks.size() > 1 && left > 0))) {
    return Problem("has raw data that end within a row; the file is damaged");
  }
  return blocks;
}

// Where each block begins.
std::vector<std::uint64_t> places_of(const std::vector<Block>& blocks, std::uint64_t place) {
  std::vector<std::uint64_t> places;
  for (const Block& block : blocks) {
    places.push_back(place);
    place += block.rows * block.row_bytes;
  }
  return places;
}

Outcome place_chunks(Chunk chunk, const TdmsRawData& data) {
  auto chunk_bytes = bytes_of(chunk.blocks);
  if (chunk_bytes && *chunk_bytes == 0) {
    return data.bytes == 0 ? Outcome() : no_channel();
  }
  if (chunk_bytes) {
    join_chunks(chunk, data);
    chunk_bytes = bytes_of(chunk.blocks);
  }
  if (!chunk_bytes) {
    return Problem(chunk_bytes.error());
  }
  const std::uint64_t chunks = *chunk_bytes == 0 ? 0 : data.bytes / *chunk_bytes;
  const std::uint64_t left = data.bytes - chunks * *chunk_bytes;
  const auto last = shortened(chunk, left, std::max<std::uint64_t>(*chunk_bytes, 1), data.closed);
  if (!last) {
    return Problem(last.error());
  }
  std::uint64_t rows_of_all = ~std::uint64_t{0};
  bool same_length = true;
  for (std::size_t i = 0; i < last->size(); ++i) {
    rows_of_all = std::min(rows_of_all, (*last)[i].rows);
    same_length = same_length && chunk.blocks[i].rows == chunk.blocks.front().rows;
  }
  const std::vector<std::uint64_t> places = places_of(chunk.blocks, data.place);
  const std::vector<std::uint64_t> last_places =
      places_of(*last, data.place + chunks * *chunk_bytes);
  for (const Part& part : chunk.parts) {
    add(part, data, places[part.block], part.values, chunks, *chunk_bytes);
    const std::uint64_t rows = data.closed   ? (*last)[part.block].rows
                               : same_length ? rows_of_all
                                             : 0;
    add(part, data, last_places[part.block], std::min(part.values, rows), 1, 0);
  }
  return {};
}

} // namespace

tl::expected<void, std::string> place_tdms_data(const std::vector<TdmsPlacedChannel>& channels,
                                                const TdmsRawData& data) {
  if (channels.empty()) {
    return data.bytes == 0 ? Outcome() : no_channel();
  }
  const bool is_text = channels.size() == 1 && channels.front().index->type == TdmsType::text;
  const bool is_daqmx = std::any_of(channels.begin(), channels.end(),
                                    [](const auto& one) { return one.index->is_daqmx; });
  if (!is_daqmx && (!data.interleaved || is_text)) {
    return place_chunks(contiguous(channels), data);
  }
  auto rows = is_daqmx ? of_daqmx(channels) : row_after_row(channels);
  return rows ? place_chunks(std::move(*rows), data) : Problem(rows.error());
}

} // namespace dyncal::drivers::files
