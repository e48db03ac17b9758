/// A Maestro Micro as its maker's document describes it, for tests: what it was sent, and servos
/// that arrive at once. It shares no code with the driver. Besides, so that the contract of bulk
/// transfers can be tested on it: endpoint 2 takes a transfer, endpoint 0x81 gives it back.
#ifndef CONTRACT_SUPPORT_MAESTRO_MODEL_H
#define CONTRACT_SUPPORT_MAESTRO_MODEL_H

#include <stdbool.h>
#include <stdint.h>

struct maestro_model {
    volatile uint16_t target[6], speed[6], acceleration[6];
    volatile uint16_t errors;
    volatile uint32_t requests, unknown;
    uint8_t echo[4096];
    int echo_size; ///< 0: none waits
};

/// Descriptors of it: device (18 bytes), and configuration with the echo's endpoints.
extern const uint8_t maestro_model_device[18];
extern const uint8_t maestro_model_configuration[32];
#define MAESTRO_MODEL_SERIAL "00031415"

/// Answers a vendor request; data as in a USB control transfer. Returns: bytes, or -1: refused.
int maestro_model_control(void *ctx, const uint8_t setup[8], uint8_t *data, uint16_t size);
int maestro_model_bulk_out(void *ctx, uint8_t endpoint, const uint8_t *data, uint32_t size);
/// -2: nothing waits.
int maestro_model_bulk_in(void *ctx, uint8_t endpoint, uint8_t *data, uint32_t capacity);

#endif
