/// The CAN buses of a rig's drives: one for both axes, or one each.
///
/// `bus = can:NAME` is a network interface, `slcan:DEVICE[@BITRATE]` an adapter on a serial port,
/// `gs_usb[:SERIAL][/CHANNEL][@BITRATE]` a USB adapter that this program drives itself; 1000000
/// bit/s if not said. Two buses look like one: a request goes to the bus of its drive, whose number
/// is no other drive's on any bus. One that a bus does not take is dropped and counted, so that the
/// other bus goes on; a bus that is off is restarted. The kernel may take its time for that (a USB
/// adapter is stopped and started), so it is asked in the background, to which the bus belongs
/// until then: it is off, and nothing comes from it. Shown: tests/scenario/test_rig_bus.c,
/// tests/scenario/test_rig_bus_news.c, tests/vm/guest/buses.sh.
#ifndef LINUX_RIG_BUS_H
#define LINUX_RIG_BUS_H

#include "rig.h"
#include "side_job.h"

#include "linux/linux_can.h"
#include "linux/linux_gs_usb.h"
#include "linux/linux_slcan.h"

#include <stdbool.h>

enum rig_bus_kind { RIG_BUS_SOCKETCAN, RIG_BUS_SLCAN, RIG_BUS_GS_USB };

enum { RIG_BUSES_MAX = 2 };

/// What the text of a bus says.
struct rig_bus_address {
    enum rig_bus_kind kind;
    char path[LINUX_SERIAL_PATH_BYTES]; ///< interface, device or serial number; may be empty for
                                        ///< gs_usb: any
    uint8_t channel;
    uint32_t bitrate;
};

/// False: it can't be read.
bool rig_bus_parse(const char *text, struct rig_bus_address *address);

/// How a bus is, worst last.
enum rig_bus_trouble {
    RIG_BUS_WELL,
    RIG_BUS_PASSIVE, ///< frames fail, many of them
    RIG_BUS_FULL,    ///< it has refused RIG_BUS_FULL_TRIES frames in a row, for RIG_BUS_FULL_US
    RIG_BUS_OFF
};

#define RIG_BUS_FULL_TRIES   8U
#define RIG_BUS_FULL_US      20000U
#define RIG_BUS_RESTART_US   100000U   ///< from one try to restart it to the next
#define RIG_BUS_NEWS_US      1000000U  ///< of a bus' trouble, from one line to the next
#define RIG_BUS_LOST_NEWS_US 10000000U ///< of frames that are lost

/// What was seen of a bus, and what a person was told.
struct rig_bus_condition {
    enum hal_can_health health;
    uint32_t refused, refused_since_us; ///< frames in a row
    uint32_t lost_count;                ///< by the driver, when it was last looked
    struct linux_error off;             ///< why it was off last
    bool went_off;                      ///< which is not told yet
    enum rig_bus_trouble told;
    struct linux_error line; ///< that was told
    bool any_told, any_lost_told;
    uint32_t told_us, lost_told_us, frames_lost, lost_told;
};

struct rig_bus {
    const char *text; ///< as in the rig file
    struct rig_bus_address address;
    struct linux_can can;
    struct linux_slcan slcan;
    struct linux_gs_usb gs_usb;
    const struct hal_can *hal;
    struct hal_can_filter filters[AXIS_COUNT];
    uint32_t filter_count;
    struct linux_error error; ///< why it could not be opened
    bool lost;                ///< not touched until it is opened anew
    struct side_job restart;
    bool restart_begun, restarted; ///< it is being restarted; was, and has taken no frame since
    bool restart_tried;
    uint32_t restart_us; ///< when that was tried last
    enum hal_status restart_status;
    struct rig_bus_condition condition;
};

struct rig_buses {
    const struct hal_can *hal; ///< of all of them; NULL: no axis has a bus. A lost bus has gone
    uint32_t dropped;          ///< requests that their bus did not take, of several buses
    uint32_t restarts;         ///< how often a bus that was off was restarted
    uint32_t offs;             ///< how often a bus was found bus-off, or taken down
    uint32_t frames_lost;      ///< as hal_can_state.lost_count, however often a bus was opened
    struct linux_error error;  ///< of the bus that could not be opened, or was lost last

    // Private from here on.
    struct hal_can front;
    struct rig_bus bus[RIG_BUSES_MAX];
    unsigned count;
    uint32_t request_id[AXIS_COUNT]; ///< 0: no drive on a bus
    struct rig_bus *bus_of[AXIS_COUNT];
    const struct hal_clock *clock;
};

/// Which buses a rig names. False after a line on stderr. Must not move in memory afterwards.
bool rig_buses_find(struct rig_buses *buses, const struct rig *rig, const struct hal_clock *clock);

/// Opens them; not HAL_OK: buses->error has the line, and rig_buses_close closes what is open.
enum hal_status rig_buses_open(struct rig_buses *buses);
void rig_buses_close(struct rig_buses *buses);

/// Has one left since the last call? Its line, once for each loss; NULL: none has.
const char *rig_buses_newly_lost(struct rig_buses *buses);
bool rig_buses_incomplete(const struct rig_buses *buses);

/// Whether a bus is neither lost nor in the background.
bool rig_bus_is_at_hand(struct rig_buses *buses, struct rig_bus *bus);
/// Of its driver: why the last call failed.
const struct linux_error *rig_bus_error(const struct rig_bus *bus);

/// At every tick: how the buses are. Returns a line for people when that has changed, of each bus
/// one a second at most, and never one less than the last word; NULL: nothing is new. *severe: set
/// with a line.
const char *rig_buses_news(struct rig_buses *buses, bool *severe);

/// Opens a lost bus anew, which may take long: in any thread, alone. False: bus->error. The caller
/// clears bus->lost when it is done.
bool rig_bus_reopen(struct rig_buses *buses, struct rig_bus *bus) MUST_CHECK;

#endif
