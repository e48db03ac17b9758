// Usage: node run.mjs IMAGE.uf2 BUILD-ID TRACE   The image of the Raspberry Pi Pico in rp2040js: verdicts on its output; the
// servo pulses of a moving target go into TRACE for the plant (tests/mcu/rp2040/plant.c).
import fs from 'fs';
import { Board, Computer, Program, readUf2 } from './board.mjs';

const [uf2, buildId, tracePath] = process.argv.slice(2);
const MS = 1e6;
const [PAN, TILT, ENABLE, STOP_SWITCH] = [2, 3, 14, 10];
const PERIOD_US = 20000;
const WATCHDOG_MS = 33;
const flash = readUf2(uf2);

let failed = 0;
function verdict(name, holds, detail = '') {
    if (!holds) failed++;
    if (!holds && detail !== '') console.log(`  ${detail}`);
    console.log(`${holds ? 'ok' : 'FAIL'} rp2040: ${name}`);
}
const near = (got, wanted, within) => Math.abs(got - wanted) <= within;

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
    for (const key of 'starus\x7f\x7f\x7ftus\r') {
        board.type(key);
        board.run(board.ns + MS);
    }
    board.run(board.ns + 60 * MS);
    verdict('a person at the console: status, and a corrected typing error', board.lines.includes('mode: ready') && board.lines.includes('targets: 0, rejected 0, dropped 0'),
        board.lines.slice(-9).join('|'));
    const one = new Program(board);
    board.run(board.ns + 60 * MS);
    const hello = board.answers.find((line) => line.startsWith('$3f01H1 '));
    verdict('a program says hello: protocol, digest of the rig, build', hello !== undefined && hello.includes(` ${buildId}*`), `${hello}`);
    one.command('set pan.speed_max_dps 500');
    board.run(board.ns + 60 * MS);
    verdict('and may not go beyond the rig file', board.answers.some((line) => line.startsWith('$3f02Cno ')), board.answers.join('|'));
}

function givesPulses(board, program) {
    program.command('arm');
    const from = board.ns;
    board.run(from + 1500 * MS);
    const enabled = board.edges.find((edge) => edge.pin === ENABLE && edge.high);
    const waited = enabled === undefined ? Infinity : (enabled.ns - from) / MS; // 31 bytes take 2.7 ms
    verdict('armed: the servos get power within 5 ms of the command', waited < 5, `${waited} ms`);
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
            program.aimAt(7, direction(pan, tilt));
            board.run(board.ns + 20 * MS);
        }
        const [p, t] = [board.pulses(PAN).at(-1).us, board.pulses(TILT).at(-1).us];
        verdict(`looks at pan ${pan}, tilt ${tilt}: pulses within 1 us`, near(p, pulseUs(pan), 1) && near(t, pulseUs(tilt), 1),
            `${p} ${pulseUs(pan)}, ${t} ${pulseUs(tilt)}`);
    }
    verdict('the other channels give none', [4, 5, 6, 7].every((pin) => board.pulses(pin).length === 0));
}

// What a person reads after `status`.
function status(board) {
    const before = board.text.length;
    board.type('status\r');
    board.run(board.ns + 100 * MS);
    return board.text.slice(before);
}

// A target that sways, 50 times a second: edges and truth for the plant.
function drivesThePlant(board, program) {
    const trace = [];
    const from = board.ns;
    const first = board.edges.length;
    for (let i = 0; i < 400; i++) {
        const t = i * 0.02;
        const at = direction(25 * Math.sin((2 * Math.PI * t) / 6), 10 + 8 * Math.sin((2 * Math.PI * t) / 4));
        program.aimAt(7, at);
        trace.push([board.ns, `aim ${Math.round(board.ns)} ${at.join(' ')}`]);
        board.run(from + (i + 1) * 20 * MS);
    }
    for (const edge of board.edges.slice(first)) {
        if (edge.pin === PAN || edge.pin === TILT) trace.push([edge.ns, `edge ${Math.round(edge.ns)} ${edge.pin - PAN} ${edge.high ? 1 : 0}`]);
    }
    trace.sort((a, b) => a[0] - b[0]);
    fs.writeFileSync(tracePath, trace.map((entry) => entry[1]).join('\n') + '\n');
    verdict('tells the program that it tracks', / tracking /.test(board.answers.at(-1)), board.answers.at(-1));
    const told = status(board);
    verdict('tells a person, too, and misses no tick', /mode: tracking/.test(told) && /missed 0/.test(told), told);
}

function stops(board) {
    board.mcu.gpio[STOP_SWITCH].setInputValue(true);
    board.run(board.ns + 1200 * MS);
    const told = status(board);
    verdict('the emergency stop is told', /mode: stopped, held: emergency stop/.test(told), told);
    const widths = board.pulses(PAN, board.ns - 500 * MS).map((pulse) => pulse.us);
    verdict('and holds: the pulse stays', widths.length > 10 && widths.every((us) => us === widths[0]), widths.join(' '));
    board.mcu.gpio[STOP_SWITCH].setInputValue(false);
}

// The tick's timer stops: nobody checks in any more, once the tick that is under way is done.
function watchdogBites(board) {
    new Program(board).command('arm');
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
        board.run(1500 * MS);
        board.type('arm\r');
        board.run(1700 * MS);
        board.type('trace on 500\r');
        board.run(4000 * MS);
        const why = said.split(', ')[1];
        verdict(`${name}: says so`, board.lines.includes(`clock: ${said}, no USB`), board.lines.join('|'));
        verdict(`${name}: will not arm`, board.lines.includes(`will not arm: ${why}`) && board.lines.includes(`error: ${why}`) &&
            board.edges.every((edge) => !edge.high), board.lines.join('|'));
        // A watchdog that counts the ring oscillator instead of the crystal bites after 33,000 of its cycles.
        const mhz = Number(said.split(' ')[0]);
        const busy = board.lines.map((line) => /busy (\d+) us/.exec(line)).filter(Boolean).map((match) => match[1] * mhz);
        verdict(`${name}: each tick takes less than 0.7 of the watchdog's cycles`, busy.length >= 3 && Math.max(...busy) < 23000, `${busy}`);
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
    computer.text = '';
    computer.type('status\r');
    board.run(board.ns + 100 * MS);
    verdict('USB: answers a person', /mode: ready\r\n/.test(computer.text) && /tick: busy/.test(computer.text), computer.text);
    computer.type('arm\r');
    board.run(board.ns + 100 * MS);
    verdict('USB: obeys', board.edges.some((edge) => edge.pin === ENABLE && edge.high), computer.text);
    verdict('USB: no tick is missed for it', !/missed [1-9]/.test(computer.text) && / missed 0/.test(board.text), board.text);
    computer.text = '';
    for (let i = 0; i < 40; i++) computer.type(`target 7 0 10 ${i % 3}\r`); // faster than they can be told back
    board.run(board.ns + 1500 * MS);
    const obeyed = computer.text.split('ok\r\n').length - 1;
    verdict('USB: loses nothing of what comes too fast', obeyed === 40, `${obeyed} of 40`);

    computer.open(false);
    const said = computer.text.length;
    board.run(board.ns + 20 * MS);
    board.type('status\r');
    board.run(board.ns + 300 * MS);
    verdict('USB: is silent when the port is closed; the serial port is not', computer.text.length === said && /mode: [a-z]+\r\n[^$]*$/.test(board.text));
    const again = new Computer(board);
    usb.resetDevice();
    board.run(board.ns + 60 * MS);
    again.open();
    board.run(board.ns + 20 * MS);
    again.type('stop\r');
    board.run(board.ns + 100 * MS);
    verdict('USB: is found again after a reset of the bus', again.found && /stop/.test(again.text) && /ok/.test(again.text), again.text);
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
const program = new Program(board);
givesPulses(board, program);
drivesThePlant(board, program);
stops(board);
watchdogBites(board);
brokenClocks();
talksOverUsb();
refusesWrongSum();
process.exit(failed === 0 ? 0 : 1);
