// The tables [sources.NAME] of a bench file: what all sources have in common, and the settings of
// each driver. Plain data, any thread; nothing here knows a driver's classes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "drivers/alsa/device_settings.hpp"
#include "drivers/can/stream_settings.hpp"
#include "drivers/interferometer/interferometer_settings.hpp"
#include "drivers/pps/pulse_settings.hpp"
#include "drivers/sample_block.hpp"
#include "drivers/tables/table_settings.hpp"
#include "services/bench/file/reference_file.hpp"
#include "services/contract/bench_file_origin.hpp"
#include "services/contract/device_identity.hpp"

namespace dyncal::inline bench {

struct SmartupSourceSettings { // driver = "smartup"
  std::string listen;
  std::uint32_t sensor = 0;
  std::optional<std::uint32_t> sync_sensor; // carries the sync ADC of later firmware
};

struct SocketSourceSettings { // driver = "socket"
  std::string address;
};

struct AlsaSourceSettings : drivers::alsa::DeviceSettings { // driver = "alsa"
  std::map<std::string, double> scale{}; // our name of a channel -> value of full scale
};

struct AcsSourceSettings { // a driver of the table in acs_drivers.hpp
  std::string driver;
  std::map<std::string, std::string> texts{};
  std::map<std::string, double> numbers{};
};

struct NamedChannel {         // "FILE:CHANNEL"
  std::filesystem::path path; // absolute
  std::string name;           // in the file, with its group and a slash before it where it has one
};

struct FileSourceSettings {               // driver = "file"
  std::filesystem::path path;             // absolute; the first where single channels are named
  double play_speed = 0.0;                // times real time; 0: at once
  std::optional<double> sample_rate_hz{}; // of a file without a time column
  std::string group{};                    // of an HDF5 or TDMS file with several
  double u_stamp_s = 0.0;                 // of its stamps in their time base; 0: not stated
  std::vector<NamedChannel> single{};     // channels in place of the whole file
  double time_offset_s = 0.0;             // added to its stamps
  std::map<std::string, double> scale{};  // our name of a channel -> factor of its values
};

// driver = "can". Channels, units and time base of its stream stand in SourceSettings.
struct CanSourceSettings : drivers::can::StreamSettings {
  std::string interface_name;
  std::filesystem::path log; // absolute; a candump log instead of an interface
  double play_speed = 0.0;   // of the log, times real time; 0: at once
  std::filesystem::path dbc; // absolute
  std::optional<double> restart_after_bus_off_s;
};

struct OscilloscopeSourceSettings { // driver = "oscilloscope"
  std::string address;              // or the folder
  std::filesystem::path path;       // absolute; folder with files of shots
  std::string family;               // of drivers/dso/scope_commands.hpp; empty: by its identity
  int sync_input = 1;               // sees sync and triggers
  double sync_range_v = 20.0;       // peak to peak
  double trigger_level_v = 0.0;
};

struct SeriesSourceSettings { // driver = "series"
  std::string address;        // or the folder
  std::filesystem::path path; // absolute; folder the series are written into
};

struct TableSourceSettings : drivers::tables::TableSettings {}; // driver = "table"

using DriverSettings =
    std::variant<SmartupSourceSettings, SocketSourceSettings, AlsaSourceSettings,
                 FileSourceSettings, CanSourceSettings, OscilloscopeSourceSettings,
                 SeriesSourceSettings, AcsSourceSettings, TableSourceSettings>;

struct SourceSettings {
  std::string name;
  DriverSettings driver;
  DeviceIdentity identity;
  std::map<std::string, std::string> channels;          // device's name -> ours
  std::map<std::string, std::string> units;             // our name -> D-SI
  std::map<std::string, ReferenceFile> sensitivities{}; // by our name
  std::optional<drivers::pps::PulseSettings> pulses{};  // that an instrument records
  drivers::TimeBase time_base = drivers::TimeBase::utc;
  std::optional<double> nominal_rate_hz{}; // of an instrument, as it is set: for checks beforehand
  // Of a device that records its quadrature signals.
  std::optional<drivers::interferometer::InterferometerSettings> interferometer{};
  std::string where; // "bench.toml:21", for messages
  BenchFileOrigin origin;

  // The settings of the driver, nullptr when the source has another one.
  template <class Driver>
  [[nodiscard]] const Driver* as() const {
    return std::get_if<Driver>(&driver);
  }
  template <class Driver>
  [[nodiscard]] bool is() const {
    return std::holds_alternative<Driver>(driver);
  }
};

} // namespace dyncal::inline bench
