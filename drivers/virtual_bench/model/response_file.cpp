#include "drivers/virtual_bench/model/response_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr std::array<std::string_view, 3> names{"frequency_hz", "magnitude", "phase_rad"};
constexpr const char* names_line = "frequency_hz,magnitude,phase_rad";

using Row = std::array<double, names.size()>;

struct Columns {
  std::vector<double> frequency_hz;
  std::vector<double> magnitude;
  std::vector<double> phase_rad;
};

std::string_view without_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.push_back(without_blanks(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return fields;
}

class Reader {
public:
  explicit Reader(const std::filesystem::path& path) : path_(path) {}

  Expected<Columns> read() {
    std::ifstream stream(path_);
    if (!stream) {
      return fail(ErrorCode::not_found, path_.string() + ": cannot be read");
    }
    bool named = false;
    for (std::string text; std::getline(stream, text);) {
      ++line_;
      const std::string_view line = without_blanks(text);
      if (line.empty() || line.front() == '#') {
        continue;
      }
      DYNCAL_TRY(named ? take_row(fields_of(line)) : check_names(fields_of(line)));
      named = true;
    }
    if (columns_.frequency_hz.size() < 2) {
      return malformed("a response needs a line \"" + std::string(names_line) +
                       "\" and at least two frequencies");
    }
    return std::move(columns_);
  }

private:
  [[nodiscard]] tl::unexpected<Error> malformed(const std::string& what) const {
    return fail(ErrorCode::malformed,
                path_.string() + ", line " + std::to_string(line_) + ": " + what);
  }

  [[nodiscard]] Expected<void> check_names(const std::vector<std::string_view>& fields) const {
    if (!std::equal(fields.begin(), fields.end(), names.begin(), names.end())) {
      return malformed("the first line must name the columns: " + std::string(names_line));
    }
    return {};
  }

  Expected<void> take_row(const std::vector<std::string_view>& fields) {
    if (fields.size() != names.size()) {
      return malformed("has " + std::to_string(fields.size()) +
                       " values, not three: " + names_line);
    }
    Row row{};
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto [end, status] =
          std::from_chars(fields[i].data(), fields[i].data() + fields[i].size(), row[i]);
      if (status != std::errc() || end != fields[i].data() + fields[i].size() ||
          !std::isfinite(row[i])) {
        return malformed(std::string(names[i]) + " \"" + std::string(fields[i]) +
                         "\" is not a number");
      }
    }
    return take(row);
  }

  Expected<void> take(const Row& row) {
    const auto [frequency_hz, magnitude, phase_rad] = row;
    const double before_hz = columns_.frequency_hz.empty() ? 0.0 : columns_.frequency_hz.back();
    if (!(frequency_hz > before_hz)) {
      return malformed("frequency_hz must be above 0 and rise from line to line");
    }
    if (!(magnitude > 0.0)) {
      return malformed("magnitude must be above 0; turn the phase by pi for an axis that points "
                       "the other way");
    }
    const double last_rad = columns_.phase_rad.empty() ? phase_rad : columns_.phase_rad.back();
    columns_.frequency_hz.push_back(frequency_hz);
    columns_.magnitude.push_back(magnitude);
    columns_.phase_rad.push_back(last_rad + std::remainder(phase_rad - last_rad, two_pi));
    return {};
  }

  std::filesystem::path path_;
  std::size_t line_ = 0;
  Columns columns_;
};

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

// Slope of the straight line through the phase, as a delay; a phase that leads ever more has none.
double delay_of(const Columns& columns) {
  const double mean_hz = mean(columns.frequency_hz);
  const double mean_rad = mean(columns.phase_rad);
  double product = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < columns.frequency_hz.size(); ++i) {
    const double from_mean_hz = columns.frequency_hz[i] - mean_hz;
    product += from_mean_hz * (columns.phase_rad[i] - mean_rad);
    square += from_mean_hz * from_mean_hz;
  }
  return std::max(0.0, -product / square / two_pi);
}

} // namespace

Expected<ResponseTable> read_response_file(const std::filesystem::path& path) {
  DYNCAL_TRY(auto columns, Reader(path).read());
  ResponseTable table;
  table.first_hz = columns.frequency_hz.front();
  table.last_hz = columns.frequency_hz.back();
  table.largest_magnitude = *std::max_element(columns.magnitude.begin(), columns.magnitude.end());
  table.response.delay_s = delay_of(columns);
  std::vector<double> residual_rad;
  for (std::size_t i = 0; i < columns.frequency_hz.size(); ++i) {
    residual_rad.push_back(columns.phase_rad[i] +
                           two_pi * columns.frequency_hz[i] * table.response.delay_s);
  }
  table.response.residual_phase_rad = PchipTable(columns.frequency_hz, std::move(residual_rad));
  table.response.magnitude =
      PchipTable(std::move(columns.frequency_hz), std::move(columns.magnitude));
  return table;
}

} // namespace dyncal::drivers::virtual_bench
