#include "contract/support/serial_suite.h"

#include "contract/support/contract.h"

/// So often the line is given another moment before a test gives up.
#define PATIENCE 3000

static const struct serial_fixture *fixture;
static uint64_t seed;

/// Byte number `index` of the test's endless message: no short period.
static uint8_t message(size_t index) {
    return (uint8_t)((index * 167U + (index >> 8) * 29U + (index >> 16)) & 0xFFU);
}

static void reset(void) {
    fixture->reset(fixture->context);
}

static void every_op(void) {
    CONTRACT_EVERY_OP(serial, fixture->serial);
}

static void arguments(void) {
    reset();
    uint8_t byte = 1;
    size_t count = 77;
    CHECK_EQ(hal_serial_write(fixture->serial, NULL, 1, &count), HAL_ERROR_ARGUMENT);
    CHECK_EQ(count, 0);
    count = 77;
    CHECK_EQ(hal_serial_write(fixture->serial, &byte, 0, &count), HAL_ERROR_ARGUMENT);
    CHECK_EQ(count, 0);
    CHECK_EQ(hal_serial_write(fixture->serial, &byte, 1, NULL), HAL_ERROR_ARGUMENT);
    count = 77;
    CHECK_EQ(hal_serial_read(fixture->serial, NULL, 1, &count), HAL_ERROR_ARGUMENT);
    CHECK_EQ(count, 0);
    count = 77;
    CHECK_EQ(hal_serial_read(fixture->serial, &byte, 0, &count), HAL_ERROR_ARGUMENT);
    CHECK_EQ(count, 0);
    CHECK_EQ(hal_serial_read(fixture->serial, &byte, 1, NULL), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_serial_state(fixture->serial, NULL), HAL_ERROR_ARGUMENT);
    fixture->settle(fixture->context);
    CHECK_EQ(fixture->peer_read(fixture->context, &byte, 1), 0);
}

static void nothing_to_read(void) {
    reset();
    for (int i = 0; i < 3; i++) {
        uint8_t byte = 0x5A;
        size_t count = 77;
        CHECK_EQ(hal_serial_read(fixture->serial, &byte, 1, &count), HAL_EMPTY);
        CHECK_EQ(count, 0);
        CHECK_EQ(byte, 0x5A);
        fixture->settle(fixture->context);
    }
    struct hal_serial_state state = {1, 1};
    CHECK_EQ(hal_serial_state(fixture->serial, &state), HAL_OK);
    CHECK_EQ(state.lost_count, 0);
    CHECK_EQ(state.damaged_count, 0);
}

/// Reads what the peer sent, at most chunk bytes a call, and compares it with message(from...).
static void expect_in(size_t from, size_t size, size_t chunk) {
    uint8_t data[256];
    size_t done = 0;
    for (int tries = 0; done < size && tries < PATIENCE && check_clean();) {
        size_t count = 0;
        const size_t room = chunk < size - done ? chunk : size - done;
        const enum hal_status status = hal_serial_read(fixture->serial, data, room, &count);
        if (status == HAL_EMPTY) {
            CHECK_EQ(count, 0);
            tries++;
            fixture->settle(fixture->context);
            continue;
        }
        CHECK_EQ(status, HAL_OK);
        CHECK(count >= 1U && count <= room);
        for (size_t i = 0; i < count && check_clean(); i++) {
            CHECK_EQ(data[i], message(from + done + i));
        }
        done += count;
    }
    CHECK_EQ(done, size);
}

/// The same at the other end.
static void expect_out(size_t from, size_t size) {
    uint8_t data[256];
    size_t done = 0;
    for (int tries = 0; done < size && tries < PATIENCE && check_clean();) {
        const size_t room = sizeof data < size - done ? sizeof data : size - done;
        const size_t count = fixture->peer_read(fixture->context, data, room);
        for (size_t i = 0; i < count && check_clean(); i++) {
            CHECK_EQ(data[i], message(from + done + i));
        }
        done += count;
        if (count == 0U) {
            tries++;
            fixture->settle(fixture->context);
        }
    }
    CHECK_EQ(done, size);
}

static void expect_silence(void) {
    fixture->settle(fixture->context);
    uint8_t byte;
    size_t count;
    CHECK_EQ(hal_serial_read(fixture->serial, &byte, 1, &count), HAL_EMPTY);
    CHECK_EQ(fixture->peer_read(fixture->context, &byte, 1), 0);
}

/// Writes message(from...) as far as it goes: how many bytes were taken.
static size_t write_message(size_t from, size_t size) {
    uint8_t data[256];
    const size_t room = size < sizeof data ? size : sizeof data;
    for (size_t i = 0; i < room; i++) {
        data[i] = message(from + i);
    }
    size_t count = 77;
    const enum hal_status status = hal_serial_write(fixture->serial, data, room, &count);
    if (status == HAL_BUSY) {
        CHECK_EQ(count, 0);
    } else if (CHECK_EQ(status, HAL_OK)) {
        CHECK(count >= 1U && count <= room);
    }
    return count;
}

static size_t peer_write_message(size_t from, size_t size) {
    uint8_t data[256];
    const size_t room = size < sizeof data ? size : sizeof data;
    for (size_t i = 0; i < room; i++) {
        data[i] = message(from + i);
    }
    return fixture->peer_write(fixture->context, data, room);
}

/// Nothing on the way may take a byte for a command: no echo, no translation, no flow control.
static void every_byte_value(void) {
    reset();
    for (unsigned value = 0; value < 256U && check_clean(); value++) {
        const uint8_t out = (uint8_t)value;
        uint8_t in = (uint8_t)~value;
        size_t count = 0;
        CHECK_EQ(hal_serial_write(fixture->serial, &out, 1, &count), HAL_OK);
        CHECK_EQ(count, 1);
        for (int tries = 0; tries < PATIENCE && fixture->peer_read(fixture->context, &in, 1) == 0U;
             tries++) {
            fixture->settle(fixture->context);
        }
        CHECK_EQ(in, value);
        CHECK_EQ(fixture->peer_write(fixture->context, &out, 1), 1);
        in = (uint8_t)~value;
        for (int tries = 0;
             tries < PATIENCE && hal_serial_read(fixture->serial, &in, 1, &count) == HAL_EMPTY;
             tries++) {
            fixture->settle(fixture->context);
        }
        CHECK_EQ(in, value);
    }
    expect_silence();
}

/// A small room doesn't lose the rest.
static void read_in_pieces(void) {
    reset();
    for (size_t chunk = 1; chunk <= 64U && check_clean(); chunk += chunk < 4U ? 1U : 13U) {
        CHECK_EQ(peer_write_message(chunk, 128), 128);
        expect_in(chunk, 128, chunk);
    }
    expect_silence();
}

/// A megabit each way at once, in pieces of any size.
static void long_talk(void) {
    reset();
    const size_t total = 128U * 1024U;
    size_t out = 0, in = 0, peer_out = 0, peer_in = 0;
    uint8_t data[256];
    for (uint32_t stuck = 0; (peer_in < total || in < total) && stuck < PATIENCE && check_clean();
         stuck++) {
        const size_t before = out + in + peer_out + peer_in;
        const size_t piece = 1U + (size_t)(check_random(&seed) % sizeof data);
        if (out < total) {
            out += write_message(out, piece < total - out ? piece : total - out);
        }
        size_t count = fixture->peer_read(fixture->context, data, piece);
        for (size_t i = 0; i < count && check_clean(); i++) {
            CHECK_EQ(data[i], message(peer_in++));
        }
        // Never more on its way than a device without flow control can hold.
        const size_t room =
            fixture->receive_capacity == 0U ? piece : fixture->receive_capacity - (peer_out - in);
        if (peer_out < total && room > 0U) {
            const size_t part = piece < room ? piece : room;
            peer_out +=
                peer_write_message(peer_out, part < total - peer_out ? part : total - peer_out);
        }
        const enum hal_status status = hal_serial_read(fixture->serial, data, piece, &count);
        CHECK(status == HAL_OK || status == HAL_EMPTY);
        for (size_t i = 0; i < count && check_clean(); i++) {
            CHECK_EQ(data[i], message(in++));
        }
        if (out + in + peer_out + peer_in != before) {
            stuck = 0;
        } else {
            fixture->settle(fixture->context);
        }
    }
    CHECK_EQ(in, total);
    CHECK_EQ(peer_in, total);
    expect_silence();
}

/// Nobody listens: the device takes what it has room for and then says so, at once.
static void send_buffer_full_and_drained(void) {
    for (size_t round = 0; round < 2U; round++) {
        reset();
        size_t taken = 0, count = 0;
        int refused = 0;
        while (refused < 20 && taken < 16U * 1024U * 1024U && check_clean()) {
            count = write_message(taken, 200);
            taken += count;
            refused += count == 0U ? 1 : 0;
            if (count == 0U) {
                fixture->settle(fixture->context);
            }
        }
        CHECK_EQ(refused, 20);
        CHECK(taken >= 64U);
        expect_out(0, taken);
        CHECK_EQ(write_message(taken, 10), 10);
        expect_out(taken, 10);
        expect_silence();
    }
}

/// The first bytes stay, each one more is counted.
static void receive_buffer_overflows(void) {
    reset();
    const size_t capacity = fixture->receive_capacity, extra = 9;
    for (size_t i = 0; i < capacity + extra; i++) {
        CHECK_EQ(peer_write_message(i, 1), 1);
    }
    fixture->settle(fixture->context);
    struct hal_serial_state state = {0, 0};
    CHECK_EQ(hal_serial_state(fixture->serial, &state), HAL_OK);
    CHECK_EQ(state.lost_count, extra);
    expect_in(0, capacity, 16);
    expect_silence();
}

static void expect_gone(void) {
    uint8_t byte = 0;
    size_t count = 77;
    struct hal_serial_state state;
    for (int i = 0; i < 3; i++) {
        CHECK_EQ(hal_serial_write(fixture->serial, &byte, 1, &count), HAL_ERROR_GONE);
        CHECK_EQ(count, 0);
        CHECK_EQ(hal_serial_read(fixture->serial, &byte, 1, &count), HAL_ERROR_GONE);
        CHECK_EQ(count, 0);
        CHECK_EQ(hal_serial_state(fixture->serial, &state), HAL_ERROR_GONE);
    }
}

/// Cut after any number of calls, noticed first by a read, a write or after the last bytes.
static void cut_after_every_call(void) {
    for (size_t calls = 0; calls < 12U && check_clean(); calls++) {
        reset();
        for (size_t i = 0; i < calls; i++) {
            if (i % 2U == 0U) {
                CHECK_EQ(write_message(i, 3), 3);
                expect_out(i, 3);
                CHECK_EQ(peer_write_message(i, 2), 2);
            } else {
                expect_in(i - 1U, 2, 2);
            }
        }
        fixture->hang_up(fixture->context);
        uint8_t byte = 0;
        size_t count;
        if (calls % 3U == 0U) {
            CHECK_EQ(hal_serial_write(fixture->serial, &byte, 1, &count), HAL_ERROR_GONE);
        }
        enum hal_status status = HAL_OK;
        size_t rest = 0;
        for (int i = 0; i < PATIENCE && (status == HAL_OK || status == HAL_EMPTY); i++) {
            status = hal_serial_read(fixture->serial, &byte, 1, &count);
            rest += count;
            fixture->settle(fixture->context);
        }
        CHECK_EQ(status, HAL_ERROR_GONE);
        CHECK(rest <= (calls % 2U == 1U ? 2U : 0U));
        expect_gone();
    }
    reset();
    CHECK_EQ(write_message(0, 10), 10); // a new line works
    expect_out(0, 10);
}

static void exercise(struct contract_plan *plan) {
    for (size_t round = 0; round < 3U; round++) {
        const uint8_t out = message(round);
        uint8_t in = (uint8_t)~out;
        size_t count = 77;
        if (contract_failed(plan, hal_serial_write(fixture->serial, &out, 1, &count))) {
            CHECK_EQ(count, 0);
            CHECK(!contract_failed(plan, hal_serial_write(fixture->serial, &out, 1, &count)));
        }
        CHECK_EQ(count, 1);
        expect_out(round, 1);
        CHECK_EQ(peer_write_message(round, 1), 1);
        fixture->settle(fixture->context);
        count = 77;
        if (contract_failed(plan, hal_serial_read(fixture->serial, &in, 1, &count))) {
            CHECK_EQ(count, 0);
            CHECK(!contract_failed(plan, hal_serial_read(fixture->serial, &in, 1, &count)));
        }
        CHECK_EQ(count, 1);
        CHECK_EQ(in, out);
        struct hal_serial_state state;
        CONTRACT_DO(plan, hal_serial_state(fixture->serial, &state));
    }
    uint8_t byte;
    CHECK_EQ(fixture->peer_read(fixture->context, &byte, 1), 0);
}

static void fails_at_every_call(void) {
    contract_each_failure(
        &(struct contract_failures){fixture->context, fixture->reset, fixture->fail_at, false},
        exercise);
}

void serial_suite(const struct serial_fixture *with) {
    fixture = with;
    seed = UINT64_C(0x9E3779B97F4A7C15);
    CONTRACT(with->name, every_op);
    CONTRACT(with->name, arguments);
    CONTRACT(with->name, nothing_to_read);
    CONTRACT(with->name, every_byte_value);
    CONTRACT(with->name, read_in_pieces);
    CONTRACT(with->name, long_talk);
    CONTRACT(with->name, send_buffer_full_and_drained);
    if (with->receive_capacity != 0U) {
        CONTRACT(with->name, receive_buffer_overflows);
    }
    CONTRACT_IF(with->hang_up, "the rig can't cut the line", with->name, cut_after_every_call);
    CONTRACT_IF(with->fail_at, "the rig can't make calls fail", with->name, fails_at_every_call);
}
