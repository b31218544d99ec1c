"""A stand-in for the board's bootloader: speaks avr109 on a pty as Caterina does, and fails on request.

Behaviour after Atmel's application note AVR109 and what Caterina answers (Arduino AVR core, bootloaders/caterina): no
command 'v', software id "CATERIN", device code 0x44, blocks of one page."""
import os
import select
import threading
import tty

FLASH_SIZE = 0x8000
BOOT_SECTION = 0x7000
PAGE_SIZE = 128
FIXED_ANSWERS = {"\x1B": b"", "S": b"CATERIN", "V": b"10", "p": b"S", "a": b"Y", "b": b"Y\0\x80", "t": b"\x44\0",
                 "P": b"\r", "L": b"\r", "E": b"\r"}


class Ended(Exception):
    pass


class CaterinaStandIn:
    """Answers until it is stopped; then what it holds can be looked at.

    signature: the chip's. fuses: low, high, extended (bits 4 to 7 do not exist and read as 1), lock. worn_address: the
    bits of this byte of flash cannot be written. dies_after: it answers so many blocks and nothing more, and its port
    is gone if it is unplugged."""

    def __init__(self, signature=b"\x1E\x95\x87", fuses=b"\xFF\xD0\xF8\xEF", worn_address=None, dies_after=None,
                 unplugged=False):
        self.fixed_answers = {**FIXED_ANSWERS, "s": signature[::-1]}
        for command, fuse in zip("FNQr", fuses):
            self.fixed_answers[command] = bytes([fuse])
        self.worn_address = worn_address
        self.blocks_to_answer = dies_after
        self.unplugged = unplugged
        # The flash is not blank at first: an old sketch fills it, the bootloader its own section.
        self.flash = bytearray(b"\x5A" * FLASH_SIZE)
        self.address = 0  # in bytes
        self.commands = ""  # every command in the order of arrival
        self.complaint = ""  # what a real one would have come to harm by
        # Both ends stay open: without any opener of the other end the master reads errors.
        self.master, self.other_end = os.openpty()
        tty.setraw(self.other_end)
        self.port = os.ttyname(self.other_end)
        self.silent = os.eventfd(0)  # can be read once a command has come that it does not answer
        self.end = os.eventfd(0)
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def stop(self):
        os.eventfd_write(self.end, 1)
        self.thread.join()

    def run(self):
        try:
            while self.blocks_to_answer != 0:
                command = chr(self.read(1)[0])
                self.commands += command
                os.write(self.master, self.answer(command))
            self.read(1)
            if self.unplugged:
                os.close(self.master)
            os.eventfd_write(self.silent, 1)
        except Ended:
            pass

    def answer(self, command):
        if command == "A":
            self.address = 2 * int.from_bytes(self.read(2), "big")
        elif command == "T":
            self.read(1)
        elif command == "e":
            self.flash[:BOOT_SECTION] = b"\xFF" * BOOT_SECTION
        elif command in "gB":
            return self.block(command)
        else:
            return self.fixed_answers.get(command, b"?")
        return b"\r"

    def block(self, command):
        """A block to read or to write."""
        if self.blocks_to_answer:
            self.blocks_to_answer -= 1
        size = int.from_bytes(self.read(2), "big")
        if self.read(1) != b"F":
            self.complaint = "a block of the EEPROM"
        begin, end = self.address, self.address + size
        self.address = end
        if command == "g":
            return bytes(self.flash[begin:end])
        self.write_page(begin, self.read(size))
        return b"\r"

    def write_page(self, begin, block):
        """The page is erased and written as a whole; the lock bits keep the boot section as it is."""
        if begin % PAGE_SIZE != 0 or len(block) > PAGE_SIZE:
            self.complaint = "a block is not one page"
        if begin >= BOOT_SECTION:
            self.complaint = "a block for the boot section"
            return
        self.flash[begin:begin + PAGE_SIZE] = block.ljust(PAGE_SIZE, b"\xFF")
        if self.worn_address in range(begin, begin + PAGE_SIZE):
            self.flash[self.worn_address] = 0xFF

    def read(self, size):
        data = b""
        while len(data) < size:
            # What has arrived is answered before the end.
            if self.master not in select.select([self.master, self.end], [], [])[0]:
                raise Ended
            data += os.read(self.master, size - len(data))
        return data
