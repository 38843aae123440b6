/* SPDX-FileCopyrightText: 2026 The SmartTestudo authors
   SPDX-License-Identifier: Apache-2.0

   What one writes in C in an hour on rcl: waits for all topics, takes, and publishes with the usual gate.
   Compiled by relay_paths.py; rcl has no headers in a wheel, so its functions are declared here. */
#define _GNU_SOURCE
#include <stddef.h>
#include <stdint.h>
#include <time.h>

typedef struct { void *allocate, *deallocate, *reallocate, *zero_allocate, *state; } allocator_t;
typedef struct { uint8_t *buffer; size_t length, capacity; allocator_t allocator; } message_t;

int rcl_wait_set_init(void *, size_t, size_t, size_t, size_t, size_t, size_t, void *, allocator_t);
int rcl_wait_set_clear(void *);
int rcl_wait_set_add_subscription(void *, const void *, size_t *);
int rcl_wait(void *, int64_t);
int rcl_take_serialized_message(const void *, message_t *, void *, void *);
int rcl_publish_serialized_message(const void *, const message_t *, void *);
allocator_t rcutils_get_default_allocator(void);

static int64_t now_ns(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

/* For ever, or until rcl fails; `last_ns` are zeros. */
void relay(void *context, size_t count, void **subscriptions, void **publishers, const int64_t *periods_ns, int64_t *last_ns) {
    uint64_t set[64] = {0}, info[32];
    message_t message = {.allocator = rcutils_get_default_allocator()};
    if (rcl_wait_set_init(set, count, 0, 0, 0, 0, 0, context, message.allocator)) return;
    for (;;) {
        rcl_wait_set_clear(set);
        for (size_t i = 0; i < count; i++) rcl_wait_set_add_subscription(set, subscriptions[i], NULL);
        if (rcl_wait(set, -1)) return;
        void **ready = (void **)(uintptr_t)set[0];
        for (size_t i = 0; i < count; i++) {
            if (!ready[i] || rcl_take_serialized_message(subscriptions[i], &message, info, NULL)) continue;
            int64_t now = now_ns();
            if (now - last_ns[i] < periods_ns[i]) continue;
            last_ns[i] = now;
            rcl_publish_serialized_message(publishers[i], &message, NULL);
        }
    }
}
