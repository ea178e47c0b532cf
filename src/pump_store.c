/* SPDX-License-Identifier: MIT
 *
 * pump_store.c - what a pump's threads share: its lock, the ring of samples, the turn in which each
 * event last occurred, and the robot's texts; and how readers wait for them.
 */
#include "pump_internal.h"

#include <string.h>

/* Samples copied per lock: a few microseconds. */
#define CHUNK 64u

/* A status that is older than this when it is received counts as one from before a restart. */
#define LATEST_US 10000000u

/* ------------------------------------------------------------------------------------ lock --- */

int roburoc4_pump_enter(roburoc4_pump *pump) {
    if (pump->process != roburoc4_process_id()) {
        return 0;
    }
    roburoc4_lock_take(&pump->lock);
    return 1;
}

void roburoc4_pump_leave(roburoc4_pump *pump) {
    roburoc4_lock_give(&pump->lock);
}

void roburoc4_pump_wait(roburoc4_pump *pump, uint64_t until_us) {
    uint64_t now_us = roburoc4_udp_now_us();
    if (until_us <= now_us) {
        return;
    }
    pump->waiters++;
    roburoc4_signal_wait(&pump->changed, &pump->lock, until_us - now_us);
    pump->waiters--;
    if (pump->phase == ROBUROC4_PUMP_JOINED && pump->waiters == 0) {
        roburoc4_signal_wake_all(&pump->changed); /* destroy() waits for this */
    }
}

/* ------------------------------------------------------------------------------- the writer --- */

static uint64_t made_us(const roburoc4_client *client, const roburoc4_sample *sample) {
    uint64_t mapped_us;
    if (roburoc4_client_host_time(client, sample->robot_cycles, &mapped_us) < 0 ||
        sample->host_us - mapped_us > LATEST_US) { /* or in the future */
        return sample->host_us;
    }
    return mapped_us;
}

roburoc4_result roburoc4_sample_latest(const roburoc4_client *client, uint32_t service,
                                       roburoc4_sample *out) {
    roburoc4_sample_value *value = &out->value;
    roburoc4_result result = ROBUROC4_ERR_ARGUMENT;
    memset(out, 0, sizeof *out);
    out->service = service;
    switch (service) {
    case ROBUROC4_SERVICE_IOCARD:
        result = roburoc4_client_inputs(client, &value->inputs, &out->host_us);
        break;
    case ROBUROC4_SERVICE_TELEMETER:
        result = roburoc4_client_distances(client, &value->distances, &out->host_us);
        break;
    case ROBUROC4_SERVICE_BATTERY:
        result = roburoc4_client_battery(client, &value->battery, &out->host_us);
        break;
    case ROBUROC4_SERVICE_LOCALIZATION:
        result = roburoc4_client_localization(client, &value->localization, &out->host_us);
        break;
    case ROBUROC4_SERVICE_DIFFERENTIAL:
        result = roburoc4_client_differential(client, &value->differential, &out->host_us);
        break;
    default:
        break;
    }
    out->robot_cycles = value->inputs.robot_cycles; /* the first member of every status */
    out->made_us = made_us(client, out);
    return result;
}

static void store_sample(roburoc4_pump *pump, uint32_t service) {
    roburoc4_sample sample;
    if (roburoc4_sample_latest(&pump->client, service, &sample) >= 0) {
        sample.sequence = pump->next_sample;
        pump->samples[pump->next_sample % pump->capacity] = sample;
        pump->next_sample++;
    }
}

/* Where a text is stored, or NULL for a channel beyond the client's capacities. */
static roburoc4_pump_text *find_text(roburoc4_pump *pump, int32_t io_type, uint32_t index) {
    static const uint32_t sizes[] = {ROBUROC4_MAX_SERVICES, ROBUROC4_MAX_ANALOG_INPUTS,
                                     ROBUROC4_MAX_ANALOG_OUTPUTS, ROBUROC4_MAX_DIGITAL_INPUTS,
                                     ROBUROC4_MAX_DIGITAL_OUTPUTS};
    uint32_t row = (uint32_t)(io_type + 1), before = 0, i;
    for (i = 0; i < row; i++) {
        before += sizes[i];
    }
    return index < sizes[row] ? &pump->texts[before + index] : NULL;
}

static void store_text(roburoc4_pump *pump, const uint8_t *datagram, size_t size) {
    roburoc4_description description;
    roburoc4_pump_text *text;
    uint32_t length;
    if (roburoc4_client_description(&pump->client, datagram, size, &description) < 0) {
        return;
    }
    text = find_text(pump, description.io_type, description.index);
    if (text == NULL) {
        return;
    }
    length = description.length;
    if (length > ROBUROC4_PUMP_DESCRIPTION_SIZE - 1) {
        length = ROBUROC4_PUMP_DESCRIPTION_SIZE - 1;
    }
    memcpy(text->text, description.text, length);
    text->length = (uint8_t)length;
    text->known = 1;
}

void roburoc4_pump_collect(roburoc4_pump *pump, const uint8_t *datagram, size_t size) {
    uint32_t events = roburoc4_client_take_events(&pump->client);
    uint32_t bit, service;
    if (events == 0) {
        return;
    }
    pump->event_turn++;
    for (bit = 0; bit < 32; bit++) {
        if (events >> bit & 1u) {
            pump->event_last[bit] = pump->event_turn;
        }
    }
    for (service = ROBUROC4_SERVICE_IOCARD; service < ROBUROC4_SERVICE_COUNT; service++) {
        uint32_t arrived = (uint32_t)ROBUROC4_EVENT_IOCARD << (service - ROBUROC4_SERVICE_IOCARD);
        if ((events & arrived) != 0 && pump->phase == ROBUROC4_PUMP_RUNNING) {
            store_sample(pump, service);
        }
    }
    if ((events & ROBUROC4_EVENT_DESCRIPTION) != 0 && datagram != NULL) {
        store_text(pump, datagram, size);
    }
    roburoc4_signal_wake_all(&pump->changed);
}

/* ------------------------------------------------------------------------------ the readers --- */

static uint64_t oldest_sample(const roburoc4_pump *pump) {
    return pump->next_sample > pump->capacity ? pump->next_sample - pump->capacity : 0;
}

/* The next sample that is still there for this reader. */
static uint64_t position(const roburoc4_pump *pump, const roburoc4_pump_reader *reader) {
    uint64_t oldest = oldest_sample(pump);
    uint64_t next = reader->next_sample > oldest ? reader->next_sample : oldest;
    return next < pump->next_sample ? next : pump->next_sample;
}

roburoc4_result roburoc4_pump_reader_init(roburoc4_pump *pump, roburoc4_pump_reader *reader) {
    if (!roburoc4_pump_enter(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    memset(reader, 0, sizeof *reader);
    reader->next_sample = pump->next_sample;
    reader->private_next_event = pump->event_turn + 1;
    roburoc4_pump_leave(pump);
    return ROBUROC4_OK;
}

static uint32_t copy_chunk(roburoc4_pump *pump, roburoc4_pump_reader *reader,
                           roburoc4_sample *samples, uint32_t capacity) {
    uint64_t next = position(pump, reader);
    uint32_t copied = 0;
    if (next > reader->next_sample) {
        reader->lost += next - reader->next_sample;
    }
    while (copied < capacity && next < pump->next_sample) {
        samples[copied++] = pump->samples[next++ % pump->capacity];
    }
    reader->next_sample = next;
    return copied;
}

roburoc4_result roburoc4_pump_read_samples(roburoc4_pump *pump, roburoc4_pump_reader *reader,
                                           roburoc4_sample *samples, uint32_t capacity) {
    uint32_t wanted = capacity < ROBUROC4_PUMP_QUEUE_MAX ? capacity : ROBUROC4_PUMP_QUEUE_MAX;
    uint32_t copied = 0, chunk, part;
    int over;
    do {
        chunk = wanted - copied < CHUNK ? wanted - copied : CHUNK;
        if (!roburoc4_pump_enter(pump)) {
            return ROBUROC4_ERR_CLOSED;
        }
        part = copy_chunk(pump, reader, samples + copied, chunk);
        over = pump->phase != ROBUROC4_PUMP_RUNNING && reader->next_sample == pump->next_sample;
        roburoc4_pump_leave(pump);
        copied += part;
    } while (part == chunk && copied < wanted);
    return copied == 0 && over ? ROBUROC4_ERR_CLOSED : (roburoc4_result)copied;
}

/* What a reader waits for: the number of samples to read, or the events to take. */
typedef uint32_t (*look)(const roburoc4_pump *pump, const roburoc4_pump_reader *reader,
                         uint32_t mask);

static uint32_t look_for_samples(const roburoc4_pump *pump, const roburoc4_pump_reader *reader,
                                 uint32_t mask) {
    (void)mask;
    return (uint32_t)(pump->next_sample - position(pump, reader));
}

static uint32_t look_for_events(const roburoc4_pump *pump, const roburoc4_pump_reader *reader,
                                uint32_t mask) {
    uint32_t events = 0, bit;
    for (bit = 0; bit < 32; bit++) {
        if (pump->event_last[bit] != 0 && pump->event_last[bit] >= reader->private_next_event) {
            events |= (uint32_t)1 << bit;
        }
    }
    return events & mask;
}

static roburoc4_result wait_for(roburoc4_pump *pump, const roburoc4_pump_reader *reader,
                                look look_for, uint32_t mask, uint32_t timeout_us) {
    uint64_t until_us = roburoc4_udp_now_us() + timeout_us;
    uint32_t found;
    int over;
    if (!roburoc4_pump_enter(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    for (;;) {
        found = look_for(pump, reader, mask);
        over = pump->phase != ROBUROC4_PUMP_RUNNING;
        if (found != 0 || over || roburoc4_udp_now_us() >= until_us) {
            break;
        }
        roburoc4_pump_wait(pump, until_us);
    }
    roburoc4_pump_leave(pump);
    return found == 0 && over ? ROBUROC4_ERR_CLOSED : (roburoc4_result)found;
}

roburoc4_result roburoc4_pump_wait_samples(roburoc4_pump *pump, const roburoc4_pump_reader *reader,
                                           uint32_t timeout_us) {
    return wait_for(pump, reader, look_for_samples, 0, timeout_us);
}

roburoc4_result roburoc4_pump_wait_events(roburoc4_pump *pump, const roburoc4_pump_reader *reader,
                                          uint32_t mask, uint32_t timeout_us) {
    return wait_for(pump, reader, look_for_events, mask, timeout_us);
}

roburoc4_result roburoc4_pump_take_events(roburoc4_pump *pump, roburoc4_pump_reader *reader) {
    uint32_t events;
    int over;
    if (!roburoc4_pump_enter(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    events = look_for_events(pump, reader, UINT32_MAX);
    reader->private_next_event = pump->event_turn + 1;
    over = pump->phase != ROBUROC4_PUMP_RUNNING;
    roburoc4_pump_leave(pump);
    return events == 0 && over ? ROBUROC4_ERR_CLOSED : (roburoc4_result)events;
}

static int is_text_kind(int32_t io_type) {
    return io_type >= -1 && io_type <= ROBUROC4_IO_DIGITAL_OUTPUT;
}

roburoc4_result roburoc4_pump_description(roburoc4_pump *pump, int32_t io_type, uint32_t index,
                                          char *buffer, size_t capacity) {
    roburoc4_result result = ROBUROC4_ERR_INDEX;
    const roburoc4_pump_text *text;
    if (!is_text_kind(io_type)) {
        return ROBUROC4_ERR_ARGUMENT;
    }
    if (!roburoc4_pump_enter(pump)) {
        return ROBUROC4_ERR_CLOSED;
    }
    text = find_text(pump, io_type, index);
    if (text != NULL && !text->known) {
        result = ROBUROC4_ERR_NOT_KNOWN;
    } else if (text != NULL && text->length >= capacity) {
        result = ROBUROC4_ERR_BUFFER;
    } else if (text != NULL) {
        memcpy(buffer, text->text, text->length);
        buffer[text->length] = '\0';
        result = text->length;
    }
    roburoc4_pump_leave(pump);
    return result;
}
