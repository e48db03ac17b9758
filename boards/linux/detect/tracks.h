/// What was found in a frame, matched with what was found before: ids that stay.
///
/// A track has a place and a speed; each frame it is carried on to the frame's time and takes the
/// nearest find within its gate, the nearest pairs first. A find that no track takes begins a new
/// one, which is told once it was seen in a few frames; a track that finds nothing for a while
/// ends. Ids are never used again.
#ifndef DETECT_TRACKS_H
#define DETECT_TRACKS_H

#include <stdbool.h>
#include <stdint.h>

enum { TRACKS_MAX = 128 };

struct tracks_settings {
    uint32_t first_id;
    uint32_t frames_to_confirm; ///< a track is told when it was seen so often
    double keep_s;              ///< and ends when it was not seen for so long
    double gate_px;             ///< how far a find may be from where it is expected, plus
    double gate_sizes;          ///< so many times its own size (half diagonal)
    double speed_gain;          ///< how much of a surprise goes into the speed, 0 to 1
};

struct track_find {
    double at[2], half_px[2]; ///< middle, and half width and height of its box
    double confidence;
    uint32_t track; ///< set by tracks_update: index, or UINT32_MAX where no track is left
};

struct track {
    bool used, confirmed;
    uint32_t id, hits;
    double at[2], speed_pps[2]; ///< pixels, pixels a second
    double half_px[2], confidence;
    double unseen_s;
    uint32_t find; ///< of the last update: index, or UINT32_MAX
};

struct tracks {
    uint32_t next_id;
    struct track item[TRACKS_MAX];
    uint32_t ended_count, ended[TRACKS_MAX]; ///< ids that were told and ended in the last update
};

void tracks_init(struct tracks *tracks, const struct tracks_settings *settings);

/// Moves every track: the camera has turned, and what stood at one pixel is at another now. A track
/// whose place is not in the picture any more ends with the next updates, unseen.
void tracks_move(struct tracks *tracks, void (*move)(void *context, double pixel[2]),
                 void *context);

/// elapsed_s: since the last update, at least 0.
/// Cost: O(finds * tracks), twice. Shown: tests/scenario/test_tracks.c.
void tracks_update(struct tracks *tracks, const struct tracks_settings *settings,
                   struct track_find *finds, uint32_t find_count, double elapsed_s);

#endif
