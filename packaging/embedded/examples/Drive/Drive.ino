// SPDX-License-Identifier: MIT
//
// Drive slowly forward while a button (pin 2 to ground) is held; released, the robot stops.
// A board with an Ethernet shield, at 192.168.0.50; the robot is at 192.168.0.2.

#include <Ethernet.h>
#include <roburoc4.h>

static const uint8_t BUTTON = 2;
static const IPAddress ROBOT(192, 168, 0, 2);
static const uint16_t ROBOT_PORT = 60000;

static roburoc4_client client;
static EthernetUDP udp;

// micros() starts again after 71 minutes; the client's clock does not.
static uint64_t now_us() {
    static uint32_t last = 0, wraps = 0;
    uint32_t now = micros();
    wraps += now < last;
    last = now;
    return (uint64_t)wraps << 32 | now;
}

void setup() {
    static uint8_t mac[] = {0x02, 0x00, 0x00, 0x00, 0x00, 0x50};
    pinMode(BUTTON, INPUT_PULLUP);
    Ethernet.begin(mac, IPAddress(192, 168, 0, 50));
    udp.begin(60001);
    roburoc4_client_init(&client, sizeof client, nullptr);
    roburoc4_client_start(&client, now_us());
}

void loop() {
    static uint8_t datagram[512];
    for (int whole; (whole = udp.parsePacket()) > 0;) {
        int size = udp.read(datagram, sizeof datagram);
        if (size == whole && udp.remoteIP() == ROBOT) {
            roburoc4_client_receive(&client, datagram, (size_t)size, now_us());
        }
    }

    static bool held = false;
    bool was_held = held;
    roburoc4_result result = ROBUROC4_OK;
    held = digitalRead(BUTTON) == LOW;
    if (held && !was_held) {
        result = roburoc4_client_arm(&client, now_us()); // refused with a reason
    } else if (!held && was_held) {
        result = roburoc4_client_stop(&client, now_us());
    }
    if (held) {
        result = roburoc4_client_drive(&client, 0.2f, 0.0f, 0, now_us()); // holds for 250 ms
    }
    (void)result; // below 0 if refused: roburoc4_result_text(result) says why

    for (;;) {
        roburoc4_result size =
            roburoc4_client_poll_transmit(&client, datagram, sizeof datagram, now_us());
        if (size <= 0) {
            break;
        }
        udp.beginPacket(ROBOT, ROBOT_PORT);
        udp.write(datagram, (size_t)size);
        udp.endPacket();
    }
}
