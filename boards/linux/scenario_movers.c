#include "scenario_movers.h"

#include "plant/axis_plant.h"

#include <stddef.h>

#define MOVER(member) .offset = offsetof(struct scenario_mover, member)
const struct ini_key scenario_mover_keys[SCENARIO_MOVER_KEY_COUNT] = {
    {.name = "id",
     .type = INI_WHOLE,
     .min = "0",
     .max = "4294967295",
     MOVER(id),
     .help = "of the target"},
    {.name = "object",
     .type = INI_WHOLE,
     .fallback = "0",
     .min = "0",
     .max = "65535",
     MOVER(object),
     .help = "which group it belongs to"},
    {.name = "start_m",
     .type = INI_DECIMAL_LIST,
     .min = "-1000000",
     .max = "1000000",
     .numerator = 1000000,
     MOVER(start_um),
     .help = "where it begins: east, north, up"},
    {.name = "velocity_mps",
     .type = INI_DECIMAL_LIST,
     .fallback = "0, 0, 0",
     .min = "-10000",
     .max = "10000",
     .numerator = 1000000,
     MOVER(velocity_umps),
     .help = "straight motion"},
    {.name = "radius_m",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "0",
     .max = "1000000",
     .numerator = 1000000,
     MOVER(radius_um),
     .help = "of a level circle round that"},
    {.name = "phase_deg",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "-360",
     .max = "360",
     .numerator = 1000,
     MOVER(phase_mdeg),
     .help = "where on the circle it begins, from east"},
    {.name = "turn_dps",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "-3600",
     .max = "3600",
     .numerator = 1000,
     MOVER(turn_mdps),
     .help = "how fast it goes round, toward north"},
    {.name = "from_s",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "0",
     .max = "4000000",
     .numerator = 1000000,
     MOVER(from_us),
     .help = "when it appears"},
    {.name = "until_s",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "0",
     .max = "4000000",
     .numerator = 1000000,
     MOVER(until_us),
     .help = "when it leaves; 0: stays"},
    {.name = "period_ms",
     .type = INI_DECIMAL,
     .fallback = "50",
     .min = "1",
     .max = "60000",
     .numerator = 1000,
     MOVER(period_us),
     .help = "how often the controller hears of it"},
    {.name = "noise_m",
     .type = INI_DECIMAL,
     .fallback = "0",
     .min = "0",
     .max = "1000",
     .numerator = 1000000,
     MOVER(noise_um),
     .help = "error of what it hears, standard deviation"},
};

bool scenario_movers_add(const struct scenario_mover *movers, uint32_t count, const struct ini *ini,
                         struct schedule *schedule) {
    for (uint32_t i = 0; i < count; i++) {
        const struct scenario_mover *from = &movers[i];
        if (from->start_um.count != 3U || from->velocity_umps.count != 3U) {
            ini_complain(ini, "mover", from->label,
                         from->start_um.count != 3U ? "start_m" : "velocity_mps",
                         "needs three values: east, north, up");
            return false;
        }
        const double degree = AXIS_PLANT_PI / 180.0;
        struct schedule_mover mover = {.id = (uint32_t)from->id,
                                       .object = (uint16_t)from->object,
                                       .from_us = (uint64_t)from->from_us,
                                       .until_us = (uint64_t)from->until_us,
                                       .period_us = (uint32_t)from->period_us,
                                       .radius_m = (double)from->radius_um * 1e-6,
                                       .phase_rad = (double)from->phase_mdeg * 1e-3 * degree,
                                       .rate_rps = (double)from->turn_mdps * 1e-3 * degree,
                                       .noise_m = (double)from->noise_um * 1e-6};
        for (unsigned axis = 0; axis < 3U; axis++) {
            mover.start_m[axis] = (double)from->start_um.item[axis] * 1e-6;
            mover.velocity_mps[axis] = (double)from->velocity_umps.item[axis] * 1e-6;
        }
        if (!schedule_add_mover(schedule, &mover)) {
            return false;
        }
    }
    return true;
}
