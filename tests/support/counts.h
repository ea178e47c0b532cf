/* SPDX-License-Identifier: MIT
 *
 * How many entries the client's lists have.
 */
#ifndef ROBUROC4_TESTS_COUNTS_H
#define ROBUROC4_TESTS_COUNTS_H

#include "roburoc4.h"

template <class Item>
uint32_t count_of(const roburoc4_client *client,
                  roburoc4_result (*at)(const roburoc4_client *, uint32_t, Item *)) {
    uint32_t count = 0;
    for (Item item; at(client, count, &item) == ROBUROC4_OK;) {
        count++;
    }
    return count;
}

inline uint32_t service_count(const roburoc4_client *client) {
    return count_of(client, roburoc4_client_service_at);
}

inline uint32_t telemeter_count(const roburoc4_client *client) {
    return count_of(client, roburoc4_client_telemeter);
}

#endif
