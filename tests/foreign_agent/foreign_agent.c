/* An agent that shares nothing with Aloft but idl/flight.idl: Eclipse Cyclone DDS, plain C.
   It plays `min-height` for every flight in which its name is asked for; with the site map, it climbs as long as a base
   station is within 200 m of the next point of the route, and else descends.

   usage: foreign-agent DOMAIN RUN WORKER AGENT [site-map] */
#include <dds/dds.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "flight.h"

#define STREAMS 1024
#define LONGEST_FLIGHT 1000

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

/* What the agent keeps of the site map of a stream: for every step whether a base station is near. */
struct near_sites {
  uint64_t episode_id;
  uint32_t attempt;
  uint32_t steps; /* 0: no map yet */
  uint8_t near[LONGEST_FLIGHT + 1];
};

static struct near_sites maps[STREAMS];

static void keep_map(const aloft_wire_SiteMap* map) {
  if (map->stream >= STREAMS || map->update) return;
  struct near_sites* kept = &maps[map->stream];
  kept->episode_id = map->episode_id;
  kept->attempt = map->attempt;
  kept->steps = 0;
  for (uint32_t i = 0; i < map->route._length && map->step + 1 + i <= LONGEST_FLIGHT; ++i) {
    const uint32_t step = map->step + 1 + i;
    kept->near[step] = 0;
    for (uint32_t k = 0; k < map->sites._length; ++k) {
      const double dx_m = map->sites._buffer[k].x_m - map->route._buffer[i].x_m;
      const double dy_m = map->sites._buffer[k].y_m - map->route._buffer[i].y_m;
      if (dx_m * dx_m + dy_m * dy_m < 200.0 * 200.0) kept->near[step] = 1;
    }
    kept->steps = step;
  }
}

static const struct near_sites* map_of(const aloft_wire_ChannelReport* report) {
  if (report->stream >= STREAMS) return NULL;
  const struct near_sites* kept = &maps[report->stream];
  const int fits = kept->episode_id == report->episode_id && kept->attempt == report->attempt;
  return fits && report->step < kept->steps ? kept : NULL;
}

/* The whole agent. False if the map that it needs is not there yet: the report comes again, and the map with it. */
static int decide(const aloft_wire_ChannelReport* report, int has_map, aloft_wire_Action* action) {
  const struct near_sites* map = has_map ? map_of(report) : NULL;
  if (has_map && map == NULL) return 0;
  if (map != NULL && map->near[report->step + 1])
    *action = report->height_m < report->height_max_m ? aloft_wire_ACTION_UP : aloft_wire_ACTION_HOLD;
  else
    *action = report->height_m > report->height_min_m ? aloft_wire_ACTION_DOWN : aloft_wire_ACTION_HOLD;
  return 1;
}

int main(int argc, char** argv) {
  const int has_map = argc == 6 && strcmp(argv[5], "site-map") == 0;
  if (argc != 5 && !has_map) {
    fprintf(stderr, "usage: foreign-agent DOMAIN RUN WORKER AGENT [site-map]\n");
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

  /* The site map has a partition of its own. */
  dds_entity_t site_maps = 0;
  if (has_map) {
    char map_partition[300];
    snprintf(map_partition, sizeof map_partition, "%s/site-map", partition);
    const char* map_partitions[] = {map_partition};
    dds_qos_t* in_map_partition = dds_create_qos();
    dds_qset_partition(in_map_partition, 1, map_partitions);
    const dds_entity_t map_subscriber =
        checked(dds_create_subscriber(participant, in_map_partition, NULL), "a subscriber");
    dds_delete_qos(in_map_partition);
    const dds_entity_t map_topic =
        checked(dds_create_topic(participant, &aloft_wire_SiteMap_desc, "SiteMap", NULL, NULL), "SiteMap");
    site_maps = checked(dds_create_reader(map_subscriber, map_topic, report_qos, NULL), "a reader");
  }

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
  status.privilege = has_map ? aloft_wire_PRIVILEGE_SITE_MAP : aloft_wire_PRIVILEGE_NONE;
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

    dds_sample_info_t infos[64];
    static void* told[64];
    const int32_t maps_told = has_map ? dds_take(site_maps, told, infos, 64, 64) : 0;
    for (int32_t i = 0; i < maps_told; ++i)
      if (infos[i].valid_data) keep_map(told[i]);
    if (maps_told > 0) dds_return_loan(site_maps, told, maps_told);

    static void* samples[64];
    const int32_t count = dds_take(reports, samples, infos, 64, 64);
    for (int32_t i = 0; i < count; ++i) {
      const aloft_wire_ChannelReport* report = samples[i];
      if (!infos[i].valid_data || report->last || strcmp(report->agent, agent) != 0) continue;
      static aloft_wire_HeightCommand command;
      if (!decide(report, has_map, &command.action)) continue;
      command.stream = report->stream;
      command.protocol_version = aloft_wire_PROTOCOL_VERSION;
      command.episode_id = report->episode_id;
      command.attempt = report->attempt;
      command.step = report->step + 1;
      copy_name(command.agent, sizeof command.agent, agent);
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
