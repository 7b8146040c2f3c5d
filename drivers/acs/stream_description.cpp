// The description line of the instrument's stream.
#include <nlohmann/json.hpp>

#include "drivers/acs/socket_acs.hpp"
#include "drivers/sample_rate.hpp"

namespace dyncal::drivers::acs {
namespace {

using Json = nlohmann::json;

// Of a name or another text: it is shown in lists and stands in log lines.
constexpr std::size_t max_text_bytes = 128;

// Reads members of one object; the first that is missing or of the wrong type is remembered.
class Members {
public:
  Members(const Json& object, std::string where, std::string& problem)
      : object_(object), where_(std::move(where)), problem_(problem) {}

  template <class T>
  T required(const char* name) {
    if (!object_.is_object() || !object_.contains(name)) {
      note(name, "is missing");
      return T{};
    }
    return optional<T>(name, T{});
  }

  template <class T>
  T optional(const char* name, T otherwise) {
    if (!object_.is_object() || !object_.contains(name)) {
      return otherwise;
    }
    const Json& value = object_[name];
    bool fits = false;
    if constexpr (std::is_same_v<T, std::string>) {
      fits = value.is_string();
    } else if constexpr (std::is_integral_v<T>) {
      fits = value.is_number_integer();
    } else {
      fits = value.is_number();
    }
    if (!fits) {
      note(name, "has the wrong type");
      return otherwise;
    }
    if constexpr (std::is_same_v<T, std::string>) {
      if (value.template get_ref<const std::string&>().size() > max_text_bytes) {
        note(name, "is longer than " + std::to_string(max_text_bytes) + " bytes");
        return otherwise;
      }
    }
    return value.get<T>();
  }

  void note(const std::string& name, const std::string& what) {
    if (problem_.empty()) {
      problem_ = "'" + where_ + name + "' " + what;
    }
  }

private:
  const Json& object_;
  std::string where_;
  std::string& problem_;
};

ChannelDescription parse_channel(const Json& object, std::size_t index, bool float64, double& scale,
                                 std::string& problem) {
  Members members(object, "channels[" + std::to_string(index) + "].", problem);
  ChannelDescription channel;
  channel.name = members.required<std::string>("name");
  channel.quantity = members.optional<std::string>("quantity", "");
  channel.unit = members.required<std::string>("unit");
  channel.minimum = members.optional("minimum", 0.0);
  channel.maximum = members.optional("maximum", 0.0);
  scale = float64 ? 1.0 : members.required<double>("scale");
  channel.resolution = float64 ? 0.0 : scale;
  if (channel.name.empty()) {
    members.note("name", "is empty");
  }
  if (!(scale > 0.0)) {
    members.note("scale", "must be above 0");
  }
  return channel;
}

RegularClock parse_clock(Members& root, const Json& object, StreamDescription& stream,
                         std::string& problem) {
  const Json rate_object =
      object.is_object() && object.contains("sample_rate_hz") ? object["sample_rate_hz"] : Json();
  Members members(rate_object, "sample_rate_hz.", problem);
  const SampleRate rate{members.required<std::int64_t>("numerator"),
                        members.required<std::int64_t>("denominator")};
  if (rate.numerator <= 0 || rate.denominator <= 0 || rate.denominator > 1'000'000'000) {
    members.note("numerator",
                 "and denominator must be positive whole numbers, the denominator at most 1e9");
    return {};
  }
  stream.source.nominal_rate_hz = rate.hz();
  return rate.clock(root.required<std::int64_t>("origin_ns"));
}

StreamDescription parse_members(const Json& object, std::string& problem) {
  StreamDescription stream;
  Members root(object, "", problem);
  if (root.required<std::string>("protocol") != "dyncal-acs-stream" ||
      root.required<int>("version") != 1) {
    root.note("protocol", "must be \"dyncal-acs-stream\", version 1");
  }
  stream.source.device = root.optional<std::string>("device", "");
  stream.source.serial = root.optional<std::string>("serial", "");
  stream.source.firmware = root.optional<std::string>("firmware", "");
  stream.source.driver = "socket";
  stream.source.stamp_instant = StampInstant::conversion;
  const std::string values = root.required<std::string>("values");
  stream.float64 = values == "float64";
  if (!stream.float64 && values != "int32") {
    root.note("values", "must be \"int32\" or \"float64\"");
  }
  const std::string base = root.optional<std::string>("time_base", "local");
  stream.source.time_base = base == "utc" ? TimeBase::utc : TimeBase::local;
  if (base != "utc" && base != "local") {
    root.note("time_base", "must be \"utc\" or \"local\"");
  }
  stream.clock = parse_clock(root, object, stream, problem);
  const Json channels =
      object.is_object() && object.contains("channels") ? object["channels"] : Json();
  if (!channels.is_array() || channels.empty() || channels.size() > 64) {
    root.note("channels", "must list 1 to 64 channels");
    return stream;
  }
  for (std::size_t i = 0; i < channels.size(); ++i) {
    double scale = 1.0;
    stream.source.channels.push_back(parse_channel(channels[i], i, stream.float64, scale, problem));
    stream.scale.push_back(scale);
  }
  return stream;
}

} // namespace

Expected<StreamDescription> parse_stream_description(const std::string& line) {
  const Json object = Json::parse(line, nullptr, false);
  std::string problem;
  if (object.is_discarded()) {
    problem = "not JSON";
  }
  StreamDescription stream = problem.empty() ? parse_members(object, problem) : StreamDescription{};
  if (!problem.empty()) {
    return fail(ErrorCode::malformed, "the instrument's description line: " + problem);
  }
  return stream;
}

} // namespace dyncal::drivers::acs
