#include "drivers/files/joined_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/files/file_playing.hpp"
#include "tests/unit/drivers/files/tdms_bytes.hpp"

namespace dyncal::drivers::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// One channel of numbers 1, 2, ... at 1 kHz, from a time in milliseconds on; 0: without a time.
std::string tdms(const std::string& path, std::uint64_t values, std::int64_t start_ms) {
  TdmsBytes metadata;
  metadata.add(std::uint32_t{1}).text(path).index(1, values);
  metadata.add(std::uint32_t{start_ms == 0 ? 1U : 2U}).property("wf_increment", 0.001);
  if (start_ms != 0) {
    metadata.text("wf_start_offset").add(std::uint32_t{10});
    metadata.add(1e-3 * static_cast<double>(start_ms));
  }
  std::string data;
  for (std::uint64_t i = 1; i <= values; ++i) {
    data += static_cast<char>(i % 100);
  }
  return tdms_segment(tdms_whole, metadata.bytes(), data);
}

FileSettings join(const std::vector<FileChannel>& channels) {
  FileSettings settings;
  settings.path = channels.front().path;
  settings.single = channels;
  return settings;
}

TEST(JoinedReader, JoinsChannelsOfSeveralFiles) {
  const TemporaryFile laser("laser.tdms", tdms("/'vib'/'velocity'", 5000, 0));
  const TemporaryFile sync("sync.tdms", tdms("/'s'/'sync'", 5000, 7));
  FileSettings settings = join({{laser.path(), "vib/velocity"}, {sync.path(), "s/sync"}});
  settings.channels = {{"velocity", "reference"}};
  settings.units = {{"reference", "\\metre\\second\\tothe{-1}"}};
  FileSource source(settings);
  const auto description = source.describe();
  ASSERT_TRUE(description) << description.error().message;
  ASSERT_EQ(description->channels.size(), 2U);
  EXPECT_EQ(description->channels[0].name, "reference");
  EXPECT_EQ(description->channels[0].unit, "\\metre\\second\\tothe{-1}");
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  ASSERT_EQ(sink.numbers.size(), 5000U);
  EXPECT_EQ(sink.channel(0), sink.channel(1));
  EXPECT_EQ(sink.channel(0)[4999], 0.0);
  EXPECT_EQ(sink.channel(0)[4998], 99.0);
  EXPECT_EQ(sink.stamps_ns.back(), 5'006'000'000); // those of the file that has times
}

TEST(JoinedReader, TakesAChannelOfAnyFormat) {
  const TemporaryFile file("three.csv",
                           "t_ns,sample_number,a,b\n5,1,1,2\n7,2,3,4\n20,5,5,6\n22,6,7,8\n");
  FileSource source(join({{file.path(), "b"}, {file.path(), "a"}}));
  ASSERT_TRUE(source.describe());
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  EXPECT_THAT(sink.channel(0), ElementsAre(2.0, 4.0, 6.0, 8.0));
  EXPECT_THAT(sink.channel(1), ElementsAre(1.0, 3.0, 5.0, 7.0));
  EXPECT_THAT(sink.numbers, ElementsAre(1, 2, 5, 6));
  EXPECT_THAT(sink.stamps_ns, ElementsAre(5, 7, 20, 22));
  EXPECT_THAT(problem_of(join({{file.path(), "c"}})),
              HasSubstr("three.csv: no channel 'c'; the file has: a, b"));
}

TEST(JoinedReader, RefusesWhatDoesNotBelongTogether) {
  const TemporaryFile one("one.tdms", tdms("/'g'/'a'", 50, 3));
  const TemporaryFile shorter("shorter.tdms", tdms("/'g'/'b'", 49, 3));
  const TemporaryFile later("later.tdms", tdms("/'g'/'b'", 50, 4));
  EXPECT_THAT(problem_of(join({{one.path(), "g/a"}, {shorter.path(), "g/b"}})),
              HasSubstr("shorter.tdms:g/b ends before the other does"));
  EXPECT_THAT(problem_of(join({{one.path(), "g/a"}, {later.path(), "g/b"}})),
              HasSubstr("their times of sample 0 differ by 1000000 ns"));
  const TemporaryFile numbered("numbered.csv", "sample_number,t_ns,c\n1,3000000,1\n2,4000000,1\n");
  EXPECT_THAT(problem_of(join({{one.path(), "a"}, {numbered.path(), "c"}})),
              HasSubstr("sample 0 stands where the other has 1"));
}

} // namespace
} // namespace dyncal::drivers::files
