#include "drivers/files/sigmf_meta.hpp"

#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

namespace dyncal::drivers::files {
namespace {

using Json = nlohmann::json;
using Problem = tl::unexpected<std::string>;

constexpr std::uint64_t max_count = std::uint64_t{1} << 45U;  // samples or bytes of a file
constexpr std::uint64_t max_number = std::uint64_t{1} << 62U; // of samples of a source
constexpr std::uint64_t max_recorded_channels = 4096;

const Json* find(const Json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() ? &*found : nullptr;
}

// Absent: nothing; there, but no such number: a problem.
tl::expected<std::optional<std::uint64_t>, std::string> count_in(const Json& object,
                                                                 const std::string& where,
                                                                 const char* key,
                                                                 std::uint64_t most = max_count) {
  const Json* const value = find(object, key);
  if (value == nullptr) {
    return std::nullopt;
  }
  if (!value->is_number_unsigned() || value->get<std::uint64_t>() > most) {
    return Problem(where + ": " + key + " must be a whole number from 0 on");
  }
  return value->get<std::uint64_t>();
}

// "ci16_le", "rf32_be", "cu8".
bool read_datatype(SigmfMeta& meta) {
  std::string_view text = meta.datatype;
  if (text.empty() || (text.front() != 'c' && text.front() != 'r')) {
    return false;
  }
  meta.is_complex = text.front() == 'c';
  text.remove_prefix(1);
  const bool states_order = text.ends_with("_le") || text.ends_with("_be");
  meta.big_endian = text.ends_with("_be");
  text.remove_suffix(states_order ? 3 : 0);
  constexpr std::array<std::pair<std::string_view, TdmsType>, 8> types{
      std::pair{"i8", TdmsType::i8}, {"u8", TdmsType::u8},   {"i16", TdmsType::i16},
      {"u16", TdmsType::u16},        {"i32", TdmsType::i32}, {"u32", TdmsType::u32},
      {"f32", TdmsType::f32},        {"f64", TdmsType::f64}};
  for (const auto& [name, type] : types) {
    if (text == name) {
      meta.type = type;
      return states_order || *size_of(type) == 1;
    }
  }
  return false;
}

tl::expected<void, std::string> read_global(const Json& global, SigmfMeta& meta) {
  const std::string where = "\"global\"";
  for (const char* key : {"core:dataset", "core:metadata_only"}) {
    const Json* const value = find(global, key);
    if (value != nullptr && *value != false) {
      return Problem(where + ": " + key + " is there: its data are not in the file beside it");
    }
  }
  const Json* const datatype = find(global, "core:datatype");
  meta.datatype = datatype != nullptr && datatype->is_string() ? datatype->get<std::string>() : "";
  if (!read_datatype(meta)) {
    return Problem(where + ": core:datatype \"" + meta.datatype +
                   "\" is none of those of SigMF, such as ci16_le, cf32_le, rf32_le");
  }
  const auto channels = count_in(global, where, "core:num_channels");
  const auto trailing = count_in(global, where, "core:trailing_bytes");
  if (!channels || !trailing) {
    return Problem(!channels ? channels.error() : trailing.error());
  }
  meta.channels = channels->value_or(1);
  meta.trailing_bytes = trailing->value_or(0);
  if (meta.channels == 0 || meta.channels > max_recorded_channels) {
    return Problem(where + ": core:num_channels must be 1 to " +
                   std::to_string(max_recorded_channels));
  }
  if (const Json* const rate = find(global, "core:sample_rate"); rate != nullptr) {
    if (!rate->is_number()) {
      return Problem(where + ": core:sample_rate must be a number");
    }
    meta.sample_rate_hz = rate->get<double>();
  }
  if (const Json* const hardware = find(global, "core:hw");
      hardware != nullptr && hardware->is_string()) {
    meta.hardware = hardware->get<std::string>();
  }
  return {};
}

tl::expected<SigmfCapture, std::string> read_capture(const Json& json, const std::string& where) {
  SigmfCapture capture;
  const auto start = count_in(json, where, "core:sample_start");
  const auto header = count_in(json, where, "core:header_bytes");
  const auto number = count_in(json, where, "core:global_index", max_number);
  for (const auto* read : {&start, &header, &number}) {
    if (!*read) {
      return Problem(read->error());
    }
  }
  if (!*start) {
    return Problem(where + " has no core:sample_start");
  }
  capture.start = **start;
  capture.header_bytes = header->value_or(0);
  capture.number = *number;
  if (const Json* const time = find(json, "core:datetime"); time != nullptr) {
    capture.unix_ns =
        time->is_string() ? sigmf_unix_ns(time->get_ref<const std::string&>()) : std::nullopt;
    if (!capture.unix_ns) {
      return Problem(where + ": core:datetime must be a time such as 2024-01-01T00:00:00.5Z");
    }
  }
  return capture;
}

tl::expected<void, std::string> read_captures(const Json& captures, SigmfMeta& meta) {
  for (const Json& json : captures) {
    const std::string where = "capture " + std::to_string(meta.captures.size());
    auto capture = read_capture(json, where);
    if (!capture) {
      return Problem(capture.error());
    }
    if (!meta.captures.empty() && capture->start < meta.captures.back().start) {
      return Problem(where + " begins before the one before it (core:sample_start)");
    }
    meta.captures.push_back(*capture);
  }
  if (meta.captures.empty()) {
    meta.captures.emplace_back();
  }
  return {};
}

} // namespace

tl::expected<SigmfMeta, std::string> SigmfMeta::of(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  const Json* const global = find(json, "global");
  const Json* const captures = find(json, "captures");
  if (global == nullptr || !global->is_object() || captures == nullptr || !captures->is_array()) {
    return Problem(
        "is not the metadata of a SigMF recording: JSON with \"global\" and \"captures\"");
  }
  SigmfMeta meta;
  if (auto done = read_global(*global, meta); !done) {
    return Problem(done.error());
  }
  if (auto done = read_captures(*captures, meta); !done) {
    return Problem(done.error());
  }
  return meta;
}

std::optional<std::int64_t> sigmf_unix_ns(std::string_view text) {
  const auto digits = [&](std::size_t first, std::size_t count) {
    int value = -1;
    const auto [end, status] =
        std::from_chars(text.data() + first, text.data() + first + count, value);
    return status == std::errc() && end == text.data() + first + count ? value : -1;
  };
  if (text.size() < 20 || text[4] != '-' || text[7] != '-' || text[10] != 'T' || text[13] != ':' ||
      text[16] != ':' || text.back() != 'Z') {
    return std::nullopt;
  }
  const int year = digits(0, 4), month = digits(5, 2), day = digits(8, 2);
  const int hour = digits(11, 2), minute = digits(14, 2), second = digits(17, 2);
  const std::chrono::year_month_day date(std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day)));
  if (year < 1970 || year > 2261 || !date.ok() || hour < 0 || hour > 23 || minute < 0 ||
      minute > 59 || second < 0 || second > 60) {
    return std::nullopt;
  }
  std::int64_t part_ns = 0;
  if (text.size() > 20) {
    std::int64_t unit_ns = 100'000'000;
    for (std::size_t i = 20; i + 1 < text.size(); ++i, unit_ns /= 10) {
      if (text[i] < '0' || text[i] > '9') {
        return std::nullopt;
      }
      part_ns += (text[i] - '0') * unit_ns;
    }
    if (text[19] != '.') {
      return std::nullopt;
    }
  }
  const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
  return ((days * 24 + hour) * 60 + minute) * 60'000'000'000 + second * 1'000'000'000LL + part_ns;
}

tl::expected<std::vector<std::uint64_t>, std::string> sigmf_numbers(const SigmfMeta& meta,
                                                                    const SampleRate& rate) {
  std::vector<std::uint64_t> numbers{0};
  const SigmfCapture& first = meta.captures.front();
  for (std::size_t i = 1; i < meta.captures.size(); ++i) {
    const SigmfCapture& capture = meta.captures[i];
    const std::uint64_t next = numbers.back() + capture.start - meta.captures[i - 1].start;
    std::int64_t gap = 0;
    if (capture.number && first.number) {
      gap = static_cast<std::int64_t>(*capture.number - *first.number - next);
    } else if (capture.unix_ns && first.unix_ns) {
      const double since_s = 1e-9 * static_cast<double>(*capture.unix_ns - *first.unix_ns);
      const double samples = std::round(since_s * rate.hz() - static_cast<double>(next));
      gap = std::abs(samples) < 9e15 ? static_cast<std::int64_t>(samples) : -1;
    }
    if (gap < 0 || static_cast<std::uint64_t>(gap) > max_count) {
      return Problem("capture " + std::to_string(i) +
                     " begins before the last sample of the one before it (core:global_index, or "
                     "core:datetime without it)");
    }
    numbers.push_back(next + static_cast<std::uint64_t>(gap));
  }
  return numbers;
}

} // namespace dyncal::drivers::files
