// Writes TDMS files byte by byte, as LabVIEW and NI-DAQmx do, in either byte order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dyncal::drivers::files {

constexpr std::uint32_t tdms_metadata = 2;
constexpr std::uint32_t tdms_new_objects = 4;
constexpr std::uint32_t tdms_raw_data = 8;
constexpr std::uint32_t tdms_interleaved = 32;
constexpr std::uint32_t tdms_big_endian = 64;
constexpr std::uint32_t tdms_daqmx = 128;

class TdmsBytes {
public:
  explicit TdmsBytes(bool big_endian = false) : big_endian_(big_endian) {}

  template <class Number>
  TdmsBytes& add(Number number) {
    std::string bytes(sizeof(number), '\0');
    std::memcpy(bytes.data(), &number, sizeof(number));
    if (big_endian_) {
      std::reverse(bytes.begin(), bytes.end());
    }
    text_ += bytes;
    return *this;
  }
  TdmsBytes& text(std::string_view text) {
    add(static_cast<std::uint32_t>(text.size()));
    text_ += text;
    return *this;
  }
  TdmsBytes& raw(std::string_view bytes) {
    text_ += bytes;
    return *this;
  }
  // The index of `values` numbers of a type.
  TdmsBytes& index(std::uint32_t type, std::uint64_t values) {
    return add(std::uint32_t{20}).add(type).add(std::uint32_t{1}).add(values);
  }
  TdmsBytes& property(std::string_view name, double value) {
    return text(name).add(std::uint32_t{10}).add(value);
  }
  TdmsBytes& property(std::string_view name, std::string_view value) {
    return text(name).add(std::uint32_t{0x20}).text(value);
  }
  TdmsBytes& property(std::string_view name, std::uint32_t value) {
    return text(name).add(std::uint32_t{7}).add(value);
  }
  TdmsBytes& time(std::string_view name, std::int64_t seconds, std::uint64_t fraction) {
    text(name).add(std::uint32_t{0x44});
    return big_endian_ ? add(seconds).add(fraction) : add(fraction).add(seconds);
  }
  [[nodiscard]] const std::string& bytes() const { return text_; }

private:
  bool big_endian_;
  std::string text_;
};

// A segment; `next` and `raw` are its two lengths unless stated.
inline std::string tdms_segment(std::uint32_t contents, const std::string& metadata,
                                const std::string& data, bool closed = true) {
  const bool big_endian = (contents & tdms_big_endian) != 0;
  const std::uint64_t next = closed ? metadata.size() + data.size() : ~std::uint64_t{0};
  TdmsBytes lead_in(big_endian);
  lead_in.add(std::uint32_t{4713}).add(next).add(static_cast<std::uint64_t>(metadata.size()));
  return "TDSm" + TdmsBytes().add(contents).bytes() + lead_in.bytes() + metadata + data;
}

constexpr std::uint32_t tdms_whole = tdms_metadata | tdms_new_objects | tdms_raw_data;

} // namespace dyncal::drivers::files
