// A Raspberry Pi Pico in rp2040js: starts from a UF2 file as the ROM does, records what its pins and its console do.
import fs from 'fs';
import { createRequire } from 'module';

const require = createRequire(`${process.cwd()}/build/rp2040js/`);
const { RP2040, GPIOPinState, ConsoleLogger, LogLevel, USBCDC } = require('rp2040js');

const FLASH = 0x10000000;
const SRAM = 0x20000000;
const BOOT2_COPY = 0x20041f00; // where the ROM puts the second stage (RP2040 datasheet, 2.8.1.3)
const WATCHDOG = 0x40058;
const XOSC = 0x40024;
const PLL_SYS = 0x40028;
const BYTE_NS = 1e10 / 115200;

function crc32(bytes) {
    let crc = 0xffffffff;
    for (const byte of bytes) {
        crc ^= byte << 24;
        for (let bit = 0; bit < 8; bit++) crc = crc & 0x80000000 ? (crc << 1) ^ 0x04c11db7 : crc << 1;
    }
    return crc >>> 0;
}

// The blocks of a UF2 file, each checked, as the flash's content.
export function readUf2(path) {
    const file = fs.readFileSync(path);
    const flash = new Uint8Array(2 * 1024 * 1024).fill(0xff);
    const count = file.length / 512;
    for (let i = 0; i < count; i++) {
        const block = file.subarray(512 * i, 512 * i + 512);
        const word = (at) => block.readUInt32LE(at);
        if (word(0) !== 0x0a324655 || word(4) !== 0x9e5d5157 || word(508) !== 0x0ab16f30) throw new Error(`block ${i}: no UF2`);
        if (word(8) !== 0x2000 || word(28) !== 0xe48bff56) throw new Error(`block ${i}: not for an RP2040`);
        if (word(16) !== 256 || word(20) !== i || word(24) !== count) throw new Error(`block ${i}: wrong numbers`);
        flash.set(block.subarray(32, 288), word(12) - FLASH);
    }
    return flash;
}

export class Board {
    // options.crystal, options.pll: false if broken. options.after: the board whose reset this is, as a watchdog reset leaves it.
    constructor(flash, { crystal = true, pll = true, after = null } = {}) {
        const mcu = new RP2040();
        this.mcu = mcu;
        mcu.logger = new ConsoleLogger(LogLevel.Error);
        mcu.flash.set(flash);
        this.text = '';
        this.edges = []; // {ns, pin, high}
        this.resetAt = null;
        this.typed = []; // bytes on their way to the console
        this.nextByteNs = 0;
        this.program = null;
        mcu.uart[0].onByte = (byte) => (this.text += String.fromCharCode(byte));
        for (const pin of [2, 3, 4, 5, 6, 7, 14]) {
            mcu.gpio[pin].addListener((state) => this.edges.push({ ns: mcu.clock.nanos, pin, high: state === GPIOPinState.High }));
        }
        for (const pin of [10, 11, 12, 13]) mcu.gpio[pin].setInputValue(false); // switches closed to ground
        const dog = mcu.peripherals[WATCHDOG];
        dog.onWatchdogTrigger = () => {
            this.resetAt ??= mcu.clock.nanos;
            dog.timer.enable = false; // as the reset does; at 0 it would come again and again, at the same time
        };
        if (after) {
            mcu.sram.set(after.mcu.sram);
            const before = after.mcu.peripherals[WATCHDOG];
            dog.scratchData.set(before.scratchData);
            dog.reason = before.reason;
        }
        if (!crystal) this.breakBit(XOSC, 0x04);
        if (!pll) this.breakBit(PLL_SYS, 0x00);
        // What the ROM does.
        const boot2 = mcu.flash.subarray(0, 256);
        const sum = boot2[252] | (boot2[253] << 8) | (boot2[254] << 16) | (boot2[255] << 24);
        if (crc32(boot2.subarray(0, 252)) !== sum >>> 0) throw new Error('the sum of the second stage is wrong');
        mcu.sram.set(boot2, BOOT2_COPY - SRAM);
        mcu.core.PC = BOOT2_COPY;
        mcu.core.SP = BOOT2_COPY;
    }

    // Bit 31 of a status register never comes.
    breakBit(peripheral, offset) {
        const block = this.mcu.peripherals[peripheral];
        const read = block.readUint32.bind(block);
        block.readUint32 = (at) => (at === offset ? (read(at) & 0x7fffffff) >>> 0 : read(at));
    }

    get ns() {
        return this.mcu.clock.nanos;
    }

    // What a terminal or a program sends to the console, at the speed of the line.
    type(text) {
        this.typed.push(...Buffer.from(text));
    }

    // Runs until a time, or until the watchdog resets the chip.
    run(untilNs) {
        const { clock, core } = this.mcu;
        while (clock.nanos < untilNs && this.resetAt === null) {
            this.program?.stayAwake(clock.nanos);
            if (this.typed.length > 0 && clock.nanos >= this.nextByteNs) {
                this.mcu.uart[0].feedByte(this.typed.shift());
                this.nextByteNs = clock.nanos + BYTE_NS;
            }
            if (core.waiting) {
                const byteNs = this.typed.length > 0 ? this.nextByteNs - clock.nanos : Infinity;
                clock.tick(Math.max(Math.min(clock.nanosToNextAlarm, byteNs), 1));
                if (core.interruptsUpdated && core.checkForInterrupts()) core.waiting = false;
            } else {
                clock.tick((core.executeInstruction() * 1e9) / this.mcu.clkSys);
            }
        }
    }

    // Those for a person, and those for a program.
    get lines() {
        return this.text.split(/\r?\n/).filter((line) => line !== '' && !line.includes('$'));
    }
    get answers() {
        return this.text.match(/\$[0-9a-f]{4}[A-Z].*\*[0-9a-f]{4}/g) ?? [];
    }

    // Complete pulses of a pin that began at or after a time: {ns, us}.
    pulses(pin, fromNs = 0) {
        const found = [];
        let rise = null;
        for (const edge of this.edges) {
            if (edge.pin !== pin) continue;
            if (edge.high) rise = edge.ns;
            else if (rise !== null) {
                if (rise >= fromNs) found.push({ ns: rise, us: (edge.ns - rise) / 1000 });
                rise = null;
            }
        }
        return found;
    }
}

// A program on the board's serial line (docs/link.md).
export class Program {
    constructor(board) {
        this.board = board;
        board.program = this;
        this.sequence = { c: 0, t: 0 };
        this.spokeNs = 0;
        this.say('h', '');
    }

    // The board stops when nobody speaks for half a second.
    stayAwake(ns) {
        if (ns - this.spokeNs > 2e8) this.say('p', '');
    }

    say(type, body) {
        const counter = type === 't' ? 't' : 'c';
        this.sequence[counter] = (this.sequence[counter] + 1) % 256;
        const text = `3f${this.sequence[counter].toString(16).padStart(2, '0')}${type}${body}`;
        let crc = 0xffff;
        for (const byte of Buffer.from(text)) {
            crc ^= byte << 8;
            for (let bit = 0; bit < 8; bit++) crc = ((crc << 1) ^ (crc & 0x8000 ? 0x1021 : 0)) & 0xffff;
        }
        this.spokeNs = this.board.ns;
        this.board.type(`$${text}*${crc.toString(16).padStart(4, '0')}\n`);
    }

    command(text) {
        this.say('c', text);
    }

    aimAt(id, direction) {
        this.say('t', `----.${id} dir ${direction.map((part) => part.toFixed(6)).join(' ')}`);
    }
}

// A computer at the USB plug. It finds the device, chooses its configuration and opens the port (USB 2.0, 9.1.2; CDC).
export class Computer {
    constructor(board) {
        this.usb = board.mcu.usbCtrl;
        this.cdc = new USBCDC(this.usb);
        this.text = '';
        this.typed = [];
        this.found = false;
        this.asked = null; // where the bytes of endpoint 0 go while a request of ours runs
        this.given = []; // and what it takes
        this.room = 0;
        this.cdc.onSerialData = (bytes) => (this.text += Buffer.from(bytes).toString());
        this.cdc.onDeviceConnected = () => (this.found = true);
        const onWrite = this.usb.onEndpointWrite;
        this.usb.onEndpointWrite = (endpoint, bytes) => {
            if (endpoint === 0 && this.asked !== null) this.asked.push(Buffer.from(bytes));
            else onWrite(endpoint, bytes);
        };
        this.usb.onEndpointRead = (endpoint, bytes) => {
            if (endpoint === 0) this.usb.endpointReadDone(0, new Uint8Array(this.given.splice(0, bytes)));
            else if (endpoint === this.cdc.outEndpoint) {
                this.room = bytes;
                this.deliver();
            }
        };
    }

    deliver() {
        if (this.room === 0 || this.typed.length === 0) return;
        const bytes = this.typed.splice(0, this.room);
        this.room = 0;
        this.usb.endpointReadDone(this.cdc.outEndpoint, new Uint8Array(bytes));
    }

    type(text) {
        this.typed.push(...Buffer.from(text));
        this.deliver();
    }

    // A request to endpoint 0: type, request, value, index, length; bytes to give. The packets of the answer are in asked afterwards.
    request(type, request, value, index, length, given = []) {
        this.asked = [];
        this.given = given;
        this.usb.epStallArm = 0;
        this.usb.sendSetupPacket(new Uint8Array([type, request, value & 255, value >> 8, index & 255, index >> 8, length & 255, length >> 8]));
    }

    get refused() {
        return this.usb.epStallArm === 3;
    }

    open(yes = true) {
        this.request(0x21, 0x22, yes ? 3 : 0, 0, 0);
    }
}
