/* Another tool on the bus: made from dyncal.idl by idlc and from idl/README.md, with nothing of
 * dyncal.
 *
 *   native_cyclone_peer DOMAIN FROM_PARTITION TO_PARTITION
 *
 * Reads three topics in one partition and writes what it reads into another, unchanged; an instance
 * that ends there ends here. A reader of a fourth topic asks for what dyncal offers to nobody. Runs
 * until it is killed.
 */
#include <dds/dds.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "dyncal.h"

enum { most_taken = 16 };

struct echo {
  const char* topic;
  const dds_topic_descriptor_t* type;
  bool keep_all; /* profile "samples", otherwise "state" or "results" */
  dds_entity_t reader;
  dds_entity_t writer;
};

static dds_entity_t checked(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    fprintf(stderr, "%s: %s\n", what, dds_strretcode(-entity));
    exit(1);
  }
  return entity;
}

static dds_qos_t* make_qos(bool keep_all, const char* partition) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos, keep_all ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST, 1);
  dds_qset_durability_service(qos, 0, DDS_HISTORY_KEEP_LAST, keep_all ? 1500 : 1, -1, -1, -1);
  dds_qset_writer_data_lifecycle(qos, false);
  dds_qset_partition(qos, 1, &partition);
  return qos;
}

static void open_echo(struct echo* echo, dds_entity_t participant, const char* from,
                      const char* to) {
  const dds_entity_t topic =
      checked(dds_create_topic(participant, echo->type, echo->topic, NULL, NULL), echo->topic);
  dds_qos_t* reading = make_qos(echo->keep_all, from);
  dds_qos_t* writing = make_qos(echo->keep_all, to);
  echo->reader = checked(dds_create_reader(participant, topic, reading, NULL), "reader");
  echo->writer = checked(dds_create_writer(participant, topic, writing, NULL), "writer");
  dds_delete_qos(reading);
  dds_delete_qos(writing);
}

static void ask_for_more(dds_entity_t participant, const char* partition) {
  const dds_entity_t topic =
      checked(dds_create_topic(participant, &dyncal_wire_Excitation_desc, "Excitation", NULL, NULL),
              "Excitation");
  dds_qos_t* qos = make_qos(false, partition);
  dds_qset_ownership(qos, DDS_OWNERSHIP_EXCLUSIVE);
  dds_qset_deadline(qos, DDS_SECS(1));
  dds_qset_liveliness(qos, DDS_LIVELINESS_MANUAL_BY_TOPIC, DDS_SECS(2));
  checked(dds_create_reader(participant, topic, qos, NULL), "reader");
  dds_delete_qos(qos);
}

static void run_echo(const struct echo* echo) {
  void* samples[most_taken] = {NULL};
  dds_sample_info_t infos[most_taken];
  const int taken = dds_take(echo->reader, samples, infos, most_taken, most_taken);
  for (int i = 0; i < taken; ++i) {
    if (infos[i].valid_data) {
      checked(dds_write(echo->writer, samples[i]), "write");
    } else if (infos[i].instance_state == DDS_NOT_ALIVE_DISPOSED_INSTANCE_STATE) {
      checked(dds_dispose(echo->writer, samples[i]), "dispose");
    }
  }
  if (taken > 0) {
    dds_return_loan(echo->reader, samples, taken);
  }
}

int main(int argc, char** argv) {
  if (argc != 4) {
    fprintf(stderr, "usage: %s DOMAIN FROM_PARTITION TO_PARTITION\n", argv[0]);
    return 2;
  }
  struct echo echoes[] = {
      {"DauSamples", &dyncal_wire_SampleBlock_desc, true, 0, 0},
      {"Measurement", &dyncal_wire_Measurement_desc, false, 0, 0},
      {"CalibrationResult", &dyncal_wire_CalibrationResult_desc, false, 0, 0},
  };
  const size_t count = sizeof echoes / sizeof echoes[0];
  const dds_entity_t participant =
      checked(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  const dds_entity_t waitset = checked(dds_create_waitset(participant), "waitset");
  for (size_t i = 0; i < count; ++i) {
    open_echo(&echoes[i], participant, argv[2], argv[3]);
    checked(
        dds_waitset_attach(waitset, dds_create_readcondition(echoes[i].reader, DDS_ANY_STATE), 0),
        "attach");
  }
  ask_for_more(participant, argv[2]);
  for (;;) {
    checked(dds_waitset_wait(waitset, NULL, 0, DDS_SECS(1)), "wait");
    for (size_t i = 0; i < count; ++i) {
      run_echo(&echoes[i]);
    }
  }
}
