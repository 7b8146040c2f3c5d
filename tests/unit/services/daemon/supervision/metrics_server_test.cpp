#include "services/daemon/supervision/metrics_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "idl/dyncal.h"
#include "services/daemon/supervision/supervisor.hpp"
#include "tests/unit/services/daemon/supervision/scrape.hpp"

namespace dyncal::inline daemon {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using tests::fetch_metrics;
using tests::metrics_in;

const std::string free_port = "127.0.0.1:0";

class MetricsTest : public testing::Test {
protected:
  void SetUp() override {
    if (!can_serve_metrics()) {
      GTEST_SKIP() << "this build has no prometheus-cpp";
    }
    server_ = std::move(*MetricsServer::start(free_port, store_));
  }
  std::map<std::string, double> scrape() { return metrics_in(fetch_metrics(server_->port())); }

  MetricStore store_;
  std::unique_ptr<MetricsServer> server_;
};

TEST_F(MetricsTest, ServesTheCountsOfASource) {
  wire::SourceStatus status;
  status.bench("acc-1");
  status.source("dau");
  status.state(wire::SOURCE_SILENT);
  status.received(1001);
  status.lost_in_device(3);
  status.lost_in_transit(5);
  status.duplicates(7);
  status.rejected(9);
  status.stamps_not_trusted(11);
  status.dropped_in_service(13);
  status.rate_hz(999.5);
  status.buffer_fill(0.25);
  status.matched_readers(2);
  report(status, 42, store_);
  const auto values = scrape();
  const std::string labels = R"({bench="acc-1",source="dau")"; // in alphabetical order
  const std::vector<std::pair<std::string, double>> expected{
      {"dyncal_source_samples_received_total" + labels + "}", 1001},
      {R"(dyncal_source_samples_lost_total{bench="acc-1",place="device",source="dau"})", 3},
      {R"(dyncal_source_samples_lost_total{bench="acc-1",place="transit",source="dau"})", 5},
      {"dyncal_source_samples_duplicate_total" + labels + "}", 7},
      {"dyncal_source_samples_rejected_total" + labels + "}", 9},
      {"dyncal_source_stamps_not_trusted_total" + labels + "}", 11},
      {"dyncal_source_samples_dropped_total" + labels + "}", 13},
      {"dyncal_source_sample_rate_hertz" + labels + "}", 999.5},
      {"dyncal_source_buffer_fill_ratio" + labels + "}", 0.25},
      {"dyncal_source_matched_readers" + labels + "}", 2},
      {"dyncal_source_blocks_written_total" + labels + "}", 42},
      {"dyncal_source_state" + labels + R"(,state="silent"})", 1},
      {"dyncal_source_state" + labels + R"(,state="running"})", 0}};
  for (const auto& [name, value] : expected) {
    ASSERT_TRUE(values.contains(name)) << name;
    EXPECT_EQ(values.at(name), value) << name;
  }
}

TEST_F(MetricsTest, ServesTheNewestValue) {
  wire::SourceStatus status;
  status.bench("acc-1");
  status.source("dau");
  for (const std::uint64_t count : {1U, 2U, 3U}) {
    status.received(count);
    report(status, count, store_);
  }
  EXPECT_EQ(scrape().at(R"(dyncal_source_samples_received_total{bench="acc-1",source="dau"})"), 3);
}

TEST_F(MetricsTest, ServesACountThatBeganAgain) {
  for (const std::uint64_t count : {7U, 3U, 4U}) {
    report_malformed_messages(count, store_);
    EXPECT_EQ(scrape().at("dyncal_malformed_messages_total"), count);
  }
}

TEST_F(MetricsTest, ServesWhatTheAnalysisDoes) {
  report(AnalysisFigures{.runs_waiting = 1,
                         .runs_armed = 2,
                         .runs_refused = 3,
                         .runs_finished = 4,
                         .evaluation_s = 1.5,
                         .benches = 8,
                         .sources = 9,
                         .runs_of_others = 10,
                         .left_out = {{"runs", 11}},
                         .left_out_of_sources = {{"acc-1", "dau", 12, 13}},
                         .malformed_messages = 6,
                         .refused_packets = 7},
         store_);
  const auto values = scrape();
  EXPECT_EQ(values.at(R"(dyncal_analysis_runs{state="waiting"})"), 1);
  EXPECT_EQ(values.at(R"(dyncal_analysis_runs{state="armed"})"), 2);
  EXPECT_EQ(values.at(R"(dyncal_analysis_runs{state="refused"})"), 3);
  EXPECT_EQ(values.at(R"(dyncal_analysis_runs{state="finished"})"), 4);
  EXPECT_EQ(values.at("dyncal_analysis_evaluation_seconds_total"), 1.5);
  EXPECT_EQ(values.at(R"(dyncal_analysis_held{what="benches"})"), 8);
  EXPECT_EQ(values.at(R"(dyncal_analysis_held{what="sources"})"), 9);
  EXPECT_EQ(values.at(R"(dyncal_analysis_held{what="runs_of_others"})"), 10);
  EXPECT_EQ(values.at(R"(dyncal_analysis_left_out_total{what="runs"})"), 11);
  const std::string source = R"({bench="acc-1",source="dau"})";
  EXPECT_EQ(values.at("dyncal_analysis_messages_duplicate_total" + source), 12);
  EXPECT_EQ(values.at("dyncal_analysis_messages_of_others_total" + source), 13);
  EXPECT_EQ(values.at("dyncal_malformed_messages_total"), 6);
  EXPECT_EQ(values.at("dyncal_refused_packets_total"), 7);
}

TEST_F(MetricsTest, ServesWhatAGuardDoes) {
  report(GuardFigures{.bench = "acc-1", .switched_off = 3, .may_be_on = true}, store_);
  report(GuardFigures{.bench = "acc-2"}, store_);
  const auto values = scrape();
  EXPECT_EQ(values.at(R"(dyncal_guard_outputs_switched_off_total{bench="acc-1"})"), 3);
  EXPECT_EQ(values.at(R"(dyncal_guard_output_may_be_on{bench="acc-1"})"), 1);
  EXPECT_EQ(values.at(R"(dyncal_guard_outputs_switched_off_total{bench="acc-2"})"), 0);
  EXPECT_EQ(values.at(R"(dyncal_guard_output_may_be_on{bench="acc-2"})"), 0);
}

TEST_F(MetricsTest, ServesWhatEveryProcessHas) {
  const auto values = scrape();
  EXPECT_GT(values.at("process_resident_memory_bytes"), 1e6);
  EXPECT_GT(values.at("process_cpu_seconds_total"), 0.0);
  EXPECT_GT(values.at("process_open_fds"), 3);
  EXPECT_GE(values.at("process_threads"), 2);
}

TEST_F(MetricsTest, NamesKindsAsPrometheusDoes) {
  report(AnalysisFigures{}, store_);
  report(WebFigures{}, store_);
  report(wire::SourceStatus{}, 0, store_);
  const std::string text = fetch_metrics(server_->port());
  EXPECT_THAT(text, HasSubstr("200 OK"));
  EXPECT_THAT(text, HasSubstr("# TYPE dyncal_analysis_runs gauge"));
  EXPECT_THAT(text, HasSubstr("# TYPE dyncal_analysis_evaluation_seconds_total counter"));
  std::istringstream lines(text);
  int families = 0;
  for (std::string line, name, kind; std::getline(lines, line);) {
    if (line.starts_with("# TYPE dyncal_")) {
      std::istringstream(line.substr(std::string("# TYPE ").size())) >> name >> kind;
      EXPECT_EQ(kind, name.ends_with("_total") ? "counter" : "gauge") << name;
      EXPECT_THAT(name, ContainsRegex("^dyncal_[a-z_]+$"));
      ++families;
    }
  }
  EXPECT_EQ(families, 21);
}

TEST_F(MetricsTest, RefusesAPortThatIsInUse) {
  const std::string address = "127.0.0.1:" + std::to_string(server_->port());
  const auto second = MetricsServer::start(address, store_);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::network);
  EXPECT_EQ(second.error().message,
            "--metrics " + address +
                ": cannot listen there (Address already in use); give every program of this host a "
                "port of its own");
}

TEST_F(MetricsTest, RefusesWhatIsNoAddress) {
  for (const std::string text : {"9464", "localhost:9464", "127.0.0.1:", "127.0.0.1:70000", ":1"}) {
    const auto server = MetricsServer::start(text, store_);
    ASSERT_FALSE(server) << text;
    EXPECT_EQ(server.error().code, ErrorCode::bad_argument);
    EXPECT_THAT(server.error().message, HasSubstr("must be ADDRESS:PORT"));
  }
}

TEST_F(MetricsTest, AreServedByASupervisorThatIsAskedTo) {
  const ProgramIdentity identity{"dyncal-acs", "lab-2", 1, "dyncal 0.2.0", "cyclonedds"};
  const auto silent = Supervisor::create(identity, "");
  ASSERT_TRUE(silent) << silent.error().message;
  const std::string address = "127.0.0.1:" + std::to_string(server_->port());
  EXPECT_FALSE(Supervisor::create(identity, address)) << "in use";
  server_.reset();
  const auto serving = Supervisor::create(identity, address);
  ASSERT_TRUE(serving) << serving.error().message;
  const int port = std::stoi(address.substr(address.find(':') + 1));
  EXPECT_THAT(fetch_metrics(port),
              HasSubstr("dyncal_build_info{dds=\"cyclonedds\",program=\"dyncal-acs\""));
}

} // namespace
} // namespace dyncal::inline daemon
