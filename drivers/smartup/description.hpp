// What a sensor of a SmartUp Unit says about itself, put together from the six kinds of description
// messages that come every 4 s.
//
// Traps of the format that are settled here: channels that are sent but not declared are kept (the
// calibration firmware sends its three sync ADCs, in volts, as Data_11..13 and declares nothing);
// RESOLUTION is the number of steps between MIN_SCALE and MAX_SCALE, not one step; HIERARCHY is
// "Group/index" but for some sensors only "Group"; a few units of the wild are not D-SI.
//
// Names of channels, in this order: the one the configuration gives; the group in lower case with
// x, y, z when it has the three indices 0..2
// ("Acceleration/2" -> acceleration_z; voltages keep their numbers); the group alone when it has
// one member ("Temperature/0" -> temperature); the group with its index; data_NN when nothing is
// declared. A name that is taken gets _NN behind it. Plain data, one thread at a time.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/sample_block.hpp"
#include "drivers/smartup/datagram.hpp"

namespace dyncal::drivers::smartup {

// From the bench file.
struct ChannelNaming {
  std::map<std::string, std::string>
      names; // "Data_11", the declared hierarchy or the name given here -> ours
  std::map<std::string, std::string> units; // our name -> D-SI
};

// The D-SI spelling of a unit text of the firmware; what is not known to be wrong is kept.
[[nodiscard]] std::string d_si_unit(const std::string& text);

class DescriptionAssembly {
public:
  // True when this message says something new.
  bool add(const DescriptionMessage& message);

  // All six kinds have come.
  [[nodiscard]] bool complete() const;
  [[nodiscard]] const std::string& sensor_name() const { return sensor_name_; }

  // Descriptions of the channels whose bits are set, in the order of their numbers. `prefix` stands
  // before names that nobody declared.
  [[nodiscard]] std::vector<ChannelDescription> channels(std::uint16_t columns,
                                                         const ChannelNaming& naming,
                                                         const std::string& prefix = "") const;

  // One sentence per oddity of what the sensor declares.
  [[nodiscard]] std::vector<std::string> warnings() const;

private:
  struct Declared {
    std::string quantity;
    std::string unit;
    std::string hierarchy;
    std::optional<double> steps;
    std::optional<double> minimum;
    std::optional<double> maximum;
  };
  [[nodiscard]] std::string declared_name(std::size_t channel) const;

  std::string sensor_name_;
  std::uint32_t types_seen_ = 0;
  std::array<Declared, channels_of_unit> declared_;
};

} // namespace dyncal::drivers::smartup
