#include "drivers/files/csv_reader.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include "drivers/files/file_channels.hpp"
#include "drivers/files/regular_stamps.hpp"

namespace dyncal::drivers::files {
namespace {

constexpr std::size_t stretch_bytes = std::size_t{1} << 21U;

// Takes the next stretch of whole lines off the front.
std::string_view next_lines(std::string_view& rest) {
  const std::size_t line_end =
      rest.size() > stretch_bytes ? rest.find('\n', stretch_bytes) : std::string_view::npos;
  const std::string_view lines =
      rest.substr(0, line_end == std::string_view::npos ? line_end : line_end + 1);
  rest.remove_prefix(lines.size());
  return lines;
}

} // namespace

Expected<std::unique_ptr<CsvReader>> CsvReader::open(const FileSettings& settings) {
  DYNCAL_TRY(auto file, MappedFile::open(settings.path));
  std::unique_ptr<CsvReader> reader(new CsvReader(settings, std::move(file)));
  DYNCAL_TRY(reader->read_header());
  return reader;
}

tl::unexpected<Error> CsvReader::malformed(std::size_t line, const std::string& problem) const {
  return fail(ErrorCode::malformed,
              settings_.path.string() + ":" + std::to_string(line) + ": " + problem);
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
  bytes_behind_ = file_.text().size() - rest_.size();
  auto layout = CsvLayout::of(line.ends_with('\n') ? line.substr(0, line.size() - 1) : line);
  if (!layout) {
    return malformed(1, layout.error());
  }
  layout_ = std::move(*layout);
  if (!layout_.has_time && !settings_.sample_rate) {
    return fail(ErrorCode::invalid_setting,
                settings_.path.string() +
                    ":1: names no column t_ns, and no sample rate is given (sample_rate_hz of the "
                    "source in a bench file, --nominal-rate of a command); one of them must tell "
                    "the time");
  }
  DYNCAL_TRY(description_, describe_file_channels(settings_, layout_.channels));
  return {};
}

void CsvReader::read_ahead() {
  // Twice as many as can run at once: there is always one to go on with while a finished one waits
  // to be taken.
  const std::size_t stretches = 2 * std::max<std::size_t>(1, std::thread::hardware_concurrency());
  while (ahead_.size() < stretches && !rest_.empty()) {
    const std::string_view lines = next_lines(rest_);
    ahead_.push_back({lines.size(), std::async(std::launch::async, [this, lines] {
                        return read_csv_rows(lines, layout_);
                      })});
  }
}

double CsvReader::share_read() const {
  return static_cast<double>(bytes_behind_) / static_cast<double>(file_.text().size());
}

Expected<bool> CsvReader::next_stretch() {
  while (block_ == rows_.blocks.size()) {
    if (rows_.problem) {
      return malformed(first_line_ + rows_.problem->line, rows_.problem->sentence);
    }
    bytes_behind_ += std::exchange(bytes_of_rows_, 0);
    read_ahead();
    if (ahead_.empty()) {
      return false;
    }
    first_line_ += rows_.lines;
    block_ = 0;
    bytes_of_rows_ = ahead_.front().bytes;
    rows_ = ahead_.front().rows.get();
    ahead_.pop_front();
    read_ahead();
    DYNCAL_TRY(check_numbers());
  }
  return true;
}

Expected<void> CsvReader::check_numbers() {
  if (rows_.blocks.empty() || !layout_.has_number) {
    return {};
  }
  const SampleBlock& first = rows_.blocks.front();
  const SampleBlock& last = rows_.blocks.back();
  if (last_sample_ && first.first_sample <= *last_sample_) {
    return malformed(first_line_, not_rising(first.first_sample, *last_sample_));
  }
  last_sample_ = last.first_sample + last.samples - 1;
  return {};
}

SampleBlock CsvReader::next_piece(std::size_t samples) {
  SampleBlock& whole = rows_.blocks[block_];
  SampleBlock piece;
  if (taken_ == 0 && whole.samples <= samples) {
    piece = std::move(whole);
    ++block_;
    return piece;
  }
  piece.samples = std::min(samples, whole.samples - taken_);
  piece.first_sample = whole.first_sample + taken_;
  if (layout_.has_time) {
    const auto first = whole.stamps_ns.begin() + static_cast<std::ptrdiff_t>(taken_);
    piece.stamps_ns.assign(first, first + static_cast<std::ptrdiff_t>(piece.samples));
  }
  for (std::size_t channel = 0; channel < layout_.channels.size(); ++channel) {
    const auto first =
        whole.values.begin() + static_cast<std::ptrdiff_t>(channel * whole.samples + taken_);
    piece.values.insert(piece.values.end(), first,
                        first + static_cast<std::ptrdiff_t>(piece.samples));
  }
  taken_ += piece.samples;
  if (taken_ == whole.samples) {
    ++block_;
    taken_ = 0;
  }
  return piece;
}

Expected<SampleBlock> CsvReader::read(std::size_t samples) {
  DYNCAL_TRY(const auto more, next_stretch());
  if (!more) {
    return SampleBlock{};
  }
  SampleBlock block = next_piece(samples);
  if (!layout_.has_number) {
    block.first_sample = next_sample_;
  }
  next_sample_ = block.first_sample + block.samples;
  if (layout_.has_time) {
    order_.check(block);
    make_regular(block);
  } else {
    block.clock = settings_.sample_rate->clock(0);
  }
  return block;
}

} // namespace dyncal::drivers::files
