// Usage: node run.mjs IMAGE.uf2 LAYOUT BUILD-ID TRACE   The image of the Raspberry Pi Pico in rp2040js: verdicts on its output; the
// servo pulses of a moving target go into TRACE for the plant (tests/mcu/rp2040/plant.c).
import fs from 'fs';
import { Board, Computer, readUf2 } from './board.mjs';

const [uf2, layoutPath, buildId, tracePath] = process.argv.slice(2);
const MS = 1e6;
const [PAN, TILT, ENABLE, STOP_SWITCH] = [2, 3, 14, 10];
const PERIOD_US = 20000;
const WATCHDOG_MS = 33;
const flash = readUf2(uf2);
const layout = {};
for (const line of fs.readFileSync(layoutPath, 'utf8').split('\n')) {
    const [name, value] = line.split(' ');
    if (name) layout[name] = Number(value);
}

let failed = 0;
function verdict(name, holds, detail = '') {
    if (!holds) failed++;
    if (!holds && detail !== '') console.log(`  ${detail}`);
    console.log(`${holds ? 'ok' : 'FAIL'} rp2040: ${name}`);
}
const near = (got, wanted, within) => Math.abs(got - wanted) <= within;

// ---------------------------------------------------------------- into the pump's queue, as a console would

function command(board, bits) {
    const at = layout.loop + layout.commands;
    board.mcu.writeUint32(at, board.mcu.readUint32(at) | bits);
}

function aimAt(board, id, [x, y, z]) {
    const { mcu } = board;
    const count = mcu.readUint32(layout.loop + layout.update_count);
    const slot = (mcu.readUint32(layout.loop + layout.update_first) + count) % layout.updates_max;
    const at = layout.loop + layout.updates + slot * layout.update_bytes;
    for (let i = 0; i < layout.update_bytes; i += 4) mcu.writeUint32(at + i, 0);
    if (layout.kind_bytes === 1) mcu.writeUint8(at + layout.kind, layout.kind_direction);
    else mcu.writeUint32(at + layout.kind, layout.kind_direction);
    mcu.writeUint32(at + layout.id, id);
    mcu.writeUint32(at + layout.weight_q16, 0x10000);
    [x, y, z].forEach((part, i) => mcu.writeUint32(at + layout.direction + 4 * i, Math.round(part * 2 ** 30) >>> 0));
    mcu.writeUint32(layout.loop + layout.update_count, count + 1);
}

// Pan clockwise from north, tilt up; world axes east, north, up.
function direction(panDeg, tiltDeg) {
    const [pan, tilt] = [(panDeg * Math.PI) / 180, (tiltDeg * Math.PI) / 180];
    return [Math.sin(pan) * Math.cos(tilt), Math.cos(pan) * Math.cos(tilt), Math.sin(tilt)];
}

// host-sim/rigs/hobby.ini: -60 to 60 degrees are 833.33 to 2166.67 us.
const pulseUs = (deg) => 1500 + (deg * (2166.666667 - 833.333333)) / 120;

// ---------------------------------------------------------------- the tests

function boots() {
    const board = new Board(flash);
    board.run(2300 * MS);
    const said = board.lines;
    const expected = [`boresight ${buildId}`, 'board: pico', 'clock: 125 MHz, crystal and PLL run', 'reset: power-on'];
    expected.forEach((line, i) => verdict(`says "${line.split(' ')[0]}" on the console`, said[i] === line, said[i]));
    verdict('a status line a second', /^ +1 s  ready .*missed 0/.test(said[4]) && /^ +2 s  ready .*missed 0/.test(said[5]), said.join('|'));
    verdict('at 115200 baud within 0.1 %', near(board.mcu.uart[0].baudRate, 115200, 115), `${board.mcu.uart[0].baudRate}`);
    verdict('no pulse and no power before it is armed', board.edges.every((edge) => !edge.high));
    return board;
}

// A key a millisecond, as a fast typist with a slow adapter; then a checked line as a program sends it.
function answers() {
    const board = new Board(flash);
    board.run(100 * MS);
    const type = (text) => {
        for (const key of text) {
            board.mcu.uart[0].feedByte(key.charCodeAt(0));
            board.run(board.ns + MS);
        }
        board.run(board.ns + 60 * MS);
    };
    type('starus\x7f\x7f\x7ftus\r');
    verdict('a person at the console: status, and a corrected typing error', board.lines.includes('mode: ready') && board.lines.includes('targets: 0, rejected 0, dropped 0'),
        board.lines.slice(-9).join('|'));
    type('$3f01h*93d4\n');
    const hello = board.lines.find((line) => line.includes('$3f01H1 '));
    type('$3f02b*67cd\n');
    verdict('a program says hello: protocol, digest of the rig, build', hello !== undefined && hello.includes(` ${buildId}*`), `${hello}`);
}

function givesPulses(board) {
    command(board, layout.command_arm);
    const from = board.ns;
    board.run(from + 1500 * MS);
    const enabled = board.edges.find((edge) => edge.pin === ENABLE && edge.high);
    verdict('armed: the servos get power within 2 ms', enabled !== undefined && enabled.ns - from < 2 * MS);
    const home = { [PAN]: 0, [TILT]: 10 };
    for (const pin of [PAN, TILT]) {
        const pulses = board.pulses(pin, from + 1000 * MS);
        const widths = pulses.map((pulse) => pulse.us);
        verdict(`pin ${pin}: home is a pulse of ${pulseUs(home[pin]).toFixed(1)} us, within 1 us`,
            widths.length > 20 && widths.every((us) => near(us, pulseUs(home[pin]), 1)), widths.join(' '));
        const periods = pulses.slice(1).map((pulse, i) => (pulse.ns - pulses[i].ns) / 1000);
        verdict(`pin ${pin}: every 20 ms, within 1 us`, periods.every((us) => near(us, PERIOD_US, 1)), periods.join(' '));
    }
    for (const [pan, tilt] of [[30, 0], [-45.5, 25.25], [57.5, -38]]) {
        const steps = 120;
        for (let i = 0; i < steps; i++) { // said again and again: targets expire
            aimAt(board, 7, direction(pan, tilt));
            board.run(board.ns + 20 * MS);
        }
        const [p, t] = [board.pulses(PAN).at(-1).us, board.pulses(TILT).at(-1).us];
        verdict(`looks at pan ${pan}, tilt ${tilt}: pulses within 1 us`, near(p, pulseUs(pan), 1) && near(t, pulseUs(tilt), 1),
            `${p} ${pulseUs(pan)}, ${t} ${pulseUs(tilt)}`);
    }
    verdict('the other channels give none', [4, 5, 6, 7].every((pin) => board.pulses(pin).length === 0));
}

// A target that sways, 50 times a second: edges and truth for the plant.
function drivesThePlant(board) {
    const trace = [];
    const from = board.ns;
    const first = board.edges.length;
    for (let i = 0; i < 400; i++) {
        const t = i * 0.02;
        const at = direction(25 * Math.sin((2 * Math.PI * t) / 6), 10 + 8 * Math.sin((2 * Math.PI * t) / 4));
        aimAt(board, 7, at);
        trace.push([board.ns, `aim ${Math.round(board.ns)} ${at.join(' ')}`]);
        board.run(from + (i + 1) * 20 * MS);
    }
    for (const edge of board.edges.slice(first)) {
        if (edge.pin === PAN || edge.pin === TILT) trace.push([edge.ns, `edge ${Math.round(edge.ns)} ${edge.pin - PAN} ${edge.high ? 1 : 0}`]);
    }
    trace.sort((a, b) => a[0] - b[0]);
    fs.writeFileSync(tracePath, trace.map((entry) => entry[1]).join('\n') + '\n');
    verdict('tracks, and misses no tick', /tracking .*missed 0/.test(board.lines.at(-1)), board.lines.at(-1));
}

function stops(board) {
    board.mcu.gpio[STOP_SWITCH].setInputValue(true);
    board.run(board.ns + 1200 * MS);
    verdict('the emergency stop is told', /stopped .*held: emergency stop/.test(board.lines.at(-1)), board.lines.at(-1));
    const widths = board.pulses(PAN, board.ns - 500 * MS).map((pulse) => pulse.us);
    verdict('and holds: the pulse stays', widths.length > 10 && widths.every((us) => us === widths[0]), widths.join(' '));
    board.mcu.gpio[STOP_SWITCH].setInputValue(false);
}

// The tick's timer stops: nobody checks in any more, once the tick that is under way is done.
function watchdogBites(board) {
    command(board, layout.command_arm);
    board.run(board.ns + 500 * MS);
    const hung = board.ns;
    board.mcu.writeUint32(0xe000e010, 0);
    board.run(hung + 200 * MS);
    const ms = (board.resetAt - hung) / MS;
    verdict('a hang: the watchdog resets within 33 ms, not earlier than half of it',
        board.resetAt !== null && ms > WATCHDOG_MS / 2 && ms <= WATCHDOG_MS + 0.2, `${ms} ms`);
    const again = new Board(flash, { after: board });
    again.run(1200 * MS);
    verdict('and the next start says so', again.lines.includes('reset: watchdog'), again.lines.join('|'));
    verdict('and waits to be armed', again.edges.every((edge) => !edge.high) && !/tracking|settling/.test(again.text), again.text);
}

function brokenClocks() {
    for (const [options, name, said] of [[{ crystal: false }, 'without a crystal', '6 MHz, the crystal does not oscillate'],
        [{ pll: false }, 'without a PLL', '12 MHz, the PLL does not lock']]) {
        const board = new Board(flash, options);
        board.run(900 * MS);
        command(board, layout.command_arm);
        board.run(3500 * MS);
        verdict(`${name}: says so`, board.lines.includes(`clock: ${said}, no USB`), board.lines.join('|'));
        verdict(`${name}: will not arm`, board.lines.includes(`will not arm: ${said.split(', ')[1]}`) && board.edges.every((edge) => !edge.high),
            board.lines.join('|'));
        // A watchdog that counts the ring oscillator instead of the crystal bites after 33,000 of its cycles.
        const mhz = Number(said.split(' ')[0]);
        const busy = board.lines.map((line) => /busy (\d+) us/.exec(line)).filter(Boolean).map((match) => match[1] * mhz);
        verdict(`${name}: each tick takes less than 0.6 of the watchdog's cycles`, busy.length >= 3 && Math.max(...busy) < 20000, `${busy}`);
    }
}

// ---------------------------------------------------------------- the USB plug

function talksOverUsb() {
    const board = new Board(flash);
    const computer = new Computer(board);
    const { usb, cdc } = computer;
    const ask = (...request) => {
        computer.request(...request);
        board.run(board.ns + MS);
        return Buffer.concat(computer.asked);
    };
    board.run(60 * MS);
    verdict('USB: is found, gets an address and a configuration', computer.found && usb.addrEndp === 1 && cdc.inEndpoint === 2 && cdc.outEndpoint === 2);
    verdict('USB: says nothing while the port is closed', computer.text === '' && ask(0x80, 8, 0, 0, 1)[0] === 1);
    const product = ask(0x80, 6, 0x0302, 0x0409, 255);
    verdict('USB: tells its name', product[0] === product.length && product.subarray(2).toString('utf16le') === 'Boresight gimbal', product.toString());
    const device = ask(0x80, 6, 0x0100, 0, 18);
    verdict('USB: tells what it is, and no more than was asked for', device.length === 18 && device[4] === 2 && ask(0x80, 6, 0x0100, 0, 8).length === 8);
    const whole = ask(0x80, 6, 0x0200, 0, 255);
    verdict('USB: sends what is longer than a packet in two', whole.length === 67 && whole.readUInt16LE(2) === 67 && computer.asked.length === 2);
    ask(0x80, 6, 0x0600, 0, 10);
    verdict('USB: refuses what it does not know', computer.refused && computer.asked.length === 0);
    ask(0x21, 0x20, 0, 0, 7, [0x80, 0x25, 0, 0, 0, 0, 8]);
    verdict('USB: keeps the speed that is set', computer.asked.length === 1 && ask(0xa1, 0x21, 0, 0, 7).readUInt32LE(0) === 9600);

    computer.open();
    board.run(1500 * MS);
    verdict('USB: says what the serial port says', /^ +1 s  ready .*missed 0\r\n$/.test(computer.text) && board.text.endsWith(computer.text), computer.text);
    computer.open(false);
    const said = computer.text.length;
    board.run(2500 * MS);
    verdict('USB: is silent when the port is closed; the serial port is not', computer.text.length === said && / 2 s /.test(board.text));
    const again = new Computer(board);
    usb.resetDevice();
    board.run(board.ns + 60 * MS);
    again.open();
    board.run(board.ns + 20 * MS);
    board.run(3500 * MS);
    verdict('USB: is found again after a reset of the bus', again.found && / 3 s /.test(again.text) && !/missed [1-9]/.test(board.text), again.text);
}

function refusesWrongSum() {
    const broken = flash.slice();
    broken[5] ^= 1;
    let refused = false;
    try {
        new Board(broken);
    } catch (error) {
        refused = /sum/.test(error.message);
    }
    verdict('a second stage with a wrong sum would not start', refused);
}

const board = boots();
answers();
givesPulses(board);
drivesThePlant(board);
stops(board);
watchdogBites(board);
brokenClocks();
talksOverUsb();
refusesWrongSum();
process.exit(failed === 0 ? 0 : 1);
