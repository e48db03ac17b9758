# Chooses the scaling of an axis by the data, as docs/levine.md ("How the axes are chosen") says.
# axis_choose(lowest, highest, angle) sets axis_log, axis_low, axis_high and axis_tick[1..axis_ticks]; axis_at(v) is 0 at the low end, 1 at the high one.
function axis_power(v, p) { # the power of ten at or below v
    for (p = 1; p * 10 <= v * (1 + 1e-9); p *= 10) { }
    for (; p > v * (1 + 1e-9); p /= 10) { }
    return p
}
function axis_below(v, p) { # 1, 2 or 5 times a power of ten
    p = axis_power(v)
    return v >= 5 * p * (1 - 1e-9) ? 5 * p : v >= 2 * p * (1 - 1e-9) ? 2 * p : p
}
function axis_next(v, p) {
    p = axis_power(v)
    return v >= 5 * p * (1 - 1e-9) ? 10 * p : v >= 2 * p * (1 - 1e-9) ? 5 * p : 2 * p
}
function axis_floor(v) { return int(v) > v ? int(v) - 1 : int(v) }
function axis_add(v) { axis_tick[++axis_ticks] = v }
function axis_choose(lowest, highest, angle, step, v, decades) {
    axis_ticks = 0
    axis_log = !angle && lowest > 0 && highest >= 20 * lowest
    if (axis_log) {
        axis_low = axis_below(lowest)
        axis_high = axis_below(highest)
        if (axis_high < highest * (1 - 1e-9)) { axis_high = axis_next(axis_high) }
        decades = log(axis_high / axis_low) / log(10)
        if (decades <= 2.5) {
            for (v = axis_low; v <= axis_high * (1 + 1e-9); v = axis_next(v)) { axis_add(v) }
            return
        }
        axis_low = axis_power(axis_low)
        if (axis_power(axis_high) < axis_high * (1 - 1e-9)) { axis_high = 10 * axis_power(axis_high) }
        decades = log(axis_high / axis_low) / log(10)
        step = decades <= 6.001 ? 10 : 100
        for (v = axis_low; v <= axis_high * (1 + 1e-9); v *= step) { axis_add(v) }
        axis_high = axis_tick[axis_ticks] < highest * (1 - 1e-9) ? axis_tick[axis_ticks] * step : axis_tick[axis_ticks]
        if (axis_high > axis_tick[axis_ticks]) { axis_add(axis_high) }
        return
    }
    if (highest <= lowest) { highest = lowest + 1 }
    if (angle) {
        for (v = 0; v <= 360; v += 90) { axis_add(v) }
    } else {
        v = lowest >= 0 && lowest < highest / 2 ? 0 : lowest
        for (step = axis_below((highest - v) / 10); axis_steps(v, highest, step) > 5; step = axis_next(step)) { }
        axis_low = axis_floor(v / step + 1e-9) * step
        for (v = 0; v <= axis_steps(axis_low, highest, step); v++) { axis_add(axis_low + v * step) }
    }
    axis_low = axis_tick[1]
    axis_high = axis_tick[axis_ticks]
}
function axis_steps(low, high, step, from, to) { # whole steps from the tick below low to that above high
    from = axis_floor(low / step + 1e-9)
    to = -axis_floor(-high / step + 1e-9)
    return to - from
}
function axis_at(v) {
    return axis_log ? log(v / axis_low) / log(axis_high / axis_low) : (v - axis_low) / (axis_high - axis_low)
}
function axis_label(v) { return v >= 1e5 || (v > 0 && v < 0.01) ? axis_short(v) : sprintf("%g", v) }
function axis_short(v, text) { # 1e6, not 1e+06
    text = sprintf("%.0e", v)
    sub(/e\+0*/, "e", text)
    sub(/e-0*/, "e-", text)
    return text
}
