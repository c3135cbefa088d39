/* An agent that shares nothing with Aloft but idl/flight.idl: Eclipse Cyclone DDS, plain C.
   It plays `min-height` for every flight in which its name is asked for.

   usage: foreign-agent DOMAIN RUN WORKER AGENT */
#include <dds/dds.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "flight.h"

static volatile sig_atomic_t stopped = 0;

static void stop(int signal) {
  (void)signal;
  stopped = 1;
}

static dds_entity_t checked(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    fprintf(stderr, "foreign-agent: cannot create %s: %s\n", what, dds_strretcode(-entity));
    exit(1);
  }
  return entity;
}

/* Reliable, as every topic of Aloft. */
static dds_qos_t* reliable(int depth) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, depth);
  return qos;
}

static void copy_name(char* target, size_t size, const char* source) {
  snprintf(target, size, "%s", source);
}

int main(int argc, char** argv) {
  if (argc != 5) {
    fprintf(stderr, "usage: foreign-agent DOMAIN RUN WORKER AGENT\n");
    return 2;
  }
  const char* agent = argv[4];
  signal(SIGINT, stop);
  signal(SIGTERM, stop);

  char partition[256];
  snprintf(partition, sizeof partition, "aloft/%s/%s", argv[2], argv[3]);
  const char* partitions[] = {partition};
  dds_qos_t* in_partition = dds_create_qos();
  dds_qset_partition(in_partition, 1, partitions);

  const dds_entity_t participant =
      checked(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "a participant");
  const dds_entity_t publisher = checked(dds_create_publisher(participant, in_partition, NULL), "a publisher");
  const dds_entity_t subscriber = checked(dds_create_subscriber(participant, in_partition, NULL), "a subscriber");
  const dds_entity_t report_topic = checked(
      dds_create_topic(participant, &aloft_wire_ChannelReport_desc, "ChannelReport", NULL, NULL), "ChannelReport");
  const dds_entity_t command_topic = checked(
      dds_create_topic(participant, &aloft_wire_HeightCommand_desc, "HeightCommand", NULL, NULL), "HeightCommand");
  const dds_entity_t status_topic =
      checked(dds_create_topic(participant, &aloft_wire_AgentStatus_desc, "AgentStatus", NULL, NULL), "AgentStatus");

  dds_qos_t* report_qos = reliable(8);
  const dds_entity_t reports = checked(dds_create_reader(subscriber, report_topic, report_qos, NULL), "a reader");

  dds_qos_t* command_qos = reliable(8);
  dds_qset_ownership(command_qos, DDS_OWNERSHIP_EXCLUSIVE);
  dds_qset_ownership_strength(command_qos, 10);
  dds_qset_liveliness(command_qos, DDS_LIVELINESS_MANUAL_BY_TOPIC, DDS_MSECS(500));
  const dds_entity_t commands = checked(dds_create_writer(publisher, command_topic, command_qos, NULL), "a writer");

  dds_qos_t* status_qos = reliable(1);
  dds_qset_durability(status_qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  const dds_entity_t statuses = checked(dds_create_writer(publisher, status_topic, status_qos, NULL), "a writer");

  const dds_entity_t waitset = checked(dds_create_waitset(participant), "a wait set");
  const dds_entity_t unread = checked(dds_create_readcondition(reports, DDS_ANY_STATE), "a condition");
  checked(dds_waitset_attach(waitset, unread, 0), "an attachment");

  static aloft_wire_AgentStatus status;
  copy_name(status.agent, sizeof status.agent, agent);
  copy_name(status.process, sizeof status.process, "foreign-agent");
  copy_name(status.type, sizeof status.type, "external");
  status.protocol_version = aloft_wire_PROTOCOL_VERSION;
  status.privilege = aloft_wire_PRIVILEGE_NONE;
  status.pid = (uint32_t)getpid();
  status.state = aloft_wire_AGENT_READY;

  dds_time_t next_status = 0;
  while (!stopped) {
    dds_waitset_wait(waitset, NULL, 0, DDS_MSECS(100));
    dds_assert_liveliness(commands); /* every 500 ms at the latest, or another agent takes over */
    if (dds_time() >= next_status) {
      dds_write(statuses, &status);
      next_status = dds_time() + DDS_MSECS(500);
    }

    static void* samples[64];
    dds_sample_info_t infos[64];
    const int32_t count = dds_take(reports, samples, infos, 64, 64);
    for (int32_t i = 0; i < count; ++i) {
      const aloft_wire_ChannelReport* report = samples[i];
      if (!infos[i].valid_data || report->last || strcmp(report->agent, agent) != 0) continue;
      static aloft_wire_HeightCommand command;
      command.stream = report->stream;
      command.protocol_version = aloft_wire_PROTOCOL_VERSION;
      command.episode_id = report->episode_id;
      command.attempt = report->attempt;
      command.step = report->step + 1;
      copy_name(command.agent, sizeof command.agent, agent);
      /* The whole agent: stay as low as allowed. */
      command.action = report->height_m > report->height_min_m ? aloft_wire_ACTION_DOWN : aloft_wire_ACTION_HOLD;
      if (dds_write(commands, &command) < 0) fprintf(stderr, "foreign-agent: a command was not written\n");
    }
    if (count > 0) dds_return_loan(reports, samples, count);
  }

  status.state = aloft_wire_AGENT_STOPPED;
  dds_write(statuses, &status);
  dds_delete_qos(in_partition);
  dds_delete_qos(report_qos);
  dds_delete_qos(command_qos);
  dds_delete_qos(status_qos);
  dds_delete(participant);
  return 0;
}
