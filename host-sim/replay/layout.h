/// How the controller's structures lie in the memory of a 32-bit ARM, and their translation.
///
/// The compiler for the board lays a structure out by the ARM EABI (AAPCS32): as on x86-64, but
/// that a pointer has four bytes and an enum only as many as its values need. So every structure
/// that an emulated image shares with us is described field by field, in order, and the offsets
/// follow. That the description is whole and right is checked by both compilers:
/// tests/mcu/cpu/layout.sh.
#ifndef REPLAY_LAYOUT_H
#define REPLAY_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum layout_kind {
    LAYOUT_SAME, ///< integers, and structures and unions of nothing else: the same bytes on both
    LAYOUT_ENUM, ///< one byte over there, none of its values below 0
    LAYOUT_SIGNED_ENUM, ///< one byte, with values below 0
    LAYOUT_POINTER,     ///< four bytes over there; becomes NULL here
    LAYOUT_STRUCT,      ///< of another layout
};

struct layout;

struct layout_field {
    const char *name;
    enum layout_kind kind;
    uint32_t host_at, host_bytes; ///< all elements
    uint32_t align;               ///< LAYOUT_SAME
    struct layout *type;          ///< LAYOUT_STRUCT: of one element
    // Found at the first use.
    uint32_t arm_at, arm_bytes, count;
};

struct layout {
    const char *name; ///< of the struct
    struct layout_field *fields;
    unsigned field_count;
    uint32_t host_bytes;
    // Found at the first use.
    uint32_t arm_bytes, arm_align;
};

extern struct layout layout_target_update, layout_controller_pan, layout_controller_input,
    layout_controller_output, layout_controller_config, layout_controller;

uint32_t layout_arm_bytes(struct layout *layout);

/// Where a field lies over there. The name must be right.
uint32_t layout_arm_offset(struct layout *layout, const char *field);

/// Translates a whole structure.
void layout_to_host(struct layout *layout, const void *arm, void *host);
void layout_to_arm(struct layout *layout, const void *host, void *arm);

/// Writes the layout as assertions in C, for either compiler. arm: the sizes over there, else those
/// here.
void layout_write_assertions(FILE *stream, bool arm);

#endif
