#include "plant/axis_plant.h"

#include "world/trace_hash.h"

#define TWO_PI (2.0 * AXIS_PLANT_PI)

static struct axis_plant_config x4_10(void) {
    const double gear = 12.5;
    return (struct axis_plant_config){
        .inertia_kgm2 = 0.25e-4 * gear * gear,
        .static_nm = 0.8,
        .coulomb_nm = 0.6,
        .stribeck_rps = 0.1,
        .viscous_nms = 0.002,
        .peak_nm = 10.0,
        .supply_v = 24.0,
        .emf_vs = 6.0 / 1000.0 * 60.0 / TWO_PI * gear,
        .winding_ohm = 2.0 * 0.32,
        .gear = gear,
        .encoder_counts = 131072.0,
    };
}

struct axis_plant_config axis_plant_pan(void) {
    struct axis_plant_config c = x4_10();
    c.inertia_kgm2 += 0.0060 + 0.0020 + 0.0048;
    c.stop_min_rad = -200.0 * AXIS_PLANT_PI / 180.0;
    c.stop_max_rad = 200.0 * AXIS_PLANT_PI / 180.0;
    return c;
}

struct axis_plant_config axis_plant_tilt(void) {
    struct axis_plant_config c = x4_10();
    c.inertia_kgm2 += 0.0060 + 0.0020;
    c.gravity_nm = 1.5 * 9.81 * 0.010;
    c.stop_min_rad = -100.0 * AXIS_PLANT_PI / 180.0;
    c.stop_max_rad = 110.0 * AXIS_PLANT_PI / 180.0;
    return c;
}

void axis_plant_init(struct axis_plant *plant, const struct axis_plant_config *config,
                     double angle_rad) {
    *plant = (struct axis_plant){
        .angle_rad = angle_rad,
        .config = *config,
        .step_per_inertia = AXIS_PLANT_SUBSTEP_S / config->inertia_kgm2,
        .inverse_stribeck = 1.0 / config->stribeck_rps,
        .counts_per_rad = config->encoder_counts * config->gear / TWO_PI,
        .torque_per_volt = config->emf_vs / config->winding_ohm,
    };
    plant->gravity_at_rad = angle_rad;
    plant->gravity_nm = config->gravity_nm * axis_plant_cos(angle_rad + config->lever_rad);
    plant->knee_rps =
        (config->supply_v - config->peak_nm / plant->torque_per_volt) / config->emf_vs;
}

double axis_plant_cos(double x_rad) {
    const double turns = x_rad * (1.0 / TWO_PI);
    const double nearest = (double)(int64_t)(turns + (turns < 0.0 ? -0.5 : 0.5));
    const double half = (x_rad - nearest * TWO_PI) * 0.5; // within +-pi/2
    const double h2 = half * half;
    // Taylor series of the sine to the 13th power; the next term is below 7e-10. In pairs, which a
    // processor can work on at the same time.
    const double h4 = h2 * h2;
    const double low = 1.0 - h2 * (1.0 / 6.0) + h4 * (1.0 / 120.0 - h2 * (1.0 / 5040.0));
    const double high = 1.0 / 362880.0 - h2 * (1.0 / 39916800.0) + h4 * (1.0 / 6227020800.0);
    const double s = half * (low + h4 * h4 * high);
    return 1.0 - 2.0 * s * s;
}

double axis_plant_torque_max(const struct axis_plant *plant, double rate_rps) {
    const double speed = rate_rps < 0.0 ? -rate_rps : rate_rps;
    if (speed <= plant->knee_rps) {
        return plant->config.peak_nm;
    }
    const double volts = plant->config.supply_v - plant->config.emf_vs * speed;
    return volts > 0.0 ? volts * plant->torque_per_volt : 0.0;
}

static double motor_torque(const struct axis_plant *plant, double torque_nm) {
    const double peak = plant->config.peak_nm;
    const bool drives = (torque_nm > 0.0) == (plant->rate_rps > 0.0);
    const double limit = drives ? axis_plant_torque_max(plant, plant->rate_rps) : peak;
    if (torque_nm > limit) {
        return limit;
    }
    return torque_nm < -limit ? -limit : torque_nm;
}

/// The speed after one step under the given torque and friction.
static double next_rate(const struct axis_plant *plant, double torque_nm, double brake_nm) {
    const struct axis_plant_config *c = &plant->config;
    const double rate = plant->rate_rps;
    if (rate == 0.0) {
        const double hold = c->static_nm + brake_nm;
        if (torque_nm <= hold && torque_nm >= -hold) {
            return 0.0;
        }
        return (torque_nm - (torque_nm > 0.0 ? hold : -hold)) * plant->step_per_inertia;
    }
    const double s = rate * plant->inverse_stribeck;
    const double friction =
        c->coulomb_nm + (c->static_nm - c->coulomb_nm) / (1.0 + s * s) + brake_nm;
    const double next =
        rate + (torque_nm - c->viscous_nms * rate - (rate > 0.0 ? friction : -friction)) *
                   plant->step_per_inertia;
    return (next > 0.0) == (rate > 0.0) ? next : 0.0; // friction stops, it doesn't push back
}

void axis_plant_step(struct axis_plant *plant, double torque_nm, double brake_nm) {
    const struct axis_plant_config *c = &plant->config;
    const double motor = motor_torque(plant, torque_nm);
    double torque = motor + plant->disturbance_nm;
    if (c->gravity_nm != 0.0) {
        if (plant->angle_rad != plant->gravity_at_rad) { // at rest it stays what it is
            plant->gravity_at_rad = plant->angle_rad;
            plant->gravity_nm = c->gravity_nm * axis_plant_cos(plant->angle_rad + c->lever_rad);
        }
        torque -= plant->gravity_nm;
    }
    double rate = next_rate(plant, torque, brake_nm);
    double angle = plant->angle_rad + rate * AXIS_PLANT_SUBSTEP_S;
    plant->at_stop = 0;
    if (angle >= c->stop_max_rad) {
        angle = c->stop_max_rad;
        rate = rate > 0.0 ? 0.0 : rate;
        plant->at_stop = 1;
    } else if (angle <= c->stop_min_rad) {
        angle = c->stop_min_rad;
        rate = rate < 0.0 ? 0.0 : rate;
        plant->at_stop = -1;
    }
    plant->motor_nm = motor;
    plant->rate_rps = rate;
    plant->angle_rad = angle;
}

uint64_t axis_plant_hash(const struct axis_plant *plant, uint64_t hash) {
    hash = trace_hash_f64(hash, plant->angle_rad);
    hash = trace_hash_f64(hash, plant->rate_rps);
    hash = trace_hash_f64(hash, plant->motor_nm);
    return trace_hash_f64(hash, plant->disturbance_nm);
}
