/* SPDX-FileCopyrightText: 2026 The SmartTestudo authors
   SPDX-License-Identifier: Apache-2.0

   Copies of the messages that relays take and let pass, for Python, which reads many at once.
   copies_take takes a message as librcl does, copies_publish stands for its publishing; each appends a copy, or what
   is known of the message, to the buffer that is being filled. Python swaps the two buffers, and reads the one that
   was filled while the other is. The clocks are read while the mutex is held: by the steady one, stamps are in the
   order of the copies, and none that comes later is older than a swap. */
#define _GNU_SOURCE
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <time.h>

enum { NUMBER_AT = 16, GID_AT = 40, GID_BYTES = 24, LEAST_BYTES = 1 << 16 };
enum { CLOCK_TRIES = 5 };
#define NS_PER_S INT64_C(1000000000)
#define PRECISE_NS (NS_PER_S / 1000)

/* How an rcutils_uint8_array_t begins. */
typedef struct { const uint8_t *buffer; size_t length; } message_t;
typedef int take_t(const void *subscription, message_t *taken, void *info, void *allocation);

/* Before each payload, which zeros fill up to a multiple of eight bytes; its `copied_bytes` are all or none. */
typedef struct {
    uint64_t source, number, size_bytes, copied_bytes;
    int64_t stamp_ns, steady_ns;
    uint8_t gid[GID_BYTES];
} header_t;
typedef struct { uint8_t *bytes; size_t length, capacity; } buffer_t;

typedef struct {
    pthread_mutex_t mutex;
    buffer_t filled, read;
    size_t wakes_from_bytes, most_bytes;
    uint64_t dropped;        /* messages that passed, and found no room */
    int64_t (*now_ns)(void), (*steady_now_ns)(void); /* the system's clocks where they are NULL */
    int event_fd, is_woken;  /* counted up when that much is there to read, or something passed */
} copies_t;

/* What stands for the subscription whose messages are copied, or, where it has none, for the publisher of what
   passes; `source` is given with each. */
typedef struct {
    copies_t *copies;
    take_t *take;
    const void *subscription;
    uint64_t source, gid_bytes, has_payload;
} copied_t;

const size_t copies_sizes[] = {sizeof(copied_t), sizeof(header_t)};

copies_t *copies_new(size_t wakes_from_bytes, size_t most_bytes, int event_fd, int64_t (*now_ns)(void),
                     int64_t (*steady_now_ns)(void)) {
    copies_t *copies = malloc(sizeof *copies);
    if (!copies) return NULL;
    *copies = (copies_t){.mutex = PTHREAD_MUTEX_INITIALIZER, .event_fd = event_fd, .now_ns = now_ns};
    copies->steady_now_ns = steady_now_ns;
    copies->wakes_from_bytes = wakes_from_bytes;
    copies->most_bytes = most_bytes;
    return copies;
}

static int64_t clock_ns(int64_t (*given)(void), clockid_t clock) {
    struct timespec now;
    if (given) return given();
    clock_gettime(clock, &now);
    return now.tv_sec * NS_PER_S + now.tv_nsec;
}

/* Both clocks as one: what delays this thread between the two would be a jump of the clock. */
static void read_clocks(header_t *header, const copies_t *copies) {
    int64_t least_ns = INT64_MAX;
    for (int i = 0; i < CLOCK_TRIES && least_ns > PRECISE_NS; i++) {
        int64_t steady_ns = clock_ns(copies->steady_now_ns, CLOCK_BOOTTIME);
        int64_t stamp_ns = clock_ns(copies->now_ns, CLOCK_REALTIME);
        int64_t took_ns = clock_ns(copies->steady_now_ns, CLOCK_BOOTTIME) - steady_ns;
        if (took_ns >= least_ns) continue;
        least_ns = took_ns;
        header->steady_ns = steady_ns;
        header->stamp_ns = stamp_ns;
    }
}

/* Whether so many more bytes fit. */
static int has_room(buffer_t *buffer, size_t size_bytes, size_t most_bytes) {
    size_t capacity = buffer->capacity ? buffer->capacity : LEAST_BYTES, needed;
    if (size_bytes > most_bytes || (needed = buffer->length + size_bytes) > most_bytes) return 0;
    if (needed <= buffer->capacity) return 1;
    while (capacity < needed) capacity *= 2;
    uint8_t *bytes = realloc(buffer->bytes, capacity);
    if (!bytes) return 0;
    buffer->bytes = bytes;
    buffer->capacity = capacity;
    return 1;
}

/* Whether it found room. */
static int append(buffer_t *filled, header_t *header, const uint8_t *payload, const copies_t *copies) {
    size_t length = header->copied_bytes, rest = -length % sizeof header->number;
    if (!has_room(filled, sizeof *header + length + rest, copies->most_bytes)) return 0;
    read_clocks(header, copies);
    memcpy(filled->bytes + filled->length, header, sizeof *header);
    filled->length += sizeof *header;
    if (length) memcpy(filled->bytes + filled->length, payload, length);
    memset(filled->bytes + filled->length + length, 0, rest);
    filled->length += length + rest;
    return 1;
}

/* What is taken and finds no room is not copied, which the numbers of the others show. */
static void add(const copied_t *copied, uint64_t number, const uint8_t *gid, const message_t *message) {
    copies_t *copies = copied->copies;
    header_t header = {.source = copied->source, .number = number, .size_bytes = message->length};
    header.copied_bytes = copied->has_payload ? message->length : 0;
    memcpy(header.gid, gid, copied->gid_bytes < GID_BYTES ? copied->gid_bytes : GID_BYTES);
    pthread_mutex_lock(&copies->mutex);
    int is_there = append(&copies->filled, &header, message->buffer, copies);
    copies->dropped += !is_there && !copied->take;
    int wakes = !copies->is_woken && (!copied->take || copies->filled.length >= copies->wakes_from_bytes);
    if (wakes) copies->is_woken = !eventfd_write(copies->event_fd, 1);
    pthread_mutex_unlock(&copies->mutex);
}

/* A relay calls it in place of librcl's, for a copied_t in place of a subscription. */
int copies_take(const void *given, message_t *taken, void *info, void *allocation) {
    const copied_t *copied = given;
    uint64_t number;
    int code = copied->take(copied->subscription, taken, info, allocation);
    if (code) return code;
    memcpy(&number, (uint8_t *)info + NUMBER_AT, sizeof number);
    add(copied, number, (uint8_t *)info + GID_AT, taken);
    return 0;
}

/* A relay calls it in place of librcl's, for a copied_t in place of a publisher, with the GID of the source. */
int copies_publish(const void *given, const message_t *passed, const void *gid) {
    add(given, 0, gid, passed);
    return 0;
}

/* What was filled until now, to be read until the next swap; its length, and what passed and found no room. */
size_t copies_swap(copies_t *copies, const uint8_t **bytes, uint64_t *dropped) {
    pthread_mutex_lock(&copies->mutex);
    buffer_t read = copies->filled;
    copies->filled = copies->read;
    copies->filled.length = 0;
    copies->read = read;
    copies->is_woken = 0;
    *dropped = copies->dropped;
    copies->dropped = 0;
    pthread_mutex_unlock(&copies->mutex);
    *bytes = read.bytes;
    return read.length;
}

/* No relay may take from it any more. */
void copies_free(copies_t *copies) {
    free(copies->filled.bytes);
    free(copies->read.bytes);
    free(copies);
}
