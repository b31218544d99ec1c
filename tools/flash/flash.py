#!/usr/bin/env python3
"""Brings an image onto the robot's board over USB, and checks the board's fuses.

Ends with 0: done, 1: it failed, 2: the input was wrong, and then one line on standard error says what."""
import argparse
import contextlib
import errno
import fcntl
import os
import re
import select
import signal
import subprocess
import sys
import termios
import time
from pathlib import Path
from typing import NamedTuple

TOUCHES = 3
AFTER_TOUCH_S = 5.0  # reset 0.12 s, enumeration 1 to 2 s
LOOK_EVERY_S = 0.05
# avrdude waits 5 s for an answer of the bootloader, and erasing the chip takes 2 s.
AVRDUDE_SILENCE_S = 8.0
# avrdude 7.1 does not stop at this line: it tries the rest byte by byte, 5 s each.
NO_ANSWER = "programmer is not responding"
USB_ID = "[0-9A-Fa-f]{4}:[0-9A-Fa-f]{4}"
BOOTLOADER = "avr109"  # avrdude's name for it, among its programmers
RESET_TWICE = ("press its reset button twice within 750 ms (its yellow LED then fades in and out for 8 s) "
               "and try again")
# Name, avrdude's name, value of Pololu's boards (bootloaders/caterina/Caterina-A-Star.txt of github.com/pololu/a-star),
# and the bits that exist (ATmega16U4/32U4 data sheet 7766, chapter 28): the others read as 1, whatever is written.
# In the order in which they are written: the lock byte last.
FUSES = (("low", "lfuse", "0xFF", 0xFF), ("high", "hfuse", "0xD0", 0xFF),
         ("extended", "efuse", "0xC8", 0x0F), ("lock", "lock", "0xEF", 0x3F))


class Failure(Exception):
    exit_code = 1


class WrongInput(Failure):
    exit_code = 2


# A test puts its own in place of these two.
pause = time.sleep


def output_within(file, seconds):
    """Whether there is something to read, or the end, in time."""
    return bool(select.select([file], [], [], seconds)[0])


# ---- finding the board ----

class UsbPort(NamedTuple):
    device: str  # "/dev/ttyACM0"
    usb_id: str  # "1ffb:2300", as lsusb writes it
    # The socket the device is plugged into, in the kernel's words: "1-1.2". It stays when the device resets and
    # comes back with another id or as another tty.
    socket: str
    product: str  # what the device calls itself; may be empty

    def __str__(self):
        return f"{self.device} (USB {self.usb_id}{self.product and ', ' + self.product})"


def first_line(file):
    """Empty without the file."""
    with contextlib.suppress(OSError):
        return file.read_text(errors="replace").partition("\n")[0]
    return ""


def usb_ports(args):
    """The serial ports of USB devices, as the kernel lists them in sysfs; without one that is just unplugged."""
    ports = []
    for tty in sorted(Path(args.sys, "class/tty").glob("*")):
        # An interface lies between a tty and its USB device, and for USB-to-serial chips a port as well.
        above = (tty / "device").resolve().parents
        device = next((folder for folder in above if (folder / "idVendor").exists()), None)
        if device is None:
            continue
        usb_id = first_line(device / "idVendor") + ":" + first_line(device / "idProduct")
        if re.fullmatch(USB_ID, usb_id):
            name = os.path.join(args.dev, tty.name)
            ports.append(UsbPort(name, usb_id, device.name, first_line(device / "product")))
    return ports


def listed(ports):
    return ", ".join(map(str, ports)) or "none"


def find_board(args):
    """The port that was asked for; without one, that of the only board."""
    ports = usb_ports(args)
    boards = [port for port in ports if port.usb_id in (args.sketch_usb, args.bootloader_usb)]
    if args.port and not os.path.exists(args.port):
        raise WrongInput(f"PORT={args.port} does not exist; serial ports on USB: {listed(ports)}")
    if args.port:
        # Names may be links (/dev/serial/by-id/...).
        asked_for = [port for port in ports if os.path.realpath(port.device) == os.path.realpath(args.port)]
        for port in asked_for:
            if port not in boards:
                raise WrongInput(f"PORT={args.port} is {port}, not the board, which is USB {args.sketch_usb} or, "
                                 f"in its bootloader, {args.bootloader_usb}")
        # Not on USB (a pty, a plain UART): nothing can be detected from outside, so it is taken for a bootloader.
        boards = asked_for or [UsbPort(args.port, args.bootloader_usb, "", "")]
    if not boards:
        raise Failure(f"no board found: looked for USB {args.sketch_usb} and, in its bootloader, {args.bootloader_usb} "
                      f"among the serial ports on USB: {listed(ports)}; if it is plugged in, {RESET_TWICE}")
    if len(boards) > 1:
        raise Failure(f"several boards found, choose one with PORT=...: {listed(boards)}")
    return boards[0]


# ---- starting its bootloader ----

def cannot_open(device, reason):
    """The failure to raise; `reason` is the operating system's, which avrdude passes on."""
    if reason in (os.strerror(errno.EACCES), os.strerror(errno.EPERM)):
        return Failure(f"no right to open {device}: install the udev rule tools/flash/60-screed.rules "
                       "(docs/flashing.md) and plug the board in again")
    if reason == os.strerror(errno.EBUSY):
        return Failure(f"{device} is in use: end the serial monitor (or ModemManager) that holds it")
    return Failure(f"cannot open {device}: {reason}")


def touch_at_1200_baud(device):
    """Opens and closes it; that it has just vanished is no error."""
    try:
        port = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    except OSError as error:
        if error.errno in (errno.ENOENT, errno.ENODEV, errno.ENXIO, errno.EIO):
            return
        raise cannot_open(device, error.strerror) from None
    with contextlib.suppress(OSError, termios.error):
        settings = termios.tcgetattr(port)
        settings[2] |= termios.HUPCL  # control modes: the kernel lowers DTR at the last close
        settings[4] = settings[5] = termios.B1200
        termios.tcsetattr(port, termios.TCSANOW, settings)
        # And here, for a port that another program keeps open: then ours is not the last close.
        fcntl.ioctl(port, termios.TIOCMBIC, termios.TIOCM_DTR.to_bytes(4, sys.byteorder))
    os.close(port)


def start_bootloader(args):
    """Finds the board and returns its bootloader's port: the board's own when it is there already, otherwise the one
    that appears in the same socket after a touch, under whatever name."""
    board = find_board(args)
    if board.usb_id == args.bootloader_usb:
        return board.device

    def in_socket(usb_id):
        for port in usb_ports(args):
            if port.socket == board.socket and port.usb_id == usb_id:
                return port.device
        return ""

    no_right = ""
    for _ in range(TOUCHES):
        # A reset may have given the sketch's port another name; while it is away there is only waiting.
        sketch = in_socket(args.sketch_usb)
        if sketch:
            print(f"restarting {sketch} in its bootloader")
            touch_at_1200_baud(sketch)
        for _ in range(round(AFTER_TOUCH_S / LOOK_EVERY_S)):
            found = in_socket(args.bootloader_usb)
            if os.access(found, os.R_OK | os.W_OK):
                return found
            # The kernel shows a port a moment before udev has given it its rights.
            if os.path.exists(found):
                no_right = found
            pause(LOOK_EVERY_S)
    if no_right:
        raise cannot_open(no_right, os.strerror(errno.EACCES))
    raise Failure(f"no bootloader: {board.device} was opened at 1200 baud {TOUCHES} times, but no USB "
                  f"{args.bootloader_usb} came up in its place; {RESET_TWICE}")


# ---- avrdude ----

def avrdude_command(args, port, operations):
    command = [args.avrdude, "-p", args.mcu, "-c", args.programmer]
    if port:  # an ISP programmer on USB has none
        command += ["-P", port]
    if args.programmer == BOOTLOADER:  # USB has no baud rate; the number is what Caterina is documented with
        command += ["-b", "57600"]
    return command + operations


def run_avrdude(args, port, operations):
    """What avrdude said. Whatever goes wrong is raised as one line; nothing waits for avrdude without end."""
    try:
        child = subprocess.Popen(avrdude_command(args, port, operations), stdin=subprocess.DEVNULL,
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    except FileNotFoundError:
        raise Failure(f"{args.avrdude} is not installed: make deps, or apt install {args.avrdude}") from None
    except OSError as error:
        raise Failure(f"cannot run {args.avrdude}: {error.strerror}") from None
    said = ""
    with child:
        while answers := output_within(child.stdout, AVRDUDE_SILENCE_S):
            piece = os.read(child.stdout.fileno(), 4096).decode(errors="replace")
            said += piece
            if args.verbose:
                print(piece, end="", file=sys.stderr, flush=True)
            if not piece or NO_ANSWER in said:
                break
        if not answers or NO_ANSWER in said:
            child.kill()
            raise Failure(f"no answer from {port or args.programmer} " + (
                "half-way: the image on the board is incomplete; reset it twice and flash again"
                if "erasing chip" in said else
                "to avrdude's first questions: is it a bootloader, and still running (8 s)?"))
    if child.returncode != 0:
        raise avrdude_failure(args, said, child.returncode)
    return said


def avrdude_failure(args, said, exit_code):
    chip = re.search(r"signature = 0x(\w\w)(\w\w)(\w\w)", said)
    expected = re.search(r"expected signature for (.*?) is (.*)", said)
    if chip and expected:
        return Failure(f"wrong chip: its signature is {' '.join(chip.groups()).upper()}, that of an {expected[1]} is "
                       f"{expected[2]}; nothing was written")
    if byte := re.search(r"device (\w+) != input (\w+) at addr (\w+)", said):
        return Failure(f"verification failed at address {byte[3]}: the board has {byte[1]}, the image {byte[2]}; "
                       "do not let this image drive, flash again")
    if refused := re.search(r"cannot open port (.*): (.*)", said):
        return cannot_open(*refused.groups())
    error = re.search(r"(?:error|warning): (.*)", said)
    return Failure(f"{args.avrdude} failed: {error[1] if error else f'exit code {exit_code}'}")


# ---- commands ----

def print_port(args):
    """Print the board's serial port."""
    print(find_board(args).device)


def write_image(args):
    """Find the board, start its bootloader, write and verify an image."""
    if not os.path.isfile(args.image):
        raise WrongInput(f"no image {args.image}: make firmware builds it")
    args.programmer = BOOTLOADER
    port = start_bootloader(args)
    print(f"writing {args.image} through {port}")
    # The erase comes first so that an interrupted run leaves no mixture of two images: what is missing reads 0xFF,
    # which the processor runs through up to the bootloader.
    said = run_avrdude(args, port, ["-e", "-U", f"flash:w:{args.image}:i"])
    verified = re.search(r"(\d+) bytes of flash verified", said)
    if not verified:
        raise Failure(f"{args.avrdude} did not say that it verified the image")
    print(f"{verified[1]} bytes written and verified; the board starts them now")


def explanation(low, high, extended, lock):
    """What the values mean, a line each (data sheet 7766: clock sources in chapter 6, boot size 27, brown-out 29)."""
    def programmed(byte, bit):
        return byte & 1 << bit == 0

    source = low & 0x0F
    clock = "crystal" if source >= 8 else {0: "external clock", 2: "internal RC oscillator"}.get(
        source, f"clock source {source}")
    start = f"bootloader at 0x{0x8000 - (4096 >> (high >> 1 & 3)):04X}" if programmed(high, 0) else "sketch"
    brown_out = ("4.3 V", "3.5 V", "3.4 V", "2.6 V", "2.4 V", "2.2 V", "2.0 V", "off")[extended & 7]
    return (f"low       0x{low:02X}  {clock}{', divided by 8' if programmed(low, 7) else ''}\n"
            f"high      0x{high:02X}  reset starts the {start}, "
            f"{'EEPROM survives an erase' if programmed(high, 3) else 'an erase clears the EEPROM'}, "
            f"{'JTAG on' if programmed(high, 6) else 'JTAG off (PF4 to PF7 are pins)'}\n"
            f"extended  0x{extended:02X}  brown-out reset {brown_out}\n"
            f"lock      0x{lock:02X}  sketches {'cannot' if programmed(lock, 4) else 'can'} overwrite the bootloader\n")


def print_or_compare_fuses(args):
    """Print the fuses that the board should have, or compare them with the board's."""
    wanted = [getattr(args, name) for name, *_ in FUSES]
    writing, reading = [], ["-qq"]
    for (_, fuse, *_), value in zip(FUSES, wanted):
        writing += ["-U", f"{fuse}:w:0x{value:02X}:m"]
        reading += ["-U", f"{fuse}:r:-:h"]
    if args.write and not args.programmer:
        raise WrongInput("WRITE=yes needs PROGRAMMER=..., an ISP programmer that avrdude knows")
    if args.write and args.programmer == BOOTLOADER:
        raise WrongInput("PROGRAMMER=avr109, the bootloader, can read fuses but not write them: that takes "
                         "an ISP programmer")
    if not args.programmer:
        args.programmer = "PROGRAMMER"
        print(f"{explanation(*wanted)}\nto write them with an ISP programmer:\n"
              f"  {' '.join(avrdude_command(args, '', writing))}\n"
              "to compare them with the board's, which writes nothing: PROGRAMMER=avr109 (the bootloader, over USB) "
              "or an ISP programmer's name")
        return
    port = start_bootloader(args) if args.programmer == BOOTLOADER else args.port
    if args.write:
        run_avrdude(args, port, writing)
    found = re.findall(r"^0x[0-9a-f]+$", run_avrdude(args, port, reading), re.MULTILINE)  # in the order of asking
    if len(found) != len(FUSES):
        raise Failure(f"{args.avrdude} did not report the fuses")
    wrong = []
    for (name, _, _, used_bits), value, read in zip(FUSES, wanted, map(parse_byte, found)):
        print(f"{name} fuse: should be 0x{value:02X}, is 0x{read:02X}")
        if (value ^ read) & used_bits:
            wrong.append(name)
    if wrong:
        raise Failure(f"the board's fuses differ from what they should be: {', '.join(wrong)}")
    print("the fuses are right (bits that do not exist read as 1)")


# ---- the command line ----

class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise WrongInput(f"{message} (see {self.prog} --help)")


def parse_usb_id(text):
    if not re.fullmatch(USB_ID, text):
        raise argparse.ArgumentTypeError(f"'{text}': two numbers of four hexadecimal digits, as 1ffb:2300")
    return text.lower()


def parse_byte(text):
    if not re.fullmatch(r"(0[xX])?[0-9A-Fa-f]{1,2}", text):
        raise argparse.ArgumentTypeError(f"'{text}': a byte in hexadecimal, as 0xD0")
    return int(text, 16)


def parse(words):
    usb = Parser(add_help=False)
    # Pololu's boards with an ATmega32U4: boards.txt of github.com/pololu/a-star.
    usb.add_argument("--sketch-usb", type=parse_usb_id, default="1ffb:2300", metavar="ID",
                     help="USB id of the board while its sketch runs (default: %(default)s)")
    usb.add_argument("--bootloader-usb", type=parse_usb_id, default="1ffb:0101", metavar="ID",
                     help="USB id of the board's bootloader (default: %(default)s)")
    usb.add_argument("--port", help="serial port (default: search for the board on USB)")
    usb.add_argument("--sys", default="/sys", help="directory of the kernel's devices (default: %(default)s)")
    usb.add_argument("--dev", default="/dev", help="directory of the device files (default: %(default)s)")
    avrdude = Parser(add_help=False, parents=[usb])
    avrdude.add_argument("--mcu", required=True, help="avrdude's name of the microcontroller")
    avrdude.add_argument("--avrdude", default="avrdude", help="path of the avrdude program (default: search PATH)")
    avrdude.add_argument("--verbose", action="store_true", help="show avrdude's output")

    parser = Parser(prog="screed_flash", description="Flashes the robot's board over USB.")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)

    def command(name, action, options):
        added = commands.add_parser(name, help=action.__doc__, description=action.__doc__, parents=[options])
        added.set_defaults(action=action)
        return added

    write = command("write", write_image, avrdude)
    write.add_argument("image", help="Intel HEX file to write")
    command("port", print_port, usb)
    fuses = command("fuses", print_or_compare_fuses, avrdude)
    for name, _, value, _ in FUSES:
        fuses.add_argument(f"--{name}", type=parse_byte, default=value, metavar="BYTE",
                           help=f"expected {name} byte, hexadecimal (default: %(default)s)")
    fuses.add_argument("--programmer", help="avrdude's name of an ISP programmer, or avr109 for the bootloader")
    fuses.add_argument("--write", action="store_true", help="write the fuses before comparing")
    return parser.parse_args(words)


def main(words):
    """The exit code."""
    try:
        args = parse(words)
        args.action(args)
    except (Failure, OSError) as error:
        print(f"screed_flash: {error}", file=sys.stderr)
        return getattr(error, "exit_code", 1)
    return 0


if __name__ == "__main__":
    for stop in (signal.SIGINT, signal.SIGPIPE):
        signal.signal(stop, signal.SIG_DFL)  # ends without a list of calls
    sys.stdout.reconfigure(line_buffering=True)  # in a pipe, too, an error comes after what was said before it
    sys.exit(main(sys.argv[1:]))
