#include "services/programs/virtual_bench/fault_option.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/parsed_number.hpp"

namespace dyncal::inline programs::virtual_bench {
namespace {

namespace device = dyncal::drivers::virtual_bench;
using device::BenchFaults;
using device::ChannelFaults;

// The option taken to pieces. What has been asked for is gone, so that the rest is unknown. What is
// wrong first is the problem; what is read then goes nowhere.
class FaultText {
public:
  explicit FaultText(const std::string& whole) : whole_(whole) {
    for (std::size_t begin = 0; begin <= whole.size();) {
      const std::size_t end = std::min(whole.find(',', begin), whole.size());
      const std::string part = whole.substr(begin, end - begin);
      const std::size_t sign = std::min(part.find('='), part.size());
      const std::string value = sign < part.size() ? part.substr(sign + 1) : "";
      if (begin == 0) {
        name_ = part.substr(0, sign);
        value_ = value;
      } else {
        settings_[part.substr(0, sign)] = value;
      }
      begin = end + 1;
    }
  }

  [[nodiscard]] const std::string& name() const { return name_; }

  void refuse(const std::string& what) {
    if (outcome_) {
      outcome_ = fail(ErrorCode::bad_argument, fmt::format("--fault {}: {}", whole_, what));
    }
  }

  [[nodiscard]] double value(const char* meaning, double lowest, double highest) {
    return checked(value_, name_, meaning, lowest, highest);
  }

  [[nodiscard]] double setting(const std::string& key, const char* meaning, double usual,
                               double lowest, double highest) {
    const auto text = take(key);
    return text ? checked(*text, key, meaning, lowest, highest) : usual;
  }

  [[nodiscard]] std::string word(const std::string& key, const std::string& usual,
                                 const std::vector<std::string>& words) {
    std::string word = take(key).value_or(usual);
    if (std::ranges::find(words, word) == words.end()) {
      const std::string another = fmt::format(" or {}=", key);
      refuse(fmt::format("write {}={}", key, fmt::join(words, another)));
    }
    return word;
  }

  [[nodiscard]] bool without_value() {
    if (!value_.empty()) {
      refuse("takes no value");
    }
    return true;
  }

  [[nodiscard]] ChannelFaults& channel_of(BenchFaults& faults) {
    const std::map<std::string, ChannelFaults*> channels{{"sensor", &faults.sensor},
                                                         {"reference", &faults.reference},
                                                         {"sync_acs", &faults.sync_acs},
                                                         {"sync_dau", &faults.sync_dau}};
    const auto found = channels.find(take("at").value_or(""));
    if (found == channels.end()) {
      refuse("write at=CHANNEL; there are sensor, reference, sync_acs, sync_dau");
    }
    return found == channels.end() ? nowhere_ : *found->second;
  }

  // Of all that was read.
  [[nodiscard]] Expected<void> outcome() {
    if (!settings_.empty()) {
      refuse(fmt::format("has no setting \"{}\"", settings_.begin()->first));
    }
    return outcome_;
  }

private:
  [[nodiscard]] std::optional<std::string> take(const std::string& key) {
    auto found = settings_.extract(key);
    return found ? std::optional(std::move(found.mapped())) : std::nullopt;
  }

  [[nodiscard]] double checked(const std::string& text, const std::string& key, const char* meaning,
                               double lowest, double highest) {
    const auto number = parsed_number<double>(text);
    if (!number || !(*number >= lowest && *number <= highest)) {
      refuse(fmt::format("write {}={}, a number from {} to {}", key, meaning, lowest, highest));
      return lowest;
    }
    return *number;
  }

  std::string whole_;
  std::string name_;
  std::string value_;
  std::map<std::string, std::string> settings_;
  ChannelFaults nowhere_;
  Expected<void> outcome_;
};

void read_soft_ends(FaultText& text, BenchFaults& faults) {
  ChannelFaults& channel = text.channel_of(faults);
  const double limit = text.value("LIMIT", 1e-3, 1e4);
  const std::string end = text.word("end", "both", {"both", "upper", "lower"});
  channel.soft_upper = end == "lower" ? 0.0 : limit;
  channel.soft_lower = end == "upper" ? 0.0 : limit;
}

void read_stuck(FaultText& text, BenchFaults& faults) {
  ChannelFaults& channel = text.channel_of(faults);
  channel.stuck_samples = static_cast<std::size_t>(text.value("SAMPLES", 1.0, 1e6));
  channel.stuck_every_s = text.setting("every", "SECONDS", 1.0, 1e-3, 1e6);
}

void read_hum(FaultText& text, BenchFaults& faults) {
  ChannelFaults& channel = text.channel_of(faults);
  channel.hum_rel = text.value("PART", 0.0, 10.0);
  channel.hum_hz = text.setting("frequency", "HZ", 50.0, 0.1, 1e5);
  channel.hum_while_driven = text.word("while", "always", {"always", "driven"}) == "driven";
}

void read_knock(FaultText& text, BenchFaults& faults) {
  ChannelFaults& channel = text.channel_of(faults);
  channel.knock_rel = text.value("PART", -1e3, 1e3);
  channel.knock_after_s = text.setting("after", "SECONDS", 1.0, 0.0, 1e6);
}

void read_loss(FaultText& text, BenchFaults& faults) {
  const double probability = text.value("PROBABILITY", 0.0, 1.0);
  const std::string at = text.word("at", "", {"sensor", "acs"});
  const bool is_counted = text.word("counted", "yes", {"yes", "no"}) == "yes";
  auto& loss = at == "acs" ? faults.acs_loss : faults.sensor_loss;
  loss = {probability, is_counted};
}

// A number of one channel.
template <double ChannelFaults::*member>
void read_of_channel(FaultText& text, BenchFaults& faults, const char* meaning, double lowest,
                     double highest) {
  ChannelFaults& channel = text.channel_of(faults);
  channel.*member = text.value(meaning, lowest, highest);
}

struct Fault {
  std::string_view form; // NAME=VALUE[,KEY=VALUE...]
  void (*read)(FaultText&, BenchFaults&);

  [[nodiscard]] std::string_view name() const { return form.substr(0, form.find_first_of("=,")); }
};

constexpr std::array known_faults{
    Fault{"over-range=LIMIT,at=CHANNEL",
          [](FaultText& text, BenchFaults& faults) {
            read_of_channel<&ChannelFaults::range>(text, faults, "LIMIT", 1e-3, 1e4);
          }},
    Fault{"soft-ends=LIMIT,at=CHANNEL[,end=upper|lower]", read_soft_ends},
    Fault{"second-order=PART,at=CHANNEL",
          [](FaultText& text, BenchFaults& faults) {
            read_of_channel<&ChannelFaults::second_order_rel>(text, faults, "PART", -0.5, 0.5);
          }},
    Fault{"held=PART,at=CHANNEL",
          [](FaultText& text, BenchFaults& faults) {
            read_of_channel<&ChannelFaults::held_part>(text, faults, "PART", 0.0, 1.0);
          }},
    Fault{"fifo=SAMPLES",
          [](FaultText& text, BenchFaults& faults) {
            faults.fifo_samples = static_cast<std::size_t>(text.value("SAMPLES", 2.0, 1e6));
          }},
    Fault{"stuck=SAMPLES,at=CHANNEL[,every=SECONDS]", read_stuck},
    Fault{"hum=PART,at=CHANNEL[,frequency=HZ][,while=driven]", read_hum},
    Fault{"drift=PART_PER_SECOND,at=CHANNEL",
          [](FaultText& text, BenchFaults& faults) {
            read_of_channel<&ChannelFaults::drift_rel_per_s>(text, faults, "PART", -10.0, 10.0);
          }},
    Fault{"knock=PART,at=CHANNEL[,after=SECONDS]", read_knock},
    Fault{"delay-change=SECONDS[,after=SECONDS]",
          [](FaultText& text, BenchFaults& faults) {
            faults.delay_change = {text.value("SECONDS", -0.1, 0.1),
                                   text.setting("after", "SECONDS", 1.0, 0.0, 1e6)};
          }},
    Fault{"wandering=PART[,period=SECONDS]",
          [](FaultText& text, BenchFaults& faults) {
            faults.wandering = {text.value("PART", 0.0, 0.5),
                                text.setting("period", "SECONDS", 1.0, 0.01, 1e6)};
          }},
    Fault{"loss=PROBABILITY,at=sensor|acs[,counted=no]", read_loss},
    Fault{"free-running",
          [](FaultText& text, BenchFaults& faults) {
            faults.series_start.free_running = text.without_value();
          }},
    Fault{"start-jitter=SECONDS",
          [](FaultText& text, BenchFaults& faults) {
            faults.series_start.jitter_s = text.value("SECONDS", 0.0, 1.0);
          }},
    Fault{"exciter-gain=FACTOR",
          [](FaultText& text, BenchFaults& faults) {
            faults.exciter_gain = text.value("FACTOR", 1e-3, 1e3);
          }},
    Fault{"ring-down=SECONDS",
          [](FaultText& text, BenchFaults& faults) {
            faults.ring_down_s = text.value("SECONDS", 1e-3, 10.0);
          }},
    Fault{"generator-offset=VOLTS",
          [](FaultText& text, BenchFaults& faults) {
            faults.left_in_generator.offset_v = text.value("VOLTS", -10.0, 10.0);
          }},
    Fault{"generator-burst",
          [](FaultText& text, BenchFaults& faults) {
            faults.left_in_generator.in_burst = text.without_value();
          }},
    Fault{"generator-no-reset",
          [](FaultText& text, BenchFaults& faults) {
            faults.left_in_generator.is_kept = text.without_value();
          }},
    Fault{"output-stays-on",
          [](FaultText& text, BenchFaults& faults) {
            faults.output_stays_on = text.without_value();
          }},
};

std::vector<std::string_view> forms() {
  std::vector<std::string_view> all;
  std::ranges::transform(known_faults, std::back_inserter(all), &Fault::form);
  return all;
}

} // namespace

std::string fault_help() {
  return fmt::format("what is wrong on purpose, again for each fault: {}; CHANNEL is sensor, "
                     "reference, sync_acs or sync_dau; parts are of the highest level or of the "
                     "amplitude of sync; NAME=PROBABILITY per sample for stamps: {}",
                     fmt::join(forms(), ", "), fmt::join(device::stamp_fault_names(), ", "));
}

Expected<void> read_fault(const std::string& text, BenchFaults& faults) {
  FaultText fault(text);
  const auto& stamp_faults = device::stamp_fault_names();
  const auto* known = std::ranges::find(known_faults, fault.name(), &Fault::name);
  if (known != known_faults.end()) {
    known->read(fault, faults);
  } else if (std::ranges::find(stamp_faults, fault.name()) != stamp_faults.end()) {
    faults.stamps[fault.name()] = fault.value("PROBABILITY", 0.0, 1.0);
  } else {
    fault.refuse(fmt::format("no such fault; there are: {}; of stamps: {}",
                             fmt::join(forms(), ", "), fmt::join(stamp_faults, ", ")));
  }
  return fault.outcome();
}

} // namespace dyncal::inline programs::virtual_bench
