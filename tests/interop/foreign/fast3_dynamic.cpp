// C++ and Fast DDS 3, with types made while the program runs: of the table that types_of_idl.py
// makes from dyncal.idl.
//
//   fast3_dynamic TABLE read DOMAIN PARTITION BENCH RESULTS FUNCTIONS
//   fast3_dynamic TABLE write DOMAIN PARTITION BENCH SECONDS
//
// What is printed and written is in README.md.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/xtypes/dynamic_types/DynamicData.hpp>
#include <fastdds/dds/xtypes/dynamic_types/DynamicDataFactory.hpp>
#include <fastdds/dds/xtypes/dynamic_types/DynamicPubSubType.hpp>
#include <fastdds/dds/xtypes/dynamic_types/DynamicTypeBuilder.hpp>
#include <fastdds/dds/xtypes/dynamic_types/DynamicTypeBuilderFactory.hpp>
#include <fastdds/dds/xtypes/dynamic_types/MemberDescriptor.hpp>
#include <fastdds/dds/xtypes/dynamic_types/TypeDescriptor.hpp>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <thread>

namespace {

using namespace eprosima::fastdds::dds;
using Data = traits<DynamicData>::ref_type;
using Type = traits<DynamicType>::ref_type;
using std::chrono::milliseconds;

constexpr unsigned samples_a_block = 20;
constexpr milliseconds block_time{20};

template <class Thing>
Thing checked(Thing thing, const std::string& what) {
  if (!thing) {
    std::fprintf(stderr, "Fast DDS refuses the %s\n", what.c_str());
    std::exit(1);
  }
  return thing;
}

class Types {
public:
  explicit Types(const char* table) {
    std::ifstream file(table);
    std::string line, first, second, third;
    traits<DynamicTypeBuilder>::ref_type builder;
    std::string name;
    while (std::getline(file, line)) {
      std::istringstream words(line);
      words >> first >> second;
      if (first == "struct") {
        finish(name, builder);
        name = second;
        auto descriptor = traits<TypeDescriptor>::make_shared();
        descriptor->kind(TK_STRUCTURE);
        descriptor->name("dyncal::wire::" + name);
        descriptor->extensibility_kind(ExtensibilityKind::FINAL);
        builder = factory()->create_type(descriptor);
        continue;
      }
      auto member = traits<MemberDescriptor>::make_shared();
      member->name(first);
      member->type(type(second));
      member->is_key(static_cast<bool>(words >> third));
      builder->add_member(member);
    }
    finish(name, builder);
  }
  Type of_struct(const std::string& name) { return checked(structs_[name], "type " + name); }

private:
  static traits<DynamicTypeBuilderFactory>::ref_type factory() {
    return DynamicTypeBuilderFactory::get_instance();
  }
  void finish(const std::string& name, traits<DynamicTypeBuilder>::ref_type& builder) {
    if (builder) {
      structs_[name] = builder->build();
    }
  }
  Type type(const std::string& idl) {
    static const std::map<std::string, TypeKind> numbers{
        {"boolean", TK_BOOLEAN},      {"octet", TK_BYTE},      {"long", TK_INT32},
        {"unsigned_long", TK_UINT32}, {"long_long", TK_INT64}, {"unsigned_long_long", TK_UINT64},
        {"double", TK_FLOAT64}};
    constexpr auto unlimited = static_cast<std::uint32_t>(LENGTH_UNLIMITED);
    if (const auto number = numbers.find(idl); number != numbers.end()) {
      return factory()->get_primitive_type(number->second);
    }
    const std::size_t open = idl.find('<');
    const std::string inner =
        open == std::string::npos ? "" : idl.substr(open + 1, idl.rfind('>') - open - 1);
    if (idl.rfind("string", 0) == 0) {
      const auto bound = inner.empty() ? unlimited : static_cast<std::uint32_t>(std::stoul(inner));
      return factory()->create_string_type(bound)->build();
    }
    if (idl.rfind("sequence", 0) == 0) {
      return factory()->create_sequence_type(type(inner), unlimited)->build();
    }
    return of_struct(idl);
  }

  std::map<std::string, Type> structs_;
};

std::string text(const Data& data, const char* member) {
  std::string value;
  data->get_string_value(value, data->get_member_id_by_name(member));
  return value;
}

double number(const Data& data, const char* member) {
  double value = 0;
  data->get_float64_value(value, data->get_member_id_by_name(member));
  return value;
}

unsigned count(const Data& data, const char* member) {
  std::uint32_t value = 0;
  data->get_uint32_value(value, data->get_member_id_by_name(member));
  return value;
}

Data part(const Data& data, const char* member) {
  Data value;
  data->get_complex_value(value, data->get_member_id_by_name(member));
  return value;
}

void set(const Data& data, const char* member, const std::string& value) {
  data->set_string_value(data->get_member_id_by_name(member), value);
}

void set_count(const Data& data, const char* member, std::uint64_t value, bool is_long) {
  const MemberId id = data->get_member_id_by_name(member);
  is_long ? data->set_uint64_value(id, value)
          : data->set_uint32_value(id, static_cast<std::uint32_t>(value));
}

void print_result(const Data& one) {
  std::printf("CalibrationResult\t%s\t%s\t%s\t%u\t%u\t%s\t%.17g\t%.17g\t%.17g\t%.17g\t%s\t%u\t%s\n",
              text(one, "bench").c_str(), text(one, "run").c_str(), text(one, "channel").c_str(),
              count(one, "step"), count(one, "repetition"), text(one, "frequency_text_hz").c_str(),
              number(one, "magnitude"), number(one, "u_magnitude"), number(one, "phase_rad"),
              number(one, "u_phase_rad"), text(one, "unit").c_str(),
              part(one, "budget")->get_item_count(), text(one, "software").c_str());
}

void print_function(const Data& one) {
  const Data points = part(one, "points");
  std::printf("TransferFunction\t%s\t%s\t%s\t%s\t%.17g\t%u", text(one, "bench").c_str(),
              text(one, "run").c_str(), text(one, "channel").c_str(), text(one, "unit").c_str(),
              number(one, "group_delay_s"), points->get_item_count());
  for (unsigned i = 0; i < points->get_item_count(); ++i) {
    Data point;
    points->get_complex_value(point, points->get_member_id_at_index(i));
    std::printf("\t%.17g\t%.17g\t%.17g", number(point, "magnitude"), number(point, "phase_rad"),
                number(point, "u_phase_rad"));
  }
  std::printf("\n");
}

template <class Qos>
Qos make_qos(int kept) {
  Qos qos;
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = kept;
  qos.resource_limits().max_samples = 0;
  qos.resource_limits().max_instances = 0;
  qos.resource_limits().max_samples_per_instance = kept;
  qos.resource_limits().allocated_samples = 0;
  qos.endpoint().history_memory_policy =
      eprosima::fastdds::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
  qos.representation().m_value = {XCDR_DATA_REPRESENTATION};
  return qos;
}

Topic* make_topic(DomainParticipant* participant, const Type& type, const char* name) {
  TypeSupport support(new DynamicPubSubType(type));
  support.register_type(participant);
  return checked(participant->create_topic(name, support.get_type_name(), TOPIC_QOS_DEFAULT),
                 "topic");
}

int take(DataReader* reader, const Type& type, const std::string& bench,
         void (*print)(const Data&)) {
  int taken = 0;
  SampleInfo info;
  Data message = DynamicDataFactory::get_instance()->create_data(type);
  while (reader->take_next_sample(&message, &info) == RETCODE_OK) {
    if (info.valid_data && text(message, "bench") == bench) {
      print(message);
      ++taken;
    }
  }
  std::fflush(stdout);
  return taken;
}

void read(DomainParticipant* participant, Types& types, const char* partition,
          const std::string& bench, int results, int functions) {
  SubscriberQos qos;
  qos.partition().push_back(partition);
  Subscriber* subscriber = checked(participant->create_subscriber(qos), "subscriber");
  const auto reader = [&](const char* name) {
    Topic* topic = make_topic(participant, types.of_struct(name), name);
    return checked(subscriber->create_datareader(topic, make_qos<DataReaderQos>(1)), "reader");
  };
  DataReader* points = reader("CalibrationResult");
  DataReader* curves = reader("TransferFunction");
  while (results > 0 || functions > 0) {
    results -= take(points, types.of_struct("CalibrationResult"), bench, print_result);
    functions -= take(curves, types.of_struct("TransferFunction"), bench, print_function);
    std::this_thread::sleep_for(block_time);
  }
}

Data description(Types& types, const std::string& bench, std::uint64_t session) {
  auto* data = DynamicDataFactory::get_instance().get();
  const Data source = data->create_data(types.of_struct("SourceDescription"));
  set(source, "bench", bench);
  set(source, "source", "acs");
  set_count(source, "session", session, true);
  source->set_int32_value(source->get_member_id_by_name("kind"), 1); // SOURCE_ACS
  set(source, "device", "foreign source");
  const Data channels = part(source, "channels");
  const char* const described[][3] = {{"reference", "Acceleration", "\\metre\\second\\tothe{-2}"},
                                      {"sync", "Voltage", "\\volt"}};
  for (unsigned i = 0; i < 2; ++i) {
    const Data channel = data->create_data(types.of_struct("ChannelDescription"));
    set(channel, "name", described[i][0]);
    set(channel, "quantity", described[i][1]);
    set(channel, "unit", described[i][2]);
    channels->set_complex_value(static_cast<MemberId>(i), channel); // an index, in a sequence
  }
  source->set_complex_value(source->get_member_id_by_name("channels"), channels);
  source->set_float64_value(source->get_member_id_by_name("nominal_rate_hz"), 1000.0);
  set_count(source, "contract_version", 3, false);
  return source;
}

DataWriter* make_writer(DomainParticipant* participant, Publisher* publisher, const Type& type,
                        const char* name, int kept) {
  auto qos = make_qos<DataWriterQos>(kept);
  qos.publish_mode().kind = ASYNCHRONOUS_PUBLISH_MODE;
  qos.reliable_writer_qos().times.heartbeat_period = {0, 10'000'000};
  qos.reliable_writer_qos().times.nack_response_delay = {0, 0};
  qos.writer_data_lifecycle().autodispose_unregistered_instances = false;
  return checked(publisher->create_datawriter(make_topic(participant, type, name), qos), "writer");
}

void write(DomainParticipant* participant, Types& types, const char* partition,
           const std::string& bench, double seconds) {
  PublisherQos qos;
  qos.partition().push_back(partition);
  Publisher* publisher = checked(participant->create_publisher(qos), "publisher");
  DataWriter* descriptions = make_writer(
      participant, publisher, types.of_struct("SourceDescription"), "SourceDescription", 1);
  DataWriter* writer =
      make_writer(participant, publisher, types.of_struct("SampleBlock"), "AcsSamples", 250);
  const auto begin = std::chrono::steady_clock::now();
  const auto session = static_cast<std::uint64_t>(begin.time_since_epoch().count());
  Data source = description(types, bench, session);
  descriptions->write(&source);
  Data block = DynamicDataFactory::get_instance()->create_data(types.of_struct("SampleBlock"));
  set(block, "bench", bench);
  set(block, "source", "acs");
  set_count(block, "session", session, true);
  const auto set_long = [&](const char* member, std::int64_t value) {
    block->set_int64_value(block->get_member_id_by_name(member), value);
  };
  set_long("origin_ns", 250'000'000'000'000'000);
  set_long("interval_numerator_ns", 1'000'000);
  set_long("interval_denominator", 1);
  const auto blocks = static_cast<std::uint64_t>(seconds * 1000 / block_time.count());
  for (std::uint64_t i = 0; i <= blocks; ++i) {
    const unsigned length = i < blocks ? samples_a_block : 0;
    const std::uint64_t first = i * samples_a_block;
    set_count(block, "block", i, true);
    set_count(block, "first_sample", first, true);
    block->set_boolean_value(block->get_member_id_by_name("end_of_stream"), length == 0);
    set_count(block, "sample_count", length, false);
    set_count(block, "channel_count", length == 0 ? 0 : 2, false);
    std::vector<double> values;
    for (const double factor : {0.25, -0.5}) {
      for (unsigned n = 0; n < length; ++n) {
        values.push_back(static_cast<double>(first + n) * factor);
      }
    }
    block->set_float64_values(block->get_member_id_by_name("values"), values);
    writer->write(&block);
    std::this_thread::sleep_until(begin + i * block_time);
  }
  std::printf("written\t%llu\n", static_cast<unsigned long long>(blocks * samples_a_block));
  std::fflush(stdout);
  std::this_thread::sleep_for(std::chrono::seconds(3)); // repairs of the last blocks
}

} // namespace

int main(int argc, char** argv) {
  if (argc < 7) {
    std::fprintf(stderr, "usage: %s TABLE read|write DOMAIN PARTITION BENCH COUNT...\n", argv[0]);
    return 2;
  }
  Types types(argv[1]);
  auto* factory = DomainParticipantFactory::get_instance();
  factory->load_profiles();
  DomainParticipantQos qos;
  factory->get_default_participant_qos(qos);
  qos.properties().properties().emplace_back(parameter_policy_type_propagation, "disabled");
  auto* participant =
      checked(factory->create_participant(static_cast<std::uint32_t>(std::atoi(argv[3])), qos),
              "participant");
  if (std::string(argv[2]) == "write") {
    write(participant, types, argv[4], argv[5], std::atof(argv[6]));
  } else {
    read(participant, types, argv[4], argv[5], std::atoi(argv[6]), std::atoi(argv[argc - 1]));
  }
  participant->delete_contained_entities();
  factory->delete_participant(participant);
}
