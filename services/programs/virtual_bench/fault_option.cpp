#include "services/programs/virtual_bench/fault_option.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dyncal::inline programs::virtual_bench {
namespace {

namespace device = dyncal::drivers::virtual_bench;
using device::BenchFaults;
using device::ChannelFaults;

std::optional<double> number_in(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [read_to, status] = std::from_chars(text.data(), end, value);
  return status == std::errc() && read_to == end ? std::optional(value) : std::nullopt;
}

// The option taken to pieces. What has been asked for is gone, so that the rest is unknown.
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

  [[nodiscard]] tl::unexpected<Error> refuse(const std::string& what) const {
    return fail(ErrorCode::bad_argument, fmt::format("--fault {}: {}", whole_, what));
  }

  [[nodiscard]] Expected<double> value(const char* meaning, double lowest, double highest) const {
    return checked(number_in(value_), fmt::format("{}=", name_), meaning, lowest, highest);
  }

  [[nodiscard]] Expected<double> setting(const std::string& key, const char* meaning, double usual,
                                         double lowest, double highest) {
    const auto text = take(key);
    return text ? checked(number_in(*text), fmt::format("{}=", key), meaning, lowest, highest)
                : Expected<double>(usual);
  }

  [[nodiscard]] Expected<std::string> word(const std::string& key, const std::string& usual,
                                           const std::vector<std::string>& words) {
    std::string word = take(key).value_or(usual);
    if (std::ranges::find(words, word) == words.end()) {
      const std::string another = fmt::format(" or {}=", key);
      return refuse(fmt::format("write {}={}", key, fmt::join(words, another)));
    }
    return word;
  }

  [[nodiscard]] Expected<void> without_value(bool& fault) const {
    if (!value_.empty()) {
      return refuse("takes no value");
    }
    fault = true;
    return {};
  }

  [[nodiscard]] std::optional<std::string> take(const std::string& key) {
    auto found = settings_.extract(key);
    return found ? std::optional(std::move(found.mapped())) : std::nullopt;
  }

  [[nodiscard]] Expected<void> nothing_left() const {
    if (!settings_.empty()) {
      return refuse(fmt::format("has no setting \"{}\"", settings_.begin()->first));
    }
    return {};
  }

private:
  [[nodiscard]] Expected<double> checked(std::optional<double> number, const std::string& before,
                                         const char* meaning, double lowest, double highest) const {
    if (!number || !(*number >= lowest && *number <= highest)) {
      return refuse(
          fmt::format("write {}{}, a number from {} to {}", before, meaning, lowest, highest));
    }
    return *number;
  }

  std::string whole_;
  std::string name_;
  std::string value_;
  std::map<std::string, std::string> settings_;
};

Expected<ChannelFaults*> channel_of(FaultText& text, BenchFaults& faults) {
  const std::pair<const char*, ChannelFaults*> channels[] = {{"sensor", &faults.sensor},
                                                             {"reference", &faults.reference},
                                                             {"sync_acs", &faults.sync_acs},
                                                             {"sync_dau", &faults.sync_dau}};
  const std::string name = text.take("at").value_or("");
  for (const auto& [known, channel] : channels) {
    if (name == known) {
      return channel;
    }
  }
  return text.refuse("write at=CHANNEL; there are sensor, reference, sync_acs, sync_dau");
}

Expected<void> read_over_range(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(ChannelFaults* const channel, channel_of(text, faults));
  DYNCAL_TRY(channel->range, text.value("LIMIT", 1e-3, 1e4));
  return {};
}

Expected<void> read_soft_ends(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(ChannelFaults* const channel, channel_of(text, faults));
  DYNCAL_TRY(const double limit, text.value("LIMIT", 1e-3, 1e4));
  DYNCAL_TRY(const auto end, text.word("end", "both", {"both", "upper", "lower"}));
  channel->soft_upper = end == "lower" ? 0.0 : limit;
  channel->soft_lower = end == "upper" ? 0.0 : limit;
  return {};
}

Expected<void> read_held(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(ChannelFaults* const channel, channel_of(text, faults));
  DYNCAL_TRY(channel->held_part, text.value("PART", 0.0, 1.0));
  return {};
}

Expected<void> read_fifo(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(const double samples, text.value("SAMPLES", 2.0, 1e6));
  faults.fifo_samples = static_cast<std::size_t>(samples);
  return {};
}

Expected<void> read_stuck(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(ChannelFaults* const channel, channel_of(text, faults));
  DYNCAL_TRY(const double samples, text.value("SAMPLES", 1.0, 1e6));
  channel->stuck_samples = static_cast<std::size_t>(samples);
  DYNCAL_TRY(channel->stuck_every_s, text.setting("every", "SECONDS", 1.0, 1e-3, 1e6));
  return {};
}

Expected<void> read_hum(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(ChannelFaults* const channel, channel_of(text, faults));
  DYNCAL_TRY(channel->hum_rel, text.value("PART", 0.0, 10.0));
  DYNCAL_TRY(channel->hum_hz, text.setting("frequency", "HZ", 50.0, 0.1, 1e5));
  DYNCAL_TRY(const auto when, text.word("while", "always", {"always", "driven"}));
  channel->hum_while_driven = when == "driven";
  return {};
}

Expected<void> read_drift(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(ChannelFaults* const channel, channel_of(text, faults));
  DYNCAL_TRY(channel->drift_rel_per_s, text.value("PART", -10.0, 10.0));
  return {};
}

Expected<void> read_knock(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(ChannelFaults* const channel, channel_of(text, faults));
  DYNCAL_TRY(channel->knock_rel, text.value("PART", -1e3, 1e3));
  DYNCAL_TRY(channel->knock_after_s, text.setting("after", "SECONDS", 1.0, 0.0, 1e6));
  return {};
}

Expected<void> read_delay_change(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(const double by_s, text.value("SECONDS", -0.1, 0.1));
  DYNCAL_TRY(const double after_s, text.setting("after", "SECONDS", 1.0, 0.0, 1e6));
  faults.delay_change = {by_s, after_s};
  return {};
}

Expected<void> read_wandering(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(const double part, text.value("PART", 0.0, 0.5));
  DYNCAL_TRY(const double period_s, text.setting("period", "SECONDS", 1.0, 0.01, 1e6));
  faults.wandering = {part, period_s};
  return {};
}

Expected<void> read_loss(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(const double probability, text.value("PROBABILITY", 0.0, 1.0));
  DYNCAL_TRY(const auto at, text.word("at", "", {"sensor", "acs"}));
  DYNCAL_TRY(const auto counted, text.word("counted", "yes", {"yes", "no"}));
  auto& loss = at == "acs" ? faults.acs_loss : faults.sensor_loss;
  loss = {probability, counted == "yes"};
  return {};
}

Expected<void> read_free_running(FaultText& text, BenchFaults& faults) {
  return text.without_value(faults.series_start.free_running);
}

Expected<void> read_start_jitter(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(faults.series_start.jitter_s, text.value("SECONDS", 0.0, 1.0));
  return {};
}

Expected<void> read_exciter_gain(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(faults.exciter_gain, text.value("FACTOR", 1e-3, 1e3));
  return {};
}

Expected<void> read_ring_down(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(faults.ring_down_s, text.value("SECONDS", 1e-3, 10.0));
  return {};
}

Expected<void> read_left_offset(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(faults.left_in_generator.offset_v, text.value("VOLTS", -10.0, 10.0));
  return {};
}

Expected<void> read_left_burst(FaultText& text, BenchFaults& faults) {
  return text.without_value(faults.left_in_generator.in_burst);
}

Expected<void> read_no_reset(FaultText& text, BenchFaults& faults) {
  return text.without_value(faults.left_in_generator.is_kept);
}

Expected<void> read_output_stays_on(FaultText& text, BenchFaults& faults) {
  return text.without_value(faults.output_stays_on);
}

Expected<void> read_stamp_fault(FaultText& text, BenchFaults& faults) {
  DYNCAL_TRY(faults.stamps[text.name()], text.value("PROBABILITY", 0.0, 1.0));
  return {};
}

struct Fault {
  const char* name;
  const char* form;
  Expected<void> (*read)(FaultText&, BenchFaults&);
};

constexpr std::array<Fault, 19> known_faults{{
    {"over-range", "over-range=LIMIT,at=CHANNEL", read_over_range},
    {"soft-ends", "soft-ends=LIMIT,at=CHANNEL[,end=upper|lower]", read_soft_ends},
    {"held", "held=PART,at=CHANNEL", read_held},
    {"fifo", "fifo=SAMPLES", read_fifo},
    {"stuck", "stuck=SAMPLES,at=CHANNEL[,every=SECONDS]", read_stuck},
    {"hum", "hum=PART,at=CHANNEL[,frequency=HZ][,while=driven]", read_hum},
    {"drift", "drift=PART_PER_SECOND,at=CHANNEL", read_drift},
    {"knock", "knock=PART,at=CHANNEL[,after=SECONDS]", read_knock},
    {"delay-change", "delay-change=SECONDS[,after=SECONDS]", read_delay_change},
    {"wandering", "wandering=PART[,period=SECONDS]", read_wandering},
    {"loss", "loss=PROBABILITY,at=sensor|acs[,counted=no]", read_loss},
    {"free-running", "free-running", read_free_running},
    {"start-jitter", "start-jitter=SECONDS", read_start_jitter},
    {"exciter-gain", "exciter-gain=FACTOR", read_exciter_gain},
    {"ring-down", "ring-down=SECONDS", read_ring_down},
    {"generator-offset", "generator-offset=VOLTS", read_left_offset},
    {"generator-burst", "generator-burst", read_left_burst},
    {"generator-no-reset", "generator-no-reset", read_no_reset},
    {"output-stays-on", "output-stays-on", read_output_stays_on},
}};

std::vector<std::string> forms() {
  std::vector<std::string> all;
  all.reserve(known_faults.size());
  for (const Fault& fault : known_faults) {
    all.emplace_back(fault.form);
  }
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
  const bool is_of_stamps = std::ranges::find(stamp_faults, fault.name()) != stamp_faults.end();
  if (known == known_faults.end() && !is_of_stamps) {
    return fault.refuse(fmt::format("no such fault; there are: {}; of stamps: {}",
                                    fmt::join(forms(), ", "), fmt::join(stamp_faults, ", ")));
  }
  const auto read = is_of_stamps ? read_stamp_fault : known->read;
  return read(fault, faults).and_then([&] { return fault.nothing_left(); });
}

} // namespace dyncal::inline programs::virtual_bench
