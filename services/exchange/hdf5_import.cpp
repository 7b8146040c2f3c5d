#include "services/exchange/hdf5_import.hpp"

#include <algorithm>
#include <cctype>

#ifdef DYNCAL_HAVE_HDF5

#include <sstream>

#include <fmt/core.h>

#include "services/exchange/hdf5_columns.hpp"
#include "services/exchange/hdf5_reading.hpp"
#include "services/exchange/message_digest.hpp"
#include "services/exchange/temporary_recording.hpp"
#include "services/recording/recorded_topics.hpp"

namespace dyncal::services {
namespace {

constexpr std::uint64_t max_message_bytes = std::uint64_t{256} << 20U;
constexpr std::uint64_t max_text_bytes = std::uint64_t{256} << 20U;

// The file that is being read.
class Hdf5Import {
public:
  Hdf5Import(const std::filesystem::path& path, Hdf5Handle file, SharedWorkCount count,
             std::stop_token stop)
      : path_(path), file_(std::move(file)), count_(std::move(count)), stop_(std::move(stop)) {}

  [[nodiscard]] Expected<ImportedRecording> read() {
    if (auto opened = open(); !opened) {
      return fail(opened.error());
    }
    recording::WriterOptions options;
    options.library = hdf5_text(own_.id(), "Library");
    options.schemas = recording::recorded_schemas();
    options.channels = recording::recorded_channels();
    auto recording = TemporaryRecording::create(std::move(options));
    if (!recording) {
      return fail(recording.error());
    }
    auto added = add_attachments(*recording).and_then([&] { return add_messages(*recording); });
    if (!added) {
      return fail(added.error());
    }
    auto reader = recording->read(path_);
    if (!reader) {
      return fail(reader.error());
    }
    return ImportedRecording{std::move(*reader), damages()};
  }

private:
  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& what) const {
    return fail(ErrorCode::bad_file, fmt::format("{}: {}", path_.string(), what));
  }

  [[nodiscard]] Expected<void> open() {
    if (H5Lexists(file_.id(), "DYNCAL", H5P_DEFAULT) <= 0) {
      return wrong("is not an export of dyncal; a file with samples alone, such as the SmartUp "
                   "receiver writes, is evaluated by a bench file that names it as the file of a "
                   "source");
    }
    own_ = Hdf5Handle(H5Gopen2(file_.id(), "DYNCAL", H5P_DEFAULT), H5Gclose);
    const auto layout = hdf5_count(own_.id(), "Layout");
    if (layout != hdf5_layout) {
      return wrong(fmt::format("has layout {} of dyncal's exports, and this version reads {}",
                               layout.value_or(0), hdf5_layout));
    }
    topics_ = hdf5_texts(own_.id(), "Topics");
    runs_ = hdf5_texts(own_.id(), "Runs");
    for (const std::string& source : hdf5_texts(own_.id(), "Sources")) {
      auto columns = Hdf5Columns::open(file_.id(), source);
      if (!columns) {
        return wrong(fmt::format("source '{}': {}", source, columns.error()));
      }
      sources_.push_back(std::move(*columns));
    }
    return {};
  }

  [[nodiscard]] Expected<void> add_attachments(TemporaryRecording& recording) {
    for (const std::string& name : drivers::files::hdf5_members(own_.id(), "Attachments")) {
      const std::string place = "Attachments/" + name;
      const Hdf5Handle group(H5Gopen2(own_.id(), place.c_str(), H5P_DEFAULT), H5Gclose);
      const auto text = hdf5_long_text(group.id(), "Text", max_text_bytes);
      const auto time = hdf5_count(group.id(), "Log_time");
      if (!group.is_open() || !text || !time) {
        return wrong(place + " cannot be read");
      }
      auto added = recording.add(recording::Attachment{*time, hdf5_text(group.id(), "Name"),
                                                       hdf5_text(group.id(), "Media_type"), *text});
      if (!added) {
        return added;
      }
    }
    return {};
  }

  [[nodiscard]] Expected<void> add_messages(TemporaryRecording& recording) {
    Hdf5Window list(own_.id(), "Messages", hdf5_type<Hdf5Message>(), sizeof(Hdf5Message));
    Hdf5Window bytes(own_.id(), "Message_bytes", Hdf5Handle(H5Tcopy(H5T_NATIVE_UINT8), H5Tclose),
                     1);
    if (!list.is_open() || !bytes.is_open()) {
      return wrong("its list of messages cannot be read");
    }
    begin_work(count_, "importing", "messages", list.columns());
    MessageDigest digest;
    for (std::uint64_t i = 0; i < list.columns(); ++i) {
      if (stop_.stop_requested()) {
        return fail(ErrorCode::interrupted,
                    fmt::format("{}: interrupted while it was imported", path_.string()));
      }
      const auto* const one = list.at<Hdf5Message>(i, 1);
      if (one == nullptr || one->topic >= topics_.size()) {
        return wrong(fmt::format("message {} cannot be read", i + 1));
      }
      const auto channel =
          std::find_if(recording::recorded_channels().begin(), recording::recorded_channels().end(),
                       [&](const auto& known) { return known.topic == topics_[one->topic]; });
      if (channel == recording::recorded_channels().end()) {
        return wrong(fmt::format("message {} is of topic '{}', which this version does not know",
                                 i + 1, topics_[one->topic]));
      }
      recording::Message message;
      message.channel_id = channel->id;
      message.sequence = one->sequence;
      message.log_time = one->log_time;
      message.publish_time = one->publish_time;
      const auto data = data_of(*one, bytes);
      if (!data) {
        return wrong(fmt::format("message {}: {}", i + 1, data.error()));
      }
      message.data = *data;
      digest.add(channel->topic, message);
      if (auto added = recording.add(*channel, message); !added) {
        return added;
      }
      add_done(count_);
    }
    if (digest.hex() != hdf5_text(own_.id(), "Messages_sha256")) {
      return wrong("its samples are not those that were exported (their SHA-256 is another one): "
                   "export it again");
    }
    return {};
  }

  // Fails with the problem alone.
  [[nodiscard]] tl::expected<std::string, std::string> data_of(const Hdf5Message& message,
                                                               Hdf5Window& bytes) {
    if (message.source >= 0) {
      return static_cast<std::size_t>(message.source) < sources_.size()
                 ? sources_[static_cast<std::size_t>(message.source)].message(message.place, runs_)
                 : tl::expected<std::string, std::string>(
                       tl::unexpected(std::string("is of a source that the file does not have")));
    }
    const auto* const data = message.length > max_message_bytes
                                 ? nullptr
                                 : bytes.at<char>(message.place, message.length);
    if (data == nullptr) {
      return tl::unexpected(std::string("its bytes cannot be read"));
    }
    return std::string(data, message.length);
  }

  [[nodiscard]] std::vector<std::string> damages() const {
    std::vector<std::string> lines;
    std::istringstream text(hdf5_long_text(own_.id(), "Damages", max_text_bytes).value_or(""));
    for (std::string line; std::getline(text, line);) {
      lines.push_back(fmt::format("{}: before it was exported: {}", path_.string(), line));
    }
    return lines;
  }

  std::filesystem::path path_;
  Hdf5Handle file_;
  SharedWorkCount count_;
  std::stop_token stop_;
  Hdf5Handle own_;
  std::vector<std::string> topics_;
  std::vector<std::string> runs_;
  std::vector<Hdf5Columns> sources_;
};

} // namespace

Expected<ImportedRecording> import_hdf5(const std::filesystem::path& path,
                                        const SharedWorkCount& count, const std::stop_token& stop) {
  const drivers::files::Hdf5Lock lock;
  auto file = drivers::files::open_hdf5(path);
  if (!file) {
    return fail(ErrorCode::bad_file, file.error().message);
  }
  return Hdf5Import(path, std::move(*file), count, stop).read();
}

#else

namespace dyncal::services {

Expected<ImportedRecording> import_hdf5(const std::filesystem::path& path,
                                        const SharedWorkCount& /*count*/,
                                        const std::stop_token& /*stop*/) {
  return fail(ErrorCode::bad_file,
              path.string() + ": this build cannot read HDF5 (Debian: libhdf5-dev)");
}

#endif

bool is_hdf5(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".h5" || extension == ".hdf5";
}

} // namespace dyncal::services
