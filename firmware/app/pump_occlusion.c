#include "app/pump_occlusion.h"

/// Reports that a step takes in where a tick has little time: each costs some divisions.
#define REPORTS_A_STEP 4U

void pump_occlusion_attach(struct pump_occlusion *stage, struct pump *pump,
                           struct occlusion *occlusion, bool all) {
    stage->detour = (struct pump_detour){.count = 0};
    stage->occlusion = occlusion;
    stage->all = all;
    stage->time_us = 0;
    stage->read_us = hal_clock_now_us(pump->devices.clock);
    pump->detour = &stage->detour;
}

static void put(struct pump_detour *detour, const struct target_update *update) {
    detour->update[(detour->first + detour->count) % PUMP_DETOUR_MAX] = *update;
    detour->count++;
}

static void take_reports(struct pump_occlusion *stage, struct pump *pump) {
    struct target_update update;
    uint32_t taken = 0;
    bool as_is;
    while (stage->detour.count < PUMP_DETOUR_MAX && (stage->all || taken < REPORTS_A_STEP) &&
           pump_take(pump, &update, &as_is)) {
        if (as_is && update.kind == TARGET_CLEAR) {
            occlusion_forget(stage->occlusion);
        }
        if (as_is || !occlusion_report(stage->occlusion, &update, stage->time_us)) {
            put(&stage->detour, &update);
        } else {
            taken++;
        }
    }
}

void pump_occlusion_step(struct pump_occlusion *stage, struct pump *pump) {
    const uint32_t now_us = hal_clock_now_us(pump->devices.clock);
    struct occlusion *const occlusion = stage->occlusion;
    struct target_update update;
    stage->time_us += now_us - stage->read_us;
    stage->read_us = now_us;
    if (stage->detour.forget) {
        stage->detour.forget = false;
        occlusion_forget(occlusion);
    }
    take_reports(stage, pump);
    occlusion_by_object(occlusion, pump->controller->view.choice.one_object);
    occlusion_step(occlusion, stage->time_us, stage->all);
    while (stage->detour.count < PUMP_DETOUR_MAX && occlusion_next(occlusion, &update)) {
        put(&stage->detour, &update);
    }
}
