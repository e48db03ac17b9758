#include "contract/support/maestro_model.h"

#include <string.h>

const uint8_t maestro_model_device[18] = {18,   1,    0,    2,    0,    0, 0, 8, 0xFB,
                                          0x1F, 0x89, 0x00, 0x04, 0x01, 1, 2, 3, 1};
const uint8_t maestro_model_configuration[32] = {9,  2, 32, 0,    1, 1,    0, 0xC0, 50, 9,    4,
                                                 0,  0, 2,  0xFF, 0, 0,    0, 7,    5,  0x81, 2,
                                                 64, 0, 0,  7,    5, 0x02, 2, 64,   0,  0};

/// Micro: 98 bytes of the script's machine, with the errors at 2, then 7 bytes a servo.
static int variables(const struct maestro_model *model, uint8_t *data) {
    memset(data, 0, 140);
    data[2] = (uint8_t)model->errors;
    data[3] = (uint8_t)(model->errors >> 8);
    for (int i = 0; i < 6; i++) {
        uint8_t *servo = data + 98 + 7 * i;
        servo[0] = servo[2] = (uint8_t)model->target[i]; // there already
        servo[1] = servo[3] = (uint8_t)(model->target[i] >> 8);
        servo[4] = (uint8_t)model->speed[i];
        servo[5] = (uint8_t)(model->speed[i] >> 8);
        servo[6] = (uint8_t)model->acceleration[i];
    }
    return 140;
}

int maestro_model_control(void *ctx, const uint8_t setup[8], uint8_t *data, uint16_t size) {
    struct maestro_model *model = ctx;
    const uint16_t value = (uint16_t)(setup[2] | setup[3] << 8);
    const uint16_t index = (uint16_t)(setup[4] | setup[5] << 8);
    (void)size;
    model->requests++;
    if (setup[0] == 0xC0 && setup[1] == 0x83 && value == 0U && index == 0U) {
        return variables(model, data);
    }
    if (setup[0] == 0x40 && setup[1] == 0x84 && (index & 0x7FU) < 6U) {
        *((index & 0x80U) != 0U ? &model->acceleration[index & 0x7FU] : &model->speed[index]) =
            value;
        return 0;
    }
    if (setup[0] == 0x40 && setup[1] == 0x85 && index < 6U) {
        model->target[index] = value;
        return 0;
    }
    if (setup[0] == 0x40 && setup[1] == 0x86) {
        model->errors = 0;
        return 0;
    }
    model->unknown++;
    return -1;
}

int maestro_model_bulk_out(void *ctx, uint8_t endpoint, const uint8_t *data, uint32_t size) {
    struct maestro_model *model = ctx;
    if (endpoint != 2U || size > sizeof model->echo) {
        return -1;
    }
    memcpy(model->echo, data, size);
    model->echo_size = (int)size;
    return (int)size;
}

int maestro_model_bulk_in(void *ctx, uint8_t endpoint, uint8_t *data, uint32_t capacity) {
    struct maestro_model *model = ctx;
    if (endpoint != 1U || model->echo_size == 0) {
        return -2;
    }
    const int size = model->echo_size < (int)capacity ? model->echo_size : (int)capacity;
    memcpy(data, model->echo, (size_t)size);
    model->echo_size = 0;
    return size;
}
