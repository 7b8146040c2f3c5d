#include "drivers/files/hdf5_library.hpp"

#include <algorithm>
#include <array>
#include <mutex>

#include "drivers/files/mapped_file.hpp"

namespace dyncal::drivers::files {
namespace {

std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

tl::unexpected<Error> malformed(const std::filesystem::path& path, const std::string& problem) {
  return fail(ErrorCode::malformed, path.string() + ": " + problem);
}

} // namespace

Hdf5Lock::Hdf5Lock() {
  library_mutex().lock();
  // At the end of the program it would try once more to write what found no room, and crash.
  // Everything of ours is closed by then.
  [[maybe_unused]] static const herr_t left_alone = H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Hdf5Lock::~Hdf5Lock() {
  library_mutex().unlock();
}

Hdf5Handle& Hdf5Handle::operator=(Hdf5Handle&& other) noexcept {
  close();
  id_ = std::exchange(other.id_, H5I_INVALID_HID);
  close_ = other.close_;
  return *this;
}

bool Hdf5Handle::close() {
  return !is_open() || close_(std::exchange(id_, H5I_INVALID_HID)) >= 0;
}

Expected<Hdf5Handle> open_hdf5(const std::filesystem::path& path) {
  if (const auto file = MappedFile::open(path); !file) { // which knows why not
    return fail(file.error());
  }
  Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.is_open()) {
    return malformed(path, "is not an HDF5 file, or is damaged");
  }
  return file;
}

std::vector<std::string> hdf5_members(hid_t place, const std::string& group) {
  std::vector<std::string> names;
  const bool is_itself = group == "."; // which is not a link
  if (!is_itself && H5Lexists(place, group.c_str(), H5P_DEFAULT) <= 0) {
    return names;
  }
  const Hdf5Handle opened(H5Gopen2(place, group.c_str(), H5P_DEFAULT), H5Gclose);
  if (!opened.is_open()) {
    return names;
  }
  const auto add = [](hid_t /*group*/, const char* name, const H5L_info_t* /*info*/,
                      void* all) -> herr_t {
    static_cast<std::vector<std::string>*>(all)->emplace_back(name);
    return 0;
  };
  H5Literate(opened.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names);
  return names;
}

std::string hdf5_missing_filter(hid_t dataset) {
  const Hdf5Handle creation(H5Dget_create_plist(dataset), H5Pclose);
  const int filters = creation.is_open() ? H5Pget_nfilters(creation.id()) : 0;
  for (int i = 0; i < filters; ++i) {
    std::array<char, 64> name{};
    unsigned flags = 0;
    unsigned configuration = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(creation.id(), static_cast<unsigned>(i), &flags, &values, nullptr,
                       name.size() - 1, name.data(), &configuration);
    if (filter >= 0 && H5Zfilter_avail(filter) <= 0) {
      const std::string text(name.data());
      return (text.empty() ? "of number " : text + " (") + std::to_string(filter) +
             (text.empty() ? "" : ")");
    }
  }
  return {};
}

std::string hdf5_text(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) {
    return {};
  }
  const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Hdf5Handle type(attribute.is_open() ? H5Aget_type(attribute.id()) : H5I_INVALID_HID,
                        H5Tclose);
  const Hdf5Handle space(attribute.is_open() ? H5Aget_space(attribute.id()) : H5I_INVALID_HID,
                         H5Sclose);
  if (!type.is_open() || H5Tget_class(type.id()) != H5T_STRING ||
      H5Sget_simple_extent_npoints(space.id()) != 1) {
    return {};
  }
  if (H5Tis_variable_str(type.id()) > 0) {
    char* text = nullptr;
    if (H5Aread(attribute.id(), type.id(), &text) < 0 || text == nullptr) {
      return {};
    }
    std::string copy(text);
    H5free_memory(text);
    return copy;
  }
  constexpr std::size_t max_text = 65536;
  const std::size_t size = H5Tget_size(type.id());
  std::string text(std::min(size, max_text), '\0');
  if (size > max_text || H5Aread(attribute.id(), type.id(), text.data()) < 0) {
    return {};
  }
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

} // namespace dyncal::drivers::files
