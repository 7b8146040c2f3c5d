#include "drivers/smartup/reception.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/smartup/datagram_writer.hpp"
#include "tests/unit/drivers/smartup/recording.hpp"
#include "tests/unit/drivers/smartup/wire_vectors.hpp"

namespace dyncal::drivers::smartup {
namespace {

using tests::DatagramWriter;

constexpr std::uint32_t sensor_id = 0xbccb0100;
constexpr std::uint32_t other_id = 0xbccb0200;
constexpr std::uint32_t sync_id = 0xbccb0a00;
constexpr Sender unit_address{0xc0a80005, 7000};
constexpr std::int64_t start_ns = 1'600'000'000'000'000'000;
constexpr std::int64_t period_ns = 1'000'000;

// One reception that is fed datagrams of a unit whose host clock runs with the samples.
class ReceptionTest : public testing::Test {
protected:
  void listen(std::vector<SensorSettings> wanted) {
    std::vector<WantedSensor> with_sinks;
    for (SensorSettings& settings : wanted) {
      with_sinks.push_back(sink.wanted(std::move(settings)));
    }
    reception = std::make_unique<Reception>(std::move(with_sinks), sink);
  }
  void SetUp() override { listen({{.sensor = sensor_id, .sync_sensor = {}, .naming = {}}}); }

  static DatagramWriter::Data sample(std::uint32_t number, std::int64_t offset_ns = 0,
                                     std::uint32_t sensor = sensor_id) {
    return {.sensor = sensor,
            .sample_number = number,
            .stamp_ns = start_ns + number * period_ns + offset_ns};
  }

  void send(const DatagramWriter& datagram, Sender sender = unit_address) {
    reception->take(datagram.bytes(), sender, now);
  }

  // Datagrams of twelve samples with the numbers first ... last.
  void send_samples(std::uint32_t first, std::uint32_t last, std::int64_t offset_ns = 0,
                    Sender sender = unit_address) {
    for (std::uint32_t n = first; n <= last;) {
      DatagramWriter datagram("DATA");
      for (int i = 0; i < 12 && n <= last; ++i, ++n) {
        datagram.data(sample(n, offset_ns));
      }
      pass(12 * period_ns);
      send(datagram, sender);
    }
  }

  void describe(std::uint32_t sensor) {
    for (const auto& bytes : tests::mpu9250_descriptions(sensor)) {
      reception->take(bytes, unit_address, now);
    }
  }

  void pass(std::int64_t ns) {
    now.monotonic_ns += ns;
    now.utc_ns += ns;
    reception->tick(now);
  }

  SensorCounts counts(std::uint32_t sensor = sensor_id) {
    reception->finish(now);
    return sink.reports[sensor].counts;
  }

  tests::Recording sink;
  std::unique_ptr<Reception> reception;
  HostTime now{1'000'000'000, start_ns};
};

TEST_F(ReceptionTest, HandsOnEverySampleOnce) {
  describe(sensor_id);
  send_samples(1, 1200);
  const auto counted = counts();
  EXPECT_EQ(counted.received, 1200U);
  EXPECT_EQ(sink.samples(sensor_id), 1200U);
  EXPECT_EQ(counted.lost_in_unit + counted.lost_on_way + counted.duplicates +
                counted.stamps_not_trusted,
            0U);
  std::uint64_t expected = 1;
  for (const auto& block : sink.blocks[sensor_id]) {
    EXPECT_EQ(block.first_sample, expected);
    EXPECT_LE(block.samples, 60U);
    expected += block.samples;
  }
  EXPECT_EQ(sink.blocks[sensor_id][3].stamp_uncertainty_ns[0], 21U)
      << "a quarter of what the unit sends";
}

TEST_F(ReceptionTest, DescribesTheSensorBeforeOrAfterItsFirstSample) {
  send_samples(1, 12);
  EXPECT_TRUE(sink.descriptions[sensor_id].empty());
  describe(sensor_id);
  ASSERT_EQ(sink.descriptions[sensor_id].size(), 1U);
  const auto& description = sink.descriptions[sensor_id][0];
  EXPECT_EQ(description.device, "MPU_9250");
  EXPECT_EQ(description.serial, "0xbccb0100");
  EXPECT_EQ(description.channels.size(), 3U);
  EXPECT_EQ(description.channels[2].name, "acceleration_z");
  EXPECT_EQ(description.stamp_instant, StampInstant::data_ready_edge);
  describe(sensor_id);
  EXPECT_EQ(sink.descriptions[sensor_id].size(), 1U);
}

TEST_F(ReceptionTest, GivesUpWaitingForADescriptionWhenTwoHaveNotCome) {
  send_samples(1, 12);
  pass(8'000'000'000);
  EXPECT_TRUE(sink.descriptions[sensor_id].empty());
  pass(1'000'000'000);
  ASSERT_EQ(sink.descriptions[sensor_id].size(), 1U);
  EXPECT_EQ(sink.descriptions[sensor_id][0].channels[0].name, "data_01");
  describe(sensor_id);
  EXPECT_EQ(sink.descriptions[sensor_id].back().channels[0].name, "acceleration_x");
}

TEST_F(ReceptionTest, TellsLossInTheUnitFromLossOnTheWay) {
  send_samples(1, 240);
  DatagramWriter datagram("DATA");
  for (const std::uint32_t n : {241, 242, 244, 245, 246, 247, 248, 249, 250, 251, 252, 253}) {
    datagram.data(sample(n));
  }
  send(datagram);
  send_samples(266, 400);
  const auto counted = counts();
  EXPECT_EQ(counted.lost_in_unit, 1U);
  EXPECT_EQ(counted.lost_on_way, 12U);
  EXPECT_EQ(counted.received + counted.lost_in_unit + counted.lost_on_way, 400U);
  EXPECT_EQ(sink.reception.found_lost, 1U);
  const SampleCounts& common = sink.counts[sensor_id];
  EXPECT_EQ(common.received, counted.received);
  EXPECT_EQ(common.lost_in_device, 1U);
  EXPECT_EQ(common.lost_on_way, 12U);
  EXPECT_THAT(common.causes, testing::Contains(NamedCount{"datagrams: found lost", 1}))
      << "the sink has the newest account of the address too";
}

TEST_F(ReceptionTest, AGapShowsBetweenBlocks) {
  send_samples(1, 240);
  send_samples(253, 400);
  (void)counts();
  bool found = false;
  for (const auto& block : sink.blocks[sensor_id]) {
    found = found || block.first_sample == 253;
  }
  EXPECT_TRUE(found);
}

TEST_F(ReceptionTest, DuplicateDatagramsAreCountedAndLeftOut) {
  send_samples(1, 120);
  send_samples(109, 120);
  send_samples(121, 240);
  const auto counted = counts();
  EXPECT_EQ(counted.duplicates, 12U);
  EXPECT_EQ(counted.received, 240U);
  EXPECT_EQ(sink.samples(sensor_id), 240U);
}

TEST_F(ReceptionTest, ADatagramThatWasOvertakenStaysLost) {
  send_samples(1, 120);
  send_samples(133, 144);
  send_samples(121, 132);
  send_samples(145, 240);
  const auto counted = counts();
  EXPECT_EQ(counted.late, 12U);
  EXPECT_EQ(counted.lost_on_way, 12U);
  EXPECT_EQ(counted.received, 228U);
}

TEST_F(ReceptionTest, ARestartOfTheNumberingBeginsANewSession) {
  send_samples(1, 300);
  send_samples(1, 300, 30'000'000'000);
  const auto counted = counts();
  EXPECT_EQ(counted.restarts, 1U);
  EXPECT_EQ(counted.received, 600U);
  EXPECT_EQ(counted.lost_in_unit + counted.lost_on_way + counted.stamps_not_trusted, 0U);
  ASSERT_EQ(sink.sessions_begun_at[sensor_id].size(), 1U);
  EXPECT_EQ(sink.blocks[sensor_id].at(sink.sessions_begun_at[sensor_id][0]).first_sample, 1U);
}

TEST_F(ReceptionTest, StaleSamplesBeforeARestartAreNotHandedOn) {
  DatagramWriter first("DATA");
  for (std::uint32_t n = 5001; n <= 5006; ++n) {
    first.data(sample(n));
  }
  for (std::uint32_t n = 1; n <= 6; ++n) {
    first.data(sample(n, 60'000'000'000));
  }
  send(first);
  send_samples(7, 120, 60'000'000'000);
  const auto counted = counts();
  EXPECT_EQ(counted.stale, 6U);
  EXPECT_EQ(counted.received, 120U);
  EXPECT_EQ(counted.stamps_not_trusted, 0U);
  EXPECT_TRUE(sink.sessions_begun_at[sensor_id].empty());
  EXPECT_EQ(sink.blocks[sensor_id].at(0).first_sample, 1U);
}

TEST_F(ReceptionTest, StaleSamplesBeforeAPauseAreNotHandedOn) {
  DatagramWriter first("DATA");
  for (std::uint32_t n = 5001; n <= 5006; ++n) {
    first.data(sample(n));
  }
  for (std::uint32_t n = 5007; n <= 5012; ++n) {
    first.data(sample(n, 60'000'000'000));
  }
  send(first);
  send_samples(5013, 5120, 60'000'000'000);
  const auto counted = counts();
  EXPECT_EQ(counted.stale, 6U);
  EXPECT_EQ(counted.stamps_not_trusted, 0U);
  EXPECT_EQ(sink.blocks[sensor_id].at(0).first_sample, 5007U);
}

TEST_F(ReceptionTest, ASlowSensorHasNoStaleSamples) {
  DatagramWriter first("DATA");
  for (std::uint32_t n = 1; n <= 12; ++n) {
    first.data(sample(n, n * 3'000'000'000LL));
  }
  send(first);
  EXPECT_EQ(counts().stale, 0U);
  EXPECT_EQ(sink.samples(sensor_id), 12U);
}

TEST_F(ReceptionTest, StampsOfAnyYearAreOnlyNumbers) {
  DatagramWriter datagram("DATA");
  const std::int64_t latest_ns = std::int64_t{UINT32_MAX} * 1'000'000'000 + UINT32_MAX;
  std::uint32_t n = 0;
  for (const std::int64_t stamp_ns :
       {latest_ns, std::int64_t{1}, latest_ns, std::int64_t{1'000'000'000}, latest_ns - 1}) {
    datagram.data({.sensor = sensor_id, .sample_number = ++n, .stamp_ns = stamp_ns});
  }
  send(datagram);
  send_samples(6, 240);
  const auto counted = counts();
  EXPECT_EQ(counted.received + counted.stale, 240U);
  EXPECT_EQ(sink.samples(sensor_id), counted.received);
}

TEST_F(ReceptionTest, TheNumberWrapsWithoutLoss) {
  DatagramWriter datagram("DATA");
  for (std::uint32_t i = 0; i < 12; ++i) {
    datagram.data({.sensor = sensor_id,
                   .sample_number = UINT32_MAX - 5 + i,
                   .stamp_ns = start_ns + i * period_ns});
  }
  send(datagram);
  const auto counted = counts();
  EXPECT_EQ(counted.received, 12U);
  EXPECT_EQ(counted.lost_in_unit + counted.restarts, 0U);
  EXPECT_EQ(sink.blocks[sensor_id].at(0).samples, 12U);
}

TEST_F(ReceptionTest, RejectedMessagesAreCountedAndNotTakenForLost) {
  send_samples(1, 24);
  std::vector<std::uint8_t> incomplete;
  DatagramWriter::number(incomplete, 1, sensor_id);
  DatagramWriter::number(incomplete, 2, 25);
  DatagramWriter datagram("DATA");
  datagram.frame(incomplete).data(sample(26));
  send(datagram);
  const auto counted = counts();
  EXPECT_EQ(counted.rejected[static_cast<std::size_t>(Rejection::missing_field)], 1U);
  EXPECT_EQ(counted.received, 25U);
  EXPECT_EQ(counted.lost_in_unit, 0U);
}

TEST_F(ReceptionTest, BrokenDatagramsAreCountedByCause) {
  for (const auto* name : {"bad_truncated", "bad_varint", "bad_keyword", "bad_missing_required"}) {
    reception->take(tests::wire_vector(name), unit_address, now);
  }
  reception->finish(now);
  const auto rejected = [&](Rejection cause) {
    return sink.reception.rejected[static_cast<std::size_t>(cause)];
  };
  EXPECT_EQ(rejected(Rejection::truncated), 1U);
  EXPECT_EQ(rejected(Rejection::bad_length), 1U);
  EXPECT_EQ(rejected(Rejection::unknown_keyword), 1U);
  EXPECT_EQ(rejected(Rejection::missing_field), 1U);
  EXPECT_EQ(sink.reception.datagrams, 4U);
}

TEST_F(ReceptionTest, StampFaultsAreFlaggedAndCountedByName) {
  send_samples(1, 240);
  DatagramWriter datagram("DATA");
  auto no_uncertainty = sample(241);
  no_uncertainty.time_uncertainty_ns = 0;
  auto repeated = sample(242);
  repeated.stamp_ns = no_uncertainty.stamp_ns;
  datagram.data(no_uncertainty).data(repeated).data(sample(243, 1'000'000'000)).data(sample(244));
  send(datagram);
  const auto counted = counts();
  EXPECT_EQ(counted.stamps_not_trusted, 3U);
  EXPECT_EQ(counted.stamp_flags[5], 1U);
  EXPECT_EQ(counted.stamp_flags[4], 1U);
  EXPECT_EQ(counted.stamp_flags[0], 1U);
  EXPECT_THAT(sink.blocks[sensor_id].back().flags,
              testing::IsSupersetOf({stamp_no_uncertainty, stamp_repeated, stamp_second_slip}));
}

TEST_F(ReceptionTest, TheWireVectorsOfOneStreamGiveWhatTheySay) {
  reception->take(tests::wire_vector("data_interleaved"), unit_address, now);
  reception->take(tests::wire_vector("data_uncertainty_raw_msw"), unit_address, now);
  const auto counted = counts();
  EXPECT_EQ(counted.lost_in_unit + counted.lost_on_way, 1U);
  EXPECT_EQ(counted.received, 3U);
  EXPECT_EQ(counted.stamp_flags[4], 1U);
}

TEST_F(ReceptionTest, NewChannelsBeginANewSession) {
  send_samples(1, 240);
  DatagramWriter datagram("DATA");
  for (std::uint32_t n = 241; n <= 252; ++n) {
    auto wider = sample(n);
    wider.values.emplace_back(11, 0.5F);
    datagram.data(wider);
  }
  send(datagram);
  const auto counted = counts();
  EXPECT_EQ(counted.new_columns, 1U);
  EXPECT_EQ(counted.received, 252U);
  EXPECT_EQ(sink.sessions_begun_at[sensor_id].size(), 1U);
  EXPECT_EQ(sink.blocks[sensor_id].back().values.size(), 4 * sink.blocks[sensor_id].back().samples);
}

TEST_F(ReceptionTest, UnwantedSensorsAreReportedOnly) {
  send(DatagramWriter("DATA").data(sample(1, 0, other_id)).data(sample(2, 0, other_id)));
  reception->finish(now);
  EXPECT_TRUE(sink.blocks[other_id].empty());
  EXPECT_EQ(sink.reports.at(other_id).counts.received, 2U);
  EXPECT_FALSE(sink.reports.at(other_id).wanted);
  EXPECT_EQ(sink.reports.at(other_id).sender, "192.168.0.5:7000");
  EXPECT_FALSE(sink.reports.contains(sensor_id));
}

TEST_F(ReceptionTest, ASecondSenderOfTheSameIdIsNotMixedIn) {
  send_samples(1, 120);
  const Sender twin{0xc0a80006, 7000};
  send_samples(1, 24, 5'000'000, twin);
  send_samples(145, 240); // the time of the twin's datagrams has passed here too
  const auto counted = counts();
  EXPECT_EQ(counted.other_sender, 24U);
  EXPECT_EQ(counted.received, 216U);
}

TEST_F(ReceptionTest, AUnitThatCameBackWithAnotherAddressIsTheSameUnit) {
  send_samples(1, 120);
  pass(3'000'000'000);
  send_samples(121, 240, 3'000'000'000, {0xc0a80009, 7001});
  const auto counted = counts();
  EXPECT_EQ(counted.other_sender, 0U);
  EXPECT_EQ(counted.received, 240U);
}

TEST_F(ReceptionTest, MemoryIsBoundedAgainstInventedSensors) {
  for (std::uint32_t i = 0; i < 3000; ++i) {
    send(DatagramWriter("DATA").data(sample(1, 0, 0x10000000 + i)));
  }
  reception->finish(now);
  EXPECT_LE(sink.reports.size(), Reception::max_sensors);
  EXPECT_GT(sink.reception.refused, 1900U);
}

TEST_F(ReceptionTest, MemoryIsBoundedAgainstInventedUnits) {
  for (std::uint16_t port = 1; port <= 1000; ++port) {
    send(DatagramWriter("DATA").data(sample(1)), {0x7f000001, port});
  }
  reception->finish(now);
  EXPECT_EQ(sink.reception.refused, 1000 - Reception::max_units);
}

TEST_F(ReceptionTest, ASyncSensorIsJoinedByItsStamps) {
  listen({{.sensor = sensor_id,
           .sync_sensor = sync_id,
           .naming = {.names = {{"voltage_1", "sync"}}, .units = {}}}});
  describe(sensor_id);
  const std::vector<std::string> voltages{"Voltage/0", "Voltage/1", "Voltage/2"};
  for (const int type : {0, 1, 6}) {
    send(DatagramWriter("DSCP").description(sync_id, "ADC", type, voltages));
  }
  for (const int type : {3, 4, 5}) {
    send(DatagramWriter("DSCP").description(sync_id, "ADC", type, std::vector<float>{1, 2, 3}));
  }
  for (std::uint32_t n = 1; n <= 240; n += 6) {
    DatagramWriter datagram("DATA");
    for (std::uint32_t i = n; i < n + 6; ++i) {
      datagram.data(sample(i));
      auto adc = sample(i, 0, sync_id);
      adc.sample_number += 77;
      adc.values = {{1, 0.0F}, {2, static_cast<float>(i)}, {3, 0.0F}};
      datagram.data(adc);
    }
    send(datagram);
  }
  EXPECT_EQ(counts().without_sync, 0U);
  EXPECT_EQ(sink.samples(sensor_id), 240U);
  EXPECT_TRUE(sink.blocks[sync_id].empty());
  const auto& channels = sink.descriptions[sensor_id].back().channels;
  ASSERT_EQ(channels.size(), 6U);
  EXPECT_EQ(channels[3].name, "voltage_0");
  EXPECT_EQ(channels[4].name, "sync");
  const auto& block = sink.blocks[sensor_id][1];
  EXPECT_EQ(block.values[4 * block.samples], static_cast<double>(block.first_sample));
  EXPECT_TRUE(sink.sessions_begun_at[sensor_id].empty());
  EXPECT_TRUE(sink.reports.at(sync_id).wanted);
}

} // namespace
} // namespace dyncal::drivers::smartup
