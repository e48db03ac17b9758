/// Usage: uf2-writer IMAGE.bin IMAGE.uf2   Writes an RP2040 image in the format of its USB drive.
///
/// The format: github.com/microsoft/uf2, blocks of 512 bytes that each carry 256 of the image and
/// its address. The image's first 256 bytes must end with the CRC that the ROM looks for (RP2040
/// datasheet, 2.8.1.3.1): a file with a wrong one would be taken and never start.
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FLASH_ADDRESS UINT32_C(0x10000000)
#define FLASH_BYTES   (2048U * 1024U)
#define PAGE_BYTES    256U
#define BLOCK_BYTES   512U
#define FAMILY_RP2040 UINT32_C(0xE48BFF56)
#define HAS_FAMILY    UINT32_C(0x2000)

/// Polynomial 0x04C11DB7, most significant bit first, start with all ones, not inverted.
static uint32_t crc32(const uint8_t *data, size_t size_bytes) {
    uint32_t crc = UINT32_MAX;
    for (size_t i = 0; i < size_bytes; i++) {
        crc ^= (uint32_t)data[i] << 24;
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc << 1) ^ ((crc >> 31) != 0U ? UINT32_C(0x04C11DB7) : 0U);
        }
    }
    return crc;
}

static void put_u32(uint8_t *at, uint32_t value) {
    for (unsigned i = 0; i < 4U; i++) {
        at[i] = (uint8_t)(value >> (8U * i));
    }
}

static uint32_t get_u32(const uint8_t *at) {
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static int complain(const char *path, const char *what) {
    fprintf(stderr, "uf2: %s: %s\n", path, what);
    return 1;
}

static int write_blocks(const uint8_t *image, size_t size_bytes, const char *path) {
    FILE *file = fopen(path, "wb");
    if (file == NULL) {
        return complain(path, strerror(errno));
    }
    const uint32_t count = (uint32_t)((size_bytes + PAGE_BYTES - 1U) / PAGE_BYTES);
    for (uint32_t i = 0; i < count; i++) {
        uint8_t block[BLOCK_BYTES] = {0};
        const uint32_t head[] = {UINT32_C(0x0A324655),
                                 UINT32_C(0x9E5D5157),
                                 HAS_FAMILY,
                                 FLASH_ADDRESS + i * PAGE_BYTES,
                                 PAGE_BYTES,
                                 i,
                                 count,
                                 FAMILY_RP2040};
        for (unsigned k = 0; k < 8U; k++) {
            put_u32(block + 4U * k, head[k]);
        }
        memcpy(block + 32, image + (size_t)i * PAGE_BYTES, PAGE_BYTES);
        put_u32(block + BLOCK_BYTES - 4U, UINT32_C(0x0AB16F30));
        (void)fwrite(block, 1, sizeof block, file);
    }
    const int failed = ferror(file);
    return fclose(file) != 0 || failed != 0 ? complain(path, "can't be written") : 0;
}

int main(int argc, char **argv) {
    if (argc != 3) {
        fprintf(stderr, "usage: uf2-writer IMAGE.bin IMAGE.uf2\n");
        return 2;
    }
    static uint8_t image[FLASH_BYTES + PAGE_BYTES];
    FILE *file = fopen(argv[1], "rb");
    if (file == NULL) {
        return complain(argv[1], strerror(errno));
    }
    const size_t size_bytes = fread(image, 1, FLASH_BYTES + 1U, file);
    (void)fclose(file);
    if (size_bytes <= PAGE_BYTES || size_bytes > FLASH_BYTES) {
        return complain(argv[1], "is no image of 257 bytes to 2 MiB");
    }
    const uint32_t wanted = crc32(image, PAGE_BYTES - 4U);
    if (get_u32(image + PAGE_BYTES - 4U) != wanted) {
        char what[80];
        (void)snprintf(what, sizeof what, "the last word of boot2 must be 0x%08x",
                       (unsigned)wanted);
        return complain(argv[1], what);
    }
    return write_blocks(image, size_bytes, argv[2]);
}
