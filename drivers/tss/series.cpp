#include "drivers/tss/series.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "analysis/base/text.hpp"
#include "drivers/link/scpi_answer.hpp"

namespace dyncal::drivers::tss {
namespace {

static_assert(std::endian::native == std::endian::little, "values are taken over as they come");

constexpr std::size_t max_samples = 50'000'000;
constexpr std::size_t max_channels = 64;

tl::unexpected<Error> malformed(const std::string& message) {
  return fail(ErrorCode::malformed, message);
}

std::size_t bytes_of(ValueForm form) {
  switch (form) {
  case ValueForm::int16:
    return 2;
  case ValueForm::int32:
  case ValueForm::float32:
    return 4;
  case ValueForm::float64:
    break;
  }
  return 8;
}

template <class Number>
double number_at(const char* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

double value_at(ValueForm form, const char* bytes) {
  switch (form) {
  case ValueForm::int16:
    return number_at<std::int16_t>(bytes);
  case ValueForm::int32:
    return number_at<std::int32_t>(bytes);
  case ValueForm::float32:
    return number_at<float>(bytes);
  case ValueForm::float64:
    break;
  }
  return number_at<double>(bytes);
}

std::optional<ValueForm> form_by_name(const std::string& name) {
  static const std::map<std::string, ValueForm> forms = {{"int16", ValueForm::int16},
                                                         {"int32", ValueForm::int32},
                                                         {"float32", ValueForm::float32},
                                                         {"float64", ValueForm::float64}};
  const auto found = forms.find(name);
  return found == forms.end() ? std::nullopt : std::optional(found->second);
}

// get() would convert -1 or 1.5 as well; at() on a number throws, as is wanted here.
std::uint64_t whole(const nlohmann::json& number) {
  return number.is_number_unsigned() ? number.get<std::uint64_t>()
                                     : number.at("a whole number").get<std::uint64_t>();
}

// nlohmann throws on a wrong type; caught in parse_series_header.
SeriesHeader header_from(const nlohmann::json& line) {
  SeriesHeader header;
  Series& series = header.series;
  series.device = line.value("device", "");
  series.serial = line.value("serial", "");
  series.firmware = line.value("firmware", "");
  series.shot = whole(line.at("shot"));
  series.nominal_rate_hz = line.at("nominal_rate_hz").get<double>();
  series.samples = whole(line.at("samples"));
  for (const auto& channel : line.at("channels")) {
    series.channels.push_back({channel.at("name").get<std::string>(), channel.value("quantity", ""),
                               channel.value("unit", ""), channel.value("minimum", 0.0),
                               channel.value("maximum", 0.0), channel.value("scale", 0.0)});
    header.scales.push_back(channel.value("scale", 1.0));
  }
  return header;
}

Expected<void> check(const Series& series) {
  if (!(series.nominal_rate_hz > 0.0) || !std::isfinite(series.nominal_rate_hz)) {
    return malformed("a series without a nominal rate above 0");
  }
  if (series.samples == 0 || series.samples > max_samples) {
    return malformed("a series of " + std::to_string(series.samples) + " samples");
  }
  if (series.channels.empty() || series.channels.size() > max_channels) {
    return malformed("a series of " + std::to_string(series.channels.size()) + " channels");
  }
  return {};
}

class LineReader {
public:
  explicit LineReader(std::string_view text) : rest_(text) {}
  // Without the line end; nothing at the end of the text.
  std::optional<std::string_view> next() {
    if (rest_.empty()) {
      return std::nullopt;
    }
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (line.ends_with('\r')) {
      line.remove_suffix(1);
    }
    ++number_;
    return line;
  }
  [[nodiscard]] std::string where() const { return "line " + std::to_string(number_) + ": "; }

private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

Expected<void> read_key(std::string_view line, Series& series, std::string& unit) {
  const std::size_t sign = line.find('=');
  if (sign == std::string_view::npos) {
    return {}; // a remark
  }
  const std::string_view key = trimmed(line.substr(0, sign));
  const std::string_view value = trimmed(line.substr(sign + 1));
  const auto number = parse_scpi_number(value);
  if (key == "device") {
    series.device = value;
  } else if (key == "serial") {
    series.serial = value;
  } else if (key == "firmware") {
    series.firmware = value;
  } else if (key == "unit") {
    unit = value;
  } else if (key == "nominal_rate_hz" && number) {
    series.nominal_rate_hz = *number;
  } else if (key == "first_sample_s" && number) {
    series.first_sample_s = *number;
  } else if (key == "shot" && number && *number >= 0.0 && *number < 9e15 &&
             *number == std::floor(*number)) {
    series.shot = static_cast<std::uint64_t>(*number);
  } else if (key == "shot" || key == "nominal_rate_hz" || key == "first_sample_s") {
    return malformed(std::string(key) + " = '" + shown(value) + "' is not possible");
  }
  return {};
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) {
      return fields;
    }
    line.remove_prefix(comma + 1);
  }
}

} // namespace

std::size_t SeriesHeader::bytes() const {
  return series.samples * series.channels.size() * bytes_of(form);
}

Expected<SeriesHeader> parse_series_header(std::string_view json_line) {
  try {
    const auto line = nlohmann::json::parse(json_line);
    if (line.value("protocol", "") != "dyncal-series" || line.value("version", 0.0) != 1.0) {
      return malformed("'" + shown(json_line) +
                       "' does not announce a series (protocol dyncal-series, version 1)");
    }
    SeriesHeader header = header_from(line);
    const auto form = form_by_name(line.value("values", ""));
    if (!form) {
      return malformed("unknown form of values '" + shown(line.value("values", "")) +
                       "': must be int16, int32, float32 or float64");
    }
    header.form = *form;
    DYNCAL_TRY(check(header.series));
    return header;
  } catch (const nlohmann::json::exception&) {
    return malformed("'" + shown(json_line) + "' does not announce a series");
  }
}

Expected<Series> decode_series(SeriesHeader header, std::span<const char> bytes) {
  if (bytes.size() != header.bytes()) {
    return malformed("a series of " + std::to_string(bytes.size()) + " bytes where " +
                     std::to_string(header.bytes()) + " were announced");
  }
  Series series = std::move(header.series);
  const std::size_t channels = series.channels.size();
  const std::size_t step = bytes_of(header.form);
  series.values.resize(series.samples * channels);
  for (std::size_t sample = 0; sample < series.samples; ++sample) {
    for (std::size_t channel = 0; channel < channels; ++channel) {
      const double value =
          value_at(header.form, bytes.data() + (sample * channels + channel) * step) *
          header.scales[channel];
      if (!std::isfinite(value)) {
        return malformed("sample " + std::to_string(sample) + " of the series is not a number");
      }
      series.values[channel * series.samples + sample] = value;
    }
  }
  return series;
}

Expected<Series> parse_series_csv(std::string_view text) {
  LineReader lines(text);
  Series series;
  std::string unit;
  std::vector<std::vector<double>> columns;
  while (const auto line = lines.next()) {
    if (line->starts_with('#')) {
      if (auto taken = read_key(line->substr(1), series, unit); !taken) {
        return malformed(lines.where() + taken.error().message);
      }
    } else if (columns.empty()) {
      for (const std::string_view name : split(*line)) {
        series.channels.push_back({std::string(name), "", unit, 0.0, 0.0, 0.0});
      }
      columns.resize(series.channels.size());
    } else if (!trimmed(*line).empty()) {
      const auto fields = split(*line);
      if (fields.size() != columns.size()) {
        return malformed(lines.where() + std::to_string(fields.size()) + " values for " +
                         std::to_string(columns.size()) + " channels");
      }
      for (std::size_t channel = 0; channel < fields.size(); ++channel) {
        const auto value = parse_scpi_number(fields[channel]);
        if (!value) {
          return malformed(lines.where() + value.error().message);
        }
        columns[channel].push_back(*value);
      }
    }
  }
  series.samples = columns.empty() ? 0 : columns.front().size();
  DYNCAL_TRY(check(series));
  for (const auto& column : columns) {
    series.values.insert(series.values.end(), column.begin(), column.end());
  }
  return series;
}

} // namespace dyncal::drivers::tss
