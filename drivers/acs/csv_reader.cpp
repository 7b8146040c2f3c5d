#include "drivers/acs/csv_reader.hpp"

#include <algorithm>
#include <thread>

#include "drivers/acs/file_channels.hpp"
#include "drivers/acs/regular_stamps.hpp"

namespace dyncal::drivers::acs {
namespace {

constexpr std::size_t stretch_bytes = std::size_t{1} << 21U;

// Takes the next stretch of whole lines off the front.
std::string_view next_lines(std::string_view& rest) {
  const std::size_t line_end = rest.size() > stretch_bytes ? rest.find('\n', stretch_bytes) : std::string_view::npos;
  const std::string_view lines = rest.substr(0, line_end == std::string_view::npos ? line_end : line_end + 1);
  rest.remove_prefix(lines.size());
  return lines;
}

} // namespace

Expected<std::unique_ptr<CsvReader>> CsvReader::open(const FileSettings& settings) {
  auto file = MappedFile::open(settings.path);
  if (!file) {
    return tl::unexpected(file.error());
  }
  std::unique_ptr<CsvReader> reader(new CsvReader(settings, std::move(*file)));
  if (auto header = reader->read_header(); !header) {
    return tl::unexpected(header.error());
  }
  return reader;
}

tl::unexpected<Error> CsvReader::malformed(std::size_t line, const std::string& problem) const {
  return tl::unexpected(Error{ErrorCode::malformed, settings_.path.string() + ":" + std::to_string(line) + ": " + problem});
}

Expected<void> CsvReader::read_header() {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (rest_.starts_with(byte_order_mark)) {
    rest_.remove_prefix(byte_order_mark.size());
  }
  if (rest_.empty()) {
    return malformed(1, "the file is empty; its first line must name the columns");
  }
  const std::size_t line_end = std::min(rest_.find('\n'), rest_.size() - 1);
  const std::string_view line = rest_.substr(0, line_end + 1);
  rest_.remove_prefix(line.size());
  auto layout = CsvLayout::of(line.ends_with('\n') ? line.substr(0, line.size() - 1) : line);
  if (!layout) {
    return malformed(1, layout.error());
  }
  layout_ = std::move(*layout);
  if (!layout_.has_time && !settings_.sample_rate) {
    return tl::unexpected(Error{ErrorCode::invalid_setting,
                                settings_.path.string() + ": no column t_ns and no sample_rate_hz; one of them must tell the time"});
  }
  auto described = describe_file_channels(settings_, layout_.channels);
  if (!described) {
    return tl::unexpected(described.error());
  }
  description_ = std::move(*described);
  return {};
}

void CsvReader::read_ahead() {
  const std::size_t threads = std::max(1U, std::thread::hardware_concurrency());
  while (ahead_.size() < threads && !rest_.empty()) {
    ahead_.push_back(std::async(std::launch::async, [this, lines = next_lines(rest_)] { return read_csv_rows(lines, layout_); }));
  }
}

Expected<bool> CsvReader::next_stretch() {
  while (taken_ == rows_.rows) {
    if (rows_.problem) {
      return malformed(first_line_ + rows_.problem->line, rows_.problem->sentence);
    }
    read_ahead();
    if (ahead_.empty()) {
      return false;
    }
    if (rows_.rows > 0 && layout_.has_time) {
      last_stamp_ns_ = rows_.stamps_ns[rows_.rows - 1];
    }
    if (rows_.rows > 0 && layout_.has_number) {
      last_sample_ = rows_.sample_numbers[rows_.rows - 1];
    }
    first_line_ += rows_.lines;
    taken_ = 0;
    rows_ = ahead_.front().get();
    ahead_.pop_front();
    read_ahead();
    if (const auto order = check_order(); !order) {
      return tl::unexpected(order.error());
    }
  }
  return true;
}

Expected<void> CsvReader::check_order() const {
  if (rows_.rows > 0 && last_sample_ && rows_.sample_numbers[0] <= *last_sample_) {
    return malformed(first_line_, not_rising(rows_.sample_numbers[0], *last_sample_));
  }
  if (rows_.rows > 0 && last_stamp_ns_ && rows_.stamps_ns[0] <= *last_stamp_ns_) {
    return malformed(first_line_, not_rising(rows_.stamps_ns[0], *last_stamp_ns_));
  }
  return {};
}

std::size_t CsvReader::without_gap(std::size_t samples) const {
  const std::size_t most = std::min(samples, rows_.rows - taken_);
  if (!layout_.has_number) {
    return most;
  }
  std::size_t n = 1;
  while (n < most && rows_.sample_numbers[taken_ + n] == rows_.sample_numbers[taken_] + n) {
    ++n;
  }
  return n;
}

Expected<SampleBlock> CsvReader::read(std::size_t samples) {
  SampleBlock block;
  const auto more = next_stretch();
  if (!more) {
    return tl::unexpected(more.error());
  }
  if (!*more) {
    return block;
  }
  block.first_sample = layout_.has_number ? rows_.sample_numbers[taken_] : next_sample_;
  block.samples = without_gap(samples);
  block.values.resize(block.samples * layout_.channels.size());
  for (std::size_t channel = 0; channel < layout_.channels.size(); ++channel) {
    std::copy_n(rows_.channel(channel) + taken_, block.samples, block.values.data() + channel * block.samples);
  }
  if (layout_.has_time) {
    const auto first = rows_.stamps_ns.begin() + static_cast<std::ptrdiff_t>(taken_);
    block.stamps_ns.assign(first, first + static_cast<std::ptrdiff_t>(block.samples));
    make_regular(block);
  } else {
    block.clock = settings_.sample_rate->clock(0);
  }
  taken_ += block.samples;
  next_sample_ = block.first_sample + block.samples;
  return block;
}

} // namespace dyncal::drivers::acs
