"""A tree like /sys and /dev with USB serial devices in it, and a port that sees how it is opened."""
import os
import select
import shutil
import termios


class FakeUsb:
    """Folders and links as Linux lays them out for USB serial devices."""

    def __init__(self, folder):
        self.sys = folder / "sys"
        self.dev = folder / "dev"
        self.listed = self.sys / "class/tty"
        self.sockets = self.sys / "devices/usb1"
        for new in (self.listed, self.dev, self.sockets):
            new.mkdir(parents=True)
        # What else every machine has: the USB host itself, and a UART that is not on USB.
        self.write_ids(self.sockets, "1d6b:0002")
        uart = self.sys / "devices/platform/serial8250/tty/ttyS0"
        uart.mkdir(parents=True)
        (uart / "device").symlink_to(uart.parent.parent)
        (self.listed / "ttyS0").symlink_to(uart)

    @staticmethod
    def write_ids(device, usb_id):
        for file, value in zip(("idVendor", "idProduct"), usb_id.split(":")):
            (device / file).write_text(value + "\n")

    def plug_in(self, socket, usb_id, tty, port=None, product=None):
        """A device in `socket` ("1-1.2") whose port /dev/`tty` is `port`, or no file at all."""
        interface = self.sockets / socket / f"{socket}:1.0"
        node = interface / "tty" / tty
        node.mkdir(parents=True)
        (node / "device").symlink_to(interface)
        self.write_ids(self.sockets / socket, usb_id)
        if product:
            (self.sockets / socket / "product").write_text(product + "\n")
        if port:
            (self.dev / tty).symlink_to(port)
        (self.listed / tty).symlink_to(node)

    def unplug(self, socket, tty):
        (self.listed / tty).unlink()
        (self.dev / tty).unlink(missing_ok=True)
        shutil.rmtree(self.sockets / socket)


class SketchPort:
    """The port of a running sketch, until its `with` ends."""

    def __enter__(self):
        self.master, other_end = os.openpty()
        self.name = os.ttyname(other_end)
        os.close(other_end)
        return self

    def __exit__(self, *_):
        os.close(self.master)

    def touched(self):
        """It was opened at 1200 baud with hang-up on close, and nobody has it open any more."""
        waiting = select.poll()
        waiting.register(self.master, 0)
        # On Linux the master shows the settings of the other end.
        _, _, control_modes, _, _, speed, _ = termios.tcgetattr(self.master)
        closed = waiting.poll(0) == [(self.master, select.POLLHUP)]
        return closed and speed == termios.B1200 and control_modes & termios.HUPCL != 0
