#include "contract/support/can_suite.h"

#include "contract/support/contract.h"

static const struct can_fixture *fixture;
static uint64_t seed;

static void reset(void) {
    fixture->reset(fixture->context);
}

static void settle(void) {
    fixture->settle(fixture->context);
}

static uint32_t rounds(uint32_t all) {
    return fixture->share > 1U ? all / fixture->share : all;
}

/// A frame that tells its number, so that a lost, doubled or overtaken one shows.
static struct can_frame numbered(uint32_t number) {
    struct can_frame frame = {.id = 0x140, .length = 8};
    for (unsigned i = 0; i < 8U; i++) {
        frame.data[i] = (uint8_t)(number >> (i % 4U * 8U));
    }
    return frame;
}

/// A length that the rig can carry.
static uint8_t carried_length(uint8_t flags, uint8_t length) {
    return fixture->remote_length_lost && (flags & CAN_FRAME_REMOTE) != 0U ? 0U : length;
}

static struct can_frame any_frame(void) {
    const uint64_t bits = check_random(&seed);
    struct can_frame frame = {.flags = (uint8_t)(bits & 3U), .length = (uint8_t)(bits / 4U % 9U)};
    frame.id = (uint32_t)(bits >> 32) &
               ((bits & 1U) != 0U ? CAN_FRAME_EXTENDED_ID_MAX : CAN_FRAME_STANDARD_ID_MAX);
    const uint64_t data = check_random(&seed);
    memcpy(frame.data, &data, sizeof frame.data);
    frame.length = carried_length(frame.flags, frame.length);
    return frame;
}

static void expect_frame(const struct hal_can *can, const struct can_frame *wanted) {
    struct can_frame got;
    uint32_t received_us;
    if (CHECK_EQ(hal_can_receive(can, &got, &received_us), HAL_OK)) {
        CHECK(can_frame_is_valid(&got));
        CHECK(can_frame_equal(&got, wanted));
    }
}

static void expect_nothing(const struct hal_can *can) {
    struct can_frame got = numbered(12345), before = got;
    uint32_t received_us = 54321;
    CHECK_EQ(hal_can_receive(can, &got, &received_us), HAL_EMPTY);
    CHECK(memcmp(&got, &before, sizeof got) == 0 && received_us == 54321U);
}

static struct hal_can_state state_of(const struct hal_can *can) {
    struct hal_can_state state = {.health = HAL_CAN_OFF};
    CHECK_EQ(hal_can_state(can, &state), HAL_OK);
    return state;
}

static void every_op(void) {
    CONTRACT_EVERY_OP(can, fixture->a);
    CONTRACT_EVERY_OP(can, fixture->b);
}

static void arguments(void) {
    reset();
    const struct can_frame wrong[] = {
        {.id = CAN_FRAME_STANDARD_ID_MAX + 1U},
        {.id = UINT32_MAX},
        {.id = CAN_FRAME_EXTENDED_ID_MAX + 1U, .flags = CAN_FRAME_EXTENDED},
        {.id = UINT32_MAX, .flags = CAN_FRAME_EXTENDED | CAN_FRAME_REMOTE},
        {.id = 1, .length = 9},
        {.id = 1, .length = 255},
        {.id = 1, .flags = CAN_FRAME_ERROR},
        {.id = 1, .flags = 8},
        {.id = 1, .flags = 128},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        CHECK_EQ(hal_can_send(fixture->a, &wrong[i]), HAL_ERROR_ARGUMENT);
    }
    struct can_frame frame;
    uint32_t received_us;
    CHECK_EQ(hal_can_send(fixture->a, NULL), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_can_receive(fixture->a, NULL, &received_us), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_can_receive(fixture->a, &frame, NULL), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_can_state(fixture->a, NULL), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_can_set_filters(fixture->a, NULL, 1), HAL_ERROR_ARGUMENT);
    const struct hal_can_filter filters[HAL_CAN_FILTERS_MAX + 1] = {{.id = 0}};
    CHECK_EQ(hal_can_set_filters(fixture->a, filters, HAL_CAN_FILTERS_MAX + 1), HAL_ERROR_ARGUMENT);
    settle();
    expect_nothing(fixture->b);
    CHECK_EQ(hal_can_send(fixture->b, &wrong[0]), HAL_ERROR_ARGUMENT);
    const struct can_frame right = numbered(1);
    CHECK_EQ(hal_can_send(fixture->b, &right), HAL_OK); // the refused filters left all as it was
    settle();
    expect_frame(fixture->a, &right);
}

static void cross(const struct hal_can *from, const struct hal_can *to,
                  const struct can_frame *frame) {
    CHECK_EQ(hal_can_send(from, frame), HAL_OK);
    settle();
    expect_frame(to, frame);
    expect_nothing(to);
    expect_nothing(from); // nobody hears himself
}

static void boundary_frames(void) {
    reset();
    const uint32_t ids[] = {0, 1, 0x7FE, CAN_FRAME_STANDARD_ID_MAX};
    const uint32_t extended_ids[] = {0, 0x7FF, 0x800, 0x1FFFFFFE, CAN_FRAME_EXTENDED_ID_MAX};
    const uint8_t step = fixture->share > 1U ? CAN_FRAME_DATA_BYTES / 2U : 1U;
    for (uint8_t length = 0; length <= CAN_FRAME_DATA_BYTES; length += step) {
        for (uint8_t flags = 0; flags <= 3U; flags++) {
            const bool extended = (flags & CAN_FRAME_EXTENDED) != 0U;
            for (size_t i = 0; i < (extended ? 5U : 4U); i++) {
                struct can_frame frame = numbered(0xFF00A55AU);
                frame.id = extended ? extended_ids[i] : ids[i];
                frame.flags = flags;
                frame.length = carried_length(flags, length);
                cross(fixture->a, fixture->b, &frame);
                cross(fixture->b, fixture->a, &frame);
            }
        }
    }
    for (uint32_t i = 0; i < rounds(500) && check_clean(); i++) {
        const struct can_frame frame = any_frame();
        cross(fixture->a, fixture->b, &frame);
    }
}

/// In the order of the calls, whatever the ids; both ways at once.
static void order(void) {
    reset();
    for (uint32_t round = 0; round < 50U && check_clean(); round++) {
        struct can_frame sent[3];
        for (uint32_t i = 0; i < 3U; i++) {
            sent[i] = numbered(round * 3U + i);
            sent[i].id = 0x700U - i * 0x100U; // later ones would win an arbitration
        }
        for (uint32_t i = 0; i < 3U; i++) {
            CHECK_EQ(hal_can_send(fixture->a, &sent[i]), HAL_OK);
            CHECK_EQ(hal_can_send(fixture->b, &sent[2U - i]), HAL_OK);
        }
        settle();
        for (uint32_t i = 0; i < 3U; i++) {
            expect_frame(fixture->b, &sent[i]);
            expect_frame(fixture->a, &sent[2U - i]);
        }
        expect_nothing(fixture->a);
        expect_nothing(fixture->b);
    }
}

/// Until the queue refuses; then all that it took arrives, and it takes frames again.
static void send_queue_full_and_drained(void) {
    for (uint32_t round = 0; round < 3U; round++) {
        reset();
        uint32_t taken = 0;
        enum hal_status status = HAL_OK;
        while (status == HAL_OK && taken < 100000U) {
            const struct can_frame frame = numbered(taken);
            status = hal_can_send(fixture->a, &frame);
            taken += status == HAL_OK ? 1U : 0U;
        }
        CHECK_EQ(status, HAL_BUSY);
        CHECK_EQ(taken, fixture->send_capacity);
        const struct can_frame late = numbered(taken);
        CHECK_EQ(hal_can_send(fixture->a, &late), HAL_BUSY); // and still is
        settle();
        for (uint32_t i = 0; i < taken && check_clean(); i++) {
            const struct can_frame frame = numbered(i);
            expect_frame(fixture->b, &frame);
        }
        expect_nothing(fixture->b);
        cross(fixture->a, fixture->b, &late);
    }
}

/// The oldest frames stay, those that don't fit are counted, each once.
static void receive_queue_overflows(void) {
    reset();
    const uint32_t extra = 7, lost_before = state_of(fixture->b).lost_count;
    for (uint32_t i = 0; i < fixture->receive_capacity + extra && check_clean(); i++) {
        const struct can_frame frame = numbered(i);
        CHECK_EQ(hal_can_send(fixture->a, &frame), HAL_OK);
        settle();
        const uint32_t lost = i < fixture->receive_capacity ? 0 : i - fixture->receive_capacity + 1;
        CHECK_EQ(state_of(fixture->b).lost_count - lost_before, lost);
    }
    for (uint32_t i = 0; i < fixture->receive_capacity && check_clean(); i++) {
        const struct can_frame frame = numbered(i);
        expect_frame(fixture->b, &frame);
    }
    expect_nothing(fixture->b);
    CHECK_EQ(state_of(fixture->b).lost_count - lost_before, extra);
    const struct can_frame frame = numbered(9);
    cross(fixture->a, fixture->b, &frame);
}

/// Written again from the header, bit by bit, so that it shares nothing with what it checks.
static bool should_pass(const struct hal_can_filter *filters, uint32_t count,
                        const struct can_frame *frame) {
    for (uint32_t i = 0; i < count; i++) {
        bool differs = false;
        for (unsigned bit = 0; bit < 32U; bit++) {
            const uint32_t one = UINT32_C(1) << bit;
            differs = differs ||
                      ((filters[i].id_mask & one) != 0U &&
                       ((filters[i].id & one) != 0U) != ((frame->id & one) != 0U)) ||
                      (bit < 8U && (filters[i].flags_mask & one) != 0U &&
                       ((filters[i].flags & one) != 0U) != ((frame->flags & one) != 0U));
        }
        if (!differs) {
            return true;
        }
    }
    return false;
}

static void expect_filtered(const struct hal_can_filter *filters, uint32_t count,
                            const struct can_frame *frame) {
    CHECK_EQ(hal_can_send(fixture->a, frame), HAL_OK);
    settle();
    if (should_pass(filters, count, frame)) {
        expect_frame(fixture->b, frame);
    }
    expect_nothing(fixture->b);
}

static void filters_pass_what_they_say(void) {
    reset();
    const uint8_t kinds = CAN_FRAME_EXTENDED | CAN_FRAME_REMOTE;
    struct hal_can_filter filters[HAL_CAN_FILTERS_MAX];
    for (uint32_t i = 0; i < HAL_CAN_FILTERS_MAX; i++) {
        filters[i] = (struct hal_can_filter){0x241U + i, CAN_FRAME_STANDARD_ID_MAX, 0, kinds};
    }
    const uint32_t step = fixture->share > 1U ? HAL_CAN_FILTERS_MAX / 2U : 1U;
    for (uint32_t count = 0; count <= HAL_CAN_FILTERS_MAX; count += step) {
        CHECK_EQ(hal_can_set_filters(fixture->b, filters, count), HAL_OK);
        for (uint32_t id = 0x240; id < 0x240U + HAL_CAN_FILTERS_MAX + 2U; id++) {
            for (uint8_t flags = 0; flags <= kinds; flags++) {
                const struct can_frame frame = {.id = id, .flags = flags};
                expect_filtered(filters, count, &frame);
            }
        }
    }
    for (uint32_t round = 0; round < rounds(200) && check_clean(); round++) {
        for (uint32_t i = 0; i < 3U; i++) {
            const struct can_frame like = any_frame();
            const uint32_t mask = (uint32_t)(check_random(&seed) & check_random(&seed)) &
                                  (uint32_t)check_random(&seed);
            filters[i] = (struct hal_can_filter){like.id, mask, like.flags,
                                                 (uint8_t)(check_random(&seed) & kinds)};
        }
        CHECK_EQ(hal_can_set_filters(fixture->b, filters, 3), HAL_OK);
        for (int i = 0; i < 5; i++) {
            const struct can_frame frame = any_frame();
            expect_filtered(filters, 3, &frame);
        }
    }
}

/// What has arrived stays; a filter of all zeros opens everything again.
static void filters_keep_the_queue(void) {
    reset();
    const struct can_frame first = numbered(1), second = numbered(2), third = numbered(3);
    CHECK_EQ(hal_can_send(fixture->a, &first), HAL_OK);
    settle();
    CHECK_EQ(hal_can_set_filters(fixture->b, NULL, 0), HAL_OK);
    CHECK_EQ(hal_can_send(fixture->a, &second), HAL_OK);
    settle();
    const struct hal_can_filter all = {0};
    CHECK_EQ(hal_can_set_filters(fixture->b, &all, 1), HAL_OK);
    CHECK_EQ(hal_can_send(fixture->a, &third), HAL_OK);
    settle();
    expect_frame(fixture->b, &first);
    expect_frame(fixture->b, &third);
    expect_nothing(fixture->b);
    CHECK_EQ(state_of(fixture->b).lost_count, 0); // a frame not wanted is not a frame lost
}

static void arrival_times(void) {
    reset();
    uint32_t before = hal_clock_now_us(fixture->clock);
    for (uint32_t i = 0; i < 20U; i++) {
        const struct can_frame frame = numbered(i);
        CHECK_EQ(hal_can_send(fixture->a, &frame), HAL_OK);
        settle();
        const uint32_t arrived = hal_clock_now_us(fixture->clock);
        settle(); // the time is that of the arrival, not of the call
        struct can_frame got;
        uint32_t received_us;
        CHECK_EQ(hal_can_receive(fixture->b, &got, &received_us), HAL_OK);
        CHECK(hal_clock_has_reached(received_us, before));
        CHECK(hal_clock_has_reached(arrived, received_us));
        before = received_us;
    }
}

static void healthy_state(void) {
    reset();
    const struct hal_can_state state = state_of(fixture->a);
    CHECK_EQ(state.health, HAL_CAN_ACTIVE);
    CHECK_EQ(state.transmit_error_count, 0);
    CHECK_EQ(state.receive_error_count, 0);
    const struct can_frame frame = numbered(1), second = numbered(2);
    CHECK_EQ(hal_can_send(fixture->a, &frame), HAL_OK);
    CHECK_EQ(hal_can_restart(fixture->a), HAL_OK); // nothing to do: loses nothing
    CHECK_EQ(hal_can_send(fixture->a, &second), HAL_OK);
    settle();
    expect_frame(fixture->b, &frame);
    expect_frame(fixture->b, &second);
    expect_nothing(fixture->b);
    CHECK_EQ(state_of(fixture->a).health, HAL_CAN_ACTIVE);
}

/// Off the bus, nothing goes; afterwards no frame of before does.
static void bus_off_and_restart(void) {
    for (int round = 0; round < 3; round++) {
        reset();
        const struct can_frame waiting = numbered(1), stale = numbered(2), fresh = numbered(3);
        CHECK_EQ(hal_can_send(fixture->b, &waiting), HAL_OK);
        settle();
        CHECK_EQ(hal_can_send(fixture->a, &stale), HAL_OK);
        fixture->bus_off(fixture->context);
        CHECK_EQ(state_of(fixture->a).health, HAL_CAN_OFF);
        CHECK_EQ(state_of(fixture->a).transmit_error_count, 256);
        CHECK_EQ(hal_can_send(fixture->a, &fresh), HAL_ERROR_DOWN);
        settle();
        CHECK_EQ(state_of(fixture->a).health, HAL_CAN_OFF); // not by itself
        expect_frame(fixture->a, &waiting);
        expect_nothing(fixture->a);
        expect_nothing(fixture->b);
        CHECK_EQ(hal_can_restart(fixture->a), HAL_OK);
        CHECK_EQ(hal_can_restart(fixture->a), HAL_OK);
        settle();
        const struct hal_can_state state = state_of(fixture->a);
        CHECK_EQ(state.health, HAL_CAN_ACTIVE);
        CHECK_EQ(state.transmit_error_count, 0);
        CHECK_EQ(state.receive_error_count, 0);
        expect_nothing(fixture->b);
        cross(fixture->a, fixture->b, &fresh);
        cross(fixture->b, fixture->a, &fresh);
    }
}

/// Each kind of call on a, while b sends and listens. A call that fails has had no effect.
static void exercise(struct contract_plan *plan) {
    const struct hal_can_filter all = {0};
    for (uint32_t i = 0; i < 3U; i++) {
        const struct can_frame out = numbered(i), in = numbered(100U + i);
        CHECK_EQ(hal_can_send(fixture->b, &in), HAL_OK);
        settle();
        CONTRACT_DO(plan, hal_can_send(fixture->a, &out)); // while something waits to be received
        settle();
        struct can_frame got = out;
        uint32_t received_us = 54321;
        if (contract_failed(plan, hal_can_receive(fixture->a, &got, &received_us))) {
            CHECK(can_frame_equal(&got, &out) && received_us == 54321U);
            CHECK(!contract_failed(plan, hal_can_receive(fixture->a, &got, &received_us)));
        }
        CHECK(can_frame_equal(&got, &in));
        expect_frame(fixture->b, &out);
        expect_nothing(fixture->b);
        struct hal_can_state state = {.health = HAL_CAN_OFF};
        if (contract_failed(plan, hal_can_state(fixture->a, &state))) {
            CHECK_EQ(state.health, HAL_CAN_OFF);
            CHECK(!contract_failed(plan, hal_can_state(fixture->a, &state)));
        }
        CHECK_EQ(state.health, HAL_CAN_ACTIVE);
        CONTRACT_DO(plan, hal_can_restart(fixture->a));
        if (contract_failed(plan, hal_can_set_filters(fixture->a, NULL, 0))) {
            CHECK_EQ(hal_can_send(fixture->b, &in), HAL_OK); // still heard
            settle();
            CHECK(!contract_failed(plan, hal_can_receive(fixture->a, &got, &received_us)));
            CHECK(!contract_failed(plan, hal_can_set_filters(fixture->a, NULL, 0)));
        }
        CONTRACT_DO(plan, hal_can_set_filters(fixture->a, &all, 1));
    }
}

static void fails_at_every_call(void) {
    contract_each_failure(&(struct contract_failures){fixture->context, fixture->reset,
                                                      fixture->fail_at, fixture->some_cannot_fail},
                          exercise);
}

void can_suite(const struct can_fixture *with) {
    fixture = with;
    seed = UINT64_C(0x2545F4914F6CDD1D);
    CONTRACT(with->name, every_op);
    CONTRACT(with->name, arguments);
    CONTRACT(with->name, boundary_frames);
    CONTRACT(with->name, order);
    CONTRACT_IF(with->send_capacity, "the bus can't be held up", with->name,
                send_queue_full_and_drained);
    CONTRACT_IF(with->receive_capacity, "the device loses nothing, or nobody knows when",
                with->name, receive_queue_overflows);
    CONTRACT(with->name, filters_pass_what_they_say);
    CONTRACT(with->name, filters_keep_the_queue);
    CONTRACT_IF(with->clock, "nothing to compare with", with->name, arrival_times);
    CONTRACT(with->name, healthy_state);
    CONTRACT_IF(with->bus_off, "the rig can't break the bus", with->name, bus_off_and_restart);
    CONTRACT_IF(with->fail_at, "the rig can't make calls fail", with->name, fails_at_every_call);
}
