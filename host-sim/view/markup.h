/// Texts and numbers as HTML and SVG want them. What is written is well-formed XML, which both are.
#ifndef VIEW_MARKUP_H
#define VIEW_MARKUP_H

#include <stddef.h>
#include <stdio.h>

/// Bytes of the character at the beginning of a text, control characters included; 0 at the end and
/// where the bytes are not valid UTF-8, or a U+FFFE or U+FFFF.
size_t markup_character_bytes(const char *text);

/// Writes UTF-8 text so that it can stand in an element or in a quoted attribute. Bytes that are
/// not valid UTF-8 become U+FFFD, control characters a blank (XML allows neither).
void markup_text(FILE *out, const char *text);

/// Characters of a text, as markup_text writes them.
size_t markup_length(const char *text);

/// Copies text into a field of `capacity` bytes (at least 1); what does not fit is cut off between
/// two characters.
void markup_copy(char *field, size_t capacity, const char *text);

/// Writes a number with so many decimals (0 to 9) and a true minus sign, never "-0"; not finite: a
/// dash.
void markup_number(FILE *out, double value, int decimals);

/// Writes a coordinate to a tenth of a pixel in as few characters as that takes, within +-10^6.
/// Not finite: 0, so that the file stays well-formed; callers leave such points out.
void markup_px(FILE *out, double px);

#endif
