/* SPDX-FileCopyrightText: 2026 The SmartTestudo authors
   SPDX-License-Identifier: Apache-2.0

   Relays topics without Python: takes serialized messages, drops duplicates, paces, publishes and counts.
   The law of the pace is that of pacing/grid.py, source_gaps.py and of PublisherStream in stream.py, to the
   nanosecond.

   All topics share a thread. The middleware calls relay_on_message on a thread of its own, which must never wait:
   it takes and paces there if the topic allows it and its mutex is free, and leaves the rest to the shared thread.
   What a write may block for waits in `outgoing`, and is published without the mutex. If the shared thread is in
   one topic for SLOW_NS while there is more to do, another takes its place, and it ends with that topic: so a slow
   write delays the others by SLOW_NS at most. rcl's functions come as pointers: this needs no headers. */
#define _GNU_SOURCE
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ABI = 4, GID_BYTES = 24, BEGINNING_BYTES = 16, RCL_ERROR_BYTES = 4096, ERROR_BYTES = 256 };
enum { INFO_BYTES = 256, NUMBER_AT = 16, GID_AT = 40, TAKE_FAILED = 401 };
enum { BUCKETS = 7, MOST_LAG = 8, REST_SHARE = 8, STEP_OF_PERIOD = 10, STEP_PERMILLE = 693, MAX_STREAMS = 256, MAX_OUTGOING = 8, MAX_TAKEN_AT_ONCE = 16 };
#define NS_PER_S INT64_C(1000000000)
#define SLOW_NS (NS_PER_S / 100)
#define BUCKET_NS (10 * NS_PER_S)
#define LONGEST_NS (2 * NS_PER_S)
/* After all times; the period of Off, and its negative is when a stream at Full is due. */
#define NEVER_NS (INT64_C(1) << 62)
__extension__ typedef __int128 wide;

typedef struct {
    void *(*allocate)(size_t, void *);
    void (*deallocate)(void *, void *);
    void *reallocate, *zero_allocate, *state;
} allocator_t;

/* An rcutils_uint8_array_t; the middleware makes its buffer as large as a message needs. */
typedef struct { uint8_t *buffer; size_t length, capacity; allocator_t allocator; } message_t;

typedef struct { char text[RCL_ERROR_BYTES]; } rcl_error_t;
typedef struct {
    int (*take)(const void *subscription, message_t *taken, void *info, void *allocation);
    int (*publish)(const void *publisher, const message_t *sent, void *allocation_or_gid);
    rcl_error_t (*error_text)(void);
    void (*reset_error)(void);
    int64_t (*now_ns)(void); /* the system's clock where it is NULL */
} functions_t;

typedef struct { uint64_t messages, size_bytes, span_ns; int64_t last_ns; } flow_t;
typedef struct {
    flow_t arrived, relayed;
    uint64_t sent, lost, errors;
    int64_t now_ns;
    uint64_t beginning_bytes;
    uint8_t beginning[BEGINNING_BYTES]; /* of the message that was relayed last */
    char error[ERROR_BYTES];            /* the last one */
} counts_t;

typedef struct { int64_t count, total_ns, squares_us2, longest_ns; } gaps_t;

/* One publisher: the number of its last message, and, once `is_open`, its grid and its gaps; `sum` is of all
   `buckets`. */
typedef struct {
    uint8_t gid[GID_BYTES];
    uint64_t number;
    int64_t due_ns, phase_ns, held_ns, last_ns, lag_ns, step_ns;
    gaps_t buckets[BUCKETS], sum;
    uint32_t has_last, is_open, is_held, is_phase_falling;
    message_t held; /* valid until the next call */
} stream_t;

typedef struct {
    functions_t rcl;
    allocator_t allocator;
    const void *subscription, *publisher;
    uint32_t gid_bytes, takes_on_callback, publishes_at_once, gives_gid;
    int64_t period_ns;
    counts_t counts;
} settings_t;
typedef struct outgoing { message_t message; struct outgoing *next; } outgoing_t;

typedef struct relay {
    /* Guarded by the shared mutex: when to serve it at the latest, by the steady clock; 0 is at once. */
    int64_t serve_at_ns;
    struct relay *next;
    int is_served, is_stopping, is_unread;
    /* Guarded by its own; `settings` has the counts and the pace of now, `streams` one for each publisher. */
    pthread_mutex_t mutex;
    settings_t settings;
    stream_t *streams;
    message_t incoming;
    outgoing_t *first, *last, *unused;
    uint64_t stream_count, outgoing_count, messages_before; /* when it was served last */
} relay_t;

/* The mutex is never held for long, so that the middleware's threads may lock it. */
static struct {
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    pthread_t thread;
    relay_t *relays;
    int64_t sleeps_until_ns, serves_since_ns; /* 0 while it serves no topic */
    int has_thread;
} shared = {PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};

static int64_t clock_ns(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return now.tv_sec * NS_PER_S + now.tv_nsec;
}

static int64_t now_ns(const relay_t *relay) {
    return relay->settings.rcl.now_ns ? relay->settings.rcl.now_ns() : clock_ns(CLOCK_REALTIME);
}

static int64_t max_ns(int64_t one, int64_t other) { return one > other ? one : other; }
static int64_t min_ns(int64_t one, int64_t other) { return one < other ? one : other; }

/* Rounded down, also below 0; at least `least`, as else it need not fit. */
static int64_t scaled_ns(int64_t ns, int64_t by, int64_t divided_by, int64_t least) {
    wide scaled = (wide)ns * by;
    scaled = scaled / divided_by - (scaled % divided_by < 0);
    return scaled < least ? least : (int64_t)scaled;
}

static void swap(message_t *one, message_t *other) { message_t kept = *one; *one = *other; *other = kept; }

static void free_message(message_t *message) {
    if (message->buffer) message->allocator.deallocate(message->buffer, message->allocator.state);
}

static void record(flow_t *flow, int64_t now, uint64_t size_bytes) {
    if (flow->messages && now > flow->last_ns) flow->span_ns += (uint64_t)(now - flow->last_ns);
    flow->last_ns = now;
    flow->messages++;
    flow->size_bytes += size_bytes;
}

/* The gaps: as SourceGaps, which says what they are for. */
static int64_t weighted_mean_ns(const stream_t *stream) {
    int64_t total_us = stream->sum.total_ns / 1000;
    return total_us ? stream->sum.squares_us2 / total_us * 1000 : 0;
}

static int comes_in_bursts(const stream_t *stream) {
    return stream->step_ns > 0 && 4 * weighted_mean_ns(stream) >= 5 * stream->step_ns;
}

static void add_gap(gaps_t *gaps, int64_t gap_ns) {
    gaps->count++;
    gaps->total_ns += gap_ns;
    gaps->squares_us2 += (gap_ns / 1000) * (gap_ns / 1000);
    gaps->longest_ns = max_ns(gaps->longest_ns, gap_ns);
}

static void forget_gaps(stream_t *stream) {
    memset(stream->buckets, 0, sizeof stream->buckets);
    memset(&stream->sum, 0, sizeof stream->sum);
    stream->has_last = 0;
    stream->lag_ns = stream->step_ns = 0;
}

static void begin_buckets(stream_t *stream, int64_t last, int64_t number) {
    for (int64_t begun = max_ns(last, number - BUCKETS) + 1; begun <= number; begun++)
        memset(&stream->buckets[begun % BUCKETS], 0, sizeof(gaps_t));
    stream->sum = (gaps_t){0};
    for (gaps_t *bucket = stream->buckets; bucket < stream->buckets + BUCKETS; bucket++) {
        stream->sum.count += bucket->count;
        stream->sum.total_ns += bucket->total_ns;
        stream->sum.squares_us2 += bucket->squares_us2;
        stream->sum.longest_ns = max_ns(stream->sum.longest_ns, bucket->longest_ns);
    }
}

static void record_arrival(stream_t *stream, int64_t now) {
    int64_t last_ns = stream->last_ns, number = now / BUCKET_NS;
    stream->last_ns = now;
    if (!stream->has_last || now < last_ns) {
        forget_gaps(stream);
        stream->has_last = 1;
        return;
    }
    int is_first = number > last_ns / BUCKET_NS;
    if (is_first) begin_buckets(stream, last_ns / BUCKET_NS, number);
    int64_t gap_ns = min_ns(now - last_ns, LONGEST_NS), longest_ns = stream->sum.longest_ns;
    add_gap(&stream->buckets[number % BUCKETS], gap_ns);
    add_gap(&stream->sum, gap_ns);
    if (is_first || gap_ns >= stream->step_ns) stream->step_ns = stream->sum.total_ns / stream->sum.count;
    int64_t step_ns = stream->step_ns, lag_ns = stream->lag_ns;
    if (gap_ns >= step_ns && lag_ns < 2 * step_ns) lag_ns -= lag_ns / REST_SHARE;
    int64_t most_ns = comes_in_bursts(stream) ? MOST_LAG * (weighted_mean_ns(stream) - step_ns) : 0;
    int64_t late_ns = min_ns(gap_ns, longest_ns) - step_ns;
    stream->lag_ns = max_ns(min_ns(lag_ns + late_ns, min_ns(most_ns, LONGEST_NS)), 0);
}

/* The grid: each function is the method of that name in pacing/grid.py. */
static int64_t slack_ns(const settings_t *pace, const stream_t *stream) {
    if (pace->period_ns == 0 || pace->period_ns == NEVER_NS) return 0;
    int64_t longest_ns = stream->sum.longest_ns + stream->lag_ns;
    int64_t gap_ns = min_ns(max_ns(longest_ns, NS_PER_S / 4), 2 * NS_PER_S);
    return max_ns(2 * pace->period_ns, gap_ns);
}

static void start(const settings_t *pace, stream_t *stream, int64_t now) {
    stream->due_ns = pace->period_ns == NEVER_NS ? NEVER_NS : now - pace->period_ns / 2;
    stream->phase_ns = stream->is_phase_falling = 0;
}

static void move_phase(const settings_t *pace, stream_t *stream, int64_t gap_ns) {
    int64_t period_ns = pace->period_ns;
    if (gap_ns <= 0 || gap_ns >= period_ns) return;
    int64_t left_ns = gap_ns * gap_ns / period_ns, range_ns = period_ns - left_ns;
    int64_t step_ns = min_ns(period_ns / STEP_OF_PERIOD, gap_ns);
    int64_t before_ns = stream->is_phase_falling ? -stream->phase_ns : stream->phase_ns;
    int64_t after_ns = before_ns + (step_ns - left_ns * step_ns / period_ns) * STEP_PERMILLE / 1000;
    int turns = after_ns > range_ns / 2;
    if (turns) after_ns = max_ns(range_ns - after_ns, -(range_ns / 2));
    int64_t moved_ns = stream->is_phase_falling ? before_ns - after_ns : after_ns - before_ns;
    stream->phase_ns += moved_ns;
    stream->due_ns += moved_ns;
    stream->is_phase_falling ^= turns;
}

static void charge(const settings_t *pace, stream_t *stream, int64_t now) {
    int64_t due_ns = min_ns(stream->due_ns, now);
    stream->due_ns = max_ns(due_ns, now - slack_ns(pace, stream)) + pace->period_ns;
    if (stream->is_held) move_phase(pace, stream, stream->step_ns);
    stream->is_held = 0;
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
        int64_t ahead_ns = max_ns(stream->due_ns - now, -slack_ns(old, stream));
        /* More credit than any slack counts for nothing, and need not fit. */
        int64_t most_ns = max_ns(2 * pace->period_ns, LONGEST_NS);
        stream->due_ns = now + scaled_ns(ahead_ns, pace->period_ns, old->period_ns, -most_ns);
        stream->phase_ns = scaled_ns(stream->phase_ns, pace->period_ns, old->period_ns, -pace->period_ns);
    }
    if (pace->period_ns == NEVER_NS) stream->is_held = 0;
}

static int64_t release_ns(const settings_t *pace, const stream_t *stream) {
    if (!stream->is_held) return NEVER_NS;
    int64_t quiet_ns = 2 * weighted_mean_ns(stream);
    if (comes_in_bursts(stream)) quiet_ns = max_ns(quiet_ns, stream->sum.longest_ns + stream->step_ns);
    return max_ns(stream->due_ns, stream->held_ns + max_ns(quiet_ns, pace->period_ns));
}

/* In how many ns to serve it at the latest if no message comes. */
static int64_t wait_ns(const relay_t *relay, int64_t now) {
    int64_t next_ns = relay->first ? now : NEVER_NS;
    for (size_t i = 0; i < relay->stream_count; i++) {
        int64_t at_ns = release_ns(&relay->settings, &relay->streams[i]);
        if (at_ns < next_ns) next_ns = at_ns;
    }
    return next_ns < NEVER_NS ? max_ns(next_ns - now, 0) : NEVER_NS;
}

static void note_error(relay_t *relay) {
    memcpy(relay->settings.counts.error, relay->settings.rcl.error_text().text, ERROR_BYTES - 1);
    relay->settings.rcl.reset_error();
    relay->settings.counts.errors++;
}

static void pass(relay_t *relay, stream_t *stream, message_t *message, int64_t now) {
    counts_t *counts = &relay->settings.counts;
    charge(&relay->settings, stream, now);
    record(&counts->relayed, now, message->length);
    counts->beginning_bytes = message->length < BEGINNING_BYTES ? message->length : BEGINNING_BYTES;
    if (counts->beginning_bytes) memcpy(counts->beginning, message->buffer, counts->beginning_bytes);
    if (relay->settings.publishes_at_once) {
        uint8_t *gid = relay->settings.gives_gid ? stream->gid : NULL;
        if (relay->settings.rcl.publish(relay->settings.publisher, message, gid)) note_error(relay);
        return;
    }
    outgoing_t *outgoing = relay->unused ? relay->unused : calloc(1, sizeof *outgoing);
    counts->errors += !outgoing;
    if (!outgoing) return;
    relay->unused = outgoing->next;
    outgoing->next = NULL;
    outgoing->message.allocator = relay->settings.allocator;
    swap(&outgoing->message, message);
    *(relay->first ? &relay->last->next : &relay->first) = outgoing;
    relay->last = outgoing;
    relay->outgoing_count++;
}

/* What waits now; only who serves the topic publishes it, so the order stays. */
static void publish_outgoing(relay_t *relay) {
    outgoing_t *outgoing = NULL, *last = relay->last;
    while (relay->first && outgoing != last) {
        outgoing = relay->first;
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

/* It is now: what is due passes. A clock that jumped back starts every grid anew; what is held stays held. */
static void see(relay_t *relay, int64_t now) {
    int has_jumped = now < relay->settings.counts.now_ns;
    relay->settings.counts.now_ns = now;
    for (size_t i = 0; i < relay->stream_count; i++) {
        stream_t *stream = &relay->streams[i];
        if (has_jumped) {
            start(&relay->settings, stream, now);
            forget_gaps(stream);
            stream->held_ns = now;
        }
        if (release_ns(&relay->settings, stream) <= now) pass(relay, stream, &stream->held, now);
    }
}

static void forget_streams(relay_t *relay) {
    while (relay->stream_count) free_message(&relay->streams[--relay->stream_count].held);
}

/* The stream of one more publisher. Beyond the most, all begin anew, and what is held passes. */
static stream_t *new_stream(relay_t *relay) {
    if (relay->stream_count == MAX_STREAMS) {
        for (stream_t *stream = relay->streams; stream < relay->streams + MAX_STREAMS; stream++)
            if (stream->is_held) pass(relay, stream, &stream->held, relay->settings.counts.now_ns);
        forget_streams(relay);
    }
    stream_t *streams = realloc(relay->streams, (relay->stream_count + 1) * sizeof *streams);
    if (!streams) return NULL;
    relay->streams = streams;
    streams[relay->stream_count] = (stream_t){.held.allocator = relay->settings.allocator};
    return &streams[relay->stream_count++];
}

/* The stream of a message, unless that or a later one of its publisher came before. */
static stream_t *counted(relay_t *relay, const uint8_t *gid, uint64_t number) {
    counts_t *counts = &relay->settings.counts;
    stream_t *known = NULL;
    for (size_t i = 0; i < relay->stream_count && !known; i++)
        if (!memcmp(relay->streams[i].gid, gid, GID_BYTES)) known = &relay->streams[i];
    if (known && number <= known->number) return NULL;
    uint64_t before = known ? known->number : number - 1;
    if (!known && !(known = new_stream(relay))) return NULL;
    memcpy(known->gid, gid, GID_BYTES);
    known->number = number;
    counts->sent += number - before;
    counts->lost += number - before - 1;
    return known;
}

static void offer(relay_t *relay, stream_t *stream, int64_t now) {
    const settings_t *pace = &relay->settings;
    see(relay, now);
    record(&relay->settings.counts.arrived, now, relay->incoming.length);
    if (!stream->is_open) {
        stream->is_open = 1;
        start(pace, stream, now);
    }
    record_arrival(stream, now);
    if (now - stream->lag_ns >= stream->due_ns || !pace->period_ns) {
        pass(relay, stream, &relay->incoming, now);
    } else if (pace->period_ns < NEVER_NS) {
        stream->is_held = 1;
        stream->held_ns = now;
        swap(&stream->held, &relay->incoming);
    }
}

/* Whether there may be more; while much waits to be published, messages stay in the middleware's queue. */
static int take(relay_t *relay) {
    uint64_t info[INFO_BYTES / sizeof(uint64_t)];
    uint8_t gid[GID_BYTES] = {0};
    for (int taken = 0; taken < MAX_TAKEN_AT_ONCE && relay->outgoing_count < MAX_OUTGOING; taken++) {
        int code = relay->settings.rcl.take(relay->settings.subscription, &relay->incoming, info, NULL);
        if (code && code != TAKE_FAILED) note_error(relay);
        if (code) return 0;
        memcpy(gid, (uint8_t *)info + GID_AT, relay->settings.gid_bytes);
        stream_t *stream = counted(relay, gid, info[NUMBER_AT / sizeof(uint64_t)]);
        if (stream) offer(relay, stream, now_ns(relay));
    }
    return 1;
}

/* Serve it once; returns in how many ns to do so again, or -1 if there is more to take. */
int64_t relay_step(relay_t *relay, int takes) {
    pthread_mutex_lock(&relay->mutex);
    int has_more = takes && take(relay);
    int64_t now = now_ns(relay), period_ns = relay->settings.period_ns;
    see(relay, now);
    publish_outgoing(relay);
    int64_t again_ns = has_more ? -1 : wait_ns(relay, now);
    /* What comes later and is held, is not due within a period: so it need not wake the thread. */
    uint64_t messages = relay->settings.counts.arrived.messages;
    if (again_ns == NEVER_NS && period_ns && messages > relay->messages_before) again_ns = period_ns;
    relay->messages_before = messages;
    pthread_mutex_unlock(&relay->mutex);
    return again_ns;
}

static void *run(void *unused);

/* Have a new thread be the shared one; whether it could be started. */
static int start_thread(void) {
    pthread_t thread;
    if (pthread_create(&thread, NULL, run, NULL)) return 0;
    pthread_detach(shared.thread = thread);
    shared.serves_since_ns = 0;
    return shared.has_thread = 1;
}

/* Have it served in so many ns, and messages taken if some are unread. */
static void serve_in(relay_t *relay, int64_t ns, int is_unread) {
    if (ns == NEVER_NS) return;
    int64_t now = clock_ns(CLOCK_MONOTONIC);
    pthread_mutex_lock(&shared.mutex);
    relay->is_unread |= is_unread;
    if (relay->serve_at_ns) relay->serve_at_ns = ns ? now + ns : 0;
    int is_earlier = relay->serve_at_ns < shared.sleeps_until_ns;
    if (is_earlier) shared.sleeps_until_ns = relay->serve_at_ns;
    if (shared.serves_since_ns && now - shared.serves_since_ns > SLOW_NS) start_thread();
    pthread_mutex_unlock(&shared.mutex);
    if (is_earlier) pthread_cond_broadcast(&shared.changed);
}

/* Whether this is still the shared thread. */
static int serve_now(relay_t *relay) {
    int takes = relay->is_unread;
    relay->is_unread = 0;
    relay->is_served = 1;
    relay->serve_at_ns = NEVER_NS;
    shared.serves_since_ns = clock_ns(CLOCK_MONOTONIC);
    pthread_mutex_unlock(&shared.mutex);
    int64_t again_ns = relay_step(relay, takes);
    int64_t at_ns = again_ns > 0 ? clock_ns(CLOCK_MONOTONIC) + again_ns : 0;
    pthread_mutex_lock(&shared.mutex);
    relay->is_served = 0;
    relay->is_unread |= again_ns < 0;
    if (at_ns < relay->serve_at_ns) relay->serve_at_ns = at_ns;
    if (relay->is_stopping) pthread_cond_broadcast(&shared.changed);
    int is_shared = pthread_equal(shared.thread, pthread_self());
    if (is_shared) shared.serves_since_ns = 0;
    return is_shared;
}

/* By the steady clock: another one may jump back, and then a wait would last for ever. */
static void *run(void *unused) {
    int is_shared = 1;
    pthread_mutex_lock(&shared.mutex);
    while (is_shared && shared.relays) {
        int64_t now = clock_ns(CLOCK_MONOTONIC);
        if (now < shared.sleeps_until_ns) {
            struct timespec until = {shared.sleeps_until_ns / NS_PER_S, shared.sleeps_until_ns % NS_PER_S};
            pthread_cond_clockwait(&shared.changed, &shared.mutex, CLOCK_MONOTONIC, &until);
            continue;
        }
        shared.sleeps_until_ns = NEVER_NS;
        for (relay_t *relay = shared.relays; relay && is_shared; relay = relay->next) {
            if (relay->is_served || relay->is_stopping) continue;
            if (relay->serve_at_ns <= now) is_shared = serve_now(relay);
            if (relay->serve_at_ns < shared.sleeps_until_ns) shared.sleeps_until_ns = relay->serve_at_ns;
        }
    }
    shared.has_thread &= !is_shared;
    pthread_cond_broadcast(&shared.changed);
    pthread_mutex_unlock(&shared.mutex);
    return unused;
}

/* What Python calls. All but relay_stop and relay_free may be called while the relay runs. */

const size_t relay_sizes[] = {ABI, sizeof(settings_t), sizeof(stream_t), sizeof(counts_t)};

relay_t *relay_new(const settings_t *settings) {
    relay_t *relay = malloc(sizeof *relay);
    if (!relay) return NULL;
    *relay = (relay_t){.mutex = PTHREAD_MUTEX_INITIALIZER, .settings = *settings};
    relay->incoming.allocator = settings->allocator;
    if (settings->gid_bytes > GID_BYTES) relay->settings.gid_bytes = GID_BYTES;
    return relay;
}

/* To be called before relay_start: what is known of a publisher. Whether there was memory for it. */
int relay_add_stream(relay_t *relay, const stream_t *known) {
    size_t length = known->is_held ? known->held.length : 0;
    stream_t *added = new_stream(relay);
    if (!added) return 0;
    message_t held = {NULL, length, length, added->held.allocator};
    if (length && !(held.buffer = held.allocator.allocate(length, held.allocator.state))) return 0;
    if (length) memcpy(held.buffer, known->held.buffer, length);
    *added = *known;
    added->held = held;
    begin_buckets(added, added->last_ns / BUCKET_NS, added->last_ns / BUCKET_NS);
    return 1;
}

/* Whether a thread serves it; from now on the middleware may call relay_on_message. */
int relay_start(relay_t *relay) {
    pthread_mutex_lock(&shared.mutex);
    int has_thread = shared.has_thread || start_thread();
    relay->next = shared.relays;
    relay->is_stopping = !has_thread;
    if (has_thread) shared.relays = relay;
    pthread_mutex_unlock(&shared.mutex);
    serve_in(relay, 0, 1);
    return has_thread;
}

void relay_on_message(const void *given, size_t count) {
    relay_t *relay = (relay_t *)(uintptr_t)given;
    int64_t ns = 0;
    int is_unread = 1;
    (void)count;
    if (relay->settings.takes_on_callback && !pthread_mutex_trylock(&relay->mutex)) {
        is_unread = take(relay);
        if (!is_unread) ns = wait_ns(relay, now_ns(relay));
        pthread_mutex_unlock(&relay->mutex);
    }
    serve_in(relay, ns, is_unread);
}

void relay_set_pace(relay_t *relay, int64_t period_ns) {
    pthread_mutex_lock(&relay->mutex);
    settings_t old = relay->settings;
    int64_t now = now_ns(relay);
    see(relay, now);
    relay->settings.period_ns = period_ns;
    for (size_t i = 0; i < relay->stream_count; i++)
        if (relay->streams[i].is_open) change_pace(&old, &relay->settings, &relay->streams[i], now);
    pthread_mutex_unlock(&relay->mutex);
    serve_in(relay, 0, 0);
}

/* Also has it served at the right time if the clock jumped. Once it is stopped, its time stands still: what
   would pass, nobody would publish. */
void relay_read(relay_t *relay, counts_t *counts) {
    pthread_mutex_lock(&relay->mutex);
    if (!relay->is_stopping) see(relay, now_ns(relay));
    *counts = relay->settings.counts;
    int64_t ns = relay->is_stopping ? NEVER_NS : wait_ns(relay, counts->now_ns);
    pthread_mutex_unlock(&relay->mutex);
    serve_in(relay, ns, 0);
}

/* Publish what passed, and take nothing more; the middleware must no longer call relay_on_message. */
void relay_stop(relay_t *relay) {
    pthread_mutex_lock(&shared.mutex);
    relay->is_stopping = 1;
    while (relay->is_served) pthread_cond_wait(&shared.changed, &shared.mutex);
    relay_t **at = &shared.relays;
    while (*at != relay) at = &(*at)->next;
    *at = relay->next;
    pthread_cond_broadcast(&shared.changed);
    pthread_mutex_unlock(&shared.mutex);
    relay_step(relay, 0);
}

/* Its streams once it is stopped; their number. */
size_t relay_streams(const relay_t *relay, const stream_t **streams) {
    *streams = relay->streams;
    return relay->stream_count;
}

void relay_free(relay_t *relay) {
    forget_streams(relay);
    free_message(&relay->incoming);
    for (outgoing_t *next; relay->unused; relay->unused = next) {
        next = relay->unused->next;
        free_message(&relay->unused->message);
        free(relay->unused);
    }
    free(relay->streams);
    free(relay);
}
