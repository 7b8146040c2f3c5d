/* C and Cyclone DDS, with types that idlc makes from dyncal.idl.
 *
 *   cyclone_c read DOMAIN PARTITION BENCH RESULTS FUNCTIONS
 *   cyclone_c write DOMAIN PARTITION BENCH SECONDS
 *
 * What is printed and written is in README.md.
 */
#include <dds/dds.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dyncal.h"

enum { samples_a_block = 20, most_taken = 16, block_ms = 20 };

static dds_entity_t checked(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    fprintf(stderr, "%s: %s\n", what, dds_strretcode(-entity));
    exit(1);
  }
  return entity;
}

static dds_qos_t* make_qos(int kept, const char* partition) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, kept);
  dds_qset_durability_service(qos, 0, DDS_HISTORY_KEEP_LAST, kept, -1, -1, -1);
  dds_qset_writer_data_lifecycle(qos, false);
  dds_qset_partition(qos, 1, &partition);
  return qos;
}

static dds_entity_t open_endpoint(dds_entity_t participant, const dds_topic_descriptor_t* type,
                                  const char* name, const char* partition, int kept, bool writes) {
  const dds_entity_t topic = checked(dds_create_topic(participant, type, name, NULL, NULL), name);
  dds_qos_t* qos = make_qos(kept, partition);
  const dds_entity_t endpoint = checked(writes ? dds_create_writer(participant, topic, qos, NULL)
                                               : dds_create_reader(participant, topic, qos, NULL),
                                        name);
  dds_delete_qos(qos);
  return endpoint;
}

static void print_result(const dyncal_wire_CalibrationResult* one) {
  printf("CalibrationResult\t%s\t%s\t%s\t%" PRIu32 "\t%" PRIu32 "\t%s\t%.17g\t%.17g\t%.17g\t%.17g"
         "\t%s\t%" PRIu32 "\t%s\n",
         one->bench, one->run, one->channel, one->step, one->repetition, one->frequency_text_hz,
         one->magnitude, one->u_magnitude, one->phase_rad, one->u_phase_rad, one->unit,
         one->budget._length, one->software);
}

static void print_function(const dyncal_wire_TransferFunction* one) {
  printf("TransferFunction\t%s\t%s\t%s\t%s\t%.17g\t%" PRIu32, one->bench, one->run, one->channel,
         one->unit, one->group_delay_s, one->points._length);
  for (uint32_t i = 0; i < one->points._length; ++i) {
    const dyncal_wire_TransferPoint* point = &one->points._buffer[i];
    printf("\t%.17g\t%.17g\t%.17g", point->magnitude, point->phase_rad, point->u_phase_rad);
  }
  printf("\n");
}

/* How many of the bench have come. */
static int take(dds_entity_t reader, const char* bench, bool results) {
  void* samples[most_taken] = {NULL};
  dds_sample_info_t infos[most_taken];
  const int taken = checked(dds_take(reader, samples, infos, most_taken, most_taken), "take");
  int count = 0;
  for (int i = 0; i < taken; ++i) {
    /* Both types begin with the bench. */
    if (!infos[i].valid_data || strcmp((const char*)samples[i], bench) != 0) {
      continue;
    }
    ++count;
    if (results) {
      print_result(samples[i]);
    } else {
      print_function(samples[i]);
    }
  }
  if (taken > 0) {
    dds_return_loan(reader, samples, taken);
    fflush(stdout);
  }
  return count;
}

static void read_all(dds_entity_t participant, const char* partition, const char* bench,
                     int results, int functions) {
  const dds_entity_t points = open_endpoint(participant, &dyncal_wire_CalibrationResult_desc,
                                            "CalibrationResult", partition, 1, false);
  const dds_entity_t curves = open_endpoint(participant, &dyncal_wire_TransferFunction_desc,
                                            "TransferFunction", partition, 1, false);
  while (results > 0 || functions > 0) {
    results -= take(points, bench, true);
    functions -= take(curves, bench, false);
    dds_sleepfor(DDS_MSECS(block_ms));
  }
}

static void describe(dds_entity_t writer, const char* bench, uint64_t session) {
  dyncal_wire_ChannelDescription channels[] = {
      {.name = "reference", .quantity = "Acceleration", .unit = "\\metre\\second\\tothe{-2}"},
      {.name = "sync", .quantity = "Voltage", .unit = "\\volt"}};
  dyncal_wire_SourceDescription source = {.session = session,
                                          .kind = dyncal_wire_SOURCE_ACS,
                                          .device = "foreign source",
                                          .serial = "",
                                          .driver = "",
                                          .software = "",
                                          .nominal_rate_hz = 1000.0,
                                          .contract_version = dyncal_wire_CONTRACT_VERSION,
                                          .firmware = "",
                                          .host = "",
                                          .bench_file_sha256 = "",
                                          .settings = ""};
  snprintf(source.bench, sizeof source.bench, "%s", bench);
  snprintf(source.source, sizeof source.source, "acs");
  source.channels._length = source.channels._maximum = 2;
  source.channels._buffer = channels;
  checked(dds_write(writer, &source), "description");
}

static void write_blocks(dds_entity_t participant, const char* partition, const char* bench,
                         double seconds) {
  const dds_entity_t descriptions = open_endpoint(participant, &dyncal_wire_SourceDescription_desc,
                                                  "SourceDescription", partition, 1, true);
  const dds_entity_t writer =
      open_endpoint(participant, &dyncal_wire_SampleBlock_desc, "AcsSamples", partition, 250, true);
  const dds_time_t begin = dds_time();
  describe(descriptions, bench, (uint64_t)begin);
  double values[2 * samples_a_block];
  dyncal_wire_SampleBlock block = {.session = (uint64_t)begin,
                                   .acknowledged_run = "",
                                   .origin_ns = 250000000000000000,
                                   .interval_numerator_ns = 1000000,
                                   .interval_denominator = 1};
  snprintf(block.bench, sizeof block.bench, "%s", bench);
  snprintf(block.source, sizeof block.source, "acs");
  block.values._buffer = values;
  const uint64_t blocks = (uint64_t)(seconds * 1000 / block_ms);
  for (block.block = 0; block.block <= blocks; ++block.block) {
    block.first_sample = block.block * samples_a_block;
    block.end_of_stream = block.block == blocks;
    block.sample_count = block.end_of_stream ? 0 : samples_a_block;
    block.channel_count = block.end_of_stream ? 0 : 2;
    block.values._length = block.values._maximum = 2 * block.sample_count;
    for (uint32_t i = 0; i < block.sample_count; ++i) {
      const double number = (double)(block.first_sample + i);
      values[i] = number * 0.25;
      values[samples_a_block + i] = number * -0.5;
    }
    block.received_utc_ns = dds_time();
    checked(dds_write(writer, &block), "block");
    const dds_time_t ahead = begin + (dds_time_t)block.block * DDS_MSECS(block_ms) - dds_time();
    dds_sleepfor(ahead > 0 ? ahead : 0);
  }
  printf("written\t%" PRIu64 "\n", blocks * samples_a_block);
  fflush(stdout);
  dds_sleepfor(DDS_SECS(3)); /* repairs of the last blocks */
}

int main(int argc, char** argv) {
  if (argc < 6) {
    fprintf(stderr, "usage: %s read|write DOMAIN PARTITION BENCH COUNT...\n", argv[0]);
    return 2;
  }
  const dds_entity_t participant =
      checked(dds_create_participant((dds_domainid_t)atoi(argv[2]), NULL, NULL), "participant");
  if (strcmp(argv[1], "write") == 0) {
    write_blocks(participant, argv[3], argv[4], atof(argv[5]));
  } else {
    read_all(participant, argv[3], argv[4], atoi(argv[5]), atoi(argv[argc - 1]));
  }
  checked(dds_delete(participant), "end");
  return 0;
}
