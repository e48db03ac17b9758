/// Where what a camera saw is by the time that anybody hears of it.
///
/// A frame is 10 to 100 ms old when its detections are known. A thing that goes by at 30 degrees a
/// second is 1.5 degrees farther by then, so each one's way is followed (a fading memory of its
/// last sights, by the times of their exposure) and carried on to now. What does not go as it went
/// (a jump, another thing under the same id) begins anew and is where it was seen.
#ifndef DETECT_FORESIGHT_H
#define DETECT_FORESIGHT_H

#include <stdint.h>

enum { FORESIGHT_THINGS = 256 };

/// Nothing is carried on for longer.
#define FORESIGHT_US_MAX 300000U

struct foresight {
    uint32_t count;
    struct foresight_thing {
        uint32_t id;
        uint32_t seen_us; ///< of the clock of the frames, which wraps
        uint32_t sights;  ///< since it began anew
        double at[3];     ///< then, filtered
        double rate[3];   ///< a second
    } thing[FORESIGHT_THINGS];
};

void foresight_init(struct foresight *foresight);

/// A sight of that thing, exposed at seen_us: the unit vector `world` becomes where it is at
/// now_us. More things than FORESIGHT_THINGS are where they were seen.
/// Accuracy: at 25 frames a second with 0.02 degree of noise, 60 ms later: 0.02 degree rms of a
///           thing at 20 degrees a second (1.2 where it was seen), 0.1 of one that swings by 5
///           degrees in 6 s (0.3) (tests/scenario/test_foresight.c); in the loop: docs/camera.md.
void foresight_see(struct foresight *foresight, uint32_t id, uint32_t seen_us, uint32_t now_us,
                   double world[3]);

void foresight_forget(struct foresight *foresight, uint32_t id);

#endif
