/* SPDX-FileCopyrightText: 2026 The SmartTestudo authors
   SPDX-License-Identifier: Apache-2.0

   Relays of relay.c under load, for a sanitizer: threads publish to them, others change their pace, read their
   counts, and end them and hand their streams on to a new one; all they take is copied, and read. Messages have any size and content, GIDs and
   numbers come anew and again, takes and writes fail, and the writes of one topic are slow.
   usage: relay_stress SECONDS     ends with 1 and a line of what is wrong */
#include "relay.c"

#include <stdatomic.h>
#include <stdio.h>
#include <sys/eventfd.h>
#include <unistd.h>

enum { SIZES_TOPIC = 1, RETURNED_TOPIC = 2 };
enum { TOPICS = 4, PUBLISHERS = 3, MAX_QUEUE = 10, MAX_SIZE = 70000, SLOW_TOPIC = 0, OTHERS_MEANWHILE = 5 };

typedef struct {
    uint64_t number;
    size_t size;
    uint8_t gid[GID_BYTES];
} item_t;

/* What a middleware keeps of a topic. `callback_mutex` is held while it calls, as Fast DDS does. */
typedef struct {
    pthread_mutex_t queue_mutex, callback_mutex;
    item_t queue[MAX_QUEUE];
    size_t count;
    relay_t *called;
    uint64_t next[PUBLISHERS], last[PUBLISHERS], offered, published, overflown, publishing, taken, copied, returned;
    int index, is_full, is_fuzzed;
} topic_t;

/* Of copies.c. */
typedef struct {
    void *copies;
    int (*take)(const void *subscription, message_t *taken, void *info, void *allocation);
    const void *subscription;
    uint64_t source, gid_bytes, has_payload;
} copied_t;
typedef struct {
    uint64_t source, number, size_bytes, copied_bytes;
    int64_t stamp_ns, steady_ns;
    uint8_t gid[GID_BYTES];
} header_t;
void *copies_new(size_t wakes_from_bytes, size_t most_bytes, int event_fd, int64_t (*now_ns)(void),
                 int64_t (*steady_now_ns)(void));
int copies_take(const void *given, message_t *taken, void *info, void *allocation);
int copies_publish(const void *given, const message_t *passed, void *gid);
size_t copies_swap(void *copies, const uint8_t **bytes, uint64_t *dropped);
void copies_free(void *copies);

static topic_t topics[TOPICS];
static void *copies;
static atomic_int is_over, is_wrong;
static atomic_ullong others, returned_messages;

static void *libc_allocate(size_t size, void *state) { return (void)state, malloc(size); }
static void libc_free(void *memory, void *state) { (void)state, free(memory); }

static void wrong(const char *what, int topic) {
    fprintf(stderr, "topic %d: %s\n", topic, what);
    atomic_store(&is_wrong, 1);
}

static unsigned any(unsigned *seed, unsigned below) { return (unsigned)rand_r(seed) % below; }

static int take_item(const void *subscription, message_t *taken, void *info, void *allocation) {
    topic_t *topic = (topic_t *)(uintptr_t)subscription;
    (void)allocation;
    pthread_mutex_lock(&topic->queue_mutex);
    if (!topic->count) {
        pthread_mutex_unlock(&topic->queue_mutex);
        return TAKE_FAILED;
    }
    item_t item = topic->queue[0];
    memmove(topic->queue, topic->queue + 1, --topic->count * sizeof *topic->queue);
    pthread_mutex_unlock(&topic->queue_mutex);
    if (item.size > taken->capacity) {
        free(taken->buffer);
        taken->buffer = malloc(item.size);
        taken->capacity = item.size;
    }
    taken->length = item.size;
    if (item.size) memset(taken->buffer, (int)item.number, item.size);
    if (item.size >= sizeof item.number) memcpy(taken->buffer, &item.number, sizeof item.number);
    if (item.size > sizeof item.number) taken->buffer[sizeof item.number] = item.gid[0];
    memcpy((uint8_t *)info + NUMBER_AT, &item.number, sizeof item.number);
    memcpy((uint8_t *)info + GID_AT, item.gid, GID_BYTES);
    if (topic->is_fuzzed && item.number % 97 == 0) return 1;
    pthread_mutex_lock(&topic->queue_mutex);
    topic->taken++;
    pthread_mutex_unlock(&topic->queue_mutex);
    return 0;
}

static int publish(const void *publisher, const message_t *sent, void *allocation) {
    topic_t *topic = (topic_t *)(uintptr_t)publisher;
    (void)allocation;
    pthread_mutex_lock(&topic->queue_mutex);
    if (topic->publishing++) wrong("two writes at a time", topic->index);
    topic->published++;
    uint64_t number = 0;
    if (!topic->is_fuzzed && sent->length > sizeof number) {
        int from = sent->buffer[sizeof number];
        memcpy(&number, sent->buffer, sizeof number);
        if (number <= topic->last[from]) wrong("a message came twice or too late", topic->index);
        topic->last[from] = number;
    }
    pthread_mutex_unlock(&topic->queue_mutex);
    /* A write that holds up the others waits for ever. */
    unsigned long long before = atomic_load(&others);
    if (topic->index != SLOW_TOPIC)
        atomic_fetch_add(&others, 1);
    else
        while (!atomic_load(&is_over) && atomic_load(&others) - before < OTHERS_MEANWHILE) usleep(200);
    pthread_mutex_lock(&topic->queue_mutex);
    topic->publishing--;
    pthread_mutex_unlock(&topic->queue_mutex);
    return topic->is_fuzzed && sent->length % 5 == 0;
}

static rcl_error_t error_text(void) { return (rcl_error_t){"an error"}; }
static void reset_error(void) {}

static void call(topic_t *topic) {
    pthread_mutex_lock(&topic->callback_mutex);
    if (topic->called) relay_on_message(topic->called, 1);
    pthread_mutex_unlock(&topic->callback_mutex);
}

static void *produce(void *given) {
    unsigned publisher = (unsigned)(uintptr_t)given, seed = publisher + 1;
    while (!atomic_load(&is_over)) {
        topic_t *topic = &topics[any(&seed, TOPICS)];
        item_t item = {.size = 9 + any(&seed, 2000), .gid = {(uint8_t)publisher, 1}};
        pthread_mutex_lock(&topic->queue_mutex);
        item.number = ++topic->next[publisher];
        if (topic->is_fuzzed) {
            item.size = any(&seed, 3) ? any(&seed, 20) : any(&seed, MAX_SIZE);
            item.number = any(&seed, 4) ? item.number : (uint64_t)rand_r(&seed) << any(&seed, 33);
            for (int at = 0; at < GID_BYTES && !any(&seed, 5); at++) item.gid[at] = (uint8_t)any(&seed, 256);
        }
        topic->offered++;
        if (topic->count == MAX_QUEUE) {
            memmove(topic->queue, topic->queue + 1, --topic->count * sizeof *topic->queue);
            topic->overflown++;
        }
        topic->queue[topic->count++] = item;
        pthread_mutex_unlock(&topic->queue_mutex);
        call(topic);
        usleep(any(&seed, 300));
    }
    return NULL;
}

static relay_t *begin(topic_t *topic, const settings_t *settings, relay_t *before) {
    relay_t *relay = relay_new(settings);
    const stream_t *streams;
    size_t count = before ? relay_streams(before, &streams) : 0;
    for (size_t i = 0; i < count; i++) relay_add_stream(relay, &streams[i]);
    if (before) relay_free(before);
    if (!relay_start(relay)) wrong("no thread", topic->index);
    pthread_mutex_lock(&topic->callback_mutex);
    topic->called = relay;
    pthread_mutex_unlock(&topic->callback_mutex);
    call(topic);
    return relay;
}

static void end(topic_t *topic, relay_t *relay, counts_t *counts) {
    pthread_mutex_lock(&topic->callback_mutex);
    topic->called = NULL;
    pthread_mutex_unlock(&topic->callback_mutex);
    relay_stop(relay);
    relay_read(relay, counts);
}

/* All that was copied by now. */
static void read_copies(void) {
    static int64_t last_ns;
    const uint8_t *at, *end;
    uint64_t dropped;
    size_t length = copies_swap(copies, &at, &dropped);
    if (dropped) wrong("what passed found no room", RETURNED_TOPIC);
    for (end = at + length; at < end;) {
        header_t header;
        uint64_t number;
        memcpy(&header, at, sizeof header);
        at += sizeof header;
        topic_t *topic = &topics[header.source % TOPICS];
        if (header.steady_ns < last_ns) wrong("a copy is older than the one before", topic->index);
        last_ns = header.steady_ns;
        int has_passed = header.source >= TOPICS;
        *(has_passed ? &topic->returned : &topic->copied) += 1;
        if (header.copied_bytes != (topic->index == SIZES_TOPIC ? 0 : header.size_bytes))
            wrong("a copy has another size", topic->index);
        if (header.copied_bytes >= sizeof number) {
            memcpy(&number, at, sizeof number);
            if (!has_passed && number != header.number) wrong("a copy is of another message", topic->index);
            if (has_passed && memcmp(at + sizeof number, header.gid, 1)) wrong("it has another GID", topic->index);
        }
        at += header.copied_bytes + -header.copied_bytes % sizeof number;
    }
}

static void *read_all(void *unused) {
    unsigned seed = 1;
    while (!atomic_load(&is_over)) {
        read_copies();
        usleep(any(&seed, 3000));
    }
    return unused;
}

static void *control(void *given) {
    topic_t *topic = given;
    uint64_t source = (uint64_t)topic->index;
    copied_t copied = {copies, take_item, topic, source, GID_BYTES, topic->index != SIZES_TOPIC};
    copied_t returned = {copies, NULL, NULL, TOPICS + source, GID_BYTES, 1};
    unsigned seed = (unsigned)topic->index + 99;
    settings_t settings = {
        .rcl = {copies_take, publish, error_text, reset_error, NULL},
        .allocator = {.allocate = libc_allocate, .deallocate = libc_free},
        .subscription = &copied,
        .publisher = topic,
        .gid_bytes = GID_BYTES,
        .takes_on_callback = topic->index != 1,
        .publishes_at_once = topic->index == 2,
    };
    if (topic->index == RETURNED_TOPIC) {
        settings.rcl.publish = copies_publish;
        settings.publisher = &returned;
        settings.publishes_at_once = settings.gives_gid = 1;
    }
    relay_t *relay = begin(topic, &settings, NULL);
    while (!atomic_load(&is_over)) {
        usleep(any(&seed, 5000));
        relay_read(relay, &settings.counts);
        if (!any(&seed, 4)) {
            end(topic, relay, &settings.counts);
            relay = begin(topic, &settings, relay);
        }
        if (topic->is_full || any(&seed, 8)) continue;
        settings.period_ns = any(&seed, 2) ? (int64_t)any(&seed, 20000000) : any(&seed, 3) ? 0 : NEVER_NS;
        relay_set_pace(relay, settings.period_ns);
    }
    end(topic, relay, &settings.counts);
    relay = begin(topic, &settings, relay);
    for (int i = 0; i < 500 && topic->index != SLOW_TOPIC; i++) {
        pthread_mutex_lock(&topic->queue_mutex);
        size_t left = topic->count;
        pthread_mutex_unlock(&topic->queue_mutex);
        if (!left) break;
        call(topic);
        usleep(1000);
    }
    end(topic, relay, &settings.counts);
    counts_t *counts = &settings.counts;
    if (counts->relayed.messages > counts->arrived.messages) wrong("more went than came", topic->index);
    if (topic->index == RETURNED_TOPIC)
        atomic_store(&returned_messages, counts->relayed.messages);
    else if (topic->published != counts->relayed.messages) wrong("what went is counted wrong", topic->index);
    if (topic->is_full && counts->arrived.messages != counts->relayed.messages)
        wrong("at Full not all passed", topic->index);
    if (topic->is_full && topic->index != SLOW_TOPIC && topic->offered != counts->relayed.messages + topic->overflown)
        wrong("a message was lost", topic->index);
    relay_free(relay);
    return NULL;
}

int main(int count, char **arguments) {
    pthread_t producers[PUBLISHERS], controls[TOPICS], reader;
    if (count < 2) return 2;
    copies = copies_new(1 << 12, 1 << 26, eventfd(0, EFD_NONBLOCK), NULL, NULL);
    pthread_create(&reader, NULL, read_all, NULL);
    for (int i = 0; i < TOPICS; i++) {
        topics[i].index = i;
        topics[i].is_full = i < 2;
        topics[i].is_fuzzed = i == 3;
        pthread_mutex_init(&topics[i].queue_mutex, NULL);
        pthread_mutex_init(&topics[i].callback_mutex, NULL);
        pthread_create(&controls[i], NULL, control, &topics[i]);
    }
    for (uintptr_t i = 0; i < PUBLISHERS; i++) pthread_create(&producers[i], NULL, produce, (void *)i);
    sleep((unsigned)atoi(arguments[1]));
    atomic_store(&is_over, 1);
    for (int i = 0; i < PUBLISHERS; i++) pthread_join(producers[i], NULL);
    for (int i = 0; i < TOPICS; i++) pthread_join(controls[i], NULL);
    pthread_join(reader, NULL);
    read_copies();
    for (int i = 0; i < TOPICS; i++)
        if (topics[i].copied != topics[i].taken) wrong("not all was copied once", i);
    if (topics[RETURNED_TOPIC].returned != atomic_load(&returned_messages))
        wrong("not all that passed was returned", RETURNED_TOPIC);
    copies_free(copies);
    uint64_t published = 0;
    for (int i = 0; i < TOPICS; i++) published += topics[i].published;
    printf("%llu messages\n", (unsigned long long)published);
    return atomic_load(&is_wrong);
}
