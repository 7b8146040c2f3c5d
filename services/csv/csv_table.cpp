#include "services/csv/csv_table.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fcntl.h>
#include <limits>
#include <sys/mman.h>
#include <sys/stat.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

namespace dyncal::services {
namespace {

constexpr std::size_t bytes_a_thread = std::size_t{1} << 20;
constexpr std::size_t longest_quote = 40;

tl::unexpected<Error> bad_file(std::string message) {
  return tl::unexpected(Error{ErrorCode::bad_file, std::move(message)});
}

// A file in memory, read only.
class MappedFile {
public:
  static Expected<MappedFile> open(const std::filesystem::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return bad_file(path.string() + ": " + std::generic_category().message(errno));
    MappedFile file;
    struct stat status {};
    const bool regular = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
    if (regular && status.st_size > 0) {
      file.size_ = static_cast<std::size_t>(status.st_size);
      file.data_ = ::mmap(nullptr, file.size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
    }
    ::close(descriptor);
    if (!regular) return bad_file(path.string() + ": not a regular file");
    if (file.data_ == MAP_FAILED) return bad_file(path.string() + ": cannot be mapped into memory");
    if (file.data_) ::madvise(file.data_, file.size_, MADV_SEQUENTIAL);
    return file;
  }
  MappedFile(MappedFile&& other) noexcept : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  MappedFile& operator=(MappedFile&&) = delete;
  ~MappedFile() {
    if (data_ && data_ != MAP_FAILED) ::munmap(data_, size_);
  }
  [[nodiscard]] std::string_view text() const { return {static_cast<const char*>(data_), size_}; }

private:
  MappedFile() = default;
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

std::string in_quotes(std::string_view field) {
  return "'" + std::string(field.substr(0, longest_quote)) + "'";
}

// Whole lines of the file, for one thread.
struct Part {
  std::string_view text;
  std::size_t first_row = 0;
  std::size_t rows = 0;
  std::size_t failed_row = std::numeric_limits<std::size_t>::max(); // of the file
  std::string problem;
};

void count_rows(Part& part) {
  const auto ends = std::count(part.text.begin(), part.text.end(), '\n');
  part.rows = static_cast<std::size_t>(ends) + (part.text.ends_with('\n') ? 0 : 1);
}

} // namespace

class CsvParser {
public:
  CsvParser(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {}

  Expected<CsvTable> parse(unsigned threads);

private:
  Expected<void> read_header();
  void split(unsigned threads);
  template <class Work>
  void for_each_part(Work work);
  void parse_part(Part& part);
  const char* parse_row(const char* at, const char* end, std::size_t row, std::string& problem);
  [[nodiscard]] tl::unexpected<Error> at_line(std::size_t line, const std::string& problem) const {
    return bad_file(name_ + ":" + std::to_string(line) + ": " + problem);
  }

  std::string_view text_; // after read_header(): the rows
  std::string name_;
  char separator_ = ',';
  std::size_t time_column_ = 0;
  std::size_t fields_ = 0;
  std::vector<double*> targets_; // a field; the time column has none
  std::vector<Part> parts_;
  CsvTable table_;
};

Expected<void> CsvParser::read_header() {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text_.starts_with(byte_order_mark)) text_.remove_prefix(byte_order_mark.size());
  const std::size_t line_end = text_.find('\n');
  std::string_view line = text_.substr(0, line_end);
  text_.remove_prefix(line_end == std::string_view::npos ? text_.size() : line_end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  for (const char candidate : {',', ';', '\t'}) {
    if (line.find(candidate) != std::string_view::npos) {
      separator_ = candidate;
      break;
    }
  }
  bool has_time = false;
  for (std::size_t begin = 0; begin <= line.size(); ++fields_) {
    const std::size_t end = std::min(line.find(separator_, begin), line.size());
    const std::string_view name = line.substr(begin, end - begin);
    begin = end + 1;
    if (name.empty()) return at_line(1, "column " + std::to_string(fields_ + 1) + " has no name; the first line must name the columns");
    if (name == "t_ns") {
      if (has_time) return at_line(1, "there are two columns 't_ns'");
      has_time = true;
      time_column_ = fields_;
    } else if (table_.find(name)) {
      return at_line(1, "there are two columns " + in_quotes(name));
    } else {
      table_.names_.emplace_back(name);
    }
  }
  if (!has_time) return at_line(1, "there is no column 't_ns' with the time in nanoseconds");
  return {};
}

// Cuts at line ends, about equally.
void CsvParser::split(unsigned threads) {
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t count = std::clamp<std::size_t>(text_.size() / bytes_a_thread, 1, threads);
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= count && begin < text_.size(); ++i) {
    std::size_t end = i == count ? text_.size() : std::max(begin, text_.size() * i / count);
    if (end < text_.size()) end = std::min(text_.find('\n', end), text_.size() - 1) + 1;
    parts_.push_back({text_.substr(begin, end - begin), 0, 0, std::numeric_limits<std::size_t>::max(), {}});
    begin = end;
  }
}

template <class Work>
void CsvParser::for_each_part(Work work) {
  std::vector<std::jthread> threads;
  for (std::size_t i = 1; i < parts_.size(); ++i)
    threads.emplace_back([&, i] { work(parts_[i]); });
  if (!parts_.empty()) work(parts_[0]);
}

Expected<CsvTable> CsvParser::parse(unsigned threads) {
  if (const auto header = read_header(); !header) return tl::unexpected(header.error());
  while (text_.ends_with('\n') && (text_.size() == 1 || text_[text_.size() - 2] == '\n'))
    text_.remove_suffix(1); // empty last lines
  split(threads);
  for_each_part(count_rows);
  for (Part& part : parts_) {
    part.first_row = table_.rows_;
    table_.rows_ += part.rows;
  }
  table_.stamps_ns_ = std::make_unique_for_overwrite<std::int64_t[]>(table_.rows_);
  for (std::size_t field = 0; field < fields_; ++field) {
    if (field == time_column_) {
      targets_.push_back(nullptr);
      continue;
    }
    table_.columns_.push_back(std::make_unique_for_overwrite<double[]>(table_.rows_));
    targets_.push_back(table_.columns_.back().get());
  }
  for_each_part([this](Part& part) { parse_part(part); });
  const auto failed =
      std::min_element(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) { return a.failed_row < b.failed_row; });
  if (failed != parts_.end() && !failed->problem.empty()) return at_line(failed->failed_row + 2, failed->problem);
  return std::move(table_);
}

void CsvParser::parse_part(Part& part) {
  const char* at = part.text.data();
  const char* const end = at + part.text.size();
  for (std::size_t row = part.first_row; at < end; ++row) {
    at = parse_row(at, end, row, part.problem);
    if (!at) {
      part.failed_row = row;
      return;
    }
  }
}

// The line after this one, or nullptr with the problem said.
const char* CsvParser::parse_row(const char* at, const char* end, std::size_t row, std::string& problem) {
  for (std::size_t field = 0; field < fields_; ++field) {
    const char* const begin = at;
    std::errc error{};
    if (field == time_column_) {
      const auto [next, result] = std::from_chars(at, end, table_.stamps_ns_[row]);
      at = next;
      error = result;
    } else if (at == end || *at == separator_ || *at == '\n' || *at == '\r') {
      targets_[field][row] = std::numeric_limits<double>::quiet_NaN();
    } else {
      const auto [next, result] = std::from_chars(at, end, targets_[field][row]);
      at = next;
      error = result;
    }
    const bool last = field + 1 == fields_;
    const bool line_ends = at == end || *at == '\n' || (*at == '\r' && (at + 1 == end || at[1] == '\n'));
    if (error == std::errc{} && last && line_ends) break;
    if (error == std::errc{} && !last && at != end && *at == separator_) {
      ++at;
      continue;
    }
    const char* stop = begin;
    while (stop != end && *stop != separator_ && *stop != '\n' && *stop != '\r')
      ++stop;
    const std::string_view text(begin, static_cast<std::size_t>(stop - begin));
    const std::string which = field == time_column_ ? "'t_ns'" : in_quotes(table_.names_[field - (field > time_column_ ? 1 : 0)]);
    if (error == std::errc::result_out_of_range) {
      problem = in_quotes(text) + " is too large for column " + which;
    } else if (error != std::errc{} || at != stop) {
      problem = in_quotes(text) + (field == time_column_ ? " is not an integer" : " is not a number") + " (column " + which + ")";
    } else {
      problem = std::string(last ? "more" : "fewer") + " than the " + std::to_string(fields_) + " fields that the first line names";
    }
    return nullptr;
  }
  if (at != end && *at == '\r') ++at;
  return at == end ? at : at + 1;
}

std::optional<std::size_t> CsvTable::find(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names_.begin());
}

Expected<CsvTable> parse_csv(std::string_view text, const std::string& name, unsigned threads) {
  return CsvParser(text, name).parse(threads);
}

Expected<CsvTable> read_csv(const std::filesystem::path& path, unsigned threads) {
  const auto file = MappedFile::open(path);
  if (!file) return tl::unexpected(file.error());
  return parse_csv(file->text(), path.string(), threads);
}

} // namespace dyncal::services
