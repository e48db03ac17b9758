/// Names of the constellations, for people: catalogues have three letters.
/// Shown: tests/cli/stars.c.
#ifndef LINUX_CONSTELLATIONS_H
#define LINUX_CONSTELLATIONS_H

/// "Orion" for "Ori"; what is unknown stays as it is.
const char *constellation_name(const char *abbreviation);

#endif
