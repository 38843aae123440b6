/* SPDX-FileCopyrightText: 2026 The SmartTestudo authors
   SPDX-License-Identifier: Apache-2.0

   Relays topics without Python: takes serialized messages, drops duplicates, paces, publishes and counts.

   The law of the pace is that of pacing/grid.py and of VolatileStream in pacing/stream.py, to the nanosecond.
   Each topic has a mutex and a thread. The middleware calls relay_on_message on a thread of its own, which must
   never wait: it takes and paces there if the topic allows it and the mutex is free, and leaves the rest to the
   topic's thread. What a write may block for waits in `outgoing` for that thread, which publishes without the
   mutex; so a slow write delays its own topic only. rcl's functions come as pointers: this needs no headers. */
#define _GNU_SOURCE
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ABI = 1, GID_BYTES = 24, BEGINNING_BYTES = 16, RCL_ERROR_BYTES = 4096, ERROR_BYTES = 256 };
enum { INFO_BYTES = 256, NUMBER_AT = 16, GID_AT = 40, TAKE_FAILED = 401 };
enum { ARRIVALS_KEPT = 21, MAX_STREAMS = 256, MAX_OUTGOING = 8, MAX_TAKEN_AT_ONCE = 16 };
#define NS_PER_S INT64_C(1000000000)
/* After all times; the period of Off, and its negative is when a stream at Full is due. */
#define NEVER_NS (INT64_C(1) << 62)
__extension__ typedef __int128 wide;

typedef struct {
    void *(*allocate)(size_t, void *);
    void (*deallocate)(void *, void *);
    void *(*reallocate)(void *, size_t, void *);
    void *(*zero_allocate)(size_t, size_t, void *);
    void *state;
} allocator_t;

/* An rcutils_uint8_array_t; the middleware makes its buffer as large as a message needs. */
typedef struct {
    uint8_t *buffer;
    size_t length, capacity;
    allocator_t allocator;
} message_t;

typedef struct { char text[RCL_ERROR_BYTES]; } rcl_error_t;

typedef struct {
    int (*take)(const void *subscription, message_t *taken, void *info, void *allocation);
    int (*publish)(const void *publisher, const message_t *sent, void *allocation);
    rcl_error_t (*error_text)(void);
    void (*reset_error)(void);
    int64_t (*now_ns)(void); /* the system's clock where it is NULL */
} functions_t;

typedef struct {
    uint64_t messages, size_bytes;
    int64_t span_ns, last_ns;
} flow_t;

typedef struct {
    flow_t arrived, relayed;
    uint64_t sent, lost, errors;
    int64_t now_ns;
    uint64_t beginning_bytes;
    uint8_t beginning[BEGINNING_BYTES]; /* of the message that was relayed last */
    char error[ERROR_BYTES];            /* the last one */
} counts_t;

/* One publisher: the number of its last message, and, once `is_open`, its grid. */
typedef struct {
    uint8_t gid[GID_BYTES];
    uint64_t number;
    int64_t due_ns, held_ns;
    int64_t arrivals_ns[ARRIVALS_KEPT];
    uint32_t arrivals, is_open, is_held, reserved;
    message_t held; /* valid until the next call */
} stream_t;

typedef struct {
    functions_t rcl;
    allocator_t allocator;
    const void *subscription, *publisher;
    uint32_t gid_bytes, takes_on_callback, publishes_at_once, reserved;
    int64_t period_ns, slack_ns;
    counts_t counts;
} settings_t;

typedef struct outgoing {
    message_t message;
    struct outgoing *next;
} outgoing_t;

typedef struct {
    settings_t settings; /* its counts and pace are those of now */
    pthread_mutex_t mutex;
    stream_t *streams; /* one for each publisher */
    size_t stream_count, last_stream;
    message_t incoming;
    outgoing_t *first, *last, *unused;
    unsigned outgoing_count;
    int64_t sleeps_until_ns;
    atomic_int is_stopping;
    pthread_t thread;
    /* Apart from `mutex`, and never held for long, so that the middleware's threads may lock it. */
    pthread_mutex_t wake_mutex;
    pthread_cond_t wake;
    int is_woken;
} relay_t;

static int64_t clock_ns(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return now.tv_sec * NS_PER_S + now.tv_nsec;
}

static int64_t now_ns(const relay_t *relay) {
    return relay->settings.rcl.now_ns ? relay->settings.rcl.now_ns() : clock_ns(CLOCK_REALTIME);
}

static int64_t max_ns(int64_t one, int64_t other) { return one > other ? one : other; }

static void swap(message_t *one, message_t *other) {
    message_t kept = *one;
    *one = *other;
    *other = kept;
}

static message_t new_message(const relay_t *relay) {
    return (message_t){.allocator = relay->settings.allocator};
}

static void free_message(message_t *message) {
    if (message->buffer) message->allocator.deallocate(message->buffer, message->allocator.state);
}

static void record(flow_t *flow, int64_t now, uint64_t size_bytes) {
    if (flow->messages && now > flow->last_ns) flow->span_ns += now - flow->last_ns;
    flow->last_ns = now;
    flow->messages++;
    flow->size_bytes += size_bytes;
}

/* The grid: each function is the method of that name in pacing/grid.py. */
static void start(const settings_t *pace, stream_t *stream, int64_t now) {
    stream->due_ns = pace->period_ns == NEVER_NS ? NEVER_NS : now - pace->period_ns / 2;
}

static void charge(const settings_t *pace, stream_t *stream, int64_t now) {
    if (stream->due_ns > now)
        stream->due_ns = now;
    else if (stream->due_ns < now - pace->slack_ns)
        stream->due_ns = now - pace->slack_ns;
    stream->due_ns += pace->period_ns;
}

static void change_pace(const settings_t *old, const settings_t *pace, stream_t *stream, int64_t now) {
    if (pace->period_ns == 0) {
        stream->due_ns = -NEVER_NS;
    } else if (old->period_ns == NEVER_NS || pace->period_ns == NEVER_NS) {
        start(pace, stream, now);
    } else if (old->period_ns == 0) {
        int64_t after_last_ns = stream->due_ns + pace->period_ns - pace->period_ns / 2;
        start(pace, stream, now);
        stream->due_ns = max_ns(stream->due_ns, after_last_ns);
    } else {
        wide scaled = (wide)max_ns(stream->due_ns - now, -old->slack_ns) * pace->period_ns;
        stream->due_ns = now + (int64_t)(scaled / old->period_ns - (scaled % old->period_ns < 0));
    }
    if (pace->period_ns == NEVER_NS) stream->is_held = 0;
}

/* The stream: as SourcePeriod and VolatileStream. */
static void record_arrival(stream_t *stream, int64_t now) {
    if (stream->arrivals && now < stream->arrivals_ns[stream->arrivals - 1]) stream->arrivals = 0;
    if (stream->arrivals == ARRIVALS_KEPT) {
        stream->arrivals--;
        memmove(stream->arrivals_ns, stream->arrivals_ns + 1, stream->arrivals * sizeof(int64_t));
    }
    stream->arrivals_ns[stream->arrivals++] = now;
}

static int64_t release_ns(const settings_t *pace, const stream_t *stream) {
    if (!stream->is_held) return NEVER_NS;
    int64_t quiet_ns = 0, intervals = (int64_t)stream->arrivals - 1;
    if (intervals > 0)
        quiet_ns = (stream->arrivals_ns[intervals] - stream->arrivals_ns[0]) / intervals * 2;
    return max_ns(stream->due_ns, stream->held_ns + max_ns(quiet_ns, pace->period_ns));
}

static int64_t next_release_ns(const relay_t *relay) {
    int64_t next_ns = NEVER_NS;
    for (size_t i = 0; i < relay->stream_count; i++) {
        int64_t at_ns = release_ns(&relay->settings, &relay->streams[i]);
        if (at_ns < next_ns) next_ns = at_ns;
    }
    return next_ns;
}

/* A clock that jumped back starts every grid anew; what is held stays held. */
static void see(relay_t *relay, int64_t now) {
    if (now < relay->settings.counts.now_ns)
        for (size_t i = 0; i < relay->stream_count; i++) {
            stream_t *stream = &relay->streams[i];
            start(&relay->settings, stream, now);
            stream->arrivals = 0;
            stream->held_ns = now;
        }
    relay->settings.counts.now_ns = now;
}

static void note_error(relay_t *relay) {
    const functions_t *rcl = &relay->settings.rcl;
    rcl_error_t error = rcl->error_text();
    rcl->reset_error();
    relay->settings.counts.errors++;
    memcpy(relay->settings.counts.error, error.text, ERROR_BYTES - 1);
}

static void pass(relay_t *relay, message_t *message, int64_t now) {
    counts_t *counts = &relay->settings.counts;
    record(&counts->relayed, now, message->length);
    counts->beginning_bytes = message->length < BEGINNING_BYTES ? message->length : BEGINNING_BYTES;
    if (counts->beginning_bytes) memcpy(counts->beginning, message->buffer, counts->beginning_bytes);
    if (relay->settings.publishes_at_once) {
        if (relay->settings.rcl.publish(relay->settings.publisher, message, NULL)) note_error(relay);
        return;
    }
    outgoing_t *outgoing = relay->unused;
    if (outgoing)
        relay->unused = outgoing->next;
    else if ((outgoing = malloc(sizeof *outgoing)))
        outgoing->message = new_message(relay);
    else {
        counts->errors++;
        return;
    }
    swap(&outgoing->message, message);
    outgoing->next = NULL;
    *(relay->first ? &relay->last->next : &relay->first) = outgoing;
    relay->last = outgoing;
    relay->outgoing_count++;
}

/* On the topic's thread, which alone publishes what waits: so the order stays. */
static void publish_outgoing(relay_t *relay) {
    while (relay->first) {
        outgoing_t *outgoing = relay->first;
        relay->first = outgoing->next;
        pthread_mutex_unlock(&relay->mutex);
        int code = relay->settings.rcl.publish(relay->settings.publisher, &outgoing->message, NULL);
        pthread_mutex_lock(&relay->mutex);
        if (code) note_error(relay);
        outgoing->next = relay->unused;
        relay->unused = outgoing;
        relay->outgoing_count--;
    }
}

static void release(relay_t *relay, stream_t *stream, int64_t now) {
    stream->is_held = 0;
    charge(&relay->settings, stream, now);
    pass(relay, &stream->held, now);
}

static void release_due(relay_t *relay, int64_t now) {
    for (size_t i = 0; i < relay->stream_count; i++)
        if (release_ns(&relay->settings, &relay->streams[i]) <= now) release(relay, &relay->streams[i], now);
}

static void forget_streams(relay_t *relay) {
    while (relay->stream_count) free_message(&relay->streams[--relay->stream_count].held);
}

/* The stream of one more publisher. Beyond the most, all begin anew, and what is held passes. */
static stream_t *new_stream(relay_t *relay) {
    if (relay->stream_count == MAX_STREAMS) {
        for (size_t i = 0; i < MAX_STREAMS; i++)
            if (relay->streams[i].is_held) release(relay, &relay->streams[i], relay->settings.counts.now_ns);
        forget_streams(relay);
    }
    stream_t *streams = realloc(relay->streams, (relay->stream_count + 1) * sizeof *streams);
    if (!streams) return NULL;
    relay->streams = streams;
    relay->last_stream = relay->stream_count;
    streams[relay->stream_count] = (stream_t){.held = new_message(relay)};
    return &streams[relay->stream_count++];
}

/* The stream of a message, unless that or a later one of its publisher came before. */
static stream_t *counted(relay_t *relay, const uint8_t *gid, uint64_t number) {
    counts_t *counts = &relay->settings.counts;
    for (size_t i = 0; i < relay->stream_count; i++) {
        /* Mostly it is the one before. */
        size_t at = (relay->last_stream + i) % relay->stream_count;
        stream_t *known = &relay->streams[at];
        if (memcmp(known->gid, gid, GID_BYTES)) continue;
        if (number <= known->number) return NULL;
        counts->sent += number - known->number;
        counts->lost += number - known->number - 1;
        known->number = number;
        relay->last_stream = at;
        return known;
    }
    stream_t *added = new_stream(relay);
    if (!added) return NULL;
    memcpy(added->gid, gid, GID_BYTES);
    added->number = number;
    counts->sent++;
    return added;
}

static void offer(relay_t *relay, stream_t *stream, int64_t now) {
    message_t *message = &relay->incoming;
    see(relay, now);
    record(&relay->settings.counts.arrived, now, message->length);
    release_due(relay, now);
    if (!stream->is_open) {
        stream->is_open = 1;
        start(&relay->settings, stream, now);
    }
    record_arrival(stream, now);
    if (now >= stream->due_ns) {
        stream->is_held = 0;
        charge(&relay->settings, stream, now);
        pass(relay, message, now);
    } else if (stream->due_ns < NEVER_NS) {
        stream->is_held = 1;
        stream->held_ns = now;
        swap(&stream->held, message);
    }
}

/* Whether there may be more; while much waits for the thread, messages stay in the middleware's queue. */
static int serve(relay_t *relay) {
    uint64_t info[INFO_BYTES / sizeof(uint64_t)];
    uint8_t gid[GID_BYTES] = {0};
    const settings_t *settings = &relay->settings;
    for (int taken = 0; taken < MAX_TAKEN_AT_ONCE; taken++) {
        if (relay->outgoing_count >= MAX_OUTGOING) return 1;
        int code = settings->rcl.take(settings->subscription, &relay->incoming, info, NULL);
        if (code) {
            if (code != TAKE_FAILED) note_error(relay);
            return 0;
        }
        memcpy(gid, (uint8_t *)info + GID_AT, settings->gid_bytes);
        stream_t *stream = counted(relay, gid, info[NUMBER_AT / sizeof(uint64_t)]);
        if (stream) offer(relay, stream, now_ns(relay));
    }
    return 1;
}

static void wake(relay_t *relay) {
    pthread_mutex_lock(&relay->wake_mutex);
    if (!relay->is_woken) {
        relay->is_woken = 1;
        pthread_cond_signal(&relay->wake);
    }
    pthread_mutex_unlock(&relay->wake_mutex);
}

/* By the steady clock: another one may jump back, and then this would last for ever. */
static void sleep_for(relay_t *relay, int64_t ns) {
    int64_t end_ns = clock_ns(CLOCK_MONOTONIC) + max_ns(ns, 0);
    struct timespec end = {.tv_sec = end_ns / NS_PER_S, .tv_nsec = end_ns % NS_PER_S};
    pthread_mutex_lock(&relay->wake_mutex);
    for (int code = 0; !relay->is_woken && code != ETIMEDOUT;)
        code = pthread_cond_timedwait(&relay->wake, &relay->wake_mutex, &end);
    relay->is_woken = 0;
    pthread_mutex_unlock(&relay->wake_mutex);
}

/* What its thread does whenever it wakes; returns in how many ns to do so again without a message. */
int64_t relay_step(relay_t *relay) {
    int64_t now, has_more;
    pthread_mutex_lock(&relay->mutex);
    do {
        has_more = !relay->is_stopping && serve(relay);
        now = now_ns(relay);
        see(relay, now);
        release_due(relay, now);
        publish_outgoing(relay);
    } while (has_more);
    int64_t next_ns = relay->sleeps_until_ns = next_release_ns(relay);
    pthread_mutex_unlock(&relay->mutex);
    return next_ns - now;
}

static void *run(void *given) {
    relay_t *relay = given;
    while (!atomic_load(&relay->is_stopping)) sleep_for(relay, relay_step(relay));
    relay_step(relay);
    return NULL;
}

/* What Python calls. All but relay_stop and relay_free may be called while the relay runs. */

void relay_sizes(size_t sizes[4]) {
    memcpy(sizes, (size_t[]){ABI, sizeof(settings_t), sizeof(stream_t), sizeof(counts_t)}, 4 * sizeof *sizes);
}

relay_t *relay_new(const settings_t *settings) {
    relay_t *relay = calloc(1, sizeof *relay);
    if (!relay) return NULL;
    relay->settings = *settings;
    if (relay->settings.gid_bytes > GID_BYTES) relay->settings.gid_bytes = GID_BYTES;
    relay->incoming = new_message(relay);
    pthread_condattr_t steady;
    pthread_condattr_init(&steady);
    pthread_condattr_setclock(&steady, CLOCK_MONOTONIC);
    pthread_mutex_init(&relay->mutex, NULL);
    pthread_mutex_init(&relay->wake_mutex, NULL);
    pthread_cond_init(&relay->wake, &steady);
    pthread_condattr_destroy(&steady);
    return relay;
}

/* To be called before relay_start: what is known of a publisher. Whether there was memory for it. */
int relay_add_stream(relay_t *relay, const stream_t *known) {
    stream_t *added = new_stream(relay);
    if (!added) return 0;
    message_t held = added->held;
    held.length = held.capacity = known->is_held ? known->held.length : 0;
    if (held.length && !(held.buffer = held.allocator.allocate(held.length, held.allocator.state)))
        held.length = held.capacity = 0;
    if (held.length) memcpy(held.buffer, known->held.buffer, held.length);
    *added = *known;
    added->held = held;
    return held.length || !known->is_held || !known->held.length;
}

/* Whether its thread runs; from now on the middleware may call relay_on_message. */
int relay_start(relay_t *relay) {
    return pthread_create(&relay->thread, NULL, run, relay) == 0;
}

void relay_on_message(const void *given, size_t count) {
    relay_t *relay = (relay_t *)(uintptr_t)given;
    (void)count;
    int is_left = 1;
    if (relay->settings.takes_on_callback && pthread_mutex_trylock(&relay->mutex) == 0) {
        is_left = !relay->is_stopping && serve(relay);
        is_left |= relay->first != NULL || next_release_ns(relay) < relay->sleeps_until_ns;
        pthread_mutex_unlock(&relay->mutex);
    }
    if (is_left) wake(relay);
}

void relay_set_pace(relay_t *relay, int64_t period_ns, int64_t slack_ns) {
    pthread_mutex_lock(&relay->mutex);
    settings_t old = relay->settings;
    int64_t now = now_ns(relay);
    see(relay, now);
    relay->settings.period_ns = period_ns;
    relay->settings.slack_ns = slack_ns;
    for (size_t i = 0; i < relay->stream_count; i++)
        if (relay->streams[i].is_open)
            change_pace(&old, &relay->settings, &relay->streams[i], now);
    pthread_mutex_unlock(&relay->mutex);
    wake(relay);
}

/* Also wakes the thread if the clock jumped past what it sleeps for, or back. */
void relay_read(relay_t *relay, counts_t *counts) {
    pthread_mutex_lock(&relay->mutex);
    int64_t now = now_ns(relay);
    see(relay, now);
    *counts = relay->settings.counts;
    int is_due = next_release_ns(relay) <= now;
    pthread_mutex_unlock(&relay->mutex);
    if (is_due) wake(relay);
}

/* Publish what passed, and take nothing more; the middleware must no longer call relay_on_message. */
void relay_stop(relay_t *relay) {
    atomic_store(&relay->is_stopping, 1);
    wake(relay);
    pthread_join(relay->thread, NULL);
}

/* The stream of that index once the relay is stopped; 0 where there are no more. */
int relay_stream(const relay_t *relay, size_t index, stream_t *stream) {
    if (index >= relay->stream_count) return 0;
    *stream = relay->streams[index];
    return 1;
}

void relay_free(relay_t *relay) {
    forget_streams(relay);
    free_message(&relay->incoming);
    while (relay->unused) {
        outgoing_t *outgoing = relay->unused;
        relay->unused = outgoing->next;
        free_message(&outgoing->message);
        free(outgoing);
    }
    free(relay->streams);
    pthread_cond_destroy(&relay->wake);
    pthread_mutex_destroy(&relay->mutex);
    pthread_mutex_destroy(&relay->wake_mutex);
    free(relay);
}
