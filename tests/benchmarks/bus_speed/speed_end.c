#include "speed_end.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

static const int64_t second_ns = 1000000000;

int64_t monotonic_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * second_ns + now.tv_nsec;
}

struct SpeedOptions speed_options_of(int argc, char** argv) {
  if (argc < 5) {
    fprintf(stderr, "usage: %s write|read DOMAIN BYTES BLOCKS\n", argv[0]);
    exit(2);
  }
  return (struct SpeedOptions){.writes = strcmp(argv[1], "write") == 0,
                               .domain = atoi(argv[2]),
                               .bytes = strtoull(argv[3], NULL, 10),
                               .blocks = strtoull(argv[4], NULL, 10)};
}

struct Arrivals await_arrivals(const struct SpeedOptions* options) {
  return (struct Arrivals){.wanted = options->blocks,
                           .last_ns = monotonic_ns(),
                           .latency_ns = calloc(options->blocks, sizeof(int64_t))};
}

bool is_awaited(const struct Arrivals* arrivals) {
  const int64_t patience_s = (arrivals->blocks == 0 ? 6 : 1) * LONGEST_SILENCE_S;
  return arrivals->blocks < arrivals->wanted &&
         monotonic_ns() - arrivals->last_ns < patience_s * second_ns;
}

void note_arrival(struct Arrivals* arrivals, int64_t written_ns) {
  const int64_t now_ns = monotonic_ns();
  if (arrivals->blocks == 0) {
    arrivals->first_ns = now_ns;
  }
  if (arrivals->blocks < arrivals->wanted) {
    arrivals->latency_ns[arrivals->blocks++] = now_ns - written_ns;
  }
  arrivals->last_ns = now_ns;
}

static int by_size(const void* a, const void* b) {
  const int64_t x = *(const int64_t*)a;
  const int64_t y = *(const int64_t*)b;
  return (x > y) - (x < y);
}

static double cpu_s(void) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

int report_arrivals(struct Arrivals* arrivals) {
  const size_t n = arrivals->blocks;
  qsort(arrivals->latency_ns, n, sizeof(int64_t), by_size);
  const int64_t p50_ns = n == 0 ? 0 : arrivals->latency_ns[n / 2];
  const int64_t p99_ns = n == 0 ? 0 : arrivals->latency_ns[n - 1 - n / 100];
  free(arrivals->latency_ns);
  printf("{\"blocks\": %zu, \"seconds\": %.6f, \"p50_ms\": %.4f, \"p99_ms\": %.4f, "
         "\"cpu_s\": %.3f}\n",
         n, 1e-9 * (double)(arrivals->last_ns - arrivals->first_ns), 1e-6 * (double)p50_ns,
         1e-6 * (double)p99_ns, cpu_s());
  fflush(stdout);
  return n == arrivals->wanted ? 0 : 1;
}

int report_writing(void) {
  printf("{\"cpu_s\": %.3f}\n", cpu_s());
  fflush(stdout);
  return 0;
}
