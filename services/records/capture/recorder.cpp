#include "services/records/capture/recorder.hpp"

#include <atomic>
#include <thread>

#include <fmt/core.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "services/base/version.hpp"
#include "services/bus/clock.hpp"
#include "services/bus/host_network.hpp"
#include "services/contract/digest.hpp"
#include "services/records/capture/bench_intake.hpp"
#include "services/records/capture/recorded_topics.hpp"

namespace dyncal::inline records::recording {
namespace {

using namespace std::chrono_literals;
using base::Expected;
using Instant = bus::Clock::Instant;

constexpr std::size_t chunk_bytes = std::size_t{1} << 20U;
constexpr auto chunk_interval = 1s;
constexpr auto max_wait = 100ms;
constexpr auto status_interval = 1s;
constexpr auto status_write_limit = 50ms; // it is repeated

Metadata beginning_of(const RecorderOptions& options, std::int64_t now_ns) {
  return {"dyncal.recording",
          {{"software", base::software_version()},
           {"dds", options.dds},
           {"domain", fmt::format("{}", options.domain)},
           {"host", bus::host_name()},
           {"bench", options.bench},
           {"run", options.run},
           {"began_utc_ns", fmt::format("{}", now_ns)},
           {"contract_version", fmt::format("{}", wire::CONTRACT_VERSION)},
           {"idl_sha256", contract::sha256_hex(idl_text())}}};
}

} // namespace

class Recorder::Work {
public:
  Work(bus::Participant& participant, RecorderOptions options, RecordingWriter writer)
      : participant_(participant), clock_(bus::system_clock()), options_(std::move(options)),
        wake_up_(std::make_shared<bus::WakeUp>()),
        file_(std::move(writer), options_.max_queue_bytes, options_.min_free_bytes) {}
  ~Work() { (void)stop(); }

  [[nodiscard]] Expected<void> begin() {
    DYNCAL_TRY(auto status, participant_.writer(bus::topics::recorder_status, options_.bench));
    status_writer_.emplace(std::move(status));
    auto intake = BenchIntake::open(
        participant_, clock_, options_.bench, options_.run, wake_up_,
        {.store = [this](const TakenMessage& message) { store(message); },
         .attach = [this](const Attachment& attachment) { file_.put(attachment); }});
    DYNCAL_TRY(intake);
    intake_ = std::move(*intake);
    chunk_.reserve(chunk_bytes + chunk_bytes / 8);
    next_status_ = clock_.now();
    thread_ = std::jthread([this](const std::stop_token& stop) { receive(stop); });
    return {};
  }

  Expected<RecorderStatus> stop() {
    if (thread_.joinable()) {
      thread_.request_stop();
      wake_up_->ring();
      thread_.join();
      intake_.reset();
      status_writer_.reset();
    }
    DYNCAL_TRY(file_.close());
    return status();
  }

  [[nodiscard]] RecorderStatus status() const {
    RecorderStatus status{file_.figures(), missing_, recovered_, participant_.malformed_messages(),
                          catches_up_};
    status.not_stored += dropped_;
    return status;
  }

  [[nodiscard]] const std::filesystem::path& path() const { return options_.path; }

private:
  void store(const TakenMessage& taken) {
    if (!file_.has_room(chunk_.records().size() + taken.message.data.size())) {
      ++dropped_;
      return;
    }
    if (chunk_.empty()) {
      chunk_began_ = clock_.now();
    }
    chunk_.add(taken.channel, taken.message);
    urgent_ = urgent_ || taken.is_result;
    if (chunk_.records().size() >= chunk_bytes) {
      hand_over();
    }
  }

  void hand_over() {
    if (!chunk_.empty()) {
      file_.put(std::exchange(chunk_, {}));
      chunk_.reserve(chunk_bytes + chunk_bytes / 8);
    }
    urgent_ = false;
  }

  void receive(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      clock_.wait(*wake_up_, clock_.now() + max_wait);
      turn();
    }
    intake_->take();
    hand_over();
    note();
  }

  void turn() {
    intake_->take();
    if (const auto asked = intake_->ask(); !asked) {
      spdlog::error("bench {}: {}", options_.bench, asked.error().message);
    }
    catches_up_ = intake_->catches_up();
    const Instant now = clock_.now();
    if (urgent_ || now - chunk_began_ >= chunk_interval) {
      hand_over();
    }
    if (now >= next_status_) {
      next_status_ = now + status_interval;
      note();
      publish();
    }
  }

  void note() {
    missing_ = intake_->missing();
    recovered_ = intake_->recovered();
    Metadata losses{"dyncal.losses", intake_->losses()};
    losses.entries["recorder.not_stored"] = fmt::format("{}", status().not_stored);
    losses.entries["recorder.malformed"] = fmt::format("{}", status().malformed);
    file_.note_losses(std::move(losses));
    if (const std::uint64_t dropped = dropped_; dropped > last_notice_) {
      spdlog::error("{}: the disk is too slow: {} messages could not be stored so far",
                    options_.path.string(), dropped);
      last_notice_ = dropped;
    }
  }

  void publish() {
    const RecorderStatus now = status();
    wire::ServiceStatus message;
    message.bench(options_.bench);
    message.service(
        fmt::format("recorder@{}:{}", bus::host_name(), ::getpid()).substr(0, bus::max_name));
    message.arm(wire::ARM_WAITING);
    message.health(now.ended || now.not_stored > 0 ? wire::HEALTH_FAILED : wire::HEALTH_OK);
    message.message(!now.problem.empty() ? now.problem
                    : now.not_stored > 0
                        ? fmt::format("{}: {} messages could not be stored: the disk is too slow",
                                      options_.path.string(), now.not_stored)
                        : "");
    message.software(base::software_version());
    message.dds(options_.dds);
    message.host(bus::host_name());
    message.process_id(static_cast<std::uint32_t>(::getpid()));
    message.published_utc_ns(clock_.utc_now_ns());
    message.contract_version(wire::CONTRACT_VERSION);
    message.recording(options_.path.string());
    message.messages_stored(now.stored);
    message.messages_not_stored(now.not_stored);
    status_writer_->write(message, status_write_limit);
  }

  bus::Participant& participant_;
  bus::Clock& clock_;
  RecorderOptions options_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  RecordingThread file_;
  std::optional<bus::Writer<wire::ServiceStatus>> status_writer_;
  std::unique_ptr<BenchIntake> intake_;
  Chunk chunk_; // of the receiving thread, like all without a word
  Instant chunk_began_{};
  bool urgent_ = false; // it holds a result
  Instant next_status_{};
  std::uint64_t last_notice_ = 0; // of those dropped
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<std::uint64_t> missing_{0};
  std::atomic<std::uint64_t> recovered_{0};
  std::atomic<bool> catches_up_{false};
  std::jthread thread_; // the last member: it ends before what it uses
};

Recorder::Recorder(std::unique_ptr<Work> work) : work_(std::move(work)) {}

Recorder::~Recorder() = default;

Expected<std::unique_ptr<Recorder>> Recorder::start(bus::Participant& participant,
                                                    RecorderOptions options) {
  DYNCAL_TRY(auto writer,
             RecordingWriter::create(options.path, {.library = base::software_version(),
                                                    .schemas = recorded_schemas(),
                                                    .channels = recorded_channels(),
                                                    .compression = options.compression}));
  DYNCAL_TRY(writer.add_metadata(beginning_of(options, bus::system_clock().utc_now_ns())));
  auto work = std::make_unique<Work>(participant, std::move(options), std::move(writer));
  DYNCAL_TRY(work->begin());
  return std::unique_ptr<Recorder>(new Recorder(std::move(work)));
}

RecorderStatus Recorder::status() const {
  return work_->status();
}

const std::filesystem::path& Recorder::path() const {
  return work_->path();
}

Expected<RecorderStatus> Recorder::stop() {
  return work_->stop();
}

} // namespace dyncal::inline records::recording
