/* An end of bus_speed.py on Cyclone DDS alone, with its defaults or those of CYCLONEDDS_URI: made
 * from dyncal.idl by idlc, and nothing of dyncal. */
#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dyncal.h"
#include "speed_end.h"

enum { most_taken = 16 };

static dds_entity_t checked(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    fprintf(stderr, "%s: %s\n", what, dds_strretcode(-entity));
    exit(1);
  }
  return entity;
}

static int write_blocks(const struct SpeedOptions* options, dds_entity_t writer) {
  dds_publication_matched_status_t matched = {0};
  while (matched.current_count == 0) {
    dds_sleepfor(DDS_MSECS(5));
    dds_get_publication_matched_status(writer, &matched);
  }
  dyncal_wire_SampleBlock block = {0};
  strcpy(block.bench, SPEED_PARTITION);
  strcpy(block.source, "dau");
  block.acknowledged_run = "";
  block.values._length = block.values._maximum = (uint32_t)(options->bytes / sizeof(double));
  block.values._buffer = calloc(block.values._length, sizeof(double));
  for (size_t number = 1; number <= options->blocks; ++number) {
    block.block = number;
    block.origin_ns = monotonic_ns();
    while (dds_write(writer, &block) == DDS_RETCODE_TIMEOUT) {
    }
  }
  dds_wait_for_acks(writer, DDS_SECS(LONGEST_SILENCE_S));
  free(block.values._buffer);
  return report_writing();
}

static int read_blocks(const struct SpeedOptions* options, dds_entity_t participant,
                       dds_entity_t reader) {
  const dds_entity_t waitset = dds_create_waitset(participant);
  dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS);
  dds_waitset_attach(waitset, reader, 0);
  struct Arrivals arrivals = await_arrivals(options);
  while (is_awaited(&arrivals)) {
    dds_waitset_wait(waitset, NULL, 0, DDS_SECS(1));
    void* samples[most_taken] = {NULL};
    dds_sample_info_t infos[most_taken];
    int taken = 0;
    while ((taken = dds_take(reader, samples, infos, most_taken, most_taken)) > 0) {
      for (int i = 0; i < taken; ++i) {
        if (infos[i].valid_data) {
          note_arrival(&arrivals, ((const dyncal_wire_SampleBlock*)samples[i])->origin_ns);
        }
      }
      dds_return_loan(reader, samples, taken);
    }
  }
  return report_arrivals(&arrivals);
}

int main(int argc, char** argv) {
  const struct SpeedOptions options = speed_options_of(argc, argv);
  const dds_entity_t participant =
      checked(dds_create_participant((dds_domainid_t)options.domain, NULL, NULL), "participant");
  const dds_entity_t topic =
      checked(dds_create_topic(participant, &dyncal_wire_SampleBlock_desc, SPEED_TOPIC, NULL, NULL),
              "topic");
  const char* partition = SPEED_PARTITION;
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  dds_qset_partition(qos, 1, &partition);
  const int status =
      options.writes
          ? write_blocks(&options,
                         checked(dds_create_writer(participant, topic, qos, NULL), "writer"))
          : read_blocks(&options, participant,
                        checked(dds_create_reader(participant, topic, qos, NULL), "reader"));
  dds_delete_qos(qos);
  dds_delete(participant);
  return status;
}
