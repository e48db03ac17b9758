/// The image that is flashed: an ELF file for 32-bit ARM.
#ifndef MCU_IMAGE_H
#define MCU_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct image {
    uint8_t *bytes; ///< the file
    size_t size_bytes;
    // Tables inside it; NULL and 0 if it was stripped.
    const void *symbols;
    const char *names;
    size_t symbol_count, names_bytes;
};

struct image_symbol {
    uint32_t address; ///< of a function: with the Thumb bit
    uint32_t size_bytes;
};

/// Reads a file. Returns: NULL, or what is wrong with it, to follow its name. Free in any case.
const char *image_read(struct image *image, const char *path);
void image_free(struct image *image);

/// Copies what belongs into flash (base to base + size) to where a programmer would put it.
/// Returns: NULL, or what is wrong.
const char *image_flash(const struct image *image, uint32_t base, uint8_t *flash,
                        size_t size_bytes);

/// Finds a global or local symbol.
bool image_symbol(const struct image *image, const char *name, struct image_symbol *symbol);

/// The function that an address is in; NULL: unknown.
const char *image_function_at(const struct image *image, uint32_t address);

#endif
