#include "services/records/replay/file_input.hpp"

#include <chrono>

#include <fmt/core.h>

#include "drivers/can/log_player.hpp"
#include "services/instruments/played_source.hpp"
#include "services/instruments/stream_settings.hpp"

namespace dyncal::inline records {
namespace {

constexpr std::uint64_t session = 1; // a file is one session; nothing depends on its number

// Some 64 blocks of 4096 samples of a few channels.
constexpr RingLimits ahead_limits{.span = std::chrono::hours(1), .bytes = std::size_t{8} << 20U};

RingEntry entry_of(drivers::SampleBlock block) {
  RingEntry entry;
  entry.block = std::move(block);
  entry.session = session;
  return entry;
}

Expected<std::unique_ptr<drivers::SampleSource>> driver_of(const SourceSettings& settings) {
  if (const auto* sensor = settings.as<CanSourceSettings>(); sensor && !sensor->log.empty()) {
    return std::make_unique<drivers::can::LogPlayer>(stream_settings(settings), sensor->dbc,
                                                     sensor->log, sensor->interface_name);
  }
  if (!settings.is<FileSourceSettings>()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: source '{}' is neither a file nor a CAN log; analyse evaluates "
                            "files, use 'dyncal run' for live sources",
                            settings.where, settings.name));
  }
  SourceSettings at_once = settings;
  std::get<FileSourceSettings>(at_once.driver).play_speed = 0.0;
  if (at_once.interferometer) {
    at_once.interferometer->record.clear(); // its raw signals are recorded
  }
  return make_driver(at_once);
}

} // namespace

FileInput::FileInput(std::string source, std::unique_ptr<drivers::SampleSource> driver)
    : source_(std::move(source)), driver_(std::move(driver)), ahead_(ahead_limits) {}

FileInput::~FileInput() {
  driver_->stop();
  abandoned_.request_stop();
}

Expected<std::unique_ptr<FileInput>> FileInput::open(const SourceSettings& settings) {
  DYNCAL_TRY(auto driver, driver_of(settings));
  std::unique_ptr<FileInput> input(new FileInput(settings.name, std::move(driver)));
  auto described = input->driver_->describe();
  if (!described) {
    return fail(ErrorCode::bad_file,
                fmt::format("source '{}': {}", settings.name, described.error().message));
  }
  if (const auto known = check_units(*described, settings.identity); !known) {
    return fail(ErrorCode::bad_file,
                fmt::format("source '{}': {}", settings.name, known.error().message));
  }
  if (const auto doubts = unit_doubts(*described, settings.identity); !doubts.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("source '{}': {}: leave the unit out of one of both", settings.name,
                            doubts.front()));
  }
  input->identity_ = settings.identity;
  input->factors_ = unit_factors(*described, settings.identity);
  input->description_ = with_identity(std::move(*described), settings.identity);
  input->thread_ = std::jthread([raw = input.get()] { raw->read(); });
  return input;
}

void FileInput::describe(const drivers::SourceDescription& description) {
  const std::lock_guard lock(mutex_);
  described_.emplace_back(offered_, with_identity(description, identity_));
}

void FileInput::take(drivers::SampleBlock block) {
  ++offered_;
  convert(factors_, block.samples, block.values);
  ahead_.offer_waiting(entry_of(std::move(block)), abandoned_.get_token());
}

void FileInput::read() {
  const auto outcome = driver_->run(*this);
  if (!outcome) {
    failure_ = Error{ErrorCode::bad_file,
                     fmt::format("source '{}': {}", source_, outcome.error().message)};
  }
  RingEntry end;
  end.session = session;
  end.end_of_stream = true;
  ahead_.offer(std::move(end));
}

Expected<FileBlock> FileInput::next() {
  std::optional<RingEntry> entry = ahead_.take_waiting(abandoned_.get_token());
  if (!entry || entry->end_of_stream) {
    return failure_ ? Expected<FileBlock>(fail(*failure_))
                    : FileBlock{.samples = {}, .number = number_++, .end_of_stream = true};
  }
  FileBlock block{.samples = std::move(entry->block), .number = number_++};
  take_description(block);
  note_time(view(block));
  return block;
}

// Of those before the block the newest.
void FileInput::take_description(FileBlock& block) {
  const std::lock_guard lock(mutex_);
  while (!described_.empty() && described_.front().first <= block.number) {
    if (!(described_.front().second == description_)) {
      description_ = described_.front().second;
      block.description = description_;
    }
    described_.pop_front();
  }
}

SourceBlock FileInput::view(const FileBlock& block) const {
  SourceBlock view = view_block(block.samples, session, block.number);
  view.channels = description_.channels.size();
  view.end_of_stream = block.end_of_stream;
  return view;
}

void FileInput::note_time(const SourceBlock& block) {
  if (block.samples > 0) {
    first_ns_ = first_ns_.value_or(block.first_stamp_ns());
    reached_ns_ = block.last_stamp_ns() - *first_ns_;
  }
}

} // namespace dyncal::inline records
