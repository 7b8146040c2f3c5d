#include "services/records/exchange/hdf5_export.hpp"

#ifdef DYNCAL_HAVE_HDF5

#include <algorithm>
#include <cerrno>
#include <type_traits>

#include <fmt/core.h>

#include "services/base/output_stream.hpp"
#include "services/base/version.hpp"
#include "services/records/exchange/hdf5_samples.hpp"

namespace dyncal::inline records {
namespace {

constexpr std::uint64_t layout = 2;

std::vector<std::string> run_names(const RecordingContents& contents) {
  std::vector<std::string> names;
  for (const auto& [name, run] : contents.runs) {
    names.push_back(name);
  }
  return names;
}

// The file that is being written.
class Hdf5Export {
public:
  Hdf5Export(const ExportedRecording& recording, const ExportedRuns& runs, OutputStream& output,
             const ExportProgress& progress)
      : recording_(recording), runs_(runs), output_(output), progress_(progress),
        run_numbers_(run_names(recording.contents())) {}

  [[nodiscard]] Expected<void> write() {
    errno = 0;
    if (!create()) {
      return not_written();
    }
    DYNCAL_TRY(const auto tables, row_tables(recording_, {}));
    for (const RowTable& table : tables) {
      DYNCAL_TRY(table.source().recorded->triggered ? write_samples<wire::TriggeredRecord>(table)
                                                    : write_samples<wire::SampleBlock>(table));
    }
    return write_tables() && write_texts_of_file() && close() ? Expected<void>{} : not_written();
  }

private:
  [[nodiscard]] tl::unexpected<Error> not_written() const {
    return output_.not_written(errno == 0 ? EIO : errno);
  }

  [[nodiscard]] bool create() {
    // The newest format that MATLAB and programs of ten years ago read; its heads have checksums.
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18);
    file_ = Hdf5Handle(
        H5Fcreate(output_.unfinished_path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()),
        H5Fclose);
    if (!file_.is_open()) {
      return false;
    }
    raw_ = make_group(file_.id(), "RAWDATA");
    triggered_ = make_group(file_.id(), "TRIGGERED");
    own_ = make_group(file_.id(), "DYNCAL");
    return raw_.is_open() && triggered_.is_open() && own_.is_open();
  }

  template <class T>
  [[nodiscard]] Expected<void> write_samples(const RowTable& table) {
    const ExportedSource& source = table.source();
    Hdf5Samples samples(table, source.recorded->triggered ? triggered_.id() : raw_.id());
    if (!samples.is_open()) {
      return not_written();
    }
    auto written = recording_.for_each<T>(source, [&](const InOrder<T>& one) -> Expected<void> {
      samples_done_ += one.message.sample_count();
      if (!go_on()) {
        return fail(ErrorCode::interrupted,
                    "stopped before everything was written: nothing is left");
      }
      if constexpr (std::is_same_v<T, wire::TriggeredRecord>) {
        samples.add_shot(one.message, run_numbers_);
      }
      return samples.add(table.rows_of(one)) ? Expected<void>{} : Expected<void>(not_written());
    });
    if (!written) {
      return written;
    }
    return samples.flush() ? Expected<void>{} : not_written();
  }

  [[nodiscard]] bool go_on() const {
    return progress_(0.2 + 0.8 * static_cast<double>(samples_done_) /
                               static_cast<double>(recording_.samples()));
  }

  [[nodiscard]] Hdf5Row row_of(const wire::Excitation& one) {
    return {{"run", run_numbers_(one.run().to_string())}, // from 1, by the attribute Runs
            {"step", one.step()},
            {"repetition", one.repetition()},
            {"attempt", one.attempt()},
            {"state", static_cast<std::uint32_t>(one.state())},
            {"frequency_hz", frequency_of(one)},
            {"level_m_s2", one.level_m_s2()},
            {"window_begin_utc_ns", one.window_begin_utc_ns()},
            {"window_end_utc_ns", one.window_end_utc_ns()}};
  }
  [[nodiscard]] Hdf5Row row_of(const wire::CalibrationResult& one) {
    return {{"run", run_numbers_(one.run().to_string())},
            {"channel", channel_numbers_(one.channel().to_string())},
            {"step", one.step()},
            {"repetition", one.repetition()},
            {"valid", one.valid() ? 1U : 0U},
            {"lost", one.lost()},
            {"frequency_hz", one.frequency_hz()},
            {"level_m_s2", one.level_m_s2()},
            {"magnitude", one.magnitude()},
            {"u_magnitude", one.u_magnitude()},
            {"phase_rad", one.phase_rad()},
            {"u_phase_rad", one.u_phase_rad()},
            {"attempt", std::max(one.attempt(), 1U)}};
  }

  template <class T>
  [[nodiscard]] bool write_table(hid_t group, const char* name, const std::vector<T>& messages) {
    std::string bytes;
    for (const T& one : messages) {
      append_row(bytes, row_of(one));
    }
    return Hdf5List::create(group, name, hdf5_type(row_of(T{})))
        .append(bytes.data(), messages.size());
  }

  // For people: what the messages say, too.
  [[nodiscard]] bool write_tables() {
    const Hdf5Handle group = make_group(file_.id(), "RESULTS");
    return group.is_open() && write_table(group.id(), "Excitation", runs_.excitations) &&
           write_table(group.id(), "Results", runs_.results) &&
           write_texts(group.id(), "Channels", channel_numbers_.names()) &&
           write_texts(group.id(), "Runs", run_numbers_.names());
  }

  [[nodiscard]] bool write_texts_of_file() {
    const Hdf5Handle attachments = make_group(own_.id(), "Attachments");
    bool written = attachments.is_open();
    for (std::size_t i = 0; written && i < runs_.attachments.size(); ++i) {
      const recording::Attachment& one = runs_.attachments[i];
      const std::string name = fmt::format("{}", i + 1);
      const Hdf5Handle group = make_group(attachments.id(), name);
      written = group.is_open() && write_text(group.id(), "Name", one.name) &&
                write_text(group.id(), "Media_type", one.media_type) &&
                write_count(group.id(), "Log_time", one.log_time) &&
                write_long_text(group.id(), "Text", one.data);
    }
    const recording::ScanReport& report = recording_.contents().report;
    std::vector<std::string> damages;
    for (const recording::Damage& damage : report.damages) {
      damages.push_back(recording::to_string(damage, recording_.reader().path().filename()));
    }
    std::string all_damages;
    for (const std::string& damage : damages) {
      all_damages += damage + "\n";
    }
    return written && write_text(file_.id(), "Software", software_version()) &&
           write_count(own_.id(), "Layout", layout) &&
           write_text(own_.id(), "Library", report.library) &&
           write_long_text(own_.id(), "Damages", all_damages) &&
           write_long_text(own_.id(), "Contents_json", contents_json(recording_, runs_));
  }

  [[nodiscard]] bool close() {
    bool closed = true;
    for (Hdf5Handle* handle : {&own_, &triggered_, &raw_}) {
      closed = handle->close() && closed;
    }
    return file_.close() && closed;
  }

  const ExportedRecording& recording_;
  const ExportedRuns& runs_;
  OutputStream& output_;
  const ExportProgress& progress_;
  RunNumbers run_numbers_;
  RunNumbers channel_numbers_{std::vector<std::string>{}};
  std::uint64_t samples_done_ = 0;
  // What is in the file is closed before the file.
  Hdf5Handle file_;
  Hdf5Handle raw_;
  Hdf5Handle triggered_;
  Hdf5Handle own_;
};

} // namespace

Expected<void> export_hdf5(const ExportedRecording& recording, const ExportedRuns& runs,
                           const std::filesystem::path& to, const ExportProgress& progress) {
  DYNCAL_TRY(auto output, OutputStream::create(to));
  {
    const drivers::files::Hdf5Lock lock;
    Hdf5Export file(recording, runs, output, progress);
    DYNCAL_TRY(file.write());
  }
  return output.finish();
}

} // namespace dyncal::inline records

#else

namespace dyncal::inline records {

Expected<void> export_hdf5(const ExportedRecording& /*recording*/, const ExportedRuns& /*runs*/,
                           const std::filesystem::path& to, const ExportProgress& /*progress*/) {
  return fail(ErrorCode::bad_argument,
              to.string() + ": this build has no HDF5 (Debian: libhdf5-dev); choose npz, csv or "
                            "mcap-rows");
}

} // namespace dyncal::inline records

#endif
