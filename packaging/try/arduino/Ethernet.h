// SPDX-License-Identifier: MIT
//
// What the sketch uses of Arduino, as its reference declares it, to compile the sketch without Arduino.
#include <stddef.h>
#include <stdint.h>

enum { LOW, HIGH, INPUT_PULLUP };
unsigned long micros();
void pinMode(uint8_t pin, uint8_t mode);
int digitalRead(uint8_t pin);

struct IPAddress {
    IPAddress(uint8_t, uint8_t, uint8_t, uint8_t);
    bool operator==(const IPAddress &) const;
};

struct EthernetClass {
    void begin(uint8_t *mac, IPAddress ip);
};
extern EthernetClass Ethernet;

struct EthernetUDP {
    uint8_t begin(uint16_t port);
    int parsePacket();
    int read(unsigned char *buffer, size_t size);
    IPAddress remoteIP();
    int beginPacket(IPAddress ip, uint16_t port);
    size_t write(const uint8_t *buffer, size_t size);
    int endPacket();
};
