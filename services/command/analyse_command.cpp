#include "services/command/analyse_command.hpp"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include "drivers/utc_clock.hpp"
#include "services/acs/played_source.hpp"
#include "services/command/run_command.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "services/replay/sample_memory.hpp"
#include "services/replay/shot_files.hpp"
#include "services/run/run_plan.hpp"
#include "services/source/messages.hpp"
#include "services/version.hpp"

namespace dyncal::services {
namespace {

constexpr std::size_t blocks_ahead = 64;   // of at most 4096 samples
constexpr std::size_t max_evaluations = 4; // at once, one a processor: a step takes longer than
                                           // reading the next; each holds its samples
constexpr std::uint64_t session = 1;       // a file is one session; nothing depends on its number

// A file of the bench, read in a thread of its own that waits when it is `blocks_ahead` in front.
// The thread ends with the file, with a failure, or when the object goes.
class FileInput : public drivers::SampleSink {
public:
  static Expected<std::unique_ptr<FileInput>> open(const SourceSettings& settings,
                                                   const BenchFile& bench) {
    if (!settings.is<FileSourceSettings>()) {
      return fail(ErrorCode::bad_file,
                  fmt::format("{}: source '{}' is not a file; analyse evaluates "
                              "files, use 'dyncal run' for live sources",
                              settings.where, settings.name));
    }
    SourceSettings at_once = settings;
    std::get<FileSourceSettings>(at_once.driver).play_speed = 0.0;
    auto driver = acs::make_driver(at_once);
    if (!driver) {
      return fail(driver.error());
    }
    std::unique_ptr<FileInput> input(new FileInput(std::move(*driver)));
    input->options_.bench = bench.bench;
    input->options_.source = settings.name;
    input->options_.kind = acs::kind_of(bench.method, settings.name);
    const auto described = input->driver_->describe();
    if (!described) {
      return fail(ErrorCode::bad_file,
                  fmt::format("source '{}': {}", settings.name, described.error().message));
    }
    input->description_ = to_message(input->options_, session, software_version(), *described);
    input->thread_ = std::jthread([raw = input.get()] { raw->read(); });
    return input;
  }

  ~FileInput() override {
    driver_->stop();
    const std::lock_guard lock(mutex_);
    abandoned_ = true;
    changed_.notify_all();
  }
  FileInput(const FileInput&) = delete;
  FileInput& operator=(const FileInput&) = delete;

  [[nodiscard]] const wire::SourceDescription& description() const { return description_; }
  // How far the samples taken reach, from the first one on, in the file's own time.
  [[nodiscard]] std::int64_t reached_ns() const { return reached_ns_; }

  // The next block, or the end of the stream; waits for the reading thread.
  Expected<wire::SampleBlock> next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !blocks_.empty() || done_; });
    if (blocks_.empty() && failure_) {
      return fail(*failure_);
    }
    drivers::SampleBlock block;
    const bool end = blocks_.empty();
    if (!end) {
      block = std::move(blocks_.front());
      blocks_.pop_front();
      changed_.notify_all();
    }
    lock.unlock();
    note_time(block);
    wire::SampleBlock message = to_message(options_, session, number_++, std::move(block));
    message.channel_count(static_cast<std::uint32_t>(description_.channels().size()));
    message.end_of_stream(end);
    return message;
  }

private:
  explicit FileInput(std::unique_ptr<drivers::SampleSource> driver) : driver_(std::move(driver)) {}

  // One session, described before it is played; losses show as gaps of the sample numbers.
  void describe(const drivers::SourceDescription&) override {}
  void begin_session() override {}
  void count(const drivers::SampleCounts&) override {}
  void warn(const std::string&) override {}

  void take(drivers::SampleBlock block) override {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return blocks_.size() < blocks_ahead || abandoned_; });
    blocks_.push_back(std::move(block));
    changed_.notify_all();
  }

  void read() {
    const auto outcome = driver_->run(*this);
    const std::lock_guard lock(mutex_);
    if (!outcome) {
      failure_ = Error{ErrorCode::bad_file,
                       fmt::format("source '{}': {}", options_.source, outcome.error().message)};
    }
    done_ = true;
    changed_.notify_all();
  }

  void note_time(const drivers::SampleBlock& block) {
    if (block.samples == 0) {
      return;
    }
    const std::int64_t last = block.clock
                                  ? block.clock->stamp_ns(block.first_sample + block.samples - 1)
                                  : block.stamps_ns.back();
    const std::int64_t first =
        block.clock ? block.clock->stamp_ns(block.first_sample) : block.stamps_ns.front();
    first_ns_ = first_ns_.value_or(first);
    reached_ns_ = last - *first_ns_;
  }

  std::unique_ptr<drivers::SampleSource> driver_;
  SourceOptions options_;
  wire::SourceDescription description_;
  std::uint64_t number_ = 0;
  std::optional<std::int64_t> first_ns_;
  std::int64_t reached_ns_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<drivers::SampleBlock> blocks_;
  std::optional<Error> failure_;
  bool done_ = false;
  bool abandoned_ = false;
  std::jthread thread_;
};

using Inputs = std::vector<std::unique_ptr<FileInput>>;

// All at once: a record of shots is small beside one of samples.
Expected<void> take_shots(const BenchFile& bench, const std::string& source,
                          RunEvaluator& evaluator) {
  const auto files = read_shot_files(bench, source, evaluator.recipe().run);
  if (!files) {
    return fail(files.error());
  }
  if (auto described = evaluator.describe(files->description); !described) {
    return described;
  }
  for (const wire::TriggeredRecord& record : files->records) {
    evaluator.add(record);
  }
  return {};
}

Expected<Inputs> open_inputs(const BenchFile& bench, RunEvaluator& evaluator) {
  Inputs inputs;
  for (const std::string& name : evaluator.recipe().sources()) {
    const SourceSettings& source = *bench.source(name);
    if (source.is<OscilloscopeSourceSettings>() || source.is<SeriesSourceSettings>()) {
      if (const auto read = take_shots(bench, name, evaluator); !read) {
        return fail(read.error());
      }
      continue;
    }
    auto input = FileInput::open(source, bench);
    if (!input) {
      return fail(input.error());
    }
    if (const auto described = evaluator.describe((*input)->description()); !described) {
      return fail(described.error());
    }
    inputs.push_back(std::move(*input));
  }
  return inputs;
}

void collect(EvaluationOutput output, RunOutcome& outcome) {
  std::move(output.results.begin(), output.results.end(), std::back_inserter(outcome.results));
  std::move(output.transfer_functions.begin(), output.transfer_functions.end(),
            std::back_inserter(outcome.transfer_functions));
  std::move(output.clock_reports.begin(), output.clock_reports.end(),
            std::back_inserter(outcome.clock_reports));
}

// Takes from the file that is behind in its own time, so that no record has to wait long for the
// other.
Expected<void> evaluate(Inputs inputs, RunEvaluator& evaluator, const std::stop_token& stop,
                        RunOutcome& outcome) {
  while (!evaluator.finished() && !inputs.empty() && !stop.stop_requested()) {
    const auto behind =
        std::min_element(inputs.begin(), inputs.end(), [](const auto& a, const auto& b) {
          return a->reached_ns() < b->reached_ns();
        });
    const auto block = (*behind)->next();
    if (!block) {
      return fail(block.error());
    }
    evaluator.add(*block);
    collect(evaluator.take_output(), outcome);
    if (block->end_of_stream()) {
      inputs.erase(behind);
    }
  }
  outcome.interrupted = stop.stop_requested();
  if (!evaluator.finished()) {
    evaluator.end_of_excitation(outcome.interrupted);
    evaluator.finish_now();
    collect(evaluator.take_output(), outcome);
  }
  return {};
}

Expected<RunOutcome> analyse(const AnalyseCommand& command, const std::stop_token& stop) {
  const auto bench = read_bench_file(command.bench_file);
  if (!bench) {
    return fail(bench.error());
  }
  const auto adc = read_adc_calibration(*bench);
  if (!adc) {
    return fail(adc.error());
  }
  RunOutcome outcome;
  outcome.measurement = plan_measurement(*bench, "files", utc_now_ns(), *adc);
  auto recipe = parse_recipe(outcome.measurement);
  if (!recipe) {
    return fail(recipe.error());
  }
  RunEvaluator evaluator(
      std::move(*recipe),
      std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, max_evaluations));
  auto inputs = open_inputs(*bench, evaluator);
  if (!inputs) {
    return fail(inputs.error());
  }
  if (const auto evaluated = evaluate(std::move(*inputs), evaluator, stop, outcome); !evaluated) {
    return fail(evaluated.error());
  }
  outcome.analysis_dds = "none";
  return outcome;
}

} // namespace

int run_analyse(const AnalyseCommand& command, const std::stop_token& stop) {
  keep_memory_for_samples();
  const auto outcome = analyse(command, stop);
  if (!outcome) {
    return report_error(outcome.error());
  }
  if (const auto shown = show_outcome(*outcome, command.json, command.figures); !shown) {
    return report_error(shown.error());
  }
  return conclude(*outcome);
}

} // namespace dyncal::services
