// How the raw values of a channel of a TDMS file become those that are shown: the scalings that
// NI-DAQmx and LabVIEW write as properties, Linear and Polynomial, one after the other.
//
// NI_Number_Of_Scales of them are stated, the last gives the value. Each takes the raw values, or
// what a scale of a lower number gives; one without a type is a scaler of DAQmx. They are those of
// the channel, else of its group, else of the file. All else (Table, RTD, Strain, Thermocouple, Add
// ...) is refused by its name: raw values in its place would be wrong. Plain data, any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "drivers/files/tdms/tdms_index.hpp"

namespace dyncal::drivers::files {

class TdmsScaling {
public:
  // Of the channel, its group and the file. Fails with the problem in one sentence.
  [[nodiscard]] static tl::expected<TdmsScaling, std::string>
  of(const TdmsProperties& channel, const TdmsProperties& group, const TdmsProperties& file);

  // Whose raw values it takes.
  [[nodiscard]] std::uint32_t scaler() const { return scaler_; }
  // Raw values are what is shown.
  [[nodiscard]] bool is_none() const { return scales_.empty(); }
  void apply(std::span<double> values) const;

private:
  struct Scale {
    bool is_linear = false;             // coefficients: intercept and slope
    std::vector<double> coefficients{}; // from the constant one on
  };
  [[nodiscard]] static tl::expected<TdmsScaling, std::string> of(const TdmsProperties& properties,
                                                                 std::int64_t scales);

  std::uint32_t scaler_ = tdms_raw_input;
  std::vector<Scale> scales_; // in the order they are applied
};

} // namespace dyncal::drivers::files
