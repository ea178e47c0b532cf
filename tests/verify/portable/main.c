/* SPDX-License-Identifier: MIT
 *
 * The runner for targets on which GoogleTest cannot run: the same vectors and the same safety walk
 * on every one of them. Its last line is "portable: ok, N checks, walk DIGEST", or says how many
 * checks failed. The digest has to be the same on all targets.
 */
#include "check.h"

static uint32_t passed_count, failed_count;

void say(const char *text) {
    while (*text != '\0') {
        port_put(*text++);
    }
}

void say_number(uint32_t number) {
    char digits[10];
    int count = 0;
    do {
        digits[count++] = (char)('0' + (int)(number % 10));
        number /= 10;
    } while (number > 0);
    while (count > 0) {
        port_put(digits[--count]);
    }
}

void say_hex(uint32_t number) {
    int shift;
    for (shift = 28; shift >= 0; shift -= 4) {
        port_put("0123456789abcdef"[number >> shift & 15U]);
    }
}

void check(int passed, const char *part, long line) {
    if (passed) {
        passed_count++;
        return;
    }
    if (failed_count++ < 20) {
        say("failed: ");
        say(part);
        say(":");
        say_number((uint32_t)line);
        say("\n");
    }
}

uint32_t failures(void) {
    return failed_count;
}

int main(void) {
    uint32_t digest;
    port_begin();
    test_layout();
    test_vectors();
    digest = test_walk();
    say("portable: ");
    if (failed_count > 0) {
        say_number(failed_count);
        say(" checks FAILED, ");
    } else {
        say("ok, ");
    }
    say_number(passed_count + failed_count);
    say(" checks, walk ");
    say_hex(digest);
    say("\n");
    port_end(failed_count > 0);
    return failed_count > 0;
}
