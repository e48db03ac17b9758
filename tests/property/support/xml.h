/// A checker of XML, small and strict, for what the program writes as HTML and SVG.
#ifndef SUPPORT_XML_H
#define SUPPORT_XML_H

#include <stddef.h>

/// NULL if the text is well-formed, else what is wrong; *at is then the offset. Knows elements,
/// attributes, text, &amp; &lt; &gt; &quot; &#N; and one <!DOCTYPE html>; anything else is wrong,
/// and so are two equal ids, a reference `#x` that no id answers, and, since the text may be HTML,
/// too, an element outside <svg> that closes itself (but <meta/>).
const char *xml_check(const char *text, size_t size, size_t *at);

#endif
