#include "mcu/image.h"

#include <elf.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// A piece of the file; NULL: it is not there in full.
static const void *piece(const struct image *image, uint64_t offset, uint64_t size_bytes) {
    if (offset > image->size_bytes || image->size_bytes - offset < size_bytes) {
        return NULL;
    }
    return image->bytes + offset;
}

static const char *load_file(struct image *image, const char *path) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return strerror(errno);
    }
    const char *wrong = NULL;
    if (fseek(file, 0, SEEK_END) != 0) {
        wrong = "can't be read";
    }
    const long size = wrong == NULL ? ftell(file) : -1;
    if (size <= 0 || size > 64L * 1024 * 1024) {
        wrong = "is no image: empty, or larger than 64 MiB";
    }
    rewind(file);
    if (wrong == NULL) {
        image->bytes = malloc((size_t)size);
        image->size_bytes = (size_t)size;
        if (image->bytes == NULL || fread(image->bytes, 1, (size_t)size, file) != (size_t)size) {
            wrong = "can't be read";
        }
    }
    fclose(file);
    return wrong;
}

static const char *find_symbols(struct image *image, const Elf32_Ehdr *header) {
    const Elf32_Shdr *sections =
        piece(image, header->e_shoff, (uint64_t)header->e_shnum * sizeof(Elf32_Shdr));
    if (header->e_shnum != 0U && sections == NULL) {
        return "is cut off";
    }
    for (unsigned i = 0; i < header->e_shnum; i++) {
        if (sections[i].sh_type != SHT_SYMTAB || sections[i].sh_link >= header->e_shnum) {
            continue;
        }
        const Elf32_Shdr *names = &sections[sections[i].sh_link];
        image->symbols = piece(image, sections[i].sh_offset, sections[i].sh_size);
        image->symbol_count = sections[i].sh_size / sizeof(Elf32_Sym);
        image->names = piece(image, names->sh_offset, names->sh_size);
        image->names_bytes = names->sh_size;
        if (image->symbols == NULL || image->names == NULL || names->sh_size == 0U ||
            image->names[names->sh_size - 1U] != '\0') {
            return "has a broken symbol table";
        }
    }
    return NULL;
}

const char *image_read(struct image *image, const char *path) {
    memset(image, 0, sizeof *image);
    const char *wrong = load_file(image, path);
    if (wrong != NULL) {
        return wrong;
    }
    const Elf32_Ehdr *header = piece(image, 0, sizeof *header);
    if (header == NULL || memcmp(header->e_ident, ELFMAG, SELFMAG) != 0 ||
        header->e_ident[EI_CLASS] != ELFCLASS32 || header->e_ident[EI_DATA] != ELFDATA2LSB ||
        header->e_machine != EM_ARM || header->e_phentsize != sizeof(Elf32_Phdr) ||
        (header->e_shnum != 0U && header->e_shentsize != sizeof(Elf32_Shdr))) {
        return "is no ELF image for 32-bit ARM";
    }
    return find_symbols(image, header);
}

void image_free(struct image *image) {
    free(image->bytes);
    memset(image, 0, sizeof *image);
}

const char *image_flash(const struct image *image, uint32_t base, uint8_t *flash,
                        size_t size_bytes) {
    const Elf32_Ehdr *header = (const Elf32_Ehdr *)(const void *)image->bytes;
    const Elf32_Phdr *segments =
        piece(image, header->e_phoff, (uint64_t)header->e_phnum * sizeof(Elf32_Phdr));
    if (segments == NULL) {
        return "is cut off";
    }
    size_t flashed = 0;
    for (unsigned i = 0; i < header->e_phnum; i++) {
        const Elf32_Phdr *segment = &segments[i];
        if (segment->p_type != PT_LOAD || segment->p_filesz == 0U) {
            continue;
        }
        const void *from = piece(image, segment->p_offset, segment->p_filesz);
        const uint32_t at = segment->p_paddr - base;
        if (from == NULL) {
            return "is cut off";
        }
        if (at >= size_bytes || size_bytes - at < segment->p_filesz) {
            return "has parts that don't lie in this board's flash";
        }
        memcpy(flash + at, from, segment->p_filesz);
        flashed += segment->p_filesz;
    }
    return flashed != 0U ? NULL : "has nothing to flash";
}

static const char *name_of(const struct image *image, const Elf32_Sym *symbol) {
    return symbol->st_name < image->names_bytes ? image->names + symbol->st_name : "";
}

bool image_symbol(const struct image *image, const char *name, struct image_symbol *symbol) {
    const Elf32_Sym *symbols = image->symbols;
    for (size_t i = 0; i < image->symbol_count; i++) {
        if (symbols[i].st_shndx != SHN_UNDEF && strcmp(name_of(image, &symbols[i]), name) == 0) {
            *symbol = (struct image_symbol){symbols[i].st_value, symbols[i].st_size};
            return true;
        }
    }
    return false;
}

const char *image_function_at(const struct image *image, uint32_t address) {
    const Elf32_Sym *symbols = image->symbols;
    for (size_t i = 0; i < image->symbol_count; i++) {
        const uint32_t begin = symbols[i].st_value & ~1U;
        if (ELF32_ST_TYPE(symbols[i].st_info) == STT_FUNC && address >= begin &&
            address - begin < symbols[i].st_size) {
            return name_of(image, &symbols[i]);
        }
    }
    return NULL;
}
