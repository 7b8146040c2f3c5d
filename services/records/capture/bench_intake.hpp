// Everything that is written on one bench's topics, as the bytes that it came as, for a recording;
// and what its sources are asked for again.
//
// What is about another run than the one that is recorded is left out, and results of others are
// not even asked for: an analysis keeps those of some runs, and a slow link would be full of them
// when a run begins. Samples and states of sources belong to every run. A source whose numbers
// jump, or that answered a run's ARM command before the recorder heard it, is asked for what it has
// sent (source_gaps.hpp). Readers take at most what a reader holds at once. One thread; no function
// blocks but for a short write of a request.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/records/capture/source_gaps.hpp"
#include "services/records/mcap/mcap_record.hpp"

namespace dyncal::inline records::recording {

struct TakenMessage {
  const Channel& channel;
  Message message;        // its data last until the call returns
  bool is_result = false; // rare, and what a run is for
};

class BenchIntake {
public:
  struct Sink {
    std::function<void(const TakenMessage&)> store;
    std::function<void(const Attachment&)> attach; // the bench file of a run
  };

  // `participant` and `clock` outlive the object. Fails (network) as readers do.
  [[nodiscard]] static base::Expected<std::unique_ptr<BenchIntake>>
  open(bus::Participant& participant, bus::Clock& clock, std::string bench, std::string run,
       std::shared_ptr<bus::WakeUp> wake_up, Sink sink);
  BenchIntake(const BenchIntake&) = delete;
  BenchIntake& operator=(const BenchIntake&) = delete;

  // Hands over what has come.
  void take();
  // Asks sources for what is missing, and reads where the analysis writes. Fails (network) as
  // readers do.
  [[nodiscard]] base::Expected<void> ask();

  // By source, as metadata "dyncal.losses" has it.
  [[nodiscard]] TextMap losses() const;
  [[nodiscard]] std::uint64_t missing() const;
  // What was asked for, or of a run that is over is still to be, has yet to come or be given up.
  [[nodiscard]] bool catches_up() const;
  [[nodiscard]] std::uint64_t recovered() const;

private:
  using Instant = bus::Clock::Instant;

  struct Source {
    explicit Source(std::string asker) : gaps(std::move(asker)) {}
    SourceGaps gaps;
    const Channel* channel = nullptr; // of its samples; null: not known yet
    std::set<std::string> answered;   // runs whose ARM command was heard to be answered
    std::set<std::string> asked_all;  // runs that were asked for from their beginning
  };
  struct Run {
    std::string name; // the newest that goes on
    std::vector<std::string> sources;
    Instant since{};
    bool over = false; // kept until its beginnings are there
  };
  struct AnswerReaders {
    bus::Reader<wire::SampleBlock> blocks;
    bus::Reader<wire::TriggeredRecord> records;
  };

  BenchIntake(bus::Participant& participant, bus::Clock& clock, std::string bench, std::string run,
              std::shared_ptr<bus::WakeUp> wake_up, Sink sink);
  [[nodiscard]] base::Expected<void> open_readers();
  template <class T>
  [[nodiscard]] base::Expected<void> open_reader(const bus::Topic<T>& topic);
  [[nodiscard]] base::Expected<void> read_results_of_bench();
  template <class T>
  void take(const Channel& channel, const T& message, std::string_view bytes);
  template <class T>
  void take_again(const T& message, std::string_view bytes);
  template <class T>
  void store(const Channel& channel, const T& message, std::string_view bytes);
  void look_at(const wire::Measurement& measurement);
  void look_at(const wire::SourceDescription& description);
  void look_at(const wire::ServiceStatus& status);
  [[nodiscard]] Source& source(const std::string& name);
  void ask_for_beginnings(Instant now);
  [[nodiscard]] bool beginnings_are_asked_for() const;
  [[nodiscard]] base::Expected<void> open_answer_readers();

  bus::Participant& participant_;
  bus::Clock& clock_;
  std::string bench_;
  std::string only_run_;        // empty: all
  bool reads_results_of_bench_; // those of all runs
  bool older_analysis_ = false; // one that writes results for the bench alone evaluates only_run_
  std::string asker_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  Sink sink_;
  std::vector<std::function<void()>> readers_; // take what has come
  std::optional<bus::Writer<wire::CatchUpRequest>> requests_;
  std::optional<AnswerReaders> answers_;
  std::map<std::string, Source> sources_;
  std::optional<Run> run_;
  std::set<std::string> attached_;                // runs whose bench file is in the recording
  std::map<std::uint16_t, std::uint32_t> counts_; // of messages without a number, by channel
};

} // namespace dyncal::inline records::recording
