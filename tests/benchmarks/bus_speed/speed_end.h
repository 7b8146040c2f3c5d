/* One end of the bus under full load: what all ends of bus_speed.py have in common, whoever carries
 * the blocks.
 *
 *   END write|read DOMAIN BYTES BLOCKS [more of its own]
 *
 * A writer waits for its reader, writes BLOCKS blocks of BYTES bytes of doubles as fast as they are
 * taken, and ends when all are acknowledged. Each carries its number from 1 on, and when it was
 * handed over, by the clock that both ends have. A reader ends after the last one, or when nothing
 * has come for ten seconds, and prints one line:
 *
 *   {"blocks": 1000, "seconds": 0.21, "p50_ms": 0.3, "p99_ms": 2.1, "cpu_s": 0.1}
 *
 * A writer prints its cpu_s alone. C11 and C++20.
 */
#ifndef DYNCAL_TESTS_SPEED_END_H
#define DYNCAL_TESTS_SPEED_END_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SPEED_PARTITION "bus-speed"
#define SPEED_TOPIC "DauSamples"
#define LONGEST_SILENCE_S 10

struct SpeedOptions {
  bool writes;
  int domain;
  size_t bytes;
  size_t blocks;
};

struct Arrivals {
  size_t blocks;
  size_t wanted;
  int64_t first_ns;
  int64_t last_ns;
  int64_t* latency_ns; /* of each block */
};

int64_t monotonic_ns(void);

/* Ends the process where there are too few. */
struct SpeedOptions speed_options_of(int argc, char** argv);

struct Arrivals await_arrivals(const struct SpeedOptions* options);
bool is_awaited(const struct Arrivals* arrivals);
/* Blocks come in order; one beyond those wanted is left out. */
void note_arrival(struct Arrivals* arrivals, int64_t written_ns);

/* Print the line of an end; return its exit status: 1 where blocks are missing. */
int report_arrivals(struct Arrivals* arrivals);
int report_writing(void);

#ifdef __cplusplus
}
#endif

#endif
