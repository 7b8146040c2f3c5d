// The topics of the contract: the type of each, its name, and the QoS profile that every writer and
// reader of it uses; idl/README.md explains them.
#pragma once

#include <string>

#include "idl/dyncal.h"

namespace dyncal::bus {

// `live_samples` and `live_records` are for writers of samples and records that wait for no reader,
// and for readers that want none of those before them; `paced_samples` is for writers that wait for
// their readers and have kept everything elsewhere.
enum class Profile {
  samples,
  live_samples,
  live_records,
  paced_samples,
  results,
  state,
  command,
  catch_up,
  probe
};

template <class T>
struct Topic {
  const char* name;
  Profile profile;

  // A topic stands for its name where DDS is given one.
  operator std::string() const { return name; }           // NOLINT(google-explicit-constructor)
  constexpr operator const char*() const { return name; } // NOLINT(google-explicit-constructor)
  friend bool operator==(const std::string& text, const Topic& topic) { return text == topic.name; }
};

namespace topics {

inline constexpr Topic<wire::SourceDescription> source_description{"SourceDescription",
                                                                   Profile::state};
inline constexpr Topic<wire::SourceStatus> source_status{"SourceStatus", Profile::state};
inline constexpr Topic<wire::SampleBlock> dau_samples{"DauSamples", Profile::samples};
inline constexpr Topic<wire::SampleBlock> acs_samples{"AcsSamples", Profile::samples};
inline constexpr Topic<wire::SampleBlock> can_samples{"CanSamples", Profile::samples};
inline constexpr Topic<wire::TriggeredRecord> dso_record{"DsoRecord", Profile::samples};
inline constexpr Topic<wire::TriggeredRecord> tss_record{"TssRecord", Profile::samples};
inline constexpr Topic<wire::AcsStep> acs_step{"AcsStep", Profile::results};
inline constexpr Topic<wire::Measurement> measurement{"Measurement", Profile::state};
inline constexpr Topic<wire::Excitation> excitation{"Excitation", Profile::state};
inline constexpr Topic<wire::CalibrationResult> calibration_result{"CalibrationResult",
                                                                   Profile::results};
inline constexpr Topic<wire::TransferFunction> transfer_function{"TransferFunction",
                                                                 Profile::results};
inline constexpr Topic<wire::SampleClockReport> sample_clock_report{"SampleClockReport",
                                                                    Profile::results};
inline constexpr Topic<wire::ServiceStatus> service_status{"ServiceStatus", Profile::state};
inline constexpr Topic<wire::ServiceStatus> recorder_status{"RecorderStatus", Profile::state};
inline constexpr Topic<wire::Command> command{"Command", Profile::command};
inline constexpr Topic<wire::CatchUpRequest> catch_up_request{"CatchUpRequest", Profile::command};
inline constexpr Topic<wire::SampleBlock> catch_up_samples{"CatchUpSamples", Profile::catch_up};
inline constexpr Topic<wire::TriggeredRecord> catch_up_records{"CatchUpRecords", Profile::catch_up};
inline constexpr Topic<wire::ClockRequest> clock_request{"ClockRequest", Profile::command};
inline constexpr Topic<wire::ClockAnswer> clock_answer{"ClockAnswer", Profile::command};
inline constexpr Topic<wire::LinkProbe> link_probe{"LinkProbe", Profile::probe};
inline constexpr Topic<wire::LinkEcho> link_echo{"LinkEcho", Profile::probe};

} // namespace topics
} // namespace dyncal::bus
