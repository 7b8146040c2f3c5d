// Writes datagrams as a SmartUp Unit does, for tests and the load program. Independent of the
// decoder.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dyncal::tests {

class DatagramWriter {
public:
  explicit DatagramWriter(std::string_view keyword) : bytes_(keyword.begin(), keyword.end()) {}

  static std::vector<std::pair<int, float>> three_channels() {
    std::vector<std::pair<int, float>> values;
    for (int channel = 1; channel <= 3; ++channel) {
      values.emplace_back(channel, static_cast<float>(channel));
    }
    return values;
  }

  struct Data {
    std::uint32_t sensor = 0xbccb0100;
    std::uint32_t sample_number = 1;
    std::int64_t stamp_ns = 1'600'000'000'000'000'000;
    std::uint32_t time_uncertainty_ns = 84;
    std::vector<std::pair<int, float>> values =
        three_channels(); // number of the channel and its value
  };

  DatagramWriter& data(const Data& data) {
    std::vector<std::uint8_t> message;
    number(message, 1, data.sensor);
    number(message, 2, data.sample_number);
    number(message, 3, static_cast<std::uint64_t>(data.stamp_ns / 1'000'000'000));
    number(message, 4, static_cast<std::uint64_t>(data.stamp_ns % 1'000'000'000));
    number(message, 5, data.time_uncertainty_ns);
    for (const auto& [channel, value] : data.values) {
      real(message, channel + 5, value);
    }
    return frame(message);
  }

  // Type 0, 1 or 6: texts of the channels, empty ones are left out.
  DatagramWriter& description(std::uint32_t sensor, std::string_view name, int type,
                              const std::vector<std::string>& texts) {
    std::vector<std::uint8_t> message = head(sensor, name, type);
    for (std::size_t i = 0; i < texts.size(); ++i) {
      if (!texts[i].empty()) {
        text(message, static_cast<int>(i) + 4, texts[i]);
      }
    }
    return frame(message);
  }

  // Type 3, 4 or 5.
  DatagramWriter& description(std::uint32_t sensor, std::string_view name, int type,
                              const std::vector<float>& values) {
    std::vector<std::uint8_t> message = head(sensor, name, type);
    for (std::size_t i = 0; i < values.size(); ++i) {
      real(message, static_cast<int>(i) + 20, values[i]);
    }
    return frame(message);
  }

  DatagramWriter& frame(const std::vector<std::uint8_t>& message) {
    varint(bytes_, message.size());
    bytes_.insert(bytes_.end(), message.begin(), message.end());
    return *this;
  }

  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

  static void varint(std::vector<std::uint8_t>& bytes, std::uint64_t value) {
    for (; value >= 0x80; value >>= 7U) {
      bytes.push_back(static_cast<std::uint8_t>(value | 0x80U));
    }
    bytes.push_back(static_cast<std::uint8_t>(value));
  }
  static void number(std::vector<std::uint8_t>& bytes, int field, std::uint64_t value) {
    varint(bytes, static_cast<std::uint64_t>(field) << 3U);
    varint(bytes, value);
  }
  static void real(std::vector<std::uint8_t>& bytes, int field, float value) {
    varint(bytes, (static_cast<std::uint64_t>(field) << 3U) | 5U);
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (unsigned shift = 0; shift < 32; shift += 8) {
      bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
  }
  static void text(std::vector<std::uint8_t>& bytes, int field, std::string_view value) {
    varint(bytes, (static_cast<std::uint64_t>(field) << 3U) | 2U);
    varint(bytes, value.size());
    bytes.insert(bytes.end(), value.begin(), value.end());
  }

private:
  static std::vector<std::uint8_t> head(std::uint32_t sensor, std::string_view name, int type) {
    std::vector<std::uint8_t> message;
    number(message, 1, sensor);
    text(message, 2, name);
    number(message, 3, static_cast<std::uint64_t>(type));
    return message;
  }

  std::vector<std::uint8_t> bytes_;
};

// The six description datagrams of an MPU9250 with ten declared channels.
inline std::vector<std::vector<std::uint8_t>> mpu9250_descriptions(std::uint32_t sensor) {
  const std::string acceleration = R"(\metre\second\tothe{-2})";
  const std::string rate = R"(\radian\second\tothe{-1})";
  const std::string flux = R"(\micro\tesla)";
  const auto texts = [&](int type, const std::vector<std::string>& values) {
    return DatagramWriter("DSCP").description(sensor, "MPU_9250", type, values).bytes();
  };
  const auto reals = [&](int type, const std::vector<float>& values) {
    return DatagramWriter("DSCP").description(sensor, "MPU_9250", type, values).bytes();
  };
  return {
      texts(0, {"X Acceleration", "Y Acceleration", "Z Acceleration", "X Angular velocity",
                "Y Angular velocity", "Z Angular velocity", "X Magnetic flux density",
                "Y Magnetic flux density", "Z Magnetic flux density", "Temperature"}),
      texts(1, {acceleration, acceleration, acceleration, rate, rate, rate, flux, flux, flux,
                R"(\degreecelsius)"}),
      reals(3, {65536, 65536, 65536, 65536, 65536, 65536, 65520, 65520, 65520, 65536}),
      reals(4, {-156.9F, -156.9F, -156.9F, -34.9F, -34.9F, -34.9F, -4912, -4912, -4912, -77.1F}),
      reals(5, {156.9F, 156.9F, 156.9F, 34.9F, 34.9F, 34.9F, 4912, 4912, 4912, 119.1F}),
      texts(6, {"Acceleration/0", "Acceleration/1", "Acceleration/2", "Angular_velocity/0",
                "Angular_velocity/1", "Angular_velocity/2", "Magnetic_flux_density/0",
                "Magnetic_flux_density/1", "Magnetic_flux_density/2", "Temperature/0"})};
}

} // namespace dyncal::tests
