// Cuts the samples of one sensor into blocks: about 50 ms each; a gap, new columns or the end of a
// numbering end a block early, and a slow sensor's block is handed over when time has passed. Where
// a block is cut changes nothing but the cut. One thread at a time; never fails.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/sample_block.hpp"
#include "drivers/smartup/sample_row.hpp"

namespace dyncal::drivers::smartup {

class BlockAssembly {
public:
  explicit BlockAssembly(std::int64_t block_ns) : block_ns_(block_ns) {}

  // The columns of the next block to be handed over, with all that is held for it; a channel of a
  // row that is not among them is left out, a column that a row lacks is NaN.
  void set_columns(Columns columns) { columns_ = columns; }
  [[nodiscard]] Columns columns() const { return columns_; }

  // Adds a row. Returns a block that has become ready by it: the one before when there is a gap, or
  // the one that is full with it. `period_ns` 0: not known, the block is cut by arrival.
  [[nodiscard]] std::optional<SampleBlock> add(const SampleRow& row, double period_ns,
                                               HostTime arrival);

  // The block that has waited for longer than two block durations, or any (`now` absent).
  [[nodiscard]] std::optional<SampleBlock> flush(std::optional<HostTime> now = std::nullopt);

  // Forgets what is held, and says how many samples that were.
  std::size_t discard();
  [[nodiscard]] std::size_t held() const { return rows_.size(); }

private:
  void append(const SampleRow& row, HostTime arrival);
  [[nodiscard]] bool is_full(double period_ns, HostTime arrival) const;
  [[nodiscard]] SampleBlock take();

  const std::int64_t block_ns_;
  Columns columns_;
  std::vector<SampleRow> rows_;
  std::uint64_t next_sample_ = 0; // if there is no gap
  HostTime first_arrival_;
  HostTime last_arrival_;
};

} // namespace dyncal::drivers::smartup
