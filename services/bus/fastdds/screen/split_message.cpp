#include "services/bus/fastdds/screen/split_message.hpp"

#include <algorithm>
#include <map>

#include "services/bus/fastdds/screen/rtps_format.hpp"

namespace dyncal::bus {
namespace {

using rtps_format::Bytes;
using Datagram = std::vector<unsigned char>;

constexpr unsigned char encrypted_prefix = 0x31;
constexpr unsigned char encrypted_postfix = 0x32;
constexpr unsigned char encrypted_message = 0x33;
constexpr unsigned char statistics = 0x80; // of Fast DDS alone
constexpr std::size_t statistics_bytes = 60;

void append(Datagram& datagram, Bytes bytes) {
  datagram.insert(datagram.end(), bytes.begin(), bytes.end());
}

class Splitting {
public:
  Splitting(Bytes header, std::size_t wanted) : header_(header), wanted_(wanted) {}

  void add(unsigned char id, Bytes submessage) {
    if (id == statistics) {
      end_.assign(submessage.begin(), submessage.end());
      return;
    }
    append(together_, submessage);
    is_encrypted_ = is_encrypted_ || id == encrypted_prefix;
    if (is_encrypted_ && id != encrypted_postfix) {
      return;
    }
    is_encrypted_ = false;
    if (parts_.empty() || parts_.back().size() + together_.size() + statistics_bytes > wanted_) {
      begin_part();
    }
    append(parts_.back(), together_);
    together_.clear();
    if (id == rtps_format::info_destination || id == rtps_format::info_timestamp ||
        id == rtps_format::info_source) {
      counts_[id].assign(submessage.begin(), submessage.end());
    }
  }
  // None where what is encrypted as one has no end.
  [[nodiscard]] std::vector<Datagram> parts() && {
    for (Datagram& part : parts_) {
      append(part, end_);
    }
    return together_.empty() ? std::move(parts_) : std::vector<Datagram>();
  }

private:
  void begin_part() {
    parts_.emplace_back(header_.begin(), header_.end());
    for (const auto& [id, submessage] : counts_) {
      append(parts_.back(), submessage);
    }
  }

  Bytes header_;
  std::size_t wanted_;
  std::vector<Datagram> parts_;
  std::map<unsigned char, Datagram> counts_; // for what comes behind
  Datagram together_;
  Datagram end_; // of each part
  bool is_encrypted_ = false;
};

} // namespace

std::vector<Datagram> split_message(Bytes message, std::size_t wanted) {
  using rtps_format::submessage_header_bytes;
  Splitting splitting(message.first(std::min(message.size(), rtps_format::header_bytes)), wanted);
  const bool is_whole =
      rtps_format::visit_submessages(message, [&](const rtps_format::Submessage& one) {
        const auto begin = static_cast<std::size_t>(one.body.data() - message.data());
        const std::size_t end =
            std::min(message.size(), begin + ((one.body.size() + 3U) & ~std::size_t{3}));
        splitting.add(one.id, message.subspan(begin - submessage_header_bytes,
                                              end - begin + submessage_header_bytes));
        return one.id != encrypted_message;
      });
  auto parts = std::move(splitting).parts();
  if (!is_whole || parts.empty()) {
    parts = {Datagram(message.begin(), message.end())};
  }
  return parts;
}

} // namespace dyncal::bus
