#include "drivers/files/hdf5_reader.hpp"

#include <array>
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
#include "tests/unit/drivers/files/file_playing.hpp"

namespace dyncal::drivers::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A file as the receiver writes it: fixed sizes, the tail filled with zeros.
class ReceiverFile {
public:
  explicit ReceiverFile(const std::filesystem::path& path)
      : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose),
        raw_(H5Gcreate2(file_.id(), "RAWDATA", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose) {}

  void add_sensor(const std::string& name) {
    group_ = Hdf5Handle(H5Gcreate2(raw_.id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                        H5Gclose);
  }
  template <class Number>
  void add(const std::string& name, hid_t type, hsize_t rows, const std::vector<Number>& numbers,
           const std::string& unit = "\\one") {
    const std::array<hsize_t, 2> size{rows, numbers.size() / rows};
    const Hdf5Handle space(H5Screate_simple(2, size.data(), nullptr), H5Sclose);
    const Hdf5Handle dataset(H5Dcreate2(group_.id(), name.c_str(), type, space.id(), H5P_DEFAULT,
                                        H5P_DEFAULT, H5P_DEFAULT),
                             H5Dclose);
    H5Dwrite(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
    const Hdf5Handle text(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(text.id(), unit.size());
    const Hdf5Handle one(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Handle attribute(
        H5Acreate2(dataset.id(), "Unit", text.id(), one.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    H5Awrite(attribute.id(), text.id(), unit.data());
  }
  void add_times(const std::vector<std::uint64_t>& times,
                 const std::vector<std::uint32_t>& numbers) {
    add("Absolutetime", H5T_NATIVE_UINT64, 1, times);
    add("Absolutetime_uncertainty", H5T_NATIVE_UINT32, 1,
        std::vector<std::uint32_t>(times.size(), 402));
    add("Sample_number", H5T_NATIVE_UINT32, 1, numbers);
  }

private:
  Hdf5Handle file_;
  Hdf5Handle raw_;
  Hdf5Handle group_;
};

class Hdf5ReaderTest : public testing::Test {
protected:
  [[nodiscard]] FileSettings settings(const std::string& group = "") const {
    FileSettings settings;
    settings.path = path_;
    settings.group = group;
    return settings;
  }

  tests::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "receiver.hdf5";
};

const std::vector<std::uint64_t> four_times{1'600'000'000'000'000'001, 1'600'000'000'001'000'000,
                                            1'600'000'000'004'000'007, 0};

TEST_F(Hdf5ReaderTest, PlaysWhatTheReceiverWrote) {
  {
    const Hdf5Lock lock;
    ReceiverFile file(path_);
    file.add_sensor("0x1fe40000_MPU_9250");
    file.add_times(four_times, {5, 6, 9, 0});
    file.add<float>("Acceleration", H5T_NATIVE_FLOAT, 3,
                    {1.5F, 2.5F, 3.5F, 0.F, 4.F, 5.F, 6.F, 0.F, 7.F, 8.F, 9.F, 0.F}, "\\metre");
    file.add<float>("Temperature", H5T_NATIVE_FLOAT, 1, {25.F, NAN, 26.F, 0.F});
  }
  FileSource source(settings());
  const auto described = source.describe();
  ASSERT_TRUE(described) << described.error().message;
  ASSERT_EQ(described->channels.size(), 4U);
  EXPECT_EQ(described->channels[2].name, "acceleration_z");
  EXPECT_EQ(described->channels[2].unit, "\\metre");
  EXPECT_EQ(described->channels[3].name, "temperature");
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  ASSERT_EQ(sink.blocks.size(), 2U);
  EXPECT_EQ(sink.blocks[0].first_sample, 5U);
  EXPECT_EQ(sink.blocks[1].first_sample, 9U); // the gap; the zeros behind it are not samples
  EXPECT_EQ(sink.blocks[1].samples, 1U);
  EXPECT_THAT(sink.blocks[1].values, ElementsAre(3.5, 6.0, 9.0, 26.0));
  EXPECT_THAT(sink.blocks[1].stamps_ns, ElementsAre(1'600'000'000'004'000'007));
  EXPECT_THAT(sink.blocks[1].stamp_uncertainty_ns, ElementsAre(101)); // four standard ones
  EXPECT_TRUE(std::isnan(sink.blocks[0].values[7]));
}

TEST_F(Hdf5ReaderTest, AsksWhichSensorAndRefusesWhatDoesNotFit) {
  {
    const Hdf5Lock lock;
    ReceiverFile file(path_);
    file.add_sensor("a");
    file.add_times(four_times, {5, 6, 7, 0});
    file.add_sensor("b");
    file.add_times(four_times, {5, 5, 7, 0});
    file.add<float>("Voltage", H5T_NATIVE_FLOAT, 1, {1.F, 2.F, 3.F, 4.F});
    file.add_sensor("c");
    file.add_times(four_times, {5, 6, 7, 0});
    file.add<float>("Voltage", H5T_NATIVE_FLOAT, 1, {1.F, 2.F, 3.F});
    file.add_sensor("d");
    file.add_times({0, 0}, {0, 0});
    file.add<float>("Voltage", H5T_NATIVE_FLOAT, 1, {1.F, 2.F});
    file.add_sensor("e");
  }
  const std::string path = path_.string();
  EXPECT_EQ(problem_of(settings()),
            path + ": has several sensors; name one with the key group: a, b, c, d, e");
  EXPECT_EQ(problem_of(settings("f")), path + ": no sensor 'f' in RAWDATA; it has: a, b, c, d, e");
  EXPECT_EQ(problem_of(settings("a")), path + ": RAWDATA/a: has no dataset with channels");
  EXPECT_EQ(problem_of(settings("b")),
            path + ": RAWDATA/b: sample 2: sample_number 5 after 5; it must rise");
  EXPECT_EQ(problem_of(settings("c")),
            path + ": RAWDATA/c: Voltage has 3 samples and Absolutetime 4");
  EXPECT_EQ(problem_of(settings("d")), path + ": RAWDATA/d: holds no samples: all times are 0");
  EXPECT_EQ(problem_of(settings("e")), path + ": RAWDATA/e: has no dataset Absolutetime");
}

TEST_F(Hdf5ReaderTest, RefusesWhatIsNotHdf5) {
  folder_.write("receiver.hdf5", "t_ns,a\n1,2\n");
  EXPECT_THAT(problem_of(settings()), HasSubstr("is not an HDF5 file, or is damaged"));
}

TEST_F(Hdf5ReaderTest, TellsHowMuchIsRead) {
  {
    const Hdf5Lock lock;
    ReceiverFile file(path_);
    file.add_sensor("a");
    file.add_times(four_times, {5, 6, 9, 0});
    file.add<float>("Voltage", H5T_NATIVE_FLOAT, 1, {1.F, 2.F, 3.F, 0.F});
  }
  const std::vector<double> shares = shares_of(settings());
  expect_rising_to_one(shares); // the zeros at the end are no samples
  EXPECT_DOUBLE_EQ(shares.front(), 2.0 / 3.0);
}

} // namespace
} // namespace dyncal::drivers::files
