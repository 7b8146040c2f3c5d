#include "services/daemon/supervision/daemon_metrics.hpp"

#include <array>

#include "idl/dyncal.h"
#include "services/daemon/supervision/metric_store.hpp"

namespace dyncal::inline daemon {
namespace {

constexpr MetricKind counter = MetricKind::counter;
constexpr MetricKind gauge = MetricKind::gauge;

constexpr MetricFamily build_info{"dyncal_build_info", "1, with program, version and DDS.", gauge};
constexpr MetricFamily malformed{"dyncal_malformed_messages_total",
                                 "Messages dropped because they do not match the contract.",
                                 counter};
constexpr MetricFamily refused_packets{"dyncal_refused_packets_total",
                                       "Malformed packets that never became a message.", counter};

constexpr MetricFamily received{"dyncal_source_samples_received_total",
                                "Samples that arrived and went into blocks.", counter};
constexpr MetricFamily lost{"dyncal_source_samples_lost_total",
                            "Samples lost in the device, or between device and service.", counter};
constexpr MetricFamily dropped{"dyncal_source_samples_dropped_total",
                               "Samples dropped because the network did not take them.", counter};
constexpr MetricFamily duplicates{"dyncal_source_samples_duplicate_total",
                                  "Samples that arrived more than once; left out.", counter};
constexpr MetricFamily rejected{"dyncal_source_samples_rejected_total",
                                "Samples that arrived but were unusable.", counter};
constexpr MetricFamily not_trusted{"dyncal_source_stamps_not_trusted_total",
                                   "Samples whose time stamp is not trusted.", counter};
constexpr MetricFamily rate{"dyncal_source_sample_rate_hertz", "Samples per second lately.", gauge};
constexpr MetricFamily fill{"dyncal_source_buffer_fill_ratio",
                            "Part of the buffer before the network that is in use, 0 to 1.", gauge};
constexpr MetricFamily written{"dyncal_source_blocks_written_total",
                               "Blocks or records handed to the network, empty ones included.",
                               counter};
constexpr MetricFamily readers{"dyncal_source_matched_readers",
                               "Readers of the samples that are connected.", gauge};
constexpr MetricFamily state{"dyncal_source_state", "1 for the state that the source is in.",
                             gauge};

constexpr MetricFamily runs{"dyncal_analysis_runs", "Runs that the analysis keeps, by state.",
                            gauge};
constexpr MetricFamily evaluation{"dyncal_analysis_evaluation_seconds_total",
                                  "Time that the main loop of the analysis has spent with runs.",
                                  counter};

constexpr MetricFamily held{"dyncal_analysis_held", "Objects cached by the analysis, by type.",
                            gauge};
constexpr MetricFamily left_out{"dyncal_analysis_left_out_total",
                                "Objects that had no room or made way, by type.", counter};

constexpr MetricFamily stored{"dyncal_recorder_messages_stored_total",
                              "Messages that are in the recordings.", counter};
constexpr MetricFamily not_stored{"dyncal_recorder_messages_not_stored_total",
                                  "Messages that came and could not be stored.", counter};
constexpr MetricFamily missing{"dyncal_recorder_blocks_missing_total",
                               "Blocks and records that never came, and could not be had again.",
                               counter};
constexpr MetricFamily file_size{"dyncal_recorder_file_bytes", "Size of the recording.", gauge};
constexpr MetricFamily disk{"dyncal_recorder_disk_free_bytes", "Room left on its disk.", gauge};
constexpr MetricFamily records{"dyncal_recorder_recording", "1 while it records the bench.", gauge};

constexpr MetricFamily switched_off{"dyncal_guard_outputs_switched_off_total",
                                    "Times that the output of the generator was switched off.",
                                    counter};
constexpr MetricFamily may_be_on{"dyncal_guard_output_may_be_on",
                                 "1 while an unattended output cannot be switched off.", gauge};

constexpr MetricFamily visitors{"dyncal_web_visitors", "Visitors that listen to events.", gauge};
constexpr MetricFamily requests{"dyncal_web_requests_total", "Requests that came.", counter};
constexpr MetricFamily refused{"dyncal_web_requests_refused_total",
                               "Requests that were refused, by reason.", counter};
constexpr MetricFamily shown{"dyncal_web_benches", "Benches that are shown.", gauge};
constexpr MetricFamily no_room{"dyncal_web_messages_left_out_total",
                               "Messages of benches, sources or runs beyond what is held.",
                               counter};
constexpr MetricFamily not_seen{"dyncal_web_samples_missed_total",
                                "Samples of shown signals that never came.", counter};

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
    store.set(state, with_state, one == present ? 1.0 : 0.0);
  }
}

} // namespace

void report(const ProgramIdentity& program, MetricStore& store) {
  store.set(build_info,
            {{"program", program.program}, {"version", program.software}, {"dds", program.dds}},
            1.0);
}

void report(const WebFigures& figures, MetricStore& store) {
  store.set(visitors, {}, static_cast<double>(figures.visitors));
  store.set(requests, {}, number(figures.requests));
  for (const auto& [reason, count] : figures.refused) {
    store.set(refused, {{"reason", reason}}, number(count));
  }
  store.set(shown, {}, number(figures.benches));
  store.set(no_room, {}, number(figures.left_out));
  store.set(not_seen, {}, number(figures.samples_missed));
}

void report_malformed_messages(std::uint64_t count, MetricStore& store) {
  store.set(malformed, {}, number(count));
}

void report_refused_packets(std::uint64_t count, MetricStore& store) {
  store.set(refused_packets, {}, number(count));
}

void report(const wire::SourceStatus& status, std::uint64_t messages_written, MetricStore& store) {
  const MetricLabels labels{{"bench", status.bench().to_string()},
                            {"source", status.source().to_string()}};
  const auto lost_in = [&](const char* place, std::uint64_t count) {
    MetricLabels with_place = labels;
    with_place.emplace("place", place);
    store.set(lost, with_place, number(count));
  };
  store.set(received, labels, number(status.received()));
  lost_in("device", status.lost_in_device());
  lost_in("transit", status.lost_in_transit());
  store.set(dropped, labels, number(status.dropped_in_service()));
  store.set(duplicates, labels, number(status.duplicates()));
  store.set(rejected, labels, number(status.rejected()));
  store.set(not_trusted, labels, number(status.stamps_not_trusted()));
  store.set(rate, labels, status.rate_hz());
  store.set(fill, labels, status.buffer_fill());
  store.set(written, labels, number(messages_written));
  store.set(readers, labels, number(status.matched_readers()));
  report_state(status.state(), labels, store);
}

void report(const RecorderFigures& figures, MetricStore& store) {
  const MetricLabels labels{{"bench", figures.bench}};
  store.set(stored, labels, number(figures.stored));
  store.set(not_stored, labels, number(figures.not_stored));
  store.set(missing, labels, number(figures.missing));
  store.set(file_size, labels, number(figures.file_bytes));
  store.set(disk, labels, number(figures.free_bytes));
  store.set(records, labels, figures.records ? 1.0 : 0.0);
}

void report(const GuardFigures& figures, MetricStore& store) {
  const MetricLabels labels{{"bench", figures.bench}};
  store.set(switched_off, labels, number(figures.switched_off));
  store.set(may_be_on, labels, figures.may_be_on ? 1.0 : 0.0);
}

void report(const AnalysisFigures& figures, MetricStore& store) {
  store.set(runs, {{"state", "waiting"}}, number(figures.runs_waiting));
  store.set(runs, {{"state", "armed"}}, number(figures.runs_armed));
  store.set(runs, {{"state", "refused"}}, number(figures.runs_refused));
  store.set(runs, {{"state", "finished"}}, number(figures.runs_finished));
  store.set(evaluation, {}, figures.evaluation_s);
  store.set(held, {{"what", "benches"}}, number(figures.benches));
  store.set(held, {{"what", "sources"}}, number(figures.sources));
  store.set(held, {{"what", "runs_of_others"}}, number(figures.runs_of_others));
  for (const auto& [what, count] : figures.left_out) {
    store.set(left_out, {{"what", what}}, number(count));
  }
  report_malformed_messages(figures.malformed_messages, store);
  report_refused_packets(figures.refused_packets, store);
}

} // namespace dyncal::inline daemon
