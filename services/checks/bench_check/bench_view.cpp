#include "services/checks/bench_check/bench_view.hpp"

#include <algorithm>

#include "drivers/can/dbc/dbc.hpp"
#include "drivers/can/sensor_layout.hpp"
#include "services/bench/file/adc_file.hpp"
#include "services/instruments/stream_settings.hpp"
#include "services/records/replay/file_input.hpp"
#include "services/records/replay/shot_files.hpp"

namespace dyncal::inline checks::bench_check {
namespace {

// Of the intervals of the first block; 0: too few samples.
double rate_of(const drivers::SampleBlock& block) {
  if (block.clock) {
    return 1e9 * static_cast<double>(block.clock->interval_denominator) /
           static_cast<double>(block.clock->interval_numerator_ns);
  }
  const auto& stamps = block.stamps_ns;
  return stamps.size() < 2 || stamps.back() <= stamps.front()
             ? 0.0
             : 1e9 * static_cast<double>(stamps.size() - 1) /
                   static_cast<double>(stamps.back() - stamps.front());
}

void look_at_series(const SourceSettings& settings, SourceView& view) {
  view.problem_key = "path";
  auto input = FileInput::open(settings);
  if (!input) {
    view.problem = input.error().message;
    return;
  }
  view.description = (*input)->description();
  auto block = (*input)->next();
  if (!block) {
    view.problem = block.error().message;
    return;
  }
  if (block->samples.samples == 0) {
    view.problem = "the file has no samples";
    return;
  }
  view.rate_hz = rate_of(block->samples);
  view.rate_origin = "as its first samples show";
}

void look_at_can(const SourceSettings& settings, SourceView& view) {
  view.problem_key = "dbc";
  const auto dbc = drivers::can::read_dbc_file(settings.as<CanSourceSettings>()->dbc);
  if (!dbc) {
    view.problem = dbc.error().message;
    return;
  }
  view.warnings = dbc->warnings;
  const auto layout = drivers::can::lay_out(stream_settings(settings), *dbc);
  if (!layout) {
    view.problem = layout.error().message;
    return;
  }
  drivers::SourceDescription description;
  for (const drivers::can::ChannelLayout& channel : layout->channels) {
    description.channels.push_back(channel.description);
  }
  for (const drivers::can::DbcMessage* message : layout->messages) {
    view.messages.push_back({message->name, message->id});
  }
  view.description = std::move(description);
  view.rate_hz = layout->nominal_rate_hz;
  view.rate_origin = settings.as<CanSourceSettings>()->nominal_rate_hz > 0.0
                         ? "by its nominal_rate_hz"
                         : "by its DBC file";
}

void look_at_shots(const BenchFile& bench, const std::string& name, SourceView& view) {
  view.problem_key = "path";
  auto files = read_shot_files(bench, name);
  if (!files) {
    view.problem = files.error().message;
    return;
  }
  view.description = std::move(files->description);
  view.rate_hz = view.description->nominal_rate_hz;
  view.rate_origin = "as its files state";
}

bool is_folder_of_shots(const BenchFile& bench, const SourceSettings& source) {
  const auto* scope = source.as<OscilloscopeSourceSettings>();
  const auto* series = source.as<SeriesSourceSettings>();
  return bench.method.kind == EvaluationMethod::series_timestamping &&
         ((scope != nullptr && !scope->path.empty()) ||
          (series != nullptr && !series->path.empty()));
}

SourceView look_at_source(const BenchFile& bench, const SourceSettings& settings, bool readable) {
  SourceView view;
  view.name = settings.name;
  if (const auto* file = settings.as<FileSourceSettings>()) {
    if (std::filesystem::is_regular_file(file->path)) {
      look_at_series(settings, view);
    }
  } else if (const auto* sensor = settings.as<CanSourceSettings>()) {
    if (std::filesystem::is_regular_file(sensor->dbc)) {
      look_at_can(settings, view);
    }
  } else if (readable && is_folder_of_shots(bench, settings)) {
    look_at_shots(bench, settings.name, view);
  } else if (settings.nominal_rate_hz) {
    view.rate_hz = *settings.nominal_rate_hz;
    view.rate_origin = settings.is<AlsaSourceSettings>() || settings.is<AcsSourceSettings>()
                           ? "by its sample_rate_hz"
                           : "by its nominal_rate_hz";
  }
  return view;
}

void look_at_adc(const BenchFile& bench, BenchView& view) {
  const auto& adc = bench.corrections.adc;
  if (!adc || !std::filesystem::is_regular_file(adc->file)) {
    return;
  }
  if (auto points = read_adc_file(*adc)) {
    view.adc = std::move(*points);
  } else {
    view.adc_problem = points.error().message;
  }
}

BenchView look_at(BenchFileReading reading) {
  KeyLines lines(reading.file.text);
  BenchView view{.bench = std::move(reading.file),
                 .problems = std::move(reading.problems),
                 .lines = std::move(lines),
                 .sources = {},
                 .adc = {},
                 .adc_problem = {}};
  for (const SourceSettings& source : view.bench.sources) {
    view.sources.push_back(look_at_source(view.bench, source, view.problems.empty()));
  }
  look_at_adc(view.bench, view);
  return view;
}

} // namespace

const SourceView* BenchView::source(const std::string& name) const {
  const auto found = std::ranges::find(sources, name, &SourceView::name);
  return found == sources.end() ? nullptr : &*found;
}

bool BenchView::refused(const std::string& key) const {
  return std::ranges::find(problems, key, &BenchProblem::key) != problems.end();
}

Finding BenchView::at(Severity severity, const KeyPath& key, std::string sentence,
                      std::optional<std::size_t> entry) const {
  return {severity, text_of(key), std::move(sentence), bench.path.string(),
          lines.line_of(key, entry)};
}

BenchView look_at_bench(const std::filesystem::path& path) {
  return look_at(read_whole_bench_file(path));
}

BenchView look_at_bench_text(const std::string& text, const std::filesystem::path& path) {
  return look_at(parse_whole_bench_file(text, path));
}

} // namespace dyncal::inline checks::bench_check
