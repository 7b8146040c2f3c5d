// What dyncal reads in a recorded series, for comparison with other programs:
//
//   series_values FILE OUTPUT [--channel CHANNEL]... [--group GROUP] [--rate HZ]
//
// Prints "NAME<tab>UNIT" of every channel. OUTPUT takes int64 sample numbers and stamps, then the
// values of channel after channel as float64. An error goes to stderr, with status 1.
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/files/file_source.hpp"
#include "drivers/sample_rate.hpp"

namespace {

using namespace dyncal::drivers;

class Columns : public SampleSink {
public:
  void describe(const SourceDescription& description) override {
    values_.resize(description.channels.size());
  }
  void begin_session() override {}
  void count(const SampleCounts&) override {}
  void warn(const std::string&) override {}
  void take(SampleBlock block) override {
    for (std::size_t i = 0; i < block.samples; ++i) {
      const std::uint64_t number = block.first_sample + i;
      numbers_.push_back(static_cast<std::int64_t>(number));
      stamps_ns_.push_back(block.clock ? block.clock->stamp_ns(number) : block.stamps_ns[i]);
    }
    for (std::size_t channel = 0; channel < values_.size(); ++channel) {
      const auto begin =
          block.values.begin() + static_cast<std::ptrdiff_t>(channel * block.samples);
      values_[channel].insert(values_[channel].end(), begin,
                              begin + static_cast<std::ptrdiff_t>(block.samples));
    }
  }
  [[nodiscard]] bool write(const std::string& path) const {
    std::ofstream file(path, std::ios::binary);
    const auto add = [&file](const auto& numbers) {
      file.write(reinterpret_cast<const char*>(numbers.data()),
                 static_cast<std::streamsize>(numbers.size() * sizeof(numbers[0])));
    };
    add(numbers_);
    add(stamps_ns_);
    for (const auto& channel : values_) {
      add(channel);
    }
    return static_cast<bool>(file.flush());
  }

private:
  std::vector<std::int64_t> numbers_;
  std::vector<std::int64_t> stamps_ns_;
  std::vector<std::vector<double>> values_;
};

int refuse(const std::string& problem) {
  std::fprintf(stderr, "%s\n", problem.c_str());
  return 1;
}

} // namespace

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  if (words.size() < 2 || words.size() % 2 != 0) {
    return refuse("series_values FILE OUTPUT [--channel CHANNEL]... [--group GROUP] [--rate HZ]");
  }
  files::FileSettings settings;
  settings.path = words[0];
  for (std::size_t i = 2; i < words.size(); i += 2) {
    if (words[i] == "--channel") {
      settings.single.push_back({words[0], words[i + 1]});
    } else if (words[i] == "--group") {
      settings.group = words[i + 1];
    } else {
      settings.sample_rate = sample_rate_from_hz(std::stod(words[i + 1]));
    }
  }
  files::FileSource source(settings);
  const auto description = source.describe();
  if (!description) {
    return refuse(description.error().message);
  }
  for (const ChannelDescription& channel : description->channels) {
    std::printf("%s\t%s\n", channel.name.c_str(), channel.unit.c_str());
  }
  Columns columns;
  if (const auto done = source.run(columns); !done) {
    return refuse(done.error().message);
  }
  return columns.write(words[1]) ? 0 : refuse("cannot write " + words[1]);
}
