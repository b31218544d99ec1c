"""What the flash tool's tests have in common: a made-up USB tree, the real avrdude with a stand-in for the bootloader,
and time that passes only where a test lets it."""
import contextlib
import io
import select
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from caterina_stand_in import CaterinaStandIn
from fake_usb import FakeUsb

PROGRAM = Path(__file__).parents[2] / "tools/flash/flash.py"
sys.path.append(str(PROGRAM.parent))
import flash

SKETCH = "1ffb:2300"
BOOTLOADER = "1ffb:0101"


class FlashCase(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.usb = FakeUsb(self.folder)
        self.board = None
        self.now_ms = 0
        self.at_ms = {}  # what the world does, and when
        self.enterContext(mock.patch.multiple(flash, pause=self.pause, output_within=self.output_within))

    def pause(self, seconds):
        self.now_ms += round(1000 * seconds)
        if self.now_ms in self.at_ms:
            self.at_ms[self.now_ms]()

    def output_within(self, file, _):
        """Time is up when the board does not answer and avrdude has said all that it can say."""
        silent = [self.board.silent] if self.board else []
        return file in select.select([file, *silent], [], [])[0]

    def bootloader(self, **behaviour):
        self.board = CaterinaStandIn(**behaviour)
        self.addCleanup(self.board.stop)
        return self.board

    def screed_flash(self, command, *words):
        """Exit code, standard output, standard error."""
        words = [command, "--sys", self.usb.sys, "--dev", self.usb.dev, *words]
        with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
            code = flash.main([str(word) for word in words])
        return code, out.getvalue(), err.getvalue()

    def write(self, *words):
        return self.screed_flash("write", "--mcu", "atmega32u4", *words)

    def failure(self, result, exit_code):
        """The one line that it ended with."""
        code, _, said = result
        self.assertEqual(code, exit_code, said)
        self.assertRegex(said, r"\Ascreed_flash: .*\n\Z")
        return said.removeprefix("screed_flash: ").removesuffix("\n")

    def image_of(self, size):
        """A HEX file, no two pages alike."""
        binary, image = self.folder / "image.bin", self.folder / "image.hex"
        binary.write_bytes(bytes((i * 7 + i // 128) % 256 for i in range(size)))
        subprocess.run(["avr-objcopy", "-I", "binary", "-O", "ihex", binary, image], check=True)
        return image

    def bytes_of(self, image):
        """According to binutils."""
        binary = self.folder / "expected.bin"
        subprocess.run(["avr-objcopy", "-I", "ihex", "-O", "binary", image, binary], check=True)
        return binary.read_bytes()

    def avrdude(self, script):
        """An avrdude that is this shell script."""
        program = self.folder / "avrdude"
        program.write_text("#!/bin/sh\n" + script)
        program.chmod(0o755)
        return "--avrdude", program
