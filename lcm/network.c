/* SPDX-License-Identifier: MIT */
#include "network.h"

#include <stdbool.h>
#include <string.h>

#include "text.h"

static const char udpm[] = "udpm://";

/* ADDRESS or ADDRESS:PORT of a multicast group, or nothing, up to the URL's end or '?'. */
static bool is_group(const char *text) {
    uint32_t part = 0;
    if (*text == '\0' || *text == '?') {
        return true;
    }
    for (int at = 0; at < 4; at++) {
        if ((at > 0 && *text++ != '.') || !text_number(&text, 255, &part) ||
            (at == 0 && (part < 224 || part > 239))) {
            return false;
        }
    }
    if (*text == ':') {
        text++;
        if (!text_number(&text, 65535, &part) || part == 0) {
            return false;
        }
    }
    return *text == '\0' || *text == '?';
}

/* `ttl=N&recv_buf_size=BYTES`, in any order, each once: LCM ignores what it does not know, and a
 * bridge that is heard by nobody, or by everybody, would be the result. */
static bool is_query(const char *text) {
    static const struct {
        const char *key;
        uint32_t max;
    } keys[] = {{"ttl=", 255}, {"recv_buf_size=", 999999999}};
    uint32_t value = 0;
    bool seen[2] = {false, false};
    for (;; text++) {
        size_t at = 0;
        while (at < 2 && strncmp(text, keys[at].key, strlen(keys[at].key)) != 0) {
            at++;
        }
        if (at == 2 || seen[at]) {
            return false;
        }
        seen[at] = true;
        text += strlen(keys[at].key);
        if (!text_number(&text, keys[at].max, &value) || (*text != '\0' && *text != '&')) {
            return false;
        }
        if (*text == '\0') {
            return true;
        }
    }
}

const char *network_remedy(const char *url) {
    static const char memq[] = "memq://";
    if (url[0] == '\0' || strncmp(url, memq, strlen(memq)) == 0) {
        return NULL;
    }
    if (strncmp(url, udpm, strlen(udpm)) != 0 || !is_group(url + strlen(udpm))) {
        return "the bridge has no such LCM network; give udpm://ADDRESS:PORT?ttl=N, such as "
               "'udpm://239.255.76.67:7667?ttl=0'";
    }
    const char *query = strchr(url, '?');
    return query == NULL || is_query(query + 1)
               ? NULL
               : "after the ? give ttl=0 (this machine) to ttl=255, recv_buf_size=BYTES, or both "
                 "with & between them";
}

uint16_t network_port(const char *url) {
    const char *colon =
        strncmp(url, udpm, strlen(udpm)) == 0 ? strchr(url + strlen(udpm), ':') : NULL;
    uint32_t port = 7667; /* LCM's default */
    if (strncmp(url, "memq", 4) == 0) {
        return 0;
    }
    if (colon != NULL) {
        colon++;
        (void)text_number(&colon, 65535, &port);
    }
    return (uint16_t)port;
}
