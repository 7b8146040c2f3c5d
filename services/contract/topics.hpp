// Names of the topics of the contract and the QoS profile each one uses; idl/README.md explains
// them.
#pragma once

namespace dyncal::bus::topics {

inline constexpr const char* source_description = "SourceDescription";  // state
inline constexpr const char* source_status = "SourceStatus";            // state
inline constexpr const char* dau_samples = "DauSamples";                // samples
inline constexpr const char* acs_samples = "AcsSamples";                // samples
inline constexpr const char* can_samples = "CanSamples";                // samples
inline constexpr const char* dso_record = "DsoRecord";                  // samples
inline constexpr const char* tss_record = "TssRecord";                  // samples
inline constexpr const char* measurement = "Measurement";               // state
inline constexpr const char* excitation = "Excitation";                 // state
inline constexpr const char* calibration_result = "CalibrationResult";  // results
inline constexpr const char* transfer_function = "TransferFunction";    // results
inline constexpr const char* sample_clock_report = "SampleClockReport"; // results
inline constexpr const char* service_status = "ServiceStatus";          // state
inline constexpr const char* command = "Command";                       // command

} // namespace dyncal::bus::topics
