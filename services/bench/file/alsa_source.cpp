#include <array>
#include <utility>

#include "services/bench/file/driver_tables.hpp"

namespace dyncal::inline bench {
namespace {

using drivers::alsa::SampleFormat;

constexpr std::array formats{
    std::pair("s16", SampleFormat::s16), std::pair("s24", SampleFormat::s24),
    std::pair("s24-3le", SampleFormat::s24_3le), std::pair("s32", SampleFormat::s32),
    std::pair("float", SampleFormat::float32)};

SampleFormat read_format(TomlTable& table) {
  std::vector<std::string> words;
  for (const auto& [word, format] : formats) {
    words.emplace_back(word);
  }
  const std::string chosen = table.one_of("format", words, "s32");
  for (const auto& [word, format] : formats) {
    if (chosen == word) {
      return format;
    }
  }
  return SampleFormat::s32;
}

} // namespace

AlsaSourceSettings read_alsa_source(TomlTable& table) {
  AlsaSourceSettings alsa;
  alsa.device = table.required_text("address");
  if (!table.has("sample_rate_hz")) {
    table.refuse("sample_rate_hz", "is missing: that of the device, for example 48000");
  }
  alsa.rate_hz = static_cast<unsigned>(table.whole_number("sample_rate_hz", 1, 1, "Hz"));
  alsa.format = read_format(table);
  alsa.channels = static_cast<unsigned>(table.whole_number("channel_count", 2, 1));
  alsa.scale = read_scale(table);
  return alsa;
}

} // namespace dyncal::inline bench
