#include "services/daemon/supervision/daemon_metrics.hpp"

#include <array>

#include "idl/dyncal.h"
#include "services/daemon/supervision/metric_store.hpp"

namespace dyncal::inline daemon {
namespace {

double number(std::uint64_t count) {
  return static_cast<double>(count);
}

void report_state(wire::SourceState present, const MetricLabels& labels, MetricStore& store) {
  static constexpr std::array<std::pair<wire::SourceState, const char*>, 5> states{
      {{wire::SOURCE_STARTING, "starting"},
       {wire::SOURCE_RUNNING, "running"},
       {wire::SOURCE_SILENT, "silent"},
       {wire::SOURCE_ENDED, "ended"},
       {wire::SOURCE_FAILED, "failed"}}};
  for (const auto& [one, name] : states) {
    MetricLabels with_state = labels;
    with_state.emplace("state", name);
    store.gauge("dyncal_source_state", "1 for the state that the source is in.", with_state,
                one == present ? 1.0 : 0.0);
  }
}

} // namespace

void report(const ProgramIdentity& program, MetricStore& store) {
  store.gauge("dyncal_build_info", "1, with program, version and DDS.",
              {{"program", program.program}, {"version", program.software}, {"dds", program.dds}},
              1.0);
}

void report(const WebFigures& figures, MetricStore& store) {
  store.gauge("dyncal_web_visitors", "Visitors that listen to events.", {},
              static_cast<double>(figures.visitors));
  store.counter("dyncal_web_requests_total", "Requests that came.", {}, number(figures.requests));
  for (const auto& [reason, count] : figures.refused) {
    store.counter("dyncal_web_requests_refused_total", "Requests that were refused, by reason.",
                  {{"reason", reason}}, number(count));
  }
  store.gauge("dyncal_web_benches", "Benches that are shown.", {}, number(figures.benches));
  store.counter("dyncal_web_messages_left_out_total",
                "Messages of benches, sources or runs beyond what is held.", {},
                number(figures.left_out));
  store.counter("dyncal_web_samples_missed_total", "Samples of shown signals that never came.", {},
                number(figures.samples_missed));
}

void report_malformed_messages(std::uint64_t count, MetricStore& store) {
  store.counter("dyncal_malformed_messages_total",
                "Messages dropped because they do not match the contract.", {}, number(count));
}

void report_refused_packets(std::uint64_t count, MetricStore& store) {
  store.counter("dyncal_refused_packets_total", "Malformed packets that never became a message.",
                {}, number(count));
}

void report(const wire::SourceStatus& status, std::uint64_t messages_written, MetricStore& store) {
  const MetricLabels labels{{"bench", status.bench().to_string()},
                            {"source", status.source().to_string()}};
  const auto lost_in = [&](const char* place, std::uint64_t count) {
    MetricLabels with_place = labels;
    with_place.emplace("place", place);
    store.counter("dyncal_source_samples_lost_total",
                  "Samples lost in the device, or between device and service.", with_place,
                  number(count));
  };
  store.counter("dyncal_source_samples_received_total",
                "Samples that arrived and went into blocks.", labels, number(status.received()));
  lost_in("device", status.lost_in_device());
  lost_in("transit", status.lost_in_transit());
  store.counter("dyncal_source_samples_dropped_total",
                "Samples dropped because the network did not take them.", labels,
                number(status.dropped_in_service()));
  store.counter("dyncal_source_samples_duplicate_total",
                "Samples that arrived more than once; left out.", labels,
                number(status.duplicates()));
  store.counter("dyncal_source_samples_rejected_total", "Samples that arrived but were unusable.",
                labels, number(status.rejected()));
  store.counter("dyncal_source_stamps_not_trusted_total",
                "Samples whose time stamp is not trusted.", labels,
                number(status.stamps_not_trusted()));
  store.gauge("dyncal_source_sample_rate_hertz", "Samples per second lately.", labels,
              status.rate_hz());
  store.gauge("dyncal_source_buffer_fill_ratio",
              "Part of the buffer before the network that is in use, 0 to 1.", labels,
              status.buffer_fill());
  store.counter("dyncal_source_blocks_written_total",
                "Blocks or records handed to the network, empty ones included.", labels,
                number(messages_written));
  store.gauge("dyncal_source_matched_readers", "Readers of the samples that are connected.", labels,
              number(status.matched_readers()));
  report_state(status.state(), labels, store);
}

void report(const RecorderFigures& figures, MetricStore& store) {
  const MetricLabels labels{{"bench", figures.bench}};
  store.counter("dyncal_recorder_messages_stored_total", "Messages that are in the recordings.",
                labels, number(figures.stored));
  store.counter("dyncal_recorder_messages_not_stored_total",
                "Messages that came and could not be stored.", labels, number(figures.not_stored));
  store.counter("dyncal_recorder_blocks_missing_total",
                "Blocks and records that never came, and could not be had again.", labels,
                number(figures.missing));
  store.gauge("dyncal_recorder_file_bytes", "Size of the recording.", labels,
              number(figures.file_bytes));
  store.gauge("dyncal_recorder_disk_free_bytes", "Room left on its disk.", labels,
              number(figures.free_bytes));
  store.gauge("dyncal_recorder_recording", "1 while it records the bench.", labels,
              figures.records ? 1.0 : 0.0);
}

void report(const GuardFigures& figures, MetricStore& store) {
  const MetricLabels labels{{"bench", figures.bench}};
  store.counter("dyncal_guard_outputs_switched_off_total",
                "Times that the output of the generator was switched off.", labels,
                number(figures.switched_off));
  store.gauge("dyncal_guard_output_may_be_on",
              "1 while an unattended output cannot be switched off.", labels,
              figures.may_be_on ? 1.0 : 0.0);
}

void report(const AnalysisFigures& figures, MetricStore& store) {
  store.gauge("dyncal_analysis_runs", "Runs that the analysis keeps, by state.",
              {{"state", "waiting"}}, number(figures.runs_waiting));
  store.gauge("dyncal_analysis_runs", "Runs that the analysis keeps, by state.",
              {{"state", "armed"}}, number(figures.runs_armed));
  store.gauge("dyncal_analysis_runs", "Runs that the analysis keeps, by state.",
              {{"state", "refused"}}, number(figures.runs_refused));
  store.gauge("dyncal_analysis_runs", "Runs that the analysis keeps, by state.",
              {{"state", "finished"}}, number(figures.runs_finished));
  store.counter("dyncal_analysis_evaluation_seconds_total",
                "Time that the main loop of the analysis has spent with runs.", {},
                figures.evaluation_s);
  store.gauge("dyncal_analysis_held", "Objects cached by the analysis, by type.",
              {{"what", "benches"}}, number(figures.benches));
  store.gauge("dyncal_analysis_held", "Objects cached by the analysis, by type.",
              {{"what", "sources"}}, number(figures.sources));
  store.gauge("dyncal_analysis_held", "Objects cached by the analysis, by type.",
              {{"what", "runs_of_others"}}, number(figures.runs_of_others));
  for (const auto& [what, count] : figures.left_out) {
    store.counter("dyncal_analysis_left_out_total",
                  "Objects that had no room or made way, by type.", {{"what", what}},
                  number(count));
  }
  for (const LeftOutFigures& one : figures.left_out_of_sources) {
    const MetricLabels labels{{"bench", one.bench}, {"source", one.source}};
    store.counter("dyncal_analysis_messages_duplicate_total",
                  "Messages of the source that runs had already; left out.", labels,
                  number(one.duplicates));
    store.counter("dyncal_analysis_messages_of_others_total",
                  "Messages that another program sent in the name of the source; left out.", labels,
                  number(one.of_other_programs));
  }
  report_malformed_messages(figures.malformed_messages, store);
  report_refused_packets(figures.refused_packets, store);
}

} // namespace dyncal::inline daemon
