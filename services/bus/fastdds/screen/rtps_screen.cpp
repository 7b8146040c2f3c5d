#include "services/bus/fastdds/screen/rtps_screen.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <optional>

#include "services/bus/fastdds/screen/rtps_format.hpp"
#include "services/bus/qos_profiles.hpp"

namespace dyncal::bus {

using namespace rtps_format;

namespace {

constexpr unsigned char first_of_security = 0x30;
constexpr unsigned char last_of_security = 0x34;

// Below this Fast DDS has no room for its list of missing fragments; both vendors send 1 kB and
// more.
constexpr std::uint32_t min_fragment_bytes = 64;
constexpr std::size_t max_message_bytes = 1U << 20;

void put_number(unsigned char* at, std::uint32_t value, unsigned char flags) {
  if ((flags & little_endian_flag) == 0) {
    value = __builtin_bswap32(value);
  }
  std::memcpy(at, &value, sizeof value);
}

bool nack_frag_is_whole(unsigned char flags, Bytes body) {
  constexpr std::size_t bits_at = entities_bytes + sequence_bytes + 4;
  const auto words = bitmap_words(body, bits_at, flags);
  return words && bits_at + 4 + 4 * *words + 4 <= body.size() &&
         sequence_at(body, entities_bytes, flags);
}

bool heartbeat_is_whole(unsigned char flags, Bytes body) {
  return body.size() >= entities_bytes + 2 * sequence_bytes + 4 &&
         sequence_at(body, entities_bytes, flags) &&
         sequence_at(body, entities_bytes + sequence_bytes, flags);
}

bool is_passed_unread(unsigned char id) {
  return id >= first_of_security && id <= last_of_security;
}

} // namespace

Bytes RtpsScreen::pass(Bytes datagram) {
  refused_ = true;
  if (datagram.size() < header_bytes || std::memcmp(datagram.data(), "RTPS", 4) != 0 ||
      datagram[4] != protocol_major) {
    return {};
  }
  begin(datagram.first(header_bytes));
  refused_ = !visit_submessages(datagram, [this](const Submessage& one) {
    return used_ <= max_message_bytes && pass_submessage(one.id, one.flags, one.body);
  });
  return !refused_ && used_ > header_bytes ? Bytes(buffer_.data(), used_) : Bytes();
}

void RtpsScreen::begin(Bytes header) {
  used_ = 0;
  stamp_.reset();
  append(header);
}

void RtpsScreen::append(Bytes bytes) {
  if (buffer_.size() < used_ + bytes.size() + readable_bytes_behind) {
    buffer_.resize(2 * (used_ + bytes.size() + readable_bytes_behind));
  }
  std::copy(bytes.begin(), bytes.end(), buffer_.begin() + static_cast<std::ptrdiff_t>(used_));
  used_ += bytes.size();
}

// Where its body is.
unsigned char* RtpsScreen::append_submessage(unsigned char id, unsigned char flags, Bytes body) {
  // A length of 0 stands for "to the end", which is where a longer one is.
  auto length = static_cast<std::uint16_t>(body.size() > 0xffff ? 0 : body.size());
  if ((flags & little_endian_flag) == 0) {
    length = __builtin_bswap16(length);
  }
  unsigned char header[submessage_header_bytes] = {id, flags};
  std::memcpy(header + 2, &length, sizeof length);
  append(header);
  const std::size_t at = used_;
  append(body);
  const unsigned char padding[3] = {};
  append(Bytes(padding, (4 - used_ % 4) % 4));
  return buffer_.data() + at;
}

// Returns false if the whole message is to be dropped.
bool RtpsScreen::pass_submessage(unsigned char id, unsigned char flags, Bytes body) {
  bool whole = true;
  switch (id) {
  case data:
    return pass_data(flags, body);
  case data_frag:
    return pass_fragments(flags, body);
  case gap:
    return pass_gap(flags, body);
  case acknack:
    return pass_acknack(flags, body);
  case info_timestamp:
    return pass_timestamp(flags, body);
  case nack_frag:
    whole = nack_frag_is_whole(flags, body);
    break;
  case heartbeat:
    return pass_heartbeat(flags, body);
  case heartbeat_frag:
    whole = body.size() >= entities_bytes + sequence_bytes + 8;
    break;
  case info_source:
    whole = body.size() == 20;
    break;
  case info_destination:
    whole = body.size() >= 12;
    break;
  default:
    if (!is_passed_unread(id)) {
      return true; // left out
    }
  }
  if (whole) {
    append_submessage(id, flags, body);
  }
  return whole;
}

bool RtpsScreen::pass_heartbeat(unsigned char flags, Bytes body) {
  if (!heartbeat_is_whole(flags, body)) {
    return false;
  }
  const std::int64_t first = sequence_at(body, entities_bytes, flags).value();
  const std::int64_t begin = progress_->heartbeat_begin(source(), body, first);
  unsigned char* passed = append_submessage(heartbeat, flags, body) + entities_bytes;
  if (begin != first) {
    put_number(passed, static_cast<std::uint32_t>(begin >> 32), flags);
    put_number(passed + 4, static_cast<std::uint32_t>(begin), flags);
  }
  return true;
}

bool RtpsScreen::pass_acknack(unsigned char flags, Bytes body) {
  constexpr std::size_t bits_at = entities_bytes + sequence_bytes;
  const auto words = bitmap_words(body, bits_at, flags);
  const auto base = words ? sequence_at(body, entities_bytes, flags) : std::nullopt;
  if (!base || bits_at + 4 + 4 * *words + 4 > body.size()) {
    return false;
  }
  const std::size_t count_at = bits_at + 4 + 4 * *words;
  const auto count = number_at<std::uint32_t>(body, count_at, flags);
  const bool begins_count = *base == 1 && count == 0 && (flags & final_flag) == 0;
  const AcknackCounts::Pair pair = AcknackCounts::pair(source(), body.first(entities_bytes));
  const auto now = std::chrono::steady_clock::now();
  if (const auto anew = begins_count ? acknack_counts_.begin_anew(pair, now) : std::nullopt) {
    append_beginning(flags, body.first(entities_bytes), *anew);
    return true;
  }
  const auto passed = acknack_counts_.continued(pair, {*base, *words > 0, count}, now);
  if (passed.begins_anew) {
    append_beginning(flags, body.first(entities_bytes), passed.count);
  } else {
    put_number(append_submessage(acknack, flags, body) + count_at, passed.count, flags);
  }
  return true;
}

// The ACKNACK of a reader in Fast DDS that has nothing and does not know of anything.
void RtpsScreen::append_beginning(unsigned char flags, Bytes entities, std::uint32_t count) {
  flags &= little_endian_flag;
  unsigned char body[entities_bytes + sequence_bytes + 4 + 4] = {}; // of sample 0, without a list
  std::copy(entities.begin(), entities.end(), body);
  put_number(body + entities_bytes + sequence_bytes + 4, count, flags);
  append_submessage(acknack, flags, body);
}

bool RtpsScreen::pass_data(unsigned char flags, Bytes body) {
  const auto begin = qos_begin(body, data_bytes_before_qos, flags);
  const auto qos = begin ? inline_qos(body, *begin, flags) : std::nullopt;
  if (!qos || !sequence_at(body, 4 + entities_bytes, flags)) {
    return false;
  }
  const bool has_data = (flags & data_flag) != 0;
  const bool has_key = (flags & key_flag) != 0;
  const std::size_t payload = body.size() - qos->end;
  if ((has_data && has_key) || ((has_data || has_key) && payload == 0)) {
    return false;
  }
  append_submessage(data, flags, body);
  return true;
}

bool RtpsScreen::pass_fragments(unsigned char flags, Bytes body) {
  const auto begin = qos_begin(body, fragment_bytes_before_qos, flags);
  const auto qos = begin ? inline_qos(body, *begin, flags) : std::nullopt;
  if (!qos || (flags & key_of_fragment_flag) != 0 ||
      !sequence_at(body, 4 + entities_bytes, flags)) {
    return false;
  }
  const std::uint64_t first = number_at<std::uint32_t>(body, 20, flags); // counts from 1
  const std::uint64_t count = number_at<std::uint16_t>(body, 24, flags);
  const std::uint64_t fragment_bytes = number_at<std::uint16_t>(body, 26, flags);
  const std::uint64_t sample_bytes = number_at<std::uint32_t>(body, 28, flags);
  const std::uint64_t payload = body.size() - qos->end;
  if (first == 0 || count == 0 || fragment_bytes < min_fragment_bytes ||
      sample_bytes < fragment_bytes || sample_bytes > max_sample_bytes) {
    return false;
  }
  const std::uint64_t offset = (first - 1) * fragment_bytes;
  if (offset >= sample_bytes || offset + (count - 1) * fragment_bytes >= sample_bytes ||
      payload < std::min(count * fragment_bytes, sample_bytes - offset)) {
    return false;
  }
  const SampleStamps::Sample sample = sample_of(flags, body);
  std::optional<RtpsStamp> missing_stamp;
  if (first == 1) {
    stamps_->begin(sample, stamp_);
  } else if (!stamp_) {
    missing_stamp = stamps_->of(sample);
    if (!missing_stamp) {
      return true; // left out
    }
    append_stamp(*missing_stamp);
  }
  unsigned char* passed = append_submessage(data_frag, flags, body);
  if (qos->key_hash) {
    std::memcpy(passed + *qos->key_hash, &pid_pad, sizeof pid_pad);
  }
  if (missing_stamp) {
    append_submessage(info_timestamp, little_endian_flag | no_timestamp_flag, {});
  }
  return true;
}

// The participant that sends the message.
Bytes RtpsScreen::source() const {
  return Bytes(buffer_).subspan(header_bytes - prefix_bytes, prefix_bytes);
}

SampleStamps::Sample RtpsScreen::sample_of(unsigned char flags, Bytes body) const {
  SampleStamps::Sample sample;
  std::ranges::copy(source(), sample.participant.begin());
  std::ranges::copy(body.subspan(8, sample.writer.size()), sample.writer.begin());
  sample.sequence = sequence_at(body, 4 + entities_bytes, flags).value_or(0);
  return sample;
}

bool RtpsScreen::pass_timestamp(unsigned char flags, Bytes body) {
  if ((flags & no_timestamp_flag) != 0) {
    stamp_.reset();
  } else if (body.size() < 8) {
    return false;
  } else {
    stamp_ = {number_at<std::uint32_t>(body, 0, flags), number_at<std::uint32_t>(body, 4, flags)};
  }
  append_submessage(info_timestamp, flags, body);
  return true;
}

void RtpsScreen::append_stamp(const RtpsStamp& stamp) {
  unsigned char body[8];
  put_number(body, stamp.seconds, little_endian_flag);
  put_number(body + 4, stamp.fraction, little_endian_flag);
  append_submessage(info_timestamp, little_endian_flag, body);
}

// From `first` to before `end`, as far as readers are to be told.
void RtpsScreen::append_gap(Bytes entities, std::int64_t first, std::int64_t end) {
  const ReaderProgress::Range told = progress_->of_gap(source(), entities, {first, end});
  if (told.end <= told.first) {
    return;
  }
  unsigned char body[entities_bytes + 2 * sequence_bytes + 4] = {};
  std::copy(entities.begin(), entities.end(), body);
  const auto put = [&](std::size_t at, std::int64_t sequence) {
    const auto high = static_cast<std::uint32_t>(sequence >> 32);
    const auto low = static_cast<std::uint32_t>(sequence);
    std::memcpy(body + at, &high, sizeof high);
    std::memcpy(body + at + 4, &low, sizeof low);
  };
  put(entities_bytes, told.first);
  put(entities_bytes + sequence_bytes, told.end);
  append_submessage(gap, little_endian_flag, body);
}

bool RtpsScreen::pass_gap(unsigned char flags, Bytes body) {
  constexpr std::size_t base_at = entities_bytes + sequence_bytes;
  constexpr std::size_t bits_at = base_at + sequence_bytes;
  const auto words = bitmap_words(body, bits_at, flags);
  const auto first = words ? sequence_at(body, entities_bytes, flags) : std::nullopt;
  const auto base = words ? sequence_at(body, base_at, flags) : std::nullopt;
  if (!first || !base || *first == 0) {
    return false;
  }
  const Bytes entities = body.first(entities_bytes);
  if (*base > *first) {
    append_gap(entities, *first, *base);
  }
  const std::int64_t bits = number_at<std::uint32_t>(body, bits_at, flags);
  std::int64_t begin = -1; // of a run of set bits
  for (std::int64_t bit = 0; bit <= bits; ++bit) {
    const auto word_at = bits_at + 4 + 4 * static_cast<std::size_t>(bit / 32);
    const bool set =
        bit < bits && (number_at<std::uint32_t>(body, word_at, flags) >> (31 - bit % 32) & 1U) != 0;
    if (set && begin < 0) {
      begin = bit;
    } else if (!set && begin >= 0) {
      append_gap(entities, *base + begin, *base + bit);
      begin = -1;
    }
  }
  return true;
}

} // namespace dyncal::bus
