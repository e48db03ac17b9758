/// A line of many samples thinned to what can be seen: of each column one pixel wide, the first,
/// the smallest, the largest and the last sample. So no extreme is lost, the line enters and leaves
/// each column where it did, and at most four points a column stay.
#ifndef VIEW_REDUCE_H
#define VIEW_REDUCE_H

#include <stdbool.h>
#include <stdint.h>

struct reduce_point {
    double x_px, y_px;
    uint64_t order; ///< of its column, in the order of reduce_add
};

/// Gets the points that stay, in order; `starts`: a new line begins here.
typedef void reduce_sink(void *context, double x_px, double y_px, bool starts);

struct reduce {
    reduce_sink *sink;
    void *context;
    bool starts;                                        ///< the next point that stays begins a line
    uint64_t count;                                     ///< samples in the open column
    double column;                                      ///< its number: floor(x)
    struct reduce_point first, smallest, largest, last; ///< of the open column, if count > 0
};

void reduce_start(struct reduce *reduce, reduce_sink *sink, void *context);

/// x should not fall (where it does, a new column begins). Not finite: as reduce_gap.
void reduce_add(struct reduce *reduce, double x_px, double y_px);

/// The line ends here; what follows begins a new one. Call it after the last sample, too.
void reduce_gap(struct reduce *reduce);

#endif
