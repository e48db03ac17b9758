#include "contract/support/usb_suite.h"

#include "contract/support/contract.h"

#define PATIENCE         3000
#define DESCRIPTOR_BYTES 18

static const struct usb_fixture *fixture;

static void reset(void) {
    fixture->reset(fixture->context);
}

/// GET_DESCRIPTOR, which every device answers; type 1 is the device's own, others may be refused.
static struct hal_usb_transfer ask_descriptor(uint8_t type, uint8_t *data, uint16_t size) {
    return (struct hal_usb_transfer){
        .kind = HAL_USB_CONTROL,
        .setup = {.request_type = HAL_USB_IN, .request = 6, .value = (uint16_t)(type << 8)},
        .data = data,
        .size_bytes = size};
}

static struct hal_usb_transfer bulk(uint8_t endpoint, uint8_t *data, uint16_t size) {
    return (struct hal_usb_transfer){
        .kind = HAL_USB_BULK, .endpoint = endpoint, .data = data, .size_bytes = size};
}

/// The next transfer that is handed back; null if none is for long.
static struct hal_usb_transfer *next_done(void) {
    struct hal_usb_transfer *done = NULL;
    for (int i = 0; i < PATIENCE; i++) {
        const enum hal_status status = hal_usb_poll(fixture->usb, &done);
        if (status == HAL_OK) {
            CHECK(done != NULL && done->status != HAL_BUSY);
            return done;
        }
        CHECK_EQ(status, HAL_EMPTY);
        CHECK(done == NULL);
        fixture->settle(fixture->context);
    }
    return NULL;
}

static void expect_none_done(void) {
    struct hal_usb_transfer *done = NULL;
    fixture->settle(fixture->context);
    CHECK_EQ(hal_usb_poll(fixture->usb, &done), HAL_EMPTY);
    CHECK(done == NULL);
}

/// Runs one transfer to its end.
static void run(struct hal_usb_transfer *transfer, enum hal_status wanted, uint16_t actual_bytes) {
    CHECK_EQ(hal_usb_submit(fixture->usb, transfer), HAL_OK);
    CHECK(next_done() == transfer);
    CHECK_EQ(transfer->status, wanted);
    CHECK_EQ(transfer->actual_bytes, actual_bytes);
}

static void every_op(void) {
    CONTRACT_EVERY_OP(usb, fixture->usb);
}

static void arguments(void) {
    reset();
    uint8_t data[8];
    static uint8_t much[HAL_USB_TRANSFER_BYTES_MAX + 1U];
    struct hal_usb_transfer wrong[] = {
        ask_descriptor(1, data, 8), ask_descriptor(1, data, 8),          ask_descriptor(1, data, 8),
        bulk(0, data, 8),           bulk(HAL_USB_IN, data, 8),           bulk(16, data, 8),
        bulk(0x7F, data, 8),        ask_descriptor(1, NULL, 8),          bulk(1, NULL, 8),
        bulk(1, much, sizeof much), ask_descriptor(1, much, sizeof much)};
    wrong[0].kind = (enum hal_usb_kind)7;
    wrong[1].endpoint = 1;
    wrong[2].endpoint = HAL_USB_IN;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        CHECK_EQ(hal_usb_submit(fixture->usb, &wrong[i]), HAL_ERROR_ARGUMENT);
        CHECK_EQ(wrong[i].status, HAL_OK);
    }
    struct hal_usb_transfer idle = ask_descriptor(1, data, 8);
    CHECK_EQ(hal_usb_submit(fixture->usb, NULL), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_usb_cancel(fixture->usb, NULL), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_usb_cancel(fixture->usb, &idle), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_usb_poll(fixture->usb, NULL), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_usb_identity(fixture->usb, NULL), HAL_ERROR_ARGUMENT);
    expect_none_done();
    CHECK_EQ(hal_usb_submit(fixture->usb, &idle), HAL_OK);
    CHECK_EQ(idle.status, HAL_BUSY);
    CHECK_EQ(hal_usb_submit(fixture->usb, &idle), HAL_ERROR_ARGUMENT); // it is under way
    CHECK(next_done() == &idle);
    expect_none_done();
}

static void identity_is_what_the_device_tells(void) {
    reset();
    struct hal_usb_identity identity = {0};
    CHECK_EQ(hal_usb_identity(fixture->usb, &identity), HAL_OK);
    CHECK_EQ(identity.vendor, fixture->identity.vendor);
    CHECK_EQ(identity.product, fixture->identity.product);
    CHECK_EQ(identity.release_bcd, fixture->identity.release_bcd);
    CHECK(strcmp(identity.serial_number, fixture->identity.serial_number) == 0);
    uint8_t data[DESCRIPTOR_BYTES];
    struct hal_usb_transfer transfer = ask_descriptor(1, data, sizeof data);
    run(&transfer, HAL_OK, sizeof data);
    CHECK_EQ(data[0], DESCRIPTOR_BYTES);
    CHECK_EQ(data[1], 1);
    CHECK_EQ(data[8] + data[9] * 256, identity.vendor);
    CHECK_EQ(data[10] + data[11] * 256, identity.product);
    CHECK_EQ(data[12] + data[13] * 256, identity.release_bcd);
}

/// The device sends what it has or what is asked for, whichever is less; no byte more is written.
static void short_and_cut_reads(void) {
    reset();
    uint8_t whole[DESCRIPTOR_BYTES];
    struct hal_usb_transfer transfer = ask_descriptor(1, whole, sizeof whole);
    run(&transfer, HAL_OK, sizeof whole);
    const uint16_t sizes[] = {1, 2, 8, 17, 18, 19, 64, 255};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        uint8_t data[256];
        memset(data, 0xA5, sizeof data);
        const uint16_t actual = sizes[i] < DESCRIPTOR_BYTES ? sizes[i] : DESCRIPTOR_BYTES;
        transfer = ask_descriptor(1, data, sizes[i]);
        run(&transfer, HAL_OK, actual);
        CHECK(memcmp(data, whole, actual) == 0);
        for (size_t k = actual; k < sizeof data; k++) {
            CHECK_EQ(data[k], 0xA5);
        }
    }
}

/// A refused request says so, and the next one goes.
static void refused_request(void) {
    reset();
    for (int i = 0; i < 3; i++) {
        uint8_t data[DESCRIPTOR_BYTES];
        struct hal_usb_transfer transfer = ask_descriptor(0x7E, data, sizeof data);
        run(&transfer, HAL_ERROR_UNSUPPORTED, 0);
        transfer = ask_descriptor(1, data, sizeof data);
        run(&transfer, HAL_OK, DESCRIPTOR_BYTES);
    }
}

/// As many as promised; each is handed back once, in order.
static void many_at_once(void) {
    for (int round = 0; round < 3; round++) {
        reset();
        uint8_t data[HAL_USB_PENDING_MAX + 1][DESCRIPTOR_BYTES];
        struct hal_usb_transfer transfers[HAL_USB_PENDING_MAX + 1];
        for (size_t i = 0; i <= HAL_USB_PENDING_MAX; i++) {
            transfers[i] = ask_descriptor(1, data[i], DESCRIPTOR_BYTES);
        }
        for (size_t i = 0; i < HAL_USB_PENDING_MAX; i++) {
            CHECK_EQ(hal_usb_submit(fixture->usb, &transfers[i]), HAL_OK);
        }
        const enum hal_status status =
            hal_usb_submit(fixture->usb, &transfers[HAL_USB_PENDING_MAX]);
        CHECK(status == HAL_OK || status == HAL_BUSY);
        CHECK_EQ(transfers[HAL_USB_PENDING_MAX].status, status == HAL_OK ? HAL_BUSY : HAL_OK);
        const size_t count = HAL_USB_PENDING_MAX + (status == HAL_OK ? 1U : 0U);
        for (size_t i = 0; i < count && check_clean(); i++) {
            CHECK(next_done() == &transfers[i]);
            CHECK_EQ(transfers[i].status, HAL_OK);
            CHECK_EQ(transfers[i].actual_bytes, DESCRIPTOR_BYTES);
        }
        expect_none_done();
    }
}

static void bulk_echo(void) {
    reset();
    const uint16_t sizes[] = {1, 63, 64, 65, 512, 1000, HAL_USB_TRANSFER_BYTES_MAX};
    static uint8_t out[HAL_USB_TRANSFER_BYTES_MAX], in[HAL_USB_TRANSFER_BYTES_MAX];
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        for (size_t k = 0; k < sizes[i]; k++) {
            out[k] = (uint8_t)(k * 7U + i);
        }
        memset(in, 0, sizeof in);
        struct hal_usb_transfer transfer = bulk(fixture->echo_out, out, sizes[i]);
        run(&transfer, HAL_OK, sizes[i]);
        transfer = bulk(fixture->echo_in, in, sizes[i]);
        run(&transfer, HAL_OK, sizes[i]);
        CHECK(memcmp(in, out, sizes[i]) == 0);
    }
}

/// A read waits for its data while other endpoints go on.
static void read_waits_for_data(void) {
    reset();
    uint8_t out[4] = {1, 2, 3, 4}, in[64] = {0};
    struct hal_usb_transfer reading = bulk(fixture->echo_in, in, sizeof in);
    CHECK_EQ(hal_usb_submit(fixture->usb, &reading), HAL_OK);
    expect_none_done();
    uint8_t descriptor[DESCRIPTOR_BYTES];
    struct hal_usb_transfer control = ask_descriptor(1, descriptor, sizeof descriptor);
    run(&control, HAL_OK, sizeof descriptor);
    struct hal_usb_transfer writing = bulk(fixture->echo_out, out, sizeof out);
    CHECK_EQ(hal_usb_submit(fixture->usb, &writing), HAL_OK);
    const struct hal_usb_transfer *first = next_done(), *second = next_done();
    CHECK((first == &writing && second == &reading) || (first == &reading && second == &writing));
    CHECK_EQ(reading.status, HAL_OK);
    CHECK_EQ(reading.actual_bytes, sizeof out);
    CHECK(memcmp(in, out, sizeof out) == 0);
}

static void timeout_ends_a_read(void) {
    reset();
    uint8_t in[64];
    for (uint32_t timeout_us = 5000; timeout_us <= 40000U; timeout_us *= 2U) {
        struct hal_usb_transfer reading = bulk(fixture->echo_in, in, sizeof in);
        reading.timeout_us = timeout_us;
        run(&reading, HAL_ERROR_TIMEOUT, 0);
        expect_none_done();
    }
}

static void cancel_ends_a_read(void) {
    reset();
    uint8_t in[2][64];
    struct hal_usb_transfer first = bulk(fixture->echo_in, in[0], sizeof in[0]);
    struct hal_usb_transfer second = bulk(fixture->echo_in, in[1], sizeof in[1]);
    CHECK_EQ(hal_usb_submit(fixture->usb, &first), HAL_OK);
    CHECK_EQ(hal_usb_submit(fixture->usb, &second), HAL_OK);
    CHECK_EQ(hal_usb_cancel(fixture->usb, &second), HAL_OK);
    CHECK(next_done() == &second);
    CHECK_EQ(second.status, HAL_ERROR_CANCELLED);
    CHECK_EQ(second.actual_bytes, 0);
    expect_none_done();
    CHECK_EQ(hal_usb_cancel(fixture->usb, &second), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_usb_cancel(fixture->usb, &first), HAL_OK);
    CHECK(next_done() == &first);
    CHECK_EQ(first.status, HAL_ERROR_CANCELLED);
}

/// Whatever is under way comes back, then every call says that the device is gone.
static void unplugged_mid_transfer(void) {
    const size_t step = fixture->replug_is_slow ? HAL_USB_PENDING_MAX / 2 : 1;
    for (size_t pending = 0; pending <= HAL_USB_PENDING_MAX; pending += step) {
        reset();
        uint8_t data[HAL_USB_PENDING_MAX + 1][DESCRIPTOR_BYTES];
        struct hal_usb_transfer transfers[HAL_USB_PENDING_MAX + 1];
        for (size_t i = 0; i < pending; i++) {
            transfers[i] = fixture->echo_in != 0U
                               ? bulk(fixture->echo_in, data[i], DESCRIPTOR_BYTES)
                               : ask_descriptor(1, data[i], DESCRIPTOR_BYTES);
            CHECK_EQ(hal_usb_submit(fixture->usb, &transfers[i]), HAL_OK);
        }
        fixture->unplug(fixture->context);
        for (size_t i = 0; i < pending && check_clean(); i++) {
            CHECK(next_done() == &transfers[i]);
            CHECK(transfers[i].status == HAL_ERROR_GONE ||
                  (fixture->echo_in == 0U && transfers[i].status == HAL_OK));
        }
        struct hal_usb_transfer *done = NULL;
        enum hal_status status = HAL_EMPTY;
        for (int i = 0; i < PATIENCE && status == HAL_EMPTY; i++) {
            status = hal_usb_poll(fixture->usb, &done);
            fixture->settle(fixture->context);
        }
        CHECK_EQ(status, HAL_ERROR_GONE);
        CHECK(done == NULL);
        struct hal_usb_transfer late = ask_descriptor(1, data[0], DESCRIPTOR_BYTES);
        CHECK_EQ(hal_usb_submit(fixture->usb, &late), HAL_ERROR_GONE);
        CHECK_EQ(late.status, HAL_OK);
        struct hal_usb_identity identity;
        CHECK_EQ(hal_usb_identity(fixture->usb, &identity), HAL_ERROR_GONE);
    }
    reset();
    uint8_t data[DESCRIPTOR_BYTES];
    struct hal_usb_transfer transfer = ask_descriptor(1, data, sizeof data);
    run(&transfer, HAL_OK, sizeof data);
}

static void exercise(struct contract_plan *plan) {
    for (int round = 0; round < 3; round++) {
        uint8_t data[DESCRIPTOR_BYTES] = {0};
        struct hal_usb_transfer transfer = ask_descriptor(1, data, sizeof data);
        if (contract_failed(plan, hal_usb_submit(fixture->usb, &transfer))) {
            CHECK_EQ(transfer.status, HAL_OK);
            CHECK(!contract_failed(plan, hal_usb_submit(fixture->usb, &transfer)));
        }
        struct hal_usb_transfer *done = NULL;
        for (int i = 0; i < PATIENCE && done == NULL; i++) {
            const enum hal_status status = hal_usb_poll(fixture->usb, &done);
            if (status == HAL_EMPTY) {
                plan->calls++;
                fixture->settle(fixture->context);
            } else if (contract_failed(plan, status)) {
                CHECK(done == NULL);
            }
        }
        CHECK(done == &transfer);
        CHECK_EQ(transfer.status, HAL_OK);
        CHECK_EQ(data[0], DESCRIPTOR_BYTES);
        if (fixture->echo_in != 0U) {
            struct hal_usb_transfer reading = bulk(fixture->echo_in, data, sizeof data);
            CONTRACT_DO(plan, hal_usb_submit(fixture->usb, &reading));
            CONTRACT_DO(plan, hal_usb_cancel(fixture->usb, &reading));
            done = NULL;
            CONTRACT_DO(plan, hal_usb_poll(fixture->usb, &done));
            CHECK(done == &reading);
            CHECK_EQ(reading.status, HAL_ERROR_CANCELLED);
        }
    }
}

static void fails_at_every_call(void) {
    contract_each_failure(
        &(struct contract_failures){fixture->context, fixture->reset, fixture->fail_at, false},
        exercise);
}

void usb_suite(const struct usb_fixture *with) {
    fixture = with;
    const bool echoes = with->echo_in != 0U && with->echo_out != 0U;
    CONTRACT(with->name, every_op);
    CONTRACT(with->name, arguments);
    CONTRACT(with->name, identity_is_what_the_device_tells);
    CONTRACT(with->name, short_and_cut_reads);
    CONTRACT(with->name, refused_request);
    CONTRACT(with->name, many_at_once);
    CONTRACT_IF(echoes, "the device has no echo endpoints", with->name, bulk_echo);
    CONTRACT_IF(echoes, "the device has no echo endpoints", with->name, read_waits_for_data);
    CONTRACT_IF(echoes, "the device has no echo endpoints", with->name, timeout_ends_a_read);
    CONTRACT_IF(echoes, "the device has no echo endpoints", with->name, cancel_ends_a_read);
    CONTRACT_IF(with->unplug, "the rig can't unplug it", with->name, unplugged_mid_transfer);
    CONTRACT_IF(with->fail_at, "the rig can't make calls fail", with->name, fails_at_every_call);
}
