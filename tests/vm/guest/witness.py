"""A second opinion on a run over CAN: hears the bus by python3-can and reads it by the makers' document of the drives alone.

witness.py listen INTERFACE FILE     writes what is on it, a line a frame, from when it says "listening". On SIGTERM it goes on
                                     until all requests are answered and nothing comes any more (30 s at most), then ends.
witness.py judge FILE CANDUMP RIG TARGETS RUN
                                     prints verdicts on the whole of it: FILE of the above, the log of candump -L, the rig file,
                                     the targets (directions, fixed), and what `boresight run --json` said of its ticks.

The drives speak only when asked: to 0x140 + id, answered from 0x240 + id, 8 bytes, little endian, byte 0 the command, which
the answer repeats; bytes without a meaning are 0. An angle is in 0.01 degree, what the wire can't tell is half of that.
"""
import collections
import configparser
import itertools
import json
import math
import signal
import statistics
import struct
import sys

WIRE_DEG = 0.005  # half of the last digit
PREFIX = "vm.run.witness."

Frame = collections.namedtuple("Frame", "stamp id data")


def listen(interface, path):
    import can

    asked = []
    signal.signal(signal.SIGTERM, lambda *_: asked.append(True))
    bus = can.Bus(interface="socketcan", channel=interface)
    bus.socket.setsockopt(1, 33, 16 << 20)  # SO_RCVBUFFORCE: a slow machine loses nothing
    print("listening", flush=True)
    open_requests, patience = 0, 30
    with open(path, "w") as out:
        while patience > 0:
            message = bus.recv(timeout=1.0)
            if message is None:
                patience = (0 if open_requests == 0 else patience - 1) if asked else patience
                continue
            strange = message.is_extended_id or message.is_remote_frame or message.is_error_frame or message.is_fd
            open_requests += {0x140: 1, 0x240: -1}.get(message.arbitration_id & ~0x3F, 0)
            out.write("%.6f %s%03X %s\n" % (message.timestamp, "?" if strange else "", message.arbitration_id, message.data.hex()))
    bus.shutdown()


# ---------------------------------------------------------------- the document


def decode_request(data):
    """What a request says, by name; None: it can't be read."""
    command, rest = data[0], data[1:]
    if command in (0x92, 0x9A):
        return {} if rest == bytes(7) else None
    if command == 0xA4:
        speed_dps, angle = struct.unpack("<Hi", rest[1:])
        return {"angle_deg": angle / 100, "speed_dps": speed_dps} if rest[0] == 0 else None
    if command == 0xB3:
        return {"timeout_ms": struct.unpack("<I", rest[3:])[0]} if rest[:3] == bytes(3) else None
    if command == 0x42:
        return {"index": rest[0]} if rest[0] < 4 and rest[1:] == bytes(6) else None
    return None


def decode_answer(data):
    command, rest = data[0], data[1:]
    if command == 0x92:
        return {"angle_deg": struct.unpack("<i", rest[3:])[0] / 100} if rest[:3] == bytes(3) else None
    if command == 0x9A:
        temperature, brake, voltage, errors = struct.unpack("<bxBHH", rest)
        return {"released": brake == 1, "volts": voltage / 10, "errors": errors} if brake < 2 and rest[1] == 0 else None
    if command == 0xA4:
        temperature, current, speed_dps, angle_deg = struct.unpack("<bhhh", rest)
        return {"coarse_deg": angle_deg, "speed_dps": speed_dps}
    if command == 0xB3:
        return {"timeout_ms": struct.unpack("<I", rest[3:])[0]} if rest[:3] == bytes(3) else None
    if command == 0x42:
        return {"index": rest[0], "accel_dps2": struct.unpack("<i", rest[3:])[0]} if rest[1:3] == bytes(2) else None
    return None


# ---------------------------------------------------------------- verdicts


def tell(name, faults, *more):
    """faults: what is wrong, the first ones are told."""
    for fault in list(faults)[:5]:
        print("  %s: %s" % (name, fault))
    print("%s %s%s" % ("FAIL" if faults else "ok", PREFIX, name))


def read_witness(path):
    for line in open(path):
        stamp, identifier, data = (line.split(" ") + [""])[:3]
        number = -1 if identifier.startswith("?") else int(identifier, 16)
        yield Frame(float(stamp), number, bytes.fromhex(data.strip()))


def read_candump(path):
    for line in open(path):
        stamp, _, frame = line.split()
        identifier, _, data = frame.partition("#")
        yield Frame(float(stamp.strip("()")), int(identifier, 16) if len(identifier) == 3 else -1, bytes.fromhex(data))


def compare(heard, dumped):
    """Two sockets of one kernel may get frames of two senders in another order, but not those of one."""
    faults = []
    for identifier in sorted({frame.id for frame in heard + dumped}):
        ours = [frame.data for frame in heard if frame.id == identifier]
        theirs = [frame.data for frame in dumped if frame.id == identifier]
        if ours != theirs:
            first = next((i for i, (a, b) in enumerate(zip(ours, theirs)) if a != b), min(len(ours), len(theirs)))
            faults.append("%03X: %d here, %d by candump, not the same from frame %d" % (identifier, len(ours), len(theirs), first))
    tell("heard_the_same_as_candump", faults or ([] if heard else ["nothing"]))


class Drive:
    """What went to and fro between the program and one drive, in the order of the kernel's stamps."""

    def __init__(self, name, section, frames):
        self.name = name
        number = int(section["id"])
        self.rig = {key: float(section[key]) for key in ("limit_min_deg", "limit_max_deg", "speed_max_dps", "accel_max_dps2", "jerk_max_dps3")}
        self.requests = [frame for frame in frames if frame.id == 0x140 + number]
        self.answers = [frame for frame in frames if frame.id == 0x240 + number]
        self.commands = [frame for frame in self.requests if frame.data[0] == 0xA4]
        self.angles = [decode_request(frame.data)["angle_deg"] for frame in self.commands]

    def measured(self):
        return [(frame.stamp, decode_answer(frame.data)["angle_deg"]) for frame in self.answers if frame.data[0] == 0x92]


def answered(drive):
    """In the order in which they were asked, and after it. None is left over at the end: the witness waited for that."""
    faults = ["%d requests, %d answers" % (len(drive.requests), len(drive.answers))] if len(drive.requests) != len(drive.answers) else []
    for request, answer in zip(drive.requests, drive.answers):
        asked, told = decode_request(request.data), decode_answer(answer.data)
        echoed = all(told[key] == asked[key] for key in ("timeout_ms", "index") if key in asked) if asked.keys() <= told.keys() else False
        if request.data[0] != answer.data[0] or answer.stamp < request.stamp or (request.data[0] in (0xB3, 0x42) and not echoed):
            faults.append("at %.3f s %s is answered by %s" % (request.stamp - drive.requests[0].stamp, request.data.hex(), answer.data.hex()))
    return faults


def ordered(drive):
    """Four questions first, each answered before anything is moved. Then command and question in turn; every 16th asks for the
    health, the others for the angle."""
    if not drive.commands:
        return ["no command"]
    start = drive.commands[0].stamp
    before = {frame.data[0] for frame in drive.answers if frame.stamp <= start}
    faults = [] if before == {0x92, 0x9A, 0xB3, 0x42} else ["answered before the first command: %s" % sorted(before)]
    later = [frame.data[0] for frame in drive.requests if frame.stamp >= start]
    faults += ["%02X, then %02X, at request %d" % (a, b, i) for i, (a, b) in enumerate(zip(later, later[1:])) if (a == 0xA4) == (b == 0xA4)]
    questions = [command for command in later if command != 0xA4]
    health = [i for i, command in enumerate(questions) if command == 0x9A]
    faults += ["health after %d questions" % (b - a) for a, b in zip(health, health[1:]) if b - a != 16]
    return faults if len(health) > 2 else faults + ["health is asked for %d times" % len(health)]


def stepped(angles, order, greatest, period_s):
    """The greatest of the order-th differences of the angles over 1, 2, 4, 8 and 16 commands, as a part of what the rig's limit
    and the wire allow, and what breaks that."""
    faults, part = [], 0.0
    weights = [(-1) ** (order - k) * math.comb(order, k) for k in range(order + 1)]
    for span in (1, 2, 4, 8, 16):
        allowed = greatest * (span * period_s) ** order
        for i in range(len(angles) - order * span):
            size = abs(sum(weight * angles[i + k * span] for k, weight in enumerate(weights)))
            part = max(part, (size - 2**order * WIRE_DEG) / allowed)
            if size > allowed + 2**order * WIRE_DEG + 1e-9:
                faults.append("command %d and %d times %d after it: %.2f deg, where %.4f are allowed" % (i, order, span, size, allowed))
    return faults, part


def calm(drive):
    """What the drive says of its motion does not contradict what it says of its place, and it is well."""
    faults = []
    measured = drive.measured()
    for answer in drive.answers:
        told = decode_answer(answer.data)
        if answer.data[0] == 0x9A and (told["errors"] != 0 or not 10 < told["volts"] < 60 or told["released"] != (answer.stamp > drive.commands[0].stamp)):
            faults.append("health %s" % told)
        if answer.data[0] != 0xA4:
            continue
        around = [angle for stamp, angle in measured if stamp < answer.stamp][-1:] + [angle for stamp, angle in measured if stamp > answer.stamp][:1]
        if not min(around) - 1.5 <= told["coarse_deg"] <= max(around) + 1.5:
            faults.append("%d deg between %s" % (told["coarse_deg"], around))
    return faults


def aim(path):
    """Pan and tilt of the middle of the smallest cone around the targets: one that two or three of them span."""

    def unit(v):
        size = math.hypot(*v)
        return [x / size for x in v]

    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

    points = [unit(json.loads(line)["dir"]) for line in open(path)]
    axes = [unit([a + b for a, b in zip(*pair)]) for pair in itertools.combinations(points, 2)]
    for a, b, c in itertools.combinations(points, 3):
        normal = unit(cross([x - y for x, y in zip(b, a)], [x - y for x, y in zip(c, a)]))
        axes += [normal, [-x for x in normal]]
    x, y, z = max(axes, key=lambda axis: min(sum(p * q for p, q in zip(axis, point)) for point in points))
    return math.degrees(math.atan2(x, y)), math.degrees(math.asin(z))


def judge(heard_path, candump_path, rig_path, targets_path, run_path):
    rig = configparser.ConfigParser()
    rig.read(rig_path)
    tick_s = int(rig["controller"]["tick_us"]) * 1e-6
    run = json.loads(open(run_path).readlines()[-1])
    slow = run["missed_ticks"] * 20 > run["steps"]
    heard = list(read_witness(heard_path))
    compare(heard, list(read_candump(candump_path)))

    ids = [base + int(rig[axis]["id"]) for axis in ("pan", "tilt") for base in (0x140, 0x240)]
    unread = [
        frame
        for frame in heard
        if frame.id not in ids or len(frame.data) != 8 or (decode_request if frame.id < 0x200 else decode_answer)(frame.data) is None
    ]
    tell("can_read_every_frame", ["%03X %s" % (frame.id, frame.data.hex()) for frame in unread])
    frames = sorted((frame for frame in heard if frame not in unread), key=lambda frame: frame.stamp)
    period_s = 4 * tick_s
    for axis, wanted_deg in zip(("pan", "tilt"), aim(targets_path)):
        drive = Drive(axis, rig[axis], frames)
        tell(axis + "_answers_every_request", answered(drive))
        tell(axis + "_is_asked_and_told_in_turn", ordered(drive))
        if not drive.commands or not drive.measured():
            continue
        gaps = [b.stamp - a.stamp for a, b in zip(drive.commands, drive.commands[1:])]
        median_s = statistics.median(gaps)
        print("# %s: %d commands, one every %.2f ms (median)" % (axis, len(gaps) + 1, median_s * 1e3))
        if slow:
            print("SKIP %s%s_keeps_its_period: the machine missed %d of %d ticks" % (PREFIX, axis, run["missed_ticks"], run["steps"]))
        else:
            tell(axis + "_keeps_its_period", [] if abs(median_s / period_s - 1) < 0.25 and len(gaps) > 50 else ["%.1f ms" % (median_s * 1e3)])

        place = [angle for stamp, angle in drive.measured() if stamp < drive.commands[0].stamp][-1]
        tell(axis + "_starts_where_it_is", [] if abs(drive.angles[0] - place) <= 2 * WIRE_DEG + 1e-9 else ["at %.2f, sent to %.2f" % (place, drive.angles[0])])
        low, high = drive.rig["limit_min_deg"] - WIRE_DEG, drive.rig["limit_max_deg"] + WIRE_DEG
        top_dps = [decode_request(frame.data)["speed_dps"] for frame in drive.commands]
        tell(axis + "_stays_within_its_limits", ["sent to %.2f" % angle for angle in drive.angles if not low <= angle <= high])
        tell(
            axis + "_is_told_its_top_speed",
            ["%d deg/s" % dps for dps in top_dps if not drive.rig["speed_max_dps"] <= dps <= 1.1 * drive.rig["speed_max_dps"] + 1],
        )
        # Between rest and full speed the smoothing needs half of the jerk that it may have.
        for order, quantity, key, enough in ((1, "speed", "speed_max_dps", 0.8), (2, "acceleration", "accel_max_dps2", 0.8), (3, "jerk", "jerk_max_dps3", 0.3)):
            faults, part = stepped(drive.angles, order, drive.rig[key], period_s)
            print("# %s: %s up to %.0f %% of the rig's limit" % (axis, quantity, part * 100))
            tell(axis + "_keeps_its_%s" % quantity, faults or ([] if part > enough else ["so little that this proves nothing"]))
        tell(axis + "_says_nothing_strange", calm(drive))
        last = drive.measured()[-1][1]
        tell(axis + "_arrives", [] if abs(last - wanted_deg) < 0.05 else ["%.2f deg, where %.4f are wanted" % (last, wanted_deg)])


{"listen": listen, "judge": judge}[sys.argv[1]](*sys.argv[2:])
